#include "wellgyro/io/sensor/sensor_csv.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <fstream>
#include <limits>
#include <string>
#include <system_error>
#include <utility>

#include <fmt/core.h>

#include "wellgyro/base/time_range.h"
#include "wellgyro/io/sensor/file_kind.h"
#include "wellgyro/io/sensor/sensor_layout_internal.h"
#include "wellgyro/io/text_internal.h"

namespace wellgyro {
namespace {

using sensors::Layout;
using sensors::SensorColumn;
using enum sensors::SensorColumn;

/// Nothing where the text is no number; a missing one is empty or nan.
struct Number {
  double value = 0;
  bool missing = false;
};
std::optional<Number> NumberIn(std::string_view text) {
  if (text.empty()) return Number{0, true};
  const std::optional<double> value = AnyNumberOf(text);
  if (!value || std::isinf(*value)) return std::nullopt;
  return std::isnan(*value) ? Number{0, true} : Number{*value, false};
}

/// A header whose fields ';' parts, as a spreadsheet with decimal commas writes them.
std::string WithCommas(std::string header) {
  std::ranges::replace(header, ';', ',');
  return header;
}

// [ns], between marks made for a stand at rest: below DepthTrackSetup::max_gap, 5 s.
constexpr std::int64_t kMarkEvery = 4'000'000'000;
// Of which the median is the period: right while fewer than half of them skip a sample.
constexpr std::size_t kFirstSteps = 1000;

}  // namespace

struct SensorCsv::Impl {
  explicit Impl(std::filesystem::path the_path) : path(std::move(the_path)) {}

  std::filesystem::path path;
  std::ifstream file;
  Layout layout;
  SensorTable kind = SensorTable::kSamples;
  std::optional<Fault> fault;
  std::string line, line_before;
  RepeatedRows repeated;
  std::vector<std::string_view> fields;
  int number = 0;  ///< of the line
  std::int64_t rows = 0;
  std::int64_t period_ns = 0, last_ns = 0, seq = 0;
  double md = 0;                  ///< of pipe by length
  std::optional<DepthMark> rest;  ///< whose marks are still to be given ...
  std::int64_t rest_end = 0;      ///< ... until then [ns]

  Fault Bad(std::string text, FaultCode code, int field = -1) const {
    Fault bad{.code = code, .text = std::move(text), .source = path.string(), .line = number};
    if (field >= 0 && field < static_cast<int>(fields.size())) {
      bad.column =
          static_cast<int>(fields[static_cast<std::size_t>(field)].data() - line.data()) + 1;
    }
    return bad;
  }
  void Refuse(std::string text, FaultCode code, int field = -1) {
    if (!fault) fault = Bad(std::move(text), code, field);
  }

  bool ReadLine() {
    line.swap(line_before);
    while (std::getline(file, line)) {
      ++number;
      if (!line.empty() && line.back() == '\r') line.pop_back();
      if (line.size() > 65536) {
        Refuse("a line of more than 64 KiB", FaultCode::kSize);
        return false;
      }
      const std::size_t begin = line.find_first_not_of(" \t");
      if (begin == std::string::npos || line[begin] == '#') continue;
      if (line == line_before) {
        if (repeated.count++ == 0) repeated.first_line = number;
        continue;
      }
      SplitCells(line, ',', fields);
      return true;
    }
    if (file.bad()) Refuse("reading this file failed half way", FaultCode::kIo);
    return false;
  }

  std::optional<Fault> Begin();
  std::optional<Fault> FindPeriod();

