#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "wellgyro/base/export.h"
#include "wellgyro/base/result.h"
#include "wellgyro/earth/grid.h"
#include "wellgyro/record/check.h"
#include "wellgyro/record/station.h"

/// @file
/// The survey as plain CSV: exactly one header line, UTF-8, LF, a dot for decimals. Angles to 1e-6,
/// lengths to 1e-4, variances to 9 significant digits, azimuths in [0, 360), no negative zeros.
namespace wellgyro {

/// survey.csv: the rows of `stations`, in their order. Where `grid` is not null grid azimuth,
/// northing and easting stand in the last columns. Throws std::domain_error when a station lies
/// outside the projection, std::invalid_argument, naming station (from 0) and field, where a number
/// is not finite or a variance negative.
WELLGYRO_EXPORT std::string SurveyCsv(std::span<const Station> stations, const WellGrid* grid);

/// passes.csv: the same columns after RUN,PASS,STATUS,REVISION, and SIG_MD[m] behind QUALITY: what
/// the depth's error adds at an MD. Throws as SurveyCsv.
WELLGYRO_EXPORT std::string PassesCsv(std::span<const Station> stations, const WellGrid* grid);

/// checks.csv: CODE,RUN,PASS,MD[m],VALUE,SIGMA,LIMIT,UNIT,LIMIT_SOURCE,VERDICT. What a check does
/// not have, or has as what is no finite number, stays empty.
WELLGYRO_EXPORT std::string ChecksCsv(std::span<const Check> checks);

/// Stations from the text of a survey.csv; `source` names it in Faults, which carry line and
/// column. What the columns do not hold keeps its default, grid columns are checked and left; the
/// covariance of (MD, INC, AZI) is what SIG_INC and SIG_AZI say. Faults: kForeign when the header
/// is not ours, kSyntax, kRange, kOrder when depth does not increase.
WELLGYRO_EXPORT Result<std::vector<Station>> ParseSurveyCsv(std::string_view text,
                                                            const std::string& source);

/// ParseSurveyCsv of a file.
WELLGYRO_EXPORT Result<std::vector<Station>> ReadSurveyCsv(const std::filesystem::path& path);

/// Whether `line` is the header of a survey.csv, with or without grid columns.
WELLGYRO_EXPORT bool IsSurveyCsvHeader(std::string_view line);

}  // namespace wellgyro
