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

SurveyTable ReadCsv(LineReader& lines, const ReadOptions& options, Claims& claims);
SurveyTable ReadLas(LineReader& lines, const ReadOptions& options, Claims& claims);
SurveyTable ReadP717(LineReader& lines);
SurveyTable ReadPetrel(LineReader& lines, const ReadOptions& options, Claims& claims);
SurveyTable ReadWitsml(std::string bytes, const std::string& source, const ReadOptions& options);

/// Whether XML is an export of Landmark's EDM with a definitive survey.
bool IsEdm(std::string_view bytes);
SurveyTable ReadEdm(std::string bytes, const std::string& source, const ReadOptions& options);

std::string WriteCsv(const SurveyTable& table, const WriteOptions& options);
std::string WriteLas(const SurveyTable& table, const WriteOptions& options);
std::string WriteP717(const SurveyTable& table);
std::string WritePetrel(const SurveyTable& table);
std::string WriteCompass(const SurveyTable& table);
std::string WriteWitsml1411(const SurveyTable& table);
std::string WriteWitsml21(const SurveyTable& table);
/// `bulk` names the CSV of the stations, where there is one beside the manifest.
std::string WriteOsdu(const SurveyTable& table, const std::string& bulk);
std::string WriteOsduBulk(const SurveyTable& table);

}  // namespace wellgyro
