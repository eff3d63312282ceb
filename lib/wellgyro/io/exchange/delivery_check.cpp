#include "wellgyro/io/exchange/delivery_check.h"

#include <cstdint>
#include <string_view>

#include "wellgyro/io/exchange/line_reader_internal.h"
#include "wellgyro/io/exchange/xml_internal.h"
#include "wellgyro/io/text_file.h"

namespace wellgyro {
namespace {

constexpr std::int64_t kMost = std::int64_t{1} << 31;  // [bytes] of a file, held whole: 2 GiB

std::uint32_t BigEndian(std::string_view bytes, std::size_t at, int count) {
  std::uint32_t number = 0;
  for (int k = 0; k < count; ++k) {
    number = number << 8 | static_cast<unsigned char>(bytes[at + static_cast<std::size_t>(k)]);
  }
  return number;
}

bool JsonCloses(std::string_view text) {
  int depth = 0;
  bool quoted = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (quoted) {
      if (c == '\\') ++i;
      quoted = c != '"';
    } else if (c == '"') {
      quoted = true;
    } else if (c == '{' || c == '[') {
      ++depth;
    } else if (c == '}' || c == ']') {
      --depth;
    }
  }
  return depth == 0 && !quoted;
}

bool PagesAreThere(std::string_view bytes) {
  if (bytes.size() < 100) return false;
  const std::uint32_t size = BigEndian(bytes, 16, 2), pages = BigEndian(bytes, 28, 4);
  return std::uint64_t{size == 1 ? 65536 : size} * pages == bytes.size();
}

bool XmlCloses(const std::string& text, const std::filesystem::path& path) {
  try {
    const XmlFile xml(text, path.string());
    return true;
  } catch (const TextError&) {
    return false;
  }
}

bool StartsDatabase(std::string_view head) { return head.starts_with("SQLite format 3"); }
bool StartsTable(std::string_view head) { return head.starts_with("MD,Inclination,Azimuth"); }

}  // namespace

std::optional<std::string> DeliveryKind(const std::filesystem::path& path) {
  const Result<std::string> read = ReadTextHead(path, 1 << 16);
  if (!read) return std::nullopt;
  const std::string_view head = *read;
  const auto has = [&](std::string_view word) { return head.find(word) != head.npos; };
  if (StartsDatabase(head)) {
    return head.substr(0, 100).find("GPKG") != head.npos ? "a GeoPackage" : "an SQLite database";
  }
  if (StartsTable(head)) return "the stations of an OSDU manifest";
  if (head.starts_with('{') && has("work-product-component--WellboreTrajectory")) {
    return "an OSDU manifest of a trajectory";
  }
  if (head.starts_with('{') && has("\"FeatureCollection\"")) return "a GeoJSON map";
  if (head.starts_with("<?xml") && has("<kml")) return "a KML map";
  return std::nullopt;
}

std::optional<Fault> CheckDelivery(const std::filesystem::path& path) {
  const Result<std::string> text = ReadTextFile(path, kMost);
  if (!text) return text.fault();
  bool whole = true;
  if (StartsDatabase(*text)) {
    whole = PagesAreThere(*text);
  } else if (StartsTable(*text)) {
    whole = text->ends_with("\n\n");
  } else if (text->starts_with('{')) {
    whole = JsonCloses(*text);
  } else {
    whole = XmlCloses(*text, path);
  }
  if (whole) return std::nullopt;
  return Fault{.code = FaultCode::kSize, .text = "the file is cut", .source = path.string()};
}

}  // namespace wellgyro
