#include "wellgyro/io/exchange/survey_csv.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <optional>
#include <stdexcept>
#include <utility>

#include <fmt/core.h>

#include "wellgyro/base/angle.h"
#include "wellgyro/base/units.h"
#include "wellgyro/io/number_text_internal.h"
#include "wellgyro/io/text_file.h"
#include "wellgyro/io/text_internal.h"
#include "wellgyro/io/words.h"
#include "wellgyro/survey/verdict/verdict.h"

namespace wellgyro {
namespace {

constexpr std::string_view kSurveyColumns =
    "MD[m],INC[deg],AZI_TRUE[deg],GTF[deg],TVD[m],N[m],E[m],DLS[deg/30m],VAR_NN[m2],COV_NE[m2],"
    "COV_NV[m2],VAR_EE[m2],COV_EV[m2],VAR_VV[m2],SIG_INC[deg],SIG_AZI[deg],KIND,QUALITY";
constexpr std::string_view kDepthColumn = ",SIG_MD[m]";  // of passes.csv
constexpr std::string_view kGridColumns = ",AZI_GRID[deg],NORTHING[m],EASTING[m]";
constexpr std::string_view kPassColumns = "RUN,PASS,STATUS,REVISION,";

constexpr std::size_t kNumbers = 16;  // before KIND
constexpr std::size_t kSigmas = 8;    // the last of them, empty where a station is unfit
constexpr std::size_t kFields = 18;
constexpr std::size_t kFieldsWithGrid = 21;

void AppendGrid(std::string& text, const Station& s, const WellGrid* grid) {
  if (grid == nullptr) return;
  const GridPoint p = grid->At(s.p_WT_W.x(), s.p_WT_W.y());
  text += ',' + AzimuthDeg(s.azimuth - p.convergence) + ',' + Metres(p.northing) + ',' +
          Metres(p.easting);
}

void AppendStation(std::string& text, const Station& s) {
  const auto& c = s.cov_p_WT_W;
  text += Metres(s.md) + ',' + AngleDeg(s.inclination) + ',' + AzimuthDeg(s.azimuth) + ',' +
          AzimuthDeg(s.toolface) + ',' + Metres(s.p_WT_W.z()) + ',' + Metres(s.p_WT_W.x()) + ',' +
          Metres(s.p_WT_W.y()) + ',' + Fixed(s.dogleg_severity / units::kDegPer30m, 6);
  if (Has(s.quality, Quality::kUnfit)) {
    text += std::string(kSigmas, ',');
  } else {
    const Eigen::Vector3d own = s.cov_md_inc_azi.diagonal().cwiseMax(0.0);
    for (const double v : {std::max(c(0, 0), 0.0), c(0, 1), c(0, 2), std::max(c(1, 1), 0.0),
                           c(1, 2), std::max(c(2, 2), 0.0)}) {
      text += ',' + Significant(v);
    }
    text += ',' + AngleDeg(std::sqrt(own[1])) + ',' + AngleDeg(std::sqrt(own[2]));
  }
  text += ',';
  text += WordOf(s.kind);
  text += ',' + QualityText(s.quality);
}

[[noreturn]] void RefuseStation(std::size_t i, std::string_view field, double value,
                                std::string_view why) {
  throw std::invalid_argument(
      fmt::format("station {} of the survey: {} = {} {}", i, field, value, why));
}

void NeedFinite(std::size_t i, std::string_view field, double value) {
  if (!std::isfinite(value)) RefuseStation(i, field, value, "is not finite");
}

// A variance that is zero may come out below it by rounding, and is written as zero [m^2, rad^2].
constexpr double kBelowZero = 1e-12;

// Numbers that are written are to be read again.
void CheckStation(std::size_t i, const Station& s, bool with_depth) {
  NeedFinite(i, "md", s.md);
  NeedFinite(i, "inclination", s.inclination);
  NeedFinite(i, "azimuth", s.azimuth);
  NeedFinite(i, "toolface", s.toolface);
  for (const double p : s.p_WT_W) NeedFinite(i, "p_WT_W", p);
  NeedFinite(i, "dogleg_severity", s.dogleg_severity);
  if (Has(s.quality, Quality::kUnfit)) return;
  for (const double c : s.cov_p_WT_W.reshaped()) NeedFinite(i, "cov_p_WT_W", c);
  for (int k = 0; k < 3; ++k) {
    const double var = s.cov_p_WT_W(k, k), own = s.cov_md_inc_azi(k, k);
    if (var < -kBelowZero) RefuseStation(i, "cov_p_WT_W", var, "is no variance");
    if (k == 0 && !with_depth) continue;
    NeedFinite(i, "cov_md_inc_azi", own);
    if (own < -kBelowZero) RefuseStation(i, "cov_md_inc_azi", own, "is no variance");
  }
}

void CheckStations(std::span<const Station> stations, bool with_depth) {
  for (std::size_t i = 0; i < stations.size(); ++i) CheckStation(i, stations[i], with_depth);
}

// One line cut at its commas, with the column at which each field begins.
struct Fields {
  std::vector<std::string_view> text;
  std::vector<int> column;
};

Fields Cut(std::string_view line) {
  Fields fields;
  std::size_t begin = 0;
  for (;;) {
    const std::size_t comma = line.find(',', begin);
    fields.text.push_back(line.substr(begin, comma - begin));
    fields.column.push_back(static_cast<int>(begin) + 1);
    if (comma == std::string_view::npos) return fields;
    begin = comma + 1;
  }
}

std::optional<double> Number(std::string_view text) {
  double value = 0;
  const char* const end = text.data() + text.size();
  const auto [rest, error] = std::from_chars(text.data(), end, value);
  if (error != std::errc() || rest != end || !std::isfinite(value)) return std::nullopt;
  return value;
}

// Reads lines into stations, keeping the place for Faults.
class Reader {
 public:
  Reader(const std::string& source, bool has_grid)
      : source_(source), fields_wanted_(has_grid ? kFieldsWithGrid : kFields) {}

