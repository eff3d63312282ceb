#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "wellgyro/io/exchange/columns_internal.h"
#include "wellgyro/io/exchange/exchange.h"
#include "wellgyro/io/exchange/line_reader_internal.h"

namespace wellgyro {

/// Adds stations to a table with the checks that every format shares. Complaints come back as text
/// for the caller to give its place.
class TableBuilder {
 public:
  struct Problem {
    FaultCode code;
    std::string text;
  };

  SurveyTable table;

  /// `md` [m], angles [rad]. Depth must increase over rows that belong to the path, of one survey
  /// where `survey` is given.
  std::optional<Problem> Add(double md, double inclination, double azimuth,
                             RowStatus status = RowStatus::kSurveyed);
  void Set(Column column, double value) { table.Set(column, table.rows() - 1, value); }
  void Set(TextColumn column, std::string text) {
    table.Set(column, table.rows() - 1, std::move(text));
  }

 private:
  std::optional<double> last_md_;
};

/// Whether a row with it is a station of the path.
inline bool OnPath(RowStatus status) { return status != RowStatus::kUnused; }

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
void TakeReportLine(SurveyHead& head, std::string_view line);

/// Throws std::invalid_argument: `format` needs ... .
[[noreturn]] void Lacks(std::string_view format, std::string_view what);
/// Lacks, unless the north of the azimuths is known.
void NeedNorth(const SurveyTable& table, std::string_view format);

SurveyTable ReadCsv(LineReader& lines, const ReadOptions& options);
SurveyTable ReadLas(LineReader& lines, const ReadOptions& options);
SurveyTable ReadP717(LineReader& lines);
SurveyTable ReadPetrel(LineReader& lines);
SurveyTable ReadWitsml(std::string bytes, const std::string& source);

std::string WriteCsv(const SurveyTable& table, const WriteOptions& options);
std::string WriteLas(const SurveyTable& table, const WriteOptions& options);
std::string WriteP717(const SurveyTable& table);
std::string WritePetrel(const SurveyTable& table);
std::string WriteCompass(const SurveyTable& table);
std::string WriteWitsml1411(const SurveyTable& table);
std::string WriteWitsml21(const SurveyTable& table);
std::string WriteOsdu(const SurveyTable& table);

}  // namespace wellgyro
