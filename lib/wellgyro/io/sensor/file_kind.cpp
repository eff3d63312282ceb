#include "wellgyro/io/sensor/file_kind.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <iterator>

#include <fmt/core.h>

#include "wellgyro/io/exchange/survey_csv.h"
#include "wellgyro/io/formats.h"
#include "wellgyro/io/sensor/sensor_csv.h"
#include "wellgyro/io/text_file.h"
#include "wellgyro/io/text_internal.h"

namespace wellgyro {
namespace {

struct Format {
  std::string_view name;
  FileKind kind;
  std::string_view text;
};

constexpr std::array kFormats{
    Format{formats::kJob, FileKind::kJob, "a wellgyro job"},
    Format{formats::kSimulation, FileKind::kSimulation, "a wellgyro simulation"},
    Format{formats::kNoise, FileKind::kNoise, "a wellgyro noise file"},
    Format{formats::kCalibration, FileKind::kCalibration, "a wellgyro calibration"},
    Format{formats::kTool, FileKind::kTool, "a wellgyro tool file"},
    Format{formats::kErrorModel, FileKind::kErrorModel, "a wellgyro error model"},
    Format{formats::kProgram, FileKind::kProgram, "a wellgyro survey program"},
    Format{formats::kUncertainty, FileKind::kUncertainty,
           "the summary of a wellgyro position uncertainty"},
    Format{formats::kRun, FileKind::kRun, "the run file of a wellgyro result"},
    Format{formats::kSource, FileKind::kSource, "the source file of a wellgyro result"},
    Format{formats::kClearance, FileKind::kClearancePolicy, "a wellgyro clearance policy"},
    Format{formats::kMerge, FileKind::kForeign, "the plan of a wellgyro merge"},
    Format{formats::kMerged, FileKind::kForeign, "the summary of a wellgyro merge"},
    Format{formats::kComparison, FileKind::kForeign, "the summary of a wellgyro comparison"},
    Format{formats::kPlan, FileKind::kForeign, "the plan of a wellgyro survey's stops"},
    Format{formats::kWits, FileKind::kForeign, "the items of a rig's WITS for wellgyro"},
    Format{"wellgyro.journal/1", FileKind::kForeign, "the journal of a live wellgyro survey"},
};

struct Signature {
  std::string_view bytes;
  std::string_view text;
};

constexpr std::array kSignatures{
    Signature{"\x1F\x8B", "a gzip archive"},
    Signature{"PK\x03\x04", "a zip archive"},
    Signature{"BZh", "a bzip2 archive"},
    Signature{"\xFD\x37zXZ", "an xz archive"},
    Signature{"\x28\xB5\x2F\xFD", "a zstd archive"},
    Signature{"%PDF", "a PDF document"},
    Signature{"\x89PNG", "a PNG image"},
    Signature{"\x7F"
              "ELF",
              "a program"},
    Signature{"\x89HDF", "an HDF5 file"},
    Signature{"IOGP,", "an IOGP P7/17 file"},
    Signature{"# WELL TRACE FROM PETREL", "a Petrel well trace"},
    Signature{"Survey Report", "a text report of a survey"},
    Signature{"RUN,CODE,BEGIN_UTC", "the diagnosis of a wellgyro survey"},
    Signature{"RUN,CODE,SMALLEST", "the reliability of a wellgyro survey"},
    Signature{"RUN,END_UTC,T[s]", "the stretches of a wellgyro survey"},
    Signature{"MD[m],VAR_NN[m2]", "the covariances of a wellgyro survey"},
    Signature{"MD[m],TERM,", "the terms of a wellgyro position uncertainty"},
    Signature{"MD[m],OTHER_MD[m],DISTANCE[m]", "the separation of two wells by wellgyro"},
    Signature{"WELL,MD[m],OTHER_MD[m],DISTANCE[m],N[m]", "the separations of a wellgyro clearance"},
    Signature{"WELL,MD[m],OTHER_MD[m],DISTANCE[m],ALLOWED", "the wells of a wellgyro clearance"},
    Signature{"MD[m],INC_A[deg]", "the differences of a wellgyro comparison"},
    Signature{"FROM_MD[m],TO_MD[m],LEG", "the choices of a wellgyro merge"},
    Signature{"FIRST,SECOND,FROM_MD[m]", "the comparisons of a wellgyro merge"},
    Signature{"tau_s,adev", "the Allan deviations of a wellgyro noise analysis"},
    Signature{"<", "an XML or HTML document"},
    Signature{"{", "a JSON document"},
    Signature{"~V", "a LAS file"},
};

// The next line of `text` without its end; takes it off `text`.
std::string_view NextLine(std::string_view& text) {
  const std::size_t end = std::min(text.find('\n'), text.size());
  std::string_view line = text.substr(0, end);
  text.remove_prefix(std::min(end + 1, text.size()));
  if (line.ends_with('\r')) line.remove_suffix(1);
  return line;
}

// The value of the line format = "...", which comes before anything but comments; or empty.
std::string_view FormatLine(std::string_view text) {
  while (!text.empty()) {
    std::string_view line = Trim(NextLine(text));
    if (line.empty() || line.front() == '#') continue;
    if (!line.starts_with("format")) return {};
    line = Trim(line.substr(6));
    if (!line.starts_with('=')) return {};
    line = Trim(line.substr(1));
    if (line.empty() || (line.front() != '"' && line.front() != '\'')) return {};
    const std::size_t end = line.find(line.front(), 1);
    return end == std::string_view::npos ? std::string_view() : line.substr(1, end - 1);
  }
  return {};
}

// Whether it begins with the heading of a TOML table that our files have.
bool IsOurToml(std::string_view text) {
  constexpr std::string_view kTables[] = {"[well]",  "[noise]",       "[errors]", "[earth]",
                                          "[run]",   "[policy]",      "[[leg]]",  "[tie_in]",
                                          "[depth]", "[coefficients]"};
  while (!text.empty()) {
    const std::string_view line = Trim(NextLine(text));
    if (line.empty() || line.front() == '#') continue;
    return std::ranges::find(kTables, line) != std::end(kTables);
  }
  return false;
}

FileIdentity ByFormat(std::string_view name) {
  for (const Format& format : kFormats) {
    if (format.name == name) return {format.kind, std::string(format.text)};
  }
  return {
      FileKind::kUnknownFormat,
      fmt::format("a file of format \"{}\", which this version does not know", name.substr(0, 60))};
}

/// Pages and pictures that people read; empty where the text is none of ours.
std::string_view PageOf(std::string_view head) {
  const auto says = [&](std::string_view words) { return head.find(words) != head.npos; };
  if (head.starts_with("<svg")) return "an SVG picture, which wellgyro draws and does not read";
  if (!head.starts_with("<!DOCTYPE html>")) return {};
  if (says("<title>Clearance of ")) return "the report of a wellgyro clearance";
  if (says("<title>Calibration certificate")) return "the certificate of a wellgyro calibration";
  if (says(" - gyro survey report</title>")) return "the report of a wellgyro survey";
  return {};
}

FileIdentity ByContent(std::string_view head) {
  if (const auto page = PageOf(head); !page.empty()) return {FileKind::kForeign, std::string(page)};
  for (const Signature& signature : kSignatures) {
    if (!head.starts_with(signature.bytes)) continue;
    const bool xml = signature.bytes == "<";
    const bool one = xml && head.find("witsml.org/schemas/1series") != head.npos;
    const bool two = xml && head.find("energyml/data/witsmlv2") != head.npos;
    if (one || two) return {FileKind::kForeign, one ? "a WITSML 1 object" : "a WITSML 2 object"};
    if (xml && head.find("<CD_") != head.npos) return {FileKind::kForeign, "an EDM export"};
    if (signature.bytes == "{" && head.find("\"wellgyro.survey/1\"") != head.npos) {
      return {FileKind::kForeign, "a wellgyro survey for programs"};
    }
    return {FileKind::kForeign, std::string(signature.text)};
  }
  const bool text = std::none_of(head.begin(), head.end(), [](char c) {
    const auto byte = static_cast<unsigned char>(c);
    return byte < 0x20 && byte != '\n' && byte != '\r' && byte != '\t';
  });
  return {FileKind::kForeign, text ? "text of an unknown kind" : "binary data of an unknown kind"};
}

std::string TextOf(SensorTable table) {
  switch (table) {
    case SensorTable::kSamples:
      return "a table of sensor samples";
    case SensorTable::kStill:
      return "a table of averages at rest";
    case SensorTable::kDepth:
      break;
  }
  return "a table of depths";
}

}  // namespace

FileIdentity IdentifyBytes(std::string_view head) {
  if (head.empty()) return {FileKind::kEmpty, "an empty file"};
  if (head.find("\xED\xA1\xDA\x01") != std::string_view::npos) {
    return {FileKind::kLcmLog, "an LCM log"};
  }
  if (head.starts_with("\xEF\xBB\xBF")) head.remove_prefix(3);
  if (const std::string_view format = FormatLine(head); format.starts_with("wellgyro.")) {
    return ByFormat(format);
  }
  if (IsOurToml(head)) {
    return {FileKind::kUnknownFormat,
            "TOML without its first line, which says of what kind it is, as format = "
            "\"wellgyro.job/1\""};
  }
  std::string_view rest = head;
  std::string_view line = NextLine(rest);
  if (IsSurveyCsvHeader(line)) return {FileKind::kSurveyCsv, "a wellgyro survey"};
  if (line.starts_with("RUN,PASS,STATUS,REVISION,MD[m]")) {
    return {FileKind::kPassesCsv, "the passes of a wellgyro survey"};
  }
  if (line.starts_with("CODE,RUN,PASS,MD[m],VALUE")) {
    return {FileKind::kChecksCsv, "the checks of a wellgyro survey"};
  }
  if (line.starts_with("T[s],MD[m],INC[deg],AZI_TRUE[deg],GTF[deg]")) {
    return {FileKind::kTruthCsv, "the truth of a wellgyro simulation"};
  }
  while (line.starts_with('#')) line = NextLine(rest);
  if (const auto table = SensorTableOf(line)) return {FileKind::kSensorCsv, TextOf(*table)};
  // As a spreadsheet with decimal commas writes it; which SensorCsv refuses, and says why.
  std::string commas(line);
  std::ranges::replace(commas, ';', ',');
  if (const auto table = SensorTableOf(commas)) return {FileKind::kSensorCsv, TextOf(*table)};
  return ByContent(head);
}

Result<FileIdentity> IdentifyFile(const std::filesystem::path& path) {
  const Result<std::string> head = ReadTextHead(path, 1 << 16);
  if (!head) return head.fault();
  return IdentifyBytes(*head);
}

}  // namespace wellgyro