  std::string_view Text(SensorColumn column) const {
    const auto field = static_cast<std::size_t>(layout.places[column].field);
    return field < fields.size() ? fields[field] : std::string_view();
  }
  /// Absent where the column is, or the field empty; also where it is no number, which is refused.
  std::optional<double> Get(SensorColumn column) {
    if (!layout.Has(column)) return std::nullopt;
    const auto value = NumberIn(Text(column));
    if (!value) {
      Refuse(fmt::format("\"{}\" is no number", Text(column).substr(0, 40)), FaultCode::kSyntax,
             layout.places[column].field);
    }
    if (!value || value->missing) return std::nullopt;
    return value->value * layout.places[column].factor;
  }
  /// Whole numbers of nanoseconds stay exact.
  std::optional<std::int64_t> GetTime(SensorColumn column) {
    if (!layout.Has(column)) return std::nullopt;
    const std::string_view text = Text(column);
    const auto factor = static_cast<std::int64_t>(layout.places[column].factor);
    std::int64_t whole = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), whole);
    if (error == std::errc() && end == text.data() + text.size()) {
      if (std::abs(static_cast<double>(whole)) * static_cast<double>(factor) < kFarthest) {
        return whole * factor;
      }
    } else if (const auto value = Get(column)) {
      if (std::abs(*value) < kFarthest) return std::llround(*value);
    }
    Refuse(fmt::format("\"{}\" is no time", text.substr(0, 40)), FaultCode::kRange,
           layout.places[column].field);
    return std::nullopt;
  }
  std::int32_t Whole(SensorColumn column) {
    const double value = Get(column).value_or(0);
    if (value != std::floor(value) || std::abs(value) > 1e9) {
      Refuse(fmt::format("{} is no whole number", value), FaultCode::kRange,
             layout.places[column].field);
      return 0;
    }
    return static_cast<std::int32_t>(value);
  }
  bool Triple(SensorColumn first, Eigen::Vector3d& v) {
    bool all = true;
    for (int i = 0; i < 3; ++i) {
      const auto value = Get(static_cast<SensorColumn>(first + i));
      v[i] = value.value_or(0);
      all = all && value;
    }
    return all;
  }
  /// A sample's or an average's; whether accelerometers and the two gyros across are all there.
  template <class Record>
  bool Sensors(Record& record) {
    const bool force = Triple(kAx, record.f_T);
    const auto gx = Get(kGx), gy = Get(kGy), gz = Get(kGz);
    record.w_IT_T = {gx.value_or(0), gy.value_or(0), gz.value_or(0)};
    record.has_gz = gz.has_value();
    record.has_mag = layout.HasAll({kMx, kMy, kMz}) && Triple(kMx, record.b_T);
    return force && gx && gy;
  }
  bool InOrder(std::int64_t ns, SensorColumn column) {
    if (rows > 0 && ns <= last_ns) {
      Refuse("time does not go on from the row before", FaultCode::kOrder,
             layout.places[column].field);
      return false;
    }
    return true;
  }

  bool NextSample(ImuSample& sample);
  bool NextStill(StillWindow& window);
  bool NextDepth(DepthMark& mark);
};

std::optional<Fault> SensorCsv::Impl::Begin() {
  std::error_code ignored;
  if (std::filesystem::is_directory(path, ignored)) {
    return Bad("this is a directory, not a file", FaultCode::kIo);
  }
  file.open(path, std::ios::binary);
  if (!file) return Bad("cannot open this file for reading", FaultCode::kIo);
  if (!ReadLine()) return Bad("this is an empty file", FaultCode::kForeign);
  if (SensorTableOf(line) == std::nullopt && SensorTableOf(WithCommas(line))) {
    return Bad("';' stands between its fields: write them with ',' between, and decimal points",
               FaultCode::kSyntax);
  }
  layout = sensors::LayoutOf(line);
  const auto known = layout.Kind();
  if (!known) {
    const Result<FileIdentity> what = IdentifyFile(path);
    if (what && (what->kind != FileKind::kForeign || !layout.meant)) {
      return Bad(fmt::format("this is {}, no table of samples, averages or depths", what->text),
                 FaultCode::kForeign);
    }
  }
  if (!layout.complaint.empty()) {
    return Bad(layout.complaint, FaultCode::kSyntax, layout.complaint_field);
  }
  if (!known) return Bad(layout.Lacking(), FaultCode::kForeign);
  kind = *known;
  return kind == SensorTable::kSamples ? FindPeriod() : std::nullopt;
}

std::optional<Fault> SensorCsv::Impl::FindPeriod() {
  const SensorColumn clock = layout.Has(kTool) ? kTool : kUtc;
  const auto place = file.tellg();
  const int header = number;
  std::vector<std::int64_t> steps;
  std::optional<std::int64_t> before;
  bool turned = false;
  while (steps.size() < kFirstSteps && ReadLine()) {
    const auto ns = GetTime(clock);
    if (fault) return fault;
    if (before && *ns > *before) steps.push_back(*ns - *before);
    turned = turned || (before && *ns < *before);
    before = ns;
  }
  if (fault) return fault;
  if (steps.empty() && turned) return Bad("time goes back from row to row", FaultCode::kOrder);
  if (steps.empty()) return Bad("fewer than two samples", FaultCode::kForeign);
  const auto middle = steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 2);
  std::nth_element(steps.begin(), middle, steps.end());
  period_ns = *middle;
  if (period_ns > std::numeric_limits<std::int32_t>::max()) {
    return Bad("samples are more than two seconds apart; averages at rest have a DURATION",
               FaultCode::kRange);
  }
  file.clear();
  file.seekg(place);
  number = header;
  repeated = {};
  line.clear();
  return std::nullopt;
}

bool SensorCsv::Impl::NextSample(ImuSample& sample) {
  while (ReadLine()) {
    const SensorColumn clock = layout.Has(kTool) ? kTool : kUtc;
    const auto ns = GetTime(clock);
    if (!ns || !InOrder(*ns, clock)) return false;
    sample = ImuSample{};
    const bool all = Sensors(sample);
    SampleStamp& stamp = sample.stamp;
    stamp.temperature = static_cast<float>(Get(kTemp).value_or(0));
    stamp.run = Whole(kRun);
    stamp.tool = Whole(kToolNumber);
    stamp.tool_time = ToolTime{*ns};
    stamp.utc = UtcTime{*ns};
    if (layout.Has(kTool) && layout.Has(kUtc)) {
      const auto utc = GetTime(kUtc);
      if (utc) stamp.utc = UtcTime{*utc};
    }
    stamp.utc_unsynced = !layout.Has(kUtc);
    if (fault) return false;
    stamp.period_ns = static_cast<std::int32_t>(period_ns);
    if (rows > 0) {
      const double steps = static_cast<double>(*ns - last_ns) / static_cast<double>(period_ns);
      seq += std::max<std::int64_t>(1, std::llround(steps));
    }
    stamp.seq = seq;
    ++rows;
    last_ns = *ns;
    if (all) return true;
  }
  return false;
}

