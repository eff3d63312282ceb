#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "wellgyro/record/survey_head.h"

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

/// SI value of one of `unit`, as any of the formats writes it; nothing when unknown.
std::optional<double> FactorOf(Quantity quantity, std::string_view unit);
std::optional<LengthUnit> LengthUnitOf(std::string_view unit);
std::optional<CurvatureUnit> CurvatureUnitOf(std::string_view unit);

/// "'furlong' is no unit of measured depth; known are m, ft, ftUS".
std::string NoUnit(Quantity quantity, std::string_view unit, std::string_view column);
/// The same of measured depth, which has fewer.
std::string NoUnitOfDepth(std::string_view unit);

double FactorOf(LengthUnit unit);
double FactorOf(CurvatureUnit unit);
/// SI value of the unit in which `head` wants a quantity.
double FactorOf(Quantity quantity, const SurveyHead& head);
/// Its name in CSV: m, ft, ftUS, deg, deg/30m ...
std::string UnitOf(Quantity quantity, const SurveyHead& head);
std::string_view WordOf(LengthUnit unit);     ///< m, ft, ftUS
std::string_view WordOf(CurvatureUnit unit);  ///< deg/30m, deg/100ft, deg/m, deg/ft, rad/m

/// `value` in units of `factor` as the shortest decimal text that gives it back to the last bit.
std::string Exact(double value, double factor = 1);
/// The same of a column's value; directions in [0, 360).
std::string Exact(Quantity quantity, double value, const SurveyHead& head);

/// Value of `number` units; directions come out in [0, 2 pi).
double ValueOf(Quantity quantity, double number, double factor);

}  // namespace wellgyro
