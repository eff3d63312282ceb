#include <algorithm>
#include <cmath>
#include <fstream>
#include <limits>
#include <system_error>
#include <vector>

#include <fmt/core.h>
#include <fmt/ranges.h>

#include "wellgyro/io/sensor/sensor_layout_internal.h"
#include "wellgyro/io/sensor/series_file.h"
#include "wellgyro/io/text_file.h"
#include "wellgyro/io/text_internal.h"
#include "wellgyro/noise/clean_series.h"

namespace wellgyro {
namespace {

// Nothing when it is no number; NaN for an empty field.
std::optional<double> NumberOrGap(std::string_view field) {
  return field.empty() ? std::numeric_limits<double>::quiet_NaN() : AnyNumberOf(field);
}

struct NamedUnit {
  std::string_view ending, unit;
};
constexpr NamedUnit kEndings[] = {
    {"_deg_per_h", "deg/h"}, {"_dph", "deg/h"}, {"_deg_per_s", "deg/s"}, {"_dps", "deg/s"},
    {"_rad_per_s", "rad/s"}, {"_mps2", "m/s2"}, {"_milli_g", "mg"},      {"_mg", "mg"},
    {"_ms", "ms"},           {"_us", "us"},     {"_ns", "ns"},           {"_s", "s"}};

/// "gx_deg_per_h" and "GX (deg/h)" as "gx[deg/h]" and "GX[deg/h]"; others as they are.
std::string Bracketed(std::string_view heading) {
  const std::size_t open = heading.find('(');
  if (open != std::string_view::npos && heading.ends_with(')')) {
    return fmt::format("{}[{}]", heading.substr(0, open),
                       heading.substr(open + 1, heading.size() - open - 2));
  }
  // The longest that fits: "_deg_per_s" before "_s".
  const NamedUnit* best = nullptr;
  for (const NamedUnit& named : kEndings) {
    const bool longer = best == nullptr || named.ending.size() > best->ending.size();
    if (heading.ends_with(named.ending) && longer) best = &named;
  }
  if (best == nullptr) return std::string(heading);
  return fmt::format("{}[{}]", heading.substr(0, heading.size() - best->ending.size()), best->unit);
}

class CsvReader {
 public:
  CsvReader(const std::filesystem::path& path, const SeriesColumns& columns)
      : path_(path), columns_(columns) {}

  Result<SampleSeries> Read(const std::function<void(double)>& progress) {
    const Result<std::string> head = ReadTextHead(path_, 4096);
    if (!head) return head.fault();
    if (head->empty()) return Bad("this is an empty file");
    if (head->find('\0') != std::string::npos) {
      return Bad("these are binary numbers, not text: give --type f64, i16 or i32");
    }
    std::error_code ignored;
    const auto size = static_cast<double>(std::filesystem::file_size(path_, ignored));
    std::ifstream file(path_, std::ios::binary);
    double seen = 0;
    for (std::string line; !fault_ && std::getline(file, line);) {
      ++line_number_;
      seen += static_cast<double>(line.size() + 1);
      if (!line.empty() && line.back() == '\r') line.pop_back();
      const std::size_t begin = line.find_first_not_of(" \t");
      if (begin == std::string::npos) {
        ++blank_;
      } else if (line[begin] == '#') {
        blank_ = 0;  // what stands before a remark parts it from the samples
      } else {
        TakeLine(line);
      }
      if (progress && line_number_ % 65536 == 0) progress(seen / size);
    }
    if (fault_) return *fault_;
    if (file.bad()) return Bad("reading this file failed half way");
    if (series_.values.empty()) return Bad("there is not one sample in it");
    if (time_) {
      if (sequence_) return Bad("times and sample numbers say the same twice: name one of them");
      if (const auto wrong = PlaceByTime(series_, times_)) {
        Fault fault = Bad(wrong->text, FaultCode::kOrder);
        fault.line = wrong->sample > 0 ? lines_[wrong->sample] : 0;
        return fault;
      }
    }
    return std::move(series_);
  }

 private:
  Fault Bad(std::string text, FaultCode code = FaultCode::kForeign) const {
    return Fault{.code = code, .text = std::move(text), .source = path_.string()};
  }
  void Refuse(std::string text, FaultCode code = FaultCode::kSyntax, std::size_t field = 0) {
    fault_ = Bad(std::move(text), code);
    fault_->line = line_number_;
    if (field < fields_.size()) {
      fault_->column = static_cast<int>(fields_[field].data() - line_begin_) + 1;
    }
  }

