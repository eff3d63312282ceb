#pragma once

#include <cmath>
#include <cstddef>
#include <string>

#include <gtest/gtest.h>

#include "wellgyro/base/angle.h"
#include "wellgyro/base/units.h"
#include "wellgyro/record/survey_table.h"
#include "wellgyro/trajectory/minimum_curvature.h"

namespace wellgyro::support {

/// The head of FullSurvey.
inline SurveyHead FullHead(LengthUnit unit) {
  SurveyHead h;
  h.names = {.field = "TEST FIELD",
             .region = "North Sea",
             .country = "Norway",
             .country_code = "NOR",
             .structure = "PAD A",
             .structure_kind = "offshore",
             .well = "GYRO-1 \xC3\xA6\xC3\xB8",
             .uwi = "0000-0001",
             .wellbore = "WB00",
             .uwi_wellbore = "0000-0001-00",
             .rig = "Rig A",
             .survey = "Continuous gyro <run 1> & \"out\"",
             .operator_name = "Operator",
             .contractor = "Survey Co",
             .job = "J-1",
             .author = "surveyor",
             .uid_well = "w-1",
             .uid_wellbore = "b-1",
             .uid_survey = "t-1",
             .created = "2026-01-15T08:00:00Z",
             .begin = "2026-01-15",
             .end = "2026-01-16"};
  h.azimuth = {.north = North::kGrid,
               .convergence = -1.2345 * units::kDeg,
               .declination = 0.75 * units::kDeg,
               .declination_source = "BGGM 2025",
               .declination_date = "2026-01-15"};
  h.offsets = North::kGrid;
  h.datum = "RT";
  h.datum_elevation = 25.3 * (unit == LengthUnit::kMetre ? 1 : units::kFoot);
  h.vertical_reference = "MSL";
  h.md_kind = DepthKind::kWireline;
  h.md_unit = unit;
  h.grid_unit = unit;
  h.curvature_unit =
      unit == LengthUnit::kMetre ? CurvatureUnit::kDegPer30m : CurvatureUnit::kDegPer100ft;
  h.crs = "EPSG:23031";
  h.scale = 0.99975273;
  h.method = "minimum curvature";
  h.section_azimuth = 5 * units::kDeg;
  h.tool = SurveyTool::kGyroContinuous;
  h.error_model = "A021Gc GYRO-NS-CT";
  h.definitive = true;
  h.memory = false;
  h.final_survey = true;
  h.planned = false;
  return h;
}

/// A survey with something in every column that exchange formats know, in awkward numbers.
inline SurveyTable FullSurvey(LengthUnit unit = LengthUnit::kMetre) {
  SurveyTable t;
  t.head = FullHead(unit);
  const double f = unit == LengthUnit::kMetre ? 1 : units::kFoot;
  const double f2 = f * f;
  const double dls = unit == LengthUnit::kMetre ? units::kDegPer30m : units::kDegPer100ft;
  Eigen::Vector3d at = Eigen::Vector3d::Zero();
  double severity = 0;
  for (int i = 0; i < 7; ++i) {
    const std::size_t r = t.Add(30 * i * f, (0.1 + 2.35 * i) * units::kDeg,
                                std::fmod(358.5 + 1.1 * i, 360) * units::kDeg,
                                i == 0 ? RowStatus::kTieIn : RowStatus::kSurveyed);
    if (i > 0) {
      const auto tangent = [&](std::size_t row) {
        const double s = std::sin(t.inclination(row));
        return Eigen::Vector3d(s * std::cos(t.azimuth(row)), s * std::sin(t.azimuth(row)),
                               std::cos(t.inclination(row)));
      };
      const auto leg = MinimumCurvatureLeg(30 * f, tangent(r - 1), tangent(r));
      at += leg->displacement / f;
      severity = std::round(leg->dogleg / (30 * f) / dls * 1e4) / 1e4 * dls;
    }
    t.Set(Column::kTvd, r, (at.z() + 0.0123) * f);
    t.Set(Column::kNorth, r, (at.x() - 4.4321) * f);
    t.Set(Column::kEast, r, (at.y() + 0.1) * f);
    t.Set(Column::kNorthing, r, (6625015.54 + at.x()) * f);
    t.Set(Column::kEasting, r, (427710.69 + at.y()) * f);
    t.Set(Column::kDown, r, (at.z() - 25.2877) * f);
    t.Set(Column::kLatitude, r, (59.7553 + 1e-6 * i) * units::kDeg);
    t.Set(Column::kLongitude, r, (1.71347417 - 1e-6 * i) * units::kDeg);
    t.Set(Column::kDogleg, r, severity);
    t.Set(Column::kToolface, r, (10.0 + i) * units::kDeg);
    t.Set(Column::kVerticalSection, r, (at.x() + 0.001) * f);
    t.Set(Column::kVarNN, r, (0.0025 + 0.001 * i) * f2);
    t.Set(Column::kCovNE, r, (-0.000125 * i) * f2);
    t.Set(Column::kCovNV, r, 1e-7 * f2);
    t.Set(Column::kVarEE, r, (0.003 + 0.001 * i) * f2);
    t.Set(Column::kCovEV, r, -2e-7 * f2);
    t.Set(Column::kVarVV, r, 0.01 * f2);
    t.Set(Column::kSigmaInclination, r, 0.05 * units::kDeg);
    t.Set(Column::kSigmaAzimuth, r, 0.31 * units::kDeg);
    t.Set(Column::kGravity, r, 9.81229);
    t.Set(Column::kGravityRef, r, 9.81234);
    t.Set(Column::kEarthRateMeasured, r, 15.0213 * units::kDegPerHour);
    t.Set(Column::kEarthRateReference, r, 15.041 * units::kDegPerHour);
    t.Set(Column::kUtc, r, 1768457520 + 300.125 * i);
    t.Set(TextColumn::kKind, r, i == 0 ? "tie_in" : "continuous");
    t.Set(TextColumn::kQuality, r, i == 3 ? "moved+gap" : "good");
    t.Set(TextColumn::kUid, r, "s-" + std::to_string(i));
  }
  return t;
}

/// Every value of `columns` in `b` is `a`'s, to the last bit, or absent in both.
template <class Columns>
void ExpectSameStations(const SurveyTable& a, const SurveyTable& b, const Columns& columns) {
  ASSERT_EQ(a.rows(), b.rows());
  for (std::size_t row = 0; row < a.rows(); ++row) {
    for (const Column column : columns) {
      const auto x = a.Get(column, row), y = b.Get(column, row);
      ASSERT_EQ(x.has_value(), y.has_value())
          << "column " << static_cast<int>(column) << " row " << row;
      EXPECT_EQ(x.value_or(0), y.value_or(0))
          << "column " << static_cast<int>(column) << " row " << row;
    }
  }
}

}  // namespace wellgyro::support
