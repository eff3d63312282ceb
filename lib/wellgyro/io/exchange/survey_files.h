#pragma once

#include <span>
#include <string>
#include <vector>

#include "wellgyro/base/export.h"
#include "wellgyro/io/atomic_file.h"
#include "wellgyro/io/exchange/exchange.h"
#include "wellgyro/record/survey_table.h"

/// Surveys as files that stand beside each other in a folder.
namespace wellgyro {

/// The file of a format as `name`, and beside an OSDU manifest the CSV of its stations, whose
/// columns are called as the manifest says; ready for WriteFiles. Throws as WriteSurvey.
WELLGYRO_EXPORT std::vector<OutputFile> SurveyFiles(const SurveyTable& table, SurveyFormat format,
                                                    const std::string& name,
                                                    const WriteOptions& options = {});

/// Adds a remark where positions part by more than 5 mm from the minimum curvature of the listed
/// stations.
WELLGYRO_EXPORT void SayDeparture(SurveyTable& table);

/// A file of each format named after `stem`, ready for WriteFiles: angles to 1e-6 deg, lengths to
/// 1e-4, as survey.csv has them.
WELLGYRO_EXPORT std::vector<OutputFile> ExportFormats(const SurveyTable& table,
                                                      std::span<const SurveyFormat> formats,
                                                      const std::string& stem);

}  // namespace wellgyro