  void TakeLine(const std::string& line) {
    line_begin_ = line.data();
    // Blanks separate only where nothing else does.
    if (!delimiter_) delimiter_ = DelimiterOf(line, ' ');
    SplitCells(line, *delimiter_, fields_);
    if (!columns_known_) {
      const bool header = std::any_of(fields_.begin(), fields_.end(),
                                      [](std::string_view f) { return !NumberOrGap(f); });
      FindColumns(header);
      columns_known_ = true;
      if (header || fault_) {
        blank_ = 0;
        return;
      }
    }
    LeaveBlanks();
    TakeSample();
  }

  // Where the value is the only column, an empty line between two samples is an empty field.
  void LeaveBlanks() {
    const bool fields = fields_.size() == 1 && !series_.values.empty();
    if (fields) {
      series_.values.insert(series_.values.end(), blank_, std::numeric_limits<double>::quiet_NaN());
    }
    blank_ = 0;
  }

  std::optional<std::size_t> Find(const std::string& name, bool header) {
    if (name.empty()) return std::nullopt;
    for (std::size_t i = 0; header && i < fields_.size(); ++i) {
      if (fields_[i] == name || fields_[i].substr(0, fields_[i].find('[')) == name) return i;
    }
    const std::optional<int> number = IntegerOf(name);
    if (number && *number >= 1 && static_cast<std::size_t>(*number) <= fields_.size()) {
      return static_cast<std::size_t>(*number) - 1;
    }
    Refuse(
        header
            ? fmt::format("no column is called {}; there are: {}", name, fmt::join(fields_, ", "))
            : fmt::format("no column {}: the file has {} and no header", name, fields_.size()),
        FaultCode::kRange, fields_.size());
    return std::nullopt;
  }

  void FindColumns(bool header) {
    sequence_ = Find(columns_.sequence, header);
    temperature_ = Find(columns_.temperature, header);
    value_ = Find(columns_.value, header);
    time_ = Find(columns_.time, header);
    if (fault_) return;
    if (header && !time_ && !sequence_) FindClock();
    if (header && !temperature_) FindTemperature();
    if (fault_) return;
    if (!value_) FindOnly(header);
    if (!value_ && !fault_) Refuse("no column beside times, numbers and temperatures");
    if (header && !fault_) TakeUnits();
  }

  // A clock's column under the names of tables of sensor data.
  void FindClock() {
    for (std::size_t i = 0; i < fields_.size(); ++i) {
      const auto headed = sensors::HeadedUnitOf(fields_[i]);
      const bool clock =
          headed && headed->clock && (headed->name == "TOOL" || headed->name == "UTC");
      if (clock && !time_) time_ = i;
    }
  }

  // TEMP under its name in tables of sensor data.
  void FindTemperature() {
    for (std::size_t i = 0; i < fields_.size() && !temperature_; ++i) {
      const bool named = fields_[i].substr(0, fields_[i].find('[')) == "TEMP";
      if (named && i != value_) temperature_ = i;
    }
  }

  // [K] is told from degC by what it says; any other unit is refused.
  void TakeTemperatureUnit() {
    const std::string_view heading = fields_[*temperature_];
    const std::size_t bracket = heading.find('[');
    if (bracket == std::string_view::npos || heading.substr(bracket) == "[degC]") return;
    if (heading.substr(bracket) == "[K]") {
      zero_degc_ = 273.15;
      return;
    }
    Refuse(fmt::format("column {} is no temperature in degC or K", heading), FaultCode::kForeign,
           *temperature_);
  }

  void TakeUnits() {
    if (temperature_) TakeTemperatureUnit();
    if (fault_) return;
    if (time_) {
      const std::string heading = Bracketed(fields_[*time_]);
      const auto headed = sensors::HeadedUnitOf(heading);
      constexpr double kPerSecond = 1e-9;
      if (headed && headed->clock && !headed->unit.empty()) {
        seconds_ = headed->factor * kPerSecond;
      }
    }
    const std::string heading = Bracketed(fields_[*value_]);
    const auto headed = sensors::HeadedUnitOf(heading);
    const bool known = headed && (headed->rate || headed->force);
    if (!known) {
      if (fields_[*value_].find('[') == std::string_view::npos) return;
      Refuse(fmt::format("column {} has no unit that is known: deg/h, deg/s, rad/s, m/s2, g, mg",
                         fields_[*value_]),
             FaultCode::kForeign, *value_);
      return;
    }
    if (headed->unit == "deg/h") series_.unit = "deg_per_h";
    if (headed->unit == "deg/s") series_.unit = "deg_per_s";
    if (headed->unit == "rad/s") series_.unit = "rad_per_s";
    if (headed->unit == "m/s2") series_.unit = "mps2";
    if (headed->unit == "mg" || headed->unit == "g") series_.unit = "milli_g";
    if (headed->unit == "g") scale_ = 1e3;
  }

