#pragma once

#include <optional>
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

/// Turns every direction of the survey to count from `north`: azimuths, offsets, covariances,
/// biases, closure, the plane of the vertical section and raw records. Throws std::invalid_argument
/// as AzimuthFrom.
WELLGYRO_EXPORT void TurnTo(SurveyTable& table, North north);

/// Sums what the table lacks of TVD, north, east and dogleg severity by minimum curvature, over the
/// rows that belong to the path, to 1e-6 m. The first row must lie at depth zero or have a
/// position: else nothing is done and false given. Throws std::invalid_argument, naming the
/// station, when two of them point opposite ways.
WELLGYRO_EXPORT bool FillPositions(SurveyTable& table);

/// How far positions part from minimum curvature of the listed stations, at most [m]; nothing
/// where there are none to compare. Positions of ours are summed between the stations too.
WELLGYRO_EXPORT std::optional<double> DepartureFromListed(const SurveyTable& table);

/// Sums TVD, north, east and dogleg severity afresh from the listed stations alone, from the first
/// row's own position; map coordinates, latitudes and what follows from positions are taken away.
WELLGYRO_EXPORT void SumAsListed(SurveyTable& table);

/// Closure, its azimuth, TVD below sea level and vertical section, from positions and head.
WELLGYRO_EXPORT void FillDerived(SurveyTable& table);

/// Lengths to 1e-4, angles to 1e-6 deg, the rest to 9 digits, in the units of its head.
WELLGYRO_EXPORT SurveyTable Rounded(const SurveyTable& table);

}  // namespace wellgyro
