#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "wellgyro/io/exchange/columns_internal.h"

/// IOGP P7/17 (Report 483-7) v1.0. The report itself was not at hand: field lists are those of the
/// format task force's published demonstration code (p7py, aligned with the draft of November 2019)
/// and of the user guide's two example files.
namespace wellgyro::p717 {

/// Fixed tables of the format. Unit numbers differ between the drafts of 2018 and 2019, so that
/// units are read by their names wherever a record has both.
std::string_view UnitName(int number, bool draft_2018);
int UnitNumber(std::string_view name);

/// A kind of object that positions are of, by number and code.
struct ObjectType {
  int number;
  std::string_view code, name;
};
/// Null for a code or number that the format does not have.
const ObjectType* TypeOfCode(std::string_view code);
const ObjectType* TypeOfNumber(int number);

std::string_view StatusText(int number);  ///< of rows
/// The format has no number for a tie-in: 9, other, and the point's code TP stand for it.
int NumberOfStatus(RowStatus status);
RowStatus StatusOf(int number, std::string_view point);

/// Extension fields of P7 records: the format's own, then ours from 100 on.
struct Extension {
  int number;
  std::string_view name;
  std::optional<Column> column = {};
  std::optional<TextColumn> text = {};
  std::string_view unit = {};  ///< of ours; the format's own follow from the quantity
};
const std::vector<Extension>& Extensions();

/// 2026:01:15:06:12:00.5 and seconds since 1970.
std::string TimeText(double utc);
std::optional<double> TimeOf(std::string_view text);
/// 2026:01:15 and 2026-01-15; other text stays as it is.
std::string ColonDate(std::string_view iso);
std::string IsoDate(std::string_view colons);

/// Names of MD kinds by number from 1 and of their statuses from 0.
inline constexpr std::array<std::string_view, 4> kDepthKinds{"MD-Drillpipe", "MD-Wireline",
                                                             "MD-tubing", "MD-Other"};
inline constexpr std::array<std::string_view, 5> kDepthStatuses{
    "Planned", "Indicated Depth", "Calibrated Depth", "Corrected Depth", "True Along-hole Depth"};

}  // namespace wellgyro::p717
