#include "wellgyro/io/toml/wits_file.h"

#include <string>

#include "wellgyro/base/units.h"
#include "wellgyro/io/formats.h"
#include "wellgyro/io/text_file.h"
#include "wellgyro/io/toml/toml_internal.h"

namespace wellgyro {
namespace {

WitsItems TakeWits(TomlTable& root) {
  WitsItems items;
  if (auto table = root.FindTable("items")) {
    const auto item = [&table](std::string_view key, int& value) {
      value = static_cast<int>(table->FindInteger(key, 101, 9999).value_or(value));
    };
    item("date", items.date);
    item("time", items.time);
    item("bit_depth", items.bit_depth);
  }
  items.length_unit =
      root.FindWord<double>("depth_unit", {{"m", 1.0}, {"ft", units::kFoot}}).value_or(1.0);
  root.Read("utc_offset_h", items.utc_offset, units::kHour, {.min = -14, .max = 14});
  root.Read("depth_sigma_m", items.sigma, 1, {.min = 0, .max = 100});
  items.kind = root.FindWord<DepthKind>("kind", {{"indicated", DepthKind::kIndicated},
                                                 {"wireline", DepthKind::kWireline},
                                                 {"drillpipe", DepthKind::kDrillPipe},
                                                 {"tubing", DepthKind::kTubing},
                                                 {"other", DepthKind::kOther}})
                   .value_or(items.kind);
  return items;
}

}  // namespace

Result<WitsItems> ParseWitsItems(std::string_view text, const std::filesystem::path& source) {
  return ReadTomlText<WitsItems>(text, source.string(), formats::kWits, TakeWits);
}

Result<WitsItems> ReadWitsItems(const std::filesystem::path& path) {
  const Result<std::string> text = ReadTextFile(path);
  if (!text) return text.fault();
  return ParseWitsItems(*text, path);
}

}  // namespace wellgyro
