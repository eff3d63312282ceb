#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

#include "wellgyro/base/export.h"
#include "wellgyro/base/result.h"
#include "wellgyro/record/check.h"
#include "wellgyro/record/depth.h"
#include "wellgyro/record/operations.h"
#include "wellgyro/record/quality.h"
#include "wellgyro/record/station.h"

/// The words that files use for what records hold, one list for reading and writing.
namespace wellgyro {

enum class Propagation;

WELLGYRO_EXPORT std::string_view WordOf(StationKind kind);      ///< tie_in, gyrocompass, ...
WELLGYRO_EXPORT std::string_view WordOf(StationStatus status);  ///< provisional, field, ...
WELLGYRO_EXPORT std::string_view WordOf(Pass pass);             ///< stationary, in, out, repeat
WELLGYRO_EXPORT std::string_view WordOf(Verdict verdict);       ///< pass, warn, fail, not_done
WELLGYRO_EXPORT std::string_view WordOf(Event::Kind kind);      ///< depth_zero, depth_rezero, ...
WELLGYRO_EXPORT std::string_view WordOf(DepthKind kind);        ///< indicated, wireline, ...
WELLGYRO_EXPORT std::string_view WordOf(FaultCode code);        ///< io, foreign, fingerprint, ...
WELLGYRO_EXPORT std::string_view WordOf(Propagation reach);     ///< random, systematic, ...

/// `good`, or the names of the set flags joined by `+`: moved mirror vertical saturated gap depth
/// temperature aliased gravity earth_rate clock unfit.
WELLGYRO_EXPORT std::string QualityText(Quality quality);

/// "1 stop", "0 stops", "3 stops".
WELLGYRO_EXPORT std::string Counted(std::size_t count, std::string_view noun);

/// Back from the word; nothing for any other word.
WELLGYRO_EXPORT std::optional<StationKind> StationKindOf(std::string_view word);
WELLGYRO_EXPORT std::optional<Event::Kind> EventKindOf(std::string_view word);
WELLGYRO_EXPORT std::optional<DepthKind> DepthKindOf(std::string_view word);
WELLGYRO_EXPORT std::optional<Quality> QualityOf(std::string_view text);

}  // namespace wellgyro
