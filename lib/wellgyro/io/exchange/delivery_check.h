#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "wellgyro/base/export.h"
#include "wellgyro/base/result.h"

namespace wellgyro {

/// What a file is that is written for others and not read back: an OSDU manifest or the CSV of its
/// stations, GeoJSON, KML, GeoPackage. Nothing where it is none of them.
WELLGYRO_EXPORT std::optional<std::string> DeliveryKind(const std::filesystem::path& path);

/// Whether such a file is whole: JSON that closes what it opens, XML that parses, a database of as
/// many pages as its head says, a table with its end. Fault kSize where it is cut.
WELLGYRO_EXPORT std::optional<Fault> CheckDelivery(const std::filesystem::path& path);

}  // namespace wellgyro