  void FindOnly(bool header) {
    for (std::size_t i = 0; i < fields_.size(); ++i) {
      if (i == sequence_ || i == temperature_ || i == time_) continue;
      if (value_) {
        Refuse(fmt::format("which of its {} columns? Give --channel by name or number from 1{}{}",
                           fields_.size(), header ? ": " : "",
                           header ? fmt::format("{}", fmt::join(fields_, ", ")) : ""),
               FaultCode::kConflict, fields_.size());
        return;
      }
      value_ = i;
    }
  }

  // The number in a column of this line; refuses text.
  double Number(std::size_t column) {
    if (column >= fields_.size()) {
      Refuse(fmt::format("only {} fields where column {} is wanted", fields_.size(), column + 1),
             FaultCode::kSyntax, fields_.size());
      return 0;
    }
    const std::optional<double> number = NumberOrGap(fields_[column]);
    if (!number) {
      Refuse(fmt::format("\"{}\" is not a number", fields_[column].substr(0, 40)),
             FaultCode::kSyntax, column);
    }
    return number.value_or(0);
  }

  void TakeSample() {
    const double value = Number(*value_);
    const double temperature = temperature_ ? Number(*temperature_) : 0;
    const double sequence = sequence_ ? Number(*sequence_) : 0;
    const double time = time_ ? Number(*time_) : 0;
    if (fault_) return;
    if (sequence_ && !LeaveGap(sequence)) return;
    if (time_ && !std::isfinite(time)) {
      Refuse("a sample without a time", FaultCode::kRange, *time_);
      return;
    }
    if (time_) {
      if (times_.empty()) first_time_ = time;
      times_.push_back((time - first_time_) * seconds_);
      lines_.push_back(line_number_);
    }
    series_.values.push_back(scale_ * value);
    if (temperature_) series_.temperature.push_back(static_cast<float>(temperature - zero_degc_));
  }

  // Makes room for the samples that are missing before this one.
  bool LeaveGap(double sequence) {
    if (!(std::abs(sequence) < 0x1p53) || sequence != std::floor(sequence)) {
      Refuse("a sequence number must be whole", FaultCode::kRange, *sequence_);
      return false;
    }
    const auto number = static_cast<std::int64_t>(sequence);
    const std::int64_t missing = last_sequence_ ? number - *last_sequence_ - 1 : 0;
    if (missing < 0 || missing > kGapSamplesMost) {
      Refuse(fmt::format("sequence number {} follows {}", number, *last_sequence_),
             FaultCode::kOrder, *sequence_);
      return false;
    }
    last_sequence_ = number;
    if (missing == 0) return true;
    const auto begin = std::ssize(series_.values);
    series_.gaps.push_back({begin, begin + missing});
    const auto size = static_cast<std::size_t>(begin + missing);
    series_.values.resize(size, 0);
    if (temperature_) {
      series_.temperature.resize(size,
                                 series_.temperature.empty() ? 0 : series_.temperature.back());
    }
    return true;
  }

  const std::filesystem::path& path_;
  const SeriesColumns& columns_;
  SampleSeries series_;
  std::optional<char> delimiter_;
  std::vector<std::string_view> fields_;
  bool columns_known_ = false;
  std::optional<std::size_t> value_;
  std::optional<std::size_t> sequence_;
  std::optional<std::size_t> temperature_;
  std::optional<std::size_t> time_;
  std::vector<double> times_;  ///< [s] from the first
  std::vector<int> lines_;     ///< of the times
  double first_time_ = 0, seconds_ = 1, scale_ = 1, zero_degc_ = 0;
  std::optional<std::int64_t> last_sequence_;
  const char* line_begin_ = nullptr;
  int line_number_ = 0;
  std::size_t blank_ = 0;  ///< empty lines since the last that was taken
  std::optional<Fault> fault_;
};

}  // namespace

Result<SampleSeries> ReadCsvSeries(const std::filesystem::path& path, const SeriesColumns& columns,
                                   const std::function<void(double)>& progress) {
  return CsvReader(path, columns).Read(progress);
}

}  // namespace wellgyro