  std::optional<Fault> Take(std::string_view line, int line_number) {
    line_ = line_number;
    const Fields fields = Cut(line);
    if (fields.text.size() != fields_wanted_) {
      return Complain(
          FaultCode::kSyntax, 1,
          fmt::format("{} fields where the header has {}", fields.text.size(), fields_wanted_));
    }
    std::array<double, kFieldsWithGrid> v{};
    const auto quality = QualityOf(fields.text[kNumbers + 1]);
    const bool unfit = quality && Has(*quality, Quality::kUnfit);
    for (std::size_t i = 0; i < fields_wanted_; ++i) {
      if (i == kNumbers || i == kNumbers + 1) continue;
      const bool withheld = unfit && i + kSigmas >= kNumbers && i < kNumbers;
      if (withheld && fields.text[i].empty()) continue;
      const std::optional<double> number = Number(fields.text[i]);
      if (!number) return Odd(fields, i, "is not a number");
      v[i] = *number;
    }
    const auto kind = StationKindOf(fields.text[kNumbers]);
    if (!kind) return Odd(fields, kNumbers, "is not a kind of station");
    if (!quality) return Odd(fields, kNumbers + 1, "is not a quality");
    if (!stations.empty() && !(v[0] > stations.back().md)) {
      return Odd(fields, 0, "does not lie below the station before");
    }
    if (v[1] < 0 || v[1] > 180) return Odd(fields, 1, "is no inclination");
    for (const std::size_t i : {8u, 11u, 13u, 14u, 15u}) {
      if (v[i] < 0) return Odd(fields, i, "is negative, which a variance or sigma cannot be");
    }
    stations.push_back(Make(v, *kind, *quality));
    if (unfit) MakeUnfit(stations.front(), stations.back());
    return std::nullopt;
  }

  std::vector<Station> stations;

 private:
  static Station Make(const std::array<double, kFieldsWithGrid>& v, StationKind kind,
                      Quality quality) {
    Station s;
    s.kind = kind;
    s.quality = quality;
    s.md = v[0];
    s.inclination = FromDegrees(v[1]);
    s.azimuth = WrapTwoPi(FromDegrees(v[2]));
    s.toolface = WrapTwoPi(FromDegrees(v[3]));
    s.p_WT_W = {v[5], v[6], v[4]};
    s.dogleg_severity = v[7] * units::kDegPer30m;
    s.cov_p_WT_W << v[8], v[9], v[10], v[9], v[11], v[12], v[10], v[12], v[13];
    s.cov_md_inc_azi(1, 1) = std::pow(FromDegrees(v[14]), 2);
    s.cov_md_inc_azi(2, 2) = std::pow(FromDegrees(v[15]), 2);
    DeriveTangent(s);
    return s;
  }