bool SensorCsv::Impl::NextStill(StillWindow& window) {
  if (!ReadLine()) return false;
  const auto begin = GetTime(kUtc);
  const auto duration = Get(kDuration);
  window = StillWindow{};
  const bool all = Sensors(window);
  Triple(kSigGx, window.sigma_w_IT_T);
  Triple(kSigAx, window.sigma_f_T);
  window.temperature = Get(kTemp).value_or(0);
  if (layout.Has(kIndex)) window.index_position = Whole(kIndex);
  window.run = Whole(kRun);
  window.tool = Whole(kToolNumber);
  window.md = Get(kMd);
  if (!fault && !all) Refuse("a sensor is missing in this row", FaultCode::kSyntax);
  if (!fault && !(duration && *duration > 0 && *duration < 86'400)) {
    Refuse("a duration must be above 0 and below a day", FaultCode::kRange,
           layout.places[kDuration].field);
  }
  if (fault || !InOrder(*begin, kUtc)) return false;
  window.utc_begin = UtcTime{*begin};
  window.utc_end = window.utc_begin + Duration::Seconds(*duration);
  last_ns = *begin;
  ++rows;
  return true;
}

bool SensorCsv::Impl::NextDepth(DepthMark& mark) {
  if (rest) {
    mark = *rest;
    mark.utc.ns = std::min(mark.utc.ns + kMarkEvery, rest_end);
    mark.seq = seq++;
    rest = mark.utc.ns < rest_end ? std::optional(mark) : std::nullopt;
    last_ns = mark.utc.ns;
    return true;
  }
  if (!ReadLine()) return false;
  const SensorColumn clock = layout.Has(kUtc) ? kUtc : kTool;
  const auto utc = GetTime(clock);
  const SensorColumn depth = layout.Has(kMd) ? kMd : kLengthOf;
  const auto value = Get(depth);
  if (!fault && !value) {
    Refuse("a depth is missing", FaultCode::kSyntax, layout.places[depth].field);
  }
  mark = DepthMark{};
  mark.sigma = Get(kSigMd);
  mark.tension = Get(kTensionOf);
  mark.stopped = Whole(kStopped) != 0;
  mark.magnetic_mark = Whole(kMark) != 0;
  mark.corrected = Whole(kCorrected) != 0;
  mark.run = Whole(kRun);
  if (fault || !InOrder(*utc, clock)) return false;
  md = depth == kMd ? *value : md + *value;
  mark.md = md;
  mark.kind = depth == kMd ? DepthKind::kIndicated : DepthKind::kDrillPipe;
  mark.utc = UtcTime{*utc};
  mark.seq = seq++;
  last_ns = *utc;
  ++rows;
  if (layout.Has(kEndUtc)) {
    const auto end = GetTime(kEndUtc);
    if (!fault && *end < *utc) {
      Refuse("a rest ends before it begins", FaultCode::kOrder, layout.places[kEndUtc].field);
    }
    if (fault) return false;
    mark.stopped = true;
    if (*end > *utc) rest = mark;
    rest_end = *end;
  }
  return true;
}

std::optional<SensorTable> SensorTableOf(std::string_view header) {
  return sensors::LayoutOf(header).Kind();
}

SensorCsv::SensorCsv(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
SensorCsv::~SensorCsv() = default;
SensorCsv::SensorCsv(SensorCsv&&) noexcept = default;
SensorCsv& SensorCsv::operator=(SensorCsv&&) noexcept = default;

Result<SensorCsv> SensorCsv::Open(const std::filesystem::path& path) {
  auto impl = std::make_unique<Impl>(path);
  if (auto fault = impl->Begin()) return *std::move(fault);
  return SensorCsv(std::move(impl));
}

SensorTable SensorCsv::kind() const { return impl_->kind; }
bool SensorCsv::has_utc() const { return impl_->layout.Has(kUtc); }
bool SensorCsv::has_tool() const { return impl_->layout.Has(kTool); }
const std::optional<Fault>& SensorCsv::fault() const { return impl_->fault; }
RepeatedRows SensorCsv::repeated() const { return impl_->repeated; }

bool SensorCsv::Next(Row& row) {
  if (impl_->fault) return false;
  switch (impl_->kind) {
    case SensorTable::kSamples:
      return impl_->NextSample(row.emplace<ImuSample>());
    case SensorTable::kStill:
      return impl_->NextStill(row.emplace<StillWindow>());
    case SensorTable::kDepth:
      return impl_->NextDepth(row.emplace<DepthMark>());
  }
  return false;
}

}  // namespace wellgyro
