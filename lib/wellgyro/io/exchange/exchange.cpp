#include "wellgyro/io/exchange/exchange.h"

#include <array>
#include <cmath>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <system_error>

#include <fmt/core.h>

#include "wellgyro/io/exchange/survey_tables.h"
#include "wellgyro/io/exchange/table_build_internal.h"
#include "wellgyro/io/text_file.h"

namespace wellgyro {
namespace {

struct FormatName {
  SurveyFormat format;
  std::string_view word, ending;
};
constexpr std::array kFormats{
    FormatName{SurveyFormat::kCsv, "csv", ".csv"},
    FormatName{SurveyFormat::kLas, "las", ".las"},
    FormatName{SurveyFormat::kP717, "p717", ".p717"},
    FormatName{SurveyFormat::kWitsml1411, "witsml", "-1411.xml"},
    FormatName{SurveyFormat::kWitsml20, "witsml20", "-20.xml"},
    FormatName{SurveyFormat::kWitsml21, "witsml21", "-21.xml"},
    FormatName{SurveyFormat::kPetrel, "petrel", ".dev"},
    FormatName{SurveyFormat::kCompass, "compass", ".txt"},
    FormatName{SurveyFormat::kOsdu, "osdu", ".osdu.json"},
};

constexpr std::int64_t kMostXml = std::int64_t{1} << 28;

// By its first bytes: formats that are not told by them are tables.
SurveyFormat Recognised(std::string_view head) {
  if (head.starts_with("\xEF\xBB\xBF")) head.remove_prefix(3);
  while (!head.empty() && static_cast<unsigned char>(head.front()) <= ' ') head.remove_prefix(1);
  if (head.starts_with('<')) return SurveyFormat::kWitsml1411;
  if (head.starts_with("IOGP,")) return SurveyFormat::kP717;
  if (head.starts_with("# WELL TRACE FROM PETREL")) return SurveyFormat::kPetrel;
  // LAS may begin with comments.
  while (head.starts_with('#')) {
    const std::size_t end = head.find('\n');
    if (end == std::string_view::npos) break;
    head.remove_prefix(end + 1);
  }
  return head.starts_with('~') ? SurveyFormat::kLas : SurveyFormat::kCsv;
}

void Conflict(const std::string& source, std::string_view what) {
  throw TextError{{.code = FaultCode::kConflict,
                   .text = fmt::format("the file says another {} than the options do", what),
                   .source = source}};
}

void TakeOver(std::optional<double>& value, const std::optional<double>& option,
              const std::string& source, std::string_view what) {
  if (!option) return;
  if (value && std::abs(*value - *option) > 1e-9) Conflict(source, what);
  value = option;
}

void TakeOver(std::string& value, const std::string& option) {
  if (!option.empty()) value = option;
}

void Apply(SurveyTable& table, const ReadOptions& options, const std::string& source) {
  SurveyHead& head = table.head;
  if (options.north) {
    if (head.azimuth.north != North::kUnknown && head.azimuth.north != *options.north) {
      Conflict(source, "north");
    }
    head.azimuth.north = *options.north;
    if (head.offsets == North::kUnknown) head.offsets = *options.north;
  }
  if (options.depth_unit && head.md_unit != *options.depth_unit) Conflict(source, "unit of depth");
  TakeOver(head.azimuth.convergence, options.convergence, source, "convergence");
  TakeOver(head.azimuth.declination, options.declination, source, "declination");
  TakeOver(head.datum_elevation, options.datum_elevation, source, "elevation of the datum");
  TakeOver(head.azimuth.declination_source, options.declination_source);
  TakeOver(head.azimuth.declination_date, options.declination_date);
  TakeOver(head.datum, options.datum);
}

SurveyTable ReadStream(std::istream& bytes, const std::string& source, SurveyFormat format,
                       const ReadOptions& options) {
  LineReader lines(bytes, source);
  switch (format) {
    case SurveyFormat::kLas:
      return ReadLas(lines, options);
    case SurveyFormat::kP717:
      return ReadP717(lines);
    case SurveyFormat::kPetrel:
      return ReadPetrel(lines);
    case SurveyFormat::kOsdu:
      lines.Complain(FaultCode::kForeign, "an OSDU manifest holds no stations: read its CSV");
    default:
      return ReadCsv(lines, options);
  }
}

bool IsXml(SurveyFormat format) {
  return format == SurveyFormat::kWitsml1411 || format == SurveyFormat::kWitsml20 ||
         format == SurveyFormat::kWitsml21;
}

}  // namespace

std::optional<SurveyFormat> SurveyFormatOf(std::string_view word) {
  for (const FormatName& f : kFormats) {
    if (f.word == word) return f.format;
  }
  return std::nullopt;
}

std::string_view WordOf(SurveyFormat format) {
  return kFormats[static_cast<std::size_t>(format)].word;
}

std::string FileNameOf(SurveyFormat format, const std::string& stem) {
  return stem + std::string(kFormats[static_cast<std::size_t>(format)].ending);
}

Result<SurveyTable> ParseSurvey(std::string_view text, const std::string& source,
                                const ReadOptions& options) {
  try {
    const SurveyFormat format = options.format.value_or(Recognised(text));
    SurveyTable table;
    if (IsXml(format)) {
      table = ReadWitsml(std::string(text), source);
    } else {
      std::istringstream bytes{std::string(text)};
      table = ReadStream(bytes, source, format, options);
    }
    Apply(table, options, source);
    return table;
  } catch (const TextError& error) {
    return error.fault;
  }
}

Result<SurveyTable> ReadSurvey(const std::filesystem::path& path, const ReadOptions& options) {
  const Result<std::string> head = ReadTextHead(path, 1 << 16);
  if (!head) return head.fault();
  const SurveyFormat format = options.format.value_or(Recognised(*head));
  if (IsXml(format)) {
    const Result<std::string> text = ReadTextFile(path, kMostXml);
    if (!text) return text.fault();
    ReadOptions by_format = options;
    by_format.format = format;
    return ParseSurvey(*text, path.string(), by_format);
  }
  try {
    std::ifstream bytes(path, std::ios::binary);
    SurveyTable table = ReadStream(bytes, path.string(), format, options);
    Apply(table, options, path.string());
    return table;
  } catch (const TextError& error) {
    return error.fault;
  }
}

std::string WriteSurvey(const SurveyTable& table, SurveyFormat format,
                        const WriteOptions& options) {
  switch (format) {
    case SurveyFormat::kCsv:
      return WriteCsv(table, options);
    case SurveyFormat::kLas:
      return WriteLas(table, options);
    case SurveyFormat::kP717:
      return WriteP717(table);
    case SurveyFormat::kWitsml1411:
      return WriteWitsml1411(table);
    case SurveyFormat::kWitsml20:
      throw std::invalid_argument("WITSML 2.0 is read only: write witsml (1.4.1.1) or witsml21");
    case SurveyFormat::kWitsml21:
      return WriteWitsml21(table);
    case SurveyFormat::kPetrel:
      return WritePetrel(table);
    case SurveyFormat::kCompass:
      return WriteCompass(table);
    case SurveyFormat::kOsdu:
      return WriteOsdu(table);
  }
  return {};
}

std::vector<OutputFile> ExportFormats(const SurveyTable& table,
                                      std::span<const SurveyFormat> formats,
                                      const std::string& stem) {
  const SurveyTable rounded = Rounded(table);
  std::vector<OutputFile> files;
  for (const SurveyFormat format : formats) {
    files.push_back({FileNameOf(format, stem), WriteSurvey(rounded, format)});
  }
  return files;
}

}  // namespace wellgyro