  Fault Odd(const Fields& fields, std::size_t i, std::string_view why) const {
    return Complain(i < kNumbers ? FaultCode::kRange : FaultCode::kSyntax, fields.column[i],
                    fmt::format("'{}' {}", fields.text[i].substr(0, 40), why));
  }

  Fault Complain(FaultCode code, int column, std::string text) const {
    return {
        .code = code, .text = std::move(text), .source = source_, .line = line_, .column = column};
  }

  const std::string& source_;
  std::size_t fields_wanted_;
  int line_ = 0;
};

}  // namespace

std::string SurveyCsv(std::span<const Station> stations, const WellGrid* grid) {
  CheckStations(stations, false);
  std::string text = fmt::format("{}{}\n", kSurveyColumns, grid ? kGridColumns : "");
  for (const Station& s : stations) {
    AppendStation(text, s);
    AppendGrid(text, s, grid);
    text += '\n';
  }
  return text;
}

std::string PassesCsv(std::span<const Station> stations, const WellGrid* grid) {
  CheckStations(stations, true);
  std::string text = fmt::format("{}{}{}{}\n", kPassColumns, kSurveyColumns, kDepthColumn,
                                 grid ? kGridColumns : "");
  for (const Station& s : stations) {
    text += fmt::format("{},{},{},{},", s.run, WordOf(s.pass), WordOf(s.status), s.revision);
    AppendStation(text, s);
    text += ',';
    if (!Has(s.quality, Quality::kUnfit)) {
      text += Significant(std::sqrt(std::max(s.cov_md_inc_azi(0, 0), 0.0)));
    }
    AppendGrid(text, s, grid);
    text += '\n';
  }
  return text;
}

std::string ChecksCsv(std::span<const Check> checks) {
  const auto has = [](const std::optional<double>& v) { return v && std::isfinite(*v); };
  const auto number = [&](const std::optional<double>& v) { return has(v) ? Significant(*v) : ""; };
  std::string text = "CODE,RUN,PASS,MD[m],VALUE,SIGMA,LIMIT,UNIT,LIMIT_SOURCE,VERDICT\n";
  for (const Check& c : checks) {
    text += fmt::format("{},{},{},{},{},{},{},{},{},{}\n", CsvQuoted(c.code), c.run,
                        c.pass ? WordOf(*c.pass) : "", has(c.md) ? Metres(*c.md) : "",
                        number(c.value), number(c.sigma), number(c.limit), CsvQuoted(c.unit),
                        CsvQuoted(c.limit_source), WordOf(c.verdict));
  }
  return text;
}

bool IsSurveyCsvHeader(std::string_view line) {
  return line.starts_with(kSurveyColumns) && (line.size() == kSurveyColumns.size() ||
                                              line.substr(kSurveyColumns.size()) == kGridColumns);
}

Result<std::vector<Station>> ParseSurveyCsv(std::string_view text, const std::string& source) {
  if (text.starts_with("\xEF\xBB\xBF")) text.remove_prefix(3);
  text = text.substr(0, text.find_last_not_of("\r\n") + 1);  // lines that close it may be empty
  std::optional<Reader> reader;
  int line_number = 0;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    std::string_view line = text.substr(0, end);
    text.remove_prefix(std::min(end + 1, text.size()));
    if (line.ends_with('\r')) line.remove_suffix(1);
    ++line_number;
    if (!reader) {
      if (!IsSurveyCsvHeader(line)) break;
      reader.emplace(source, line.size() > kSurveyColumns.size());
    } else if (auto fault = reader->Take(line, line_number)) {
      return *std::move(fault);
    }
  }
  if (!reader) {
    return Fault{.code = FaultCode::kForeign,
                 .text = "not a survey.csv of this program: its first line is not that header",
                 .source = source,
                 .line = 1};
  }
  return std::move(reader->stations);
}

Result<std::vector<Station>> ReadSurveyCsv(const std::filesystem::path& path) {
  Result<std::string> text = ReadTextFile(path, std::int64_t{1} << 32);
  if (!text) return text.fault();
  return ParseSurveyCsv(*text, path.string());
}

}  // namespace wellgyro
