#include "wellgyro/io/exchange/exchange.h"

#include <algorithm>
#include <array>
#include <fstream>
#include <iterator>
#include <sstream>
#include <stdexcept>
#include <system_error>
#include <utility>

#include <fmt/core.h>

#include "wellgyro/io/exchange/geo_path_internal.h"
#include "wellgyro/io/exchange/line_reader_internal.h"
#include "wellgyro/io/exchange/sheet_internal.h"
#include "wellgyro/io/exchange/table_build_internal.h"
#include "wellgyro/io/exchange/told_options_internal.h"
#include "wellgyro/io/exchange/wbp_internal.h"
#include "wellgyro/io/exchange/witness_internal.h"
#include "wellgyro/io/exchange/xml_internal.h"
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
    FormatName{SurveyFormat::kGeoJson, "geojson", ".geojson"},
    FormatName{SurveyFormat::kKml, "kml", ".kml"},
    FormatName{SurveyFormat::kGeoPackage, "gpkg", ".gpkg"},
};

const FormatName& NameOf(SurveyFormat format) {
  for (const FormatName& f : kFormats) {
    if (f.format == format) return f;
  }
  throw std::invalid_argument(
      fmt::format("SurveyFormat {} is no format of surveys", static_cast<int>(format)));
}

// By its first bytes: formats that are not told by them are tables.
SurveyFormat Recognised(std::string_view head) {
  std::string plain;
  if (head.starts_with("\xFF\xFE") || head.starts_with("\xFE\xFF")) {
    std::copy_if(head.begin() + 2, head.end(), std::back_inserter(plain),
                 [](char c) { return c != '\0'; });
    head = plain;
  }
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

// XML as UTF-8, also where its mark says UTF-16.
std::string InUtf8(std::string_view text) {
  const bool little = text.starts_with("\xFF\xFE");
  if (!little && !text.starts_with("\xFE\xFF")) return std::string(text);
  std::string rest;
  return Utf8OfUtf16(text.substr(2), little, rest);
}

SurveyTable ReadLines(LineReader& lines, SurveyFormat format, const ReadOptions& options,
                      Claims& claims) {
  switch (format) {
    case SurveyFormat::kLas:
      return ReadLas(lines, options, claims);
    case SurveyFormat::kP717:
      return ReadP717(lines);
    case SurveyFormat::kPetrel:
      return ReadPetrel(lines, options, claims);
    case SurveyFormat::kOsdu:
      lines.Complain(FaultCode::kForeign, "an OSDU manifest holds no stations: read its CSV");
    case SurveyFormat::kGeoJson:
    case SurveyFormat::kKml:
    case SurveyFormat::kGeoPackage:
      lines.Complain(FaultCode::kForeign, "a map of a survey is written, not read");
    default:
      return IsWbp(lines.Ahead()) ? ReadWbp(lines, options) : ReadCsv(lines, options, claims);
  }
}

SurveyTable ReadStream(std::istream& bytes, const std::string& source, SurveyFormat format,
                       const ReadOptions& options, Claims& claims) {
  CheckColumns(options, source);
  LineReader lines(bytes, source);
  const bool plan = format == SurveyFormat::kCsv && IsWbp(lines.Ahead());
  SurveyTable table = ReadLines(lines, format, options, claims);
  const bool fixed = format == SurveyFormat::kP717 || format == SurveyFormat::kPetrel;
  NoteUnused(table, options, !fixed && !plan, plan);
  const std::string changed = lines.CheckCertificate();
  if (!changed.empty()) table.head.notes.push_back(changed);
  return table;
}

bool IsXml(SurveyFormat format) {
  return format == SurveyFormat::kWitsml1411 || format == SurveyFormat::kWitsml20 ||
         format == SurveyFormat::kWitsml21;
}

bool IsSheet(std::string_view head, const ReadOptions& options) {
  return IsWorkbook(head) && options.format.value_or(SurveyFormat::kCsv) == SurveyFormat::kCsv;
}

}  // namespace

std::optional<SurveyFormat> SurveyFormatOf(std::string_view word) {
  for (const FormatName& f : kFormats) {
    if (f.word == word) return f.format;
  }
  return std::nullopt;
}

std::string_view WordOf(SurveyFormat format) { return NameOf(format).word; }

std::vector<std::string> WrittenFormats() {
  std::vector<std::string> words;
  for (const FormatName& f : kFormats) {
    if (f.format != SurveyFormat::kWitsml20) words.emplace_back(f.word);
  }
  return words;
}

std::string FileNameOf(SurveyFormat format, const std::string& stem) {
  return stem + std::string(NameOf(format).ending);
}

Result<SurveyTable> ParseSurvey(std::string_view text, const std::string& source,
                                const ReadOptions& options) {
  try {
    const SurveyFormat format = options.format.value_or(Recognised(text));
    SurveyTable table;
    Claims claims;
    if (IsSheet(text, options)) {
      std::istringstream rows(SheetText(std::string(text), source, options.trajectory));
      ReadOptions within = options;
      within.trajectory.clear();  // it has named the sheet
      table = ReadStream(rows, source, SurveyFormat::kCsv, within, claims);
    } else if (IsXml(format)) {
      std::string xml = InUtf8(text);
      table = IsEdm(xml) ? ReadEdm(std::move(xml), source, options)
                         : ReadWitsml(std::move(xml), source, options);
      NoteUnused(table, options, false, true);
    } else {
      std::istringstream bytes{std::string(text)};
      table = ReadStream(bytes, source, format, options, claims);
    }
    TakeOptions(table, options, claims, source);
    Witness(table, claims, source);
    return table;
  } catch (const TextError& error) {
    return error.fault;
  }
}

Result<SurveyTable> ReadSurvey(const std::filesystem::path& path, const ReadOptions& options) {
  const Result<std::string> head = ReadTextHead(path, 1 << 16);
  if (!head) return head.fault();
  const SurveyFormat format = options.format.value_or(Recognised(*head));
  if (IsXml(format) || IsSheet(*head, options)) {
    const Result<std::string> text = ReadTextFile(path, kXmlBytes);
    if (!text) return text.fault();
    ReadOptions by_format = options;
    by_format.format = format;
    return ParseSurvey(*text, path.string(), by_format);
  }
  try {
    std::ifstream bytes(path, std::ios::binary);
    Claims claims;
    SurveyTable table = ReadStream(bytes, path.string(), format, options, claims);
    TakeOptions(table, options, claims, path.string());
    Witness(table, claims, path.string());
    return table;
  } catch (const TextError& error) {
    return error.fault;
  }
}

std::string WriteSurvey(const SurveyTable& table, SurveyFormat format,
                        const WriteOptions& options) {
  CheckRows(table, WordOf(format));
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
      return WriteOsdu(table, "");
    case SurveyFormat::kGeoJson:
      return WriteGeoJson(table);
    case SurveyFormat::kKml:
      return WriteKml(table);
    case SurveyFormat::kGeoPackage:
      return WriteGeoPackage(table);
  }
  return {};
}

}  // namespace wellgyro
