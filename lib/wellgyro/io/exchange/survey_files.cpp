#include "wellgyro/io/exchange/survey_files.h"

#include <algorithm>
#include <optional>
#include <utility>

#include <fmt/core.h>

#include "wellgyro/io/exchange/exchange.h"
#include "wellgyro/io/exchange/table_build_internal.h"

namespace wellgyro {

std::vector<OutputFile> SurveyFiles(const SurveyTable& table, SurveyFormat format,
                                    const std::string& name, const WriteOptions& options) {
  if (format != SurveyFormat::kOsdu) return {{name, WriteSurvey(table, format, options)}};
  CheckRows(table, WordOf(format));
  const std::string bulk = name.substr(0, name.rfind(".json")) + ".csv";
  return {{bulk, WriteOsduBulk(table)}, {name, WriteOsdu(table, bulk)}};
}

void SayDeparture(SurveyTable& table) {
  constexpr double kRounding = 0.005;  // [m], of positions written to the centimetre
  const auto departure = DepartureFromListed(table);
  if (!departure || *departure < kRounding) return;
  const std::string remark = fmt::format(
      "positions are not the minimum curvature of the listed stations: they part from "
      "it by up to {:.3f} m",
      *departure);
  std::vector<std::string>& remarks = table.head.remarks;
  if (std::find(remarks.begin(), remarks.end(), remark) == remarks.end()) {
    remarks.push_back(remark);
  }
}

std::vector<OutputFile> ExportFormats(const SurveyTable& table,
                                      std::span<const SurveyFormat> formats,
                                      const std::string& stem) {
  SurveyTable rounded = Rounded(table);
  SayDeparture(rounded);
  std::vector<OutputFile> files;
  for (const SurveyFormat format : formats) {
    for (OutputFile& file : SurveyFiles(rounded, format, FileNameOf(format, stem))) {
      files.push_back(std::move(file));
    }
  }
  return files;
}

}  // namespace wellgyro
