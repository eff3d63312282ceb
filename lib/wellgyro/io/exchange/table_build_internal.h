#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "wellgyro/io/exchange/claims_internal.h"
#include "wellgyro/io/exchange/columns_internal.h"
#include "wellgyro/io/exchange/exchange.h"
#include "wellgyro/io/exchange/line_reader_internal.h"
#include "wellgyro/io/exchange/table_builder_internal.h"

namespace wellgyro {

using Pairs = std::vector<std::pair<std::string, std::string>>;
/// What a head says that fits in "key: value" lines; nothing where it says nothing.
Pairs PairsOf(const SurveyHead& head);
/// Takes one such line in; false for an unknown key or a value that is none.
bool TakePair(SurveyHead& head, std::string_view key, std::string_view value);

/// Keeps a remark of a file; beyond the first 1000 they are left out.
void AddRemark(SurveyHead& head, std::string remark);
/// A remark as one line.
std::string OneLine(std::string remark);
/// All of a head's remarks in one line, for formats that have a single place for them.
std::string JoinedRemarks(const SurveyHead& head);

/// Takes in a line of a Compass-style report's head, as "North Reference: Grid"; leaves others.
void TakeReportLine(SurveyHead& head, std::string_view line, Claims& claims);

/// Throws std::invalid_argument: `format` needs ... .
[[noreturn]] void Lacks(std::string_view format, std::string_view what);
/// Lacks, unless the north of the azimuths is known.
void NeedNorth(const SurveyTable& table, std::string_view format);
/// Throws std::invalid_argument where a number is not finite, or the depth of a row on the path is
/// less than that of the one before on it: no reader would take them.
void CheckRows(const SurveyTable& table, std::string_view format);

// Readers throw the Fault of what they cannot use, with line or element; ReadSurvey catches it.
// `claims` collects what the file says of itself, to be held against its numbers.

/// Any table by its headings.
SurveyTable ReadCsv(LineReader& lines, const ReadOptions& options, Claims& claims);
/// CWLS LAS 2.0 and 3.0: the curves of a survey, by mnemonic.
SurveyTable ReadLas(LineReader& lines, const ReadOptions& options, Claims& claims);
/// IOGP P7/17 v1.0, drafts of 2018 and 2019.
SurveyTable ReadP717(LineReader& lines);
/// A Petrel well trace.
SurveyTable ReadPetrel(LineReader& lines, const ReadOptions& options, Claims& claims);
/// WITSML 1.4.1.1, 2.0 and 2.1 trajectories, UTF-8 or UTF-16.
SurveyTable ReadWitsml(std::string bytes, const std::string& source, const ReadOptions& options);

/// Whether XML is an export of Landmark's EDM with a definitive survey.
bool IsEdm(std::string_view bytes);
/// The definitive survey of such an export.
SurveyTable ReadEdm(std::string bytes, const std::string& source, const ReadOptions& options);

// Writers throw by Lacks what their format needs and the table has not.

/// One header line; a preamble where asked for.
std::string WriteCsv(const SurveyTable& table, const WriteOptions& options);
/// LAS 2.0, the step 0 where depths are uneven.
std::string WriteLas(const SurveyTable& table, const WriteOptions& options);
std::string WriteP717(const SurveyTable& table);
std::string WritePetrel(const SurveyTable& table);
std::string WriteCompass(const SurveyTable& table);
/// A trajectory of each version, with matrixes where there are covariances.
std::string WriteWitsml1411(const SurveyTable& table);
std::string WriteWitsml21(const SurveyTable& table);
/// `bulk` names the CSV of the stations, where there is one beside the manifest.
std::string WriteOsdu(const SurveyTable& table, const std::string& bulk);
/// The stations of a manifest as CSV, columns called as it says.
std::string WriteOsduBulk(const SurveyTable& table);

}  // namespace wellgyro
