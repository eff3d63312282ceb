#pragma once

#include <filesystem>
#include <string_view>

#include "wellgyro/base/export.h"
#include "wellgyro/base/result.h"
#include "wellgyro/record/wits_items.h"

namespace wellgyro {

/// Reads which items of a rig's WITS stream mean what, `format = "wellgyro.wits/1"`: `[items]` with
/// date, time and bit_depth as RRII (record, item), `depth_unit` ("m" or "ft"), `utc_offset_h`,
/// `depth_sigma_m` and `kind`. What is absent is as WitsItems has it.
WELLGYRO_EXPORT Result<WitsItems> ReadWitsItems(const std::filesystem::path& path);
WELLGYRO_EXPORT Result<WitsItems> ParseWitsItems(std::string_view text,
                                                 const std::filesystem::path& source);

}  // namespace wellgyro
