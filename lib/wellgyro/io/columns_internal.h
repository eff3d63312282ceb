#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "wellgyro/record/survey_table.h"

namespace wellgyro {

/// What a column measures, which settles its units.
enum class Quantity {
  kLength,      ///< in SurveyHead::md_unit
  kGridLength,  ///< in SurveyHead::grid_unit
  kAngle,
  kDirection,  ///< an angle in [0, 360)
  kCurvature,
  kArea,  ///< in md_unit squared
  kAcceleration,
  kRate,
  kTemperature,
  kTime,
  kRatio,
  kNumber,
};

/// A column as table formats know it.
struct ColumnInfo {
  Column column;
  Quantity quantity;
  std::string_view csv;   ///< name in CSV headers
  std::string_view las;   ///< curve mnemonic
  std::string_view text;  ///< in words
};
std::span<const ColumnInfo> AllColumns();
const ColumnInfo& InfoOf(Column column);

struct TextColumnInfo {
  TextColumn column;
  std::string_view csv;
};
std::span<const TextColumnInfo> AllTextColumns();

/// A column's heading taken apart: what it is, its unit as written, and the north it names.
struct Heading {
  std::optional<Column> column;
  std::optional<TextColumn> text;
  bool status = false;
  std::string unit;
  North north = North::kUnknown;
};
/// From any name that importers and vendors use, as "Measured Depth ( ft )" or "AZI_TRUE[deg]".
Heading HeadingOf(std::string_view heading);

/// SI value of one of `unit`, as any of the formats writes it; nothing when unknown.
std::optional<double> FactorOf(Quantity quantity, std::string_view unit);
std::optional<LengthUnit> LengthUnitOf(std::string_view unit);
std::optional<CurvatureUnit> CurvatureUnitOf(std::string_view unit);

double FactorOf(LengthUnit unit);
double FactorOf(CurvatureUnit unit);
/// SI value of the unit in which `head` wants a quantity.
double FactorOf(Quantity quantity, const SurveyHead& head);
/// Its name in CSV: m, ft, ftUS, deg, deg/30m ...
std::string UnitOf(Quantity quantity, const SurveyHead& head);
std::string_view WordOf(LengthUnit unit);  ///< m, ft, ftUS

std::string_view WordOf(North north);  ///< true, grid, magnetic, unknown
std::optional<North> NorthOf(std::string_view word);
std::string_view WordOf(RowStatus status);  ///< surveyed, tie_in ...
std::optional<RowStatus> RowStatusOf(std::string_view word);
std::string_view WordOf(SurveyTool tool);  ///< gyroscopic inertial ..., WITSML's words
std::optional<SurveyTool> SurveyToolOf(std::string_view word);

/// `value` in units of `factor` as the shortest decimal text that gives it back to the last bit.
std::string Exact(double value, double factor = 1);
/// The same of a column's value; directions in [0, 360).
std::string Exact(Quantity quantity, double value, const SurveyHead& head);

/// Value of `number` units; directions come out in [0, 2 pi).
double ValueOf(Quantity quantity, double number, double factor);

}  // namespace wellgyro
