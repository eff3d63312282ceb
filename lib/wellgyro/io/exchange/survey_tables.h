#pragma once

#include <span>

#include "wellgyro/base/export.h"
#include "wellgyro/earth/grid.h"
#include "wellgyro/record/station.h"
#include "wellgyro/record/survey_table.h"
#include "wellgyro/survey/job.h"

/// What is done to a survey between reading and writing it.
namespace wellgyro {

/// A survey of ours for exchange: `stations` of `job`, azimuths true, positions in W, with
/// covariances; northing, easting, grid azimuth and scale where `grid` is not null.
WELLGYRO_EXPORT SurveyTable TableOfSurvey(const Job& job, std::span<const Station> stations,
                                          const WellGrid* grid);

/// Metric or field units for MD, TVD, offsets and curvature; grid coordinates keep their own.
WELLGYRO_EXPORT void SetUnits(SurveyTable& table, LengthUnit unit);

/// Turns azimuths, offsets and covariances to count from `north`. Throws std::invalid_argument as
/// AzimuthFrom.
WELLGYRO_EXPORT void TurnTo(SurveyTable& table, North north);

/// Sums TVD, north, east and dogleg severity by minimum curvature where the table has no positions,
/// over the rows that belong to the path, to 1e-6 m. The first row must lie at depth zero or have a
/// position: else nothing is done and false given. Throws std::invalid_argument, naming the
/// station, when two of them point opposite ways.
WELLGYRO_EXPORT bool FillPositions(SurveyTable& table);

/// Closure, its azimuth, TVD below sea level and vertical section, from positions and head.
WELLGYRO_EXPORT void FillDerived(SurveyTable& table);

/// Lengths to 1e-4, angles to 1e-6 deg, the rest to 9 digits, in the units of its head.
WELLGYRO_EXPORT SurveyTable Rounded(const SurveyTable& table);

}  // namespace wellgyro
