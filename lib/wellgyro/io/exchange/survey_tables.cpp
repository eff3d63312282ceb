#include <array>
#include <cmath>
#include <stdexcept>
#include <string>
#include <vector>

#include <fmt/core.h>

#include "wellgyro/base/angle.h"
#include "wellgyro/base/units.h"
#include "wellgyro/io/exchange/exchange.h"
#include "wellgyro/io/exchange/table_build_internal.h"
#include "wellgyro/io/iso_time_internal.h"
#include "wellgyro/io/text_internal.h"
#include "wellgyro/io/words.h"
#include "wellgyro/math/rotation.h"
#include "wellgyro/trajectory/leg_geometry.h"
#include "wellgyro/trajectory/minimum_curvature.h"

namespace wellgyro {
namespace {

/// Sets what was computed, with six digits behind the point in the unit that the file has.
void SetComputed(SurveyTable& table, Column column, std::size_t row, double value) {
  const Quantity quantity = InfoOf(column).quantity;
  const double factor = FactorOf(quantity, table.head);
  // A whole number over a million is the double that its decimals are read as.
  const double number = std::round(value / factor * 1e6) / 1e6;
  table.Set(column, row, ValueOf(quantity, number + 0.0, factor));
}

void SetCovariance(SurveyTable& table, std::size_t row, const Eigen::Matrix3d& c) {
  table.Set(Column::kVarNN, row, c(0, 0));
  table.Set(Column::kCovNE, row, c(0, 1));
  table.Set(Column::kCovNV, row, c(0, 2));
  table.Set(Column::kVarEE, row, c(1, 1));
  table.Set(Column::kCovEV, row, c(1, 2));
  table.Set(Column::kVarVV, row, c(2, 2));
}

std::optional<Eigen::Matrix3d> CovarianceOf(const SurveyTable& table, std::size_t row) {
  const auto nn = table.Get(Column::kVarNN, row), ne = table.Get(Column::kCovNE, row);
  const auto nv = table.Get(Column::kCovNV, row), ee = table.Get(Column::kVarEE, row);
  const auto ev = table.Get(Column::kCovEV, row), vv = table.Get(Column::kVarVV, row);
  if (!nn || !ne || !nv || !ee || !ev || !vv) return std::nullopt;
  Eigen::Matrix3d c;
  c << *nn, *ne, *nv, *ne, *ee, *ev, *nv, *ev, *vv;
  return c;
}

std::string TextOfKey(const Job& job, std::string_view key) {
  for (const auto& [name, value] : job.identity) {
    if (name == key) return value;
  }
  return {};
}

SurveyHead HeadOf(const Job& job, const WellGrid* grid) {
  SurveyHead head;
  SurveyIdentity& names = head.names;
  names.well = job.well.name;
  names.wellbore = TextOfKey(job, "wellbore");
  if (names.wellbore.empty()) names.wellbore = names.well;
  names.field = TextOfKey(job, "field");
  names.operator_name = TextOfKey(job, "operator");
  names.contractor = TextOfKey(job, "contractor");
  names.rig = TextOfKey(job, "rig");
  names.country = TextOfKey(job, "country");
  names.uwi = TextOfKey(job, "uwi");
  names.job = TextOfKey(job, "job");
  names.author = TextOfKey(job, "surveyor");
  names.survey = TextOfKey(job, "survey");
  if (names.survey.empty()) names.survey = "Gyro survey";
  head.azimuth.north = head.offsets = North::kTrue;
  head.datum = TextOfKey(job, "datum");
  if (head.datum.empty()) head.datum = "depth datum";
  head.datum_elevation = job.well.datum_elevation;
  head.vertical_reference = "MSL";
  head.md_kind = job.depth.kind;
  head.method = "minimum curvature";
  head.error_model = TextOfKey(job, "error_model");
  head.planned = false;
  head.memory = false;
  if (grid) {
    head.azimuth.convergence = grid->At(0, 0).convergence;
    head.scale = grid->At(0, 0).scale;
    const GridSpec& spec = *job.grid;
    head.crs = spec.epsg.empty() ? spec.name : spec.epsg;
  }
  return head;
}

void TurnVector(SurveyTable& table, std::size_t row, const Eigen::Matrix3d& r, Column north,
                Column east) {
  const auto n = table.Get(north, row), e = table.Get(east, row);
  if (!n || !e) return;
  const Eigen::Vector3d p = r * Eigen::Vector3d(*n, *e, 0);
  table.Set(north, row, p.x());
  table.Set(east, row, p.y());
}

SurveyTool ToolOf(std::span<const Station> stations) {
  SurveyTool tool = SurveyTool::kUnknown;
  for (const Station& s : stations) {
    if (s.kind == StationKind::kContinuous) return SurveyTool::kGyroContinuous;
    if (s.kind != StationKind::kTieIn) tool = SurveyTool::kGyroNorthSeeking;
  }
  return tool;
}

RowStatus StatusOf(const Station& s) {
  if (s.status == StationStatus::kRejected) return RowStatus::kUnused;
  return s.kind == StationKind::kTieIn ? RowStatus::kTieIn : RowStatus::kSurveyed;
}

std::size_t AddStation(SurveyTable& table, const Station& s) {
  const std::size_t row = table.Add(s.md, s.inclination, s.azimuth, StatusOf(s));
  table.Set(Column::kToolface, row, s.toolface);
  table.Set(Column::kNorth, row, s.p_WT_W.x());
  table.Set(Column::kEast, row, s.p_WT_W.y());
  table.Set(Column::kTvd, row, s.p_WT_W.z());
  table.Set(Column::kDogleg, row, s.dogleg_severity);
  if (!Has(s.quality, Quality::kUnfit)) {
    SetCovariance(table, row, s.cov_p_WT_W);
    table.Set(Column::kSigmaInclination, row, std::sqrt(s.cov_md_inc_azi(1, 1)));
    table.Set(Column::kSigmaAzimuth, row, std::sqrt(s.cov_md_inc_azi(2, 2)));
  }
  if (s.gravity > 0) table.Set(Column::kGravity, row, s.gravity);
  if (s.gravity_ref > 0) table.Set(Column::kGravityRef, row, s.gravity_ref);
  if (s.earth_rate) {
    table.Set(Column::kEarthRateMeasured, row, *s.earth_rate);
    table.Set(Column::kEarthRateReference, row, s.earth_rate_ref);
  }
  table.Set(TextColumn::kKind, row, std::string(WordOf(s.kind)));
  table.Set(TextColumn::kQuality, row, QualityText(s.quality));
  return row;
}

void SetGrid(SurveyTable& table, std::size_t row, const Station& s, const WellGrid& grid) {
  const GridPoint p = grid.At(s.p_WT_W.x(), s.p_WT_W.y());
  table.Set(Column::kAzimuthGrid, row, WrapTwoPi(s.azimuth - p.convergence));
  table.Set(Column::kNorthing, row, p.northing);
  table.Set(Column::kEasting, row, p.easting);
}

}  // namespace

SurveyTable TableOfSurvey(const Job& job, std::span<const Station> stations, const WellGrid* grid) {
  SurveyTable table;
  table.head = HeadOf(job, job.grid ? grid : nullptr);
  table.head.tool = ToolOf(stations);
  bool accepted = !stations.empty();
  std::optional<double> first, last;
  for (const Station& s : stations) {
    const std::size_t row = AddStation(table, s);
    if (grid && job.grid) SetGrid(table, row, s, *grid);
    if (s.kind == StationKind::kTieIn) continue;
    accepted = accepted && s.status == StationStatus::kDefinitive;
    if (s.utc.ns <= 0) continue;
    const double utc = static_cast<double>(s.utc.ns) * 1e-9;
    table.Set(Column::kUtc, row, utc);
    first = first ? std::min(*first, utc) : utc;
    last = last ? std::max(*last, utc) : utc;
  }
  table.head.definitive = table.head.final_survey = accepted;
  // Nothing here reads a clock: the survey is as old as its last station.
  if (first) table.head.names.begin = IsoUtc(*first);
  if (last) table.head.names.end = table.head.names.created = IsoUtc(*last);
  return table;
}

void SetUnits(SurveyTable& table, LengthUnit unit) {
  if (unit != LengthUnit::kMetre && unit != LengthUnit::kFoot && unit != LengthUnit::kUsFoot) {
    throw std::invalid_argument(
        fmt::format("SetUnits: LengthUnit {} is no unit", static_cast<int>(unit)));
  }
  table.head.md_unit = unit;
  table.head.curvature_unit =
      unit == LengthUnit::kMetre ? CurvatureUnit::kDegPer30m : CurvatureUnit::kDegPer100ft;
}

void TurnTo(SurveyTable& table, North north) {
  SurveyHead& head = table.head;
  const North azimuth_from = head.azimuth.north, offsets_from = head.offsets;
  // What cannot be turned is refused before anything has been.
  static_cast<void>(AzimuthFrom(head.azimuth, 0, azimuth_from, north));
  // Where there are no offsets, it does not matter that nobody said what they count from.
  const bool offsets = offsets_from != North::kUnknown || table.Has(Column::kNorth) ||
                       head.section_north != 0 || head.section_east != 0;
  const double turn = offsets ? AzimuthFrom(head.azimuth, 0, offsets_from, north) : 0;
  for (std::size_t row = 0; row < table.rows(); ++row) {
    if (azimuth_from != north) {
      table.Set(Column::kAzimuth, row,
                AzimuthFrom(head.azimuth, table.azimuth(row), azimuth_from, north));
    }
    if (offsets_from == north || !table.Has(Column::kNorth)) continue;
    Eigen::Matrix3d r;
    r << std::cos(turn), -std::sin(turn), 0, std::sin(turn), std::cos(turn), 0, 0, 0, 1;
    TurnVector(table, row, r, Column::kNorth, Column::kEast);
    if (const auto c = CovarianceOf(table, row)) {
      SetCovariance(table, row, r * *c * r.transpose());
    }
    TurnVector(table, row, r, Column::kBiasN, Column::kBiasE);
    if (const auto closure = table.Get(Column::kClosureAzimuth, row)) {
      table.Set(Column::kClosureAzimuth, row, WrapTwoPi(*closure + turn));
    }
  }
  for (GyroRawRecord& raw : head.gyro_raw) {
    raw.azimuth = AzimuthFrom(head.azimuth, raw.azimuth, azimuth_from, north);
  }
  const double section_north = head.section_north;
  head.section_north = section_north * std::cos(turn) - head.section_east * std::sin(turn);
  head.section_east = section_north * std::sin(turn) + head.section_east * std::cos(turn);
  if (head.section_azimuth && azimuth_from != north) {
    head.section_azimuth = AzimuthFrom(head.azimuth, *head.section_azimuth, azimuth_from, north);
  }
  head.azimuth.north = north;
  head.offsets = north;
  for (SurveyRun& run : head.runs) run.azimuth.north = north;
}

bool FillPositions(SurveyTable& table) {
  if (table.Has(Column::kTvd) && table.Has(Column::kNorth) && table.Has(Column::kEast)) return true;
  std::vector<double> md, inclination, azimuth;
  std::vector<std::size_t> rows;
  for (std::size_t row = 0; row < table.rows(); ++row) {
    if (!OnPath(table.status(row))) continue;
    rows.push_back(row);
    md.push_back(table.md(row));
    inclination.push_back(table.inclination(row));
    azimuth.push_back(table.azimuth(row));
  }
  if (rows.empty()) return false;
  const auto tvd = table.Get(Column::kTvd, rows[0]);
  if (!tvd && md[0] != 0) return false;
  std::vector<Eigen::Vector3d> position(md.size());
  std::vector<double> severity(md.size());
  MinimumCurvature(md, inclination, azimuth, {0, 0, tvd.value_or(0)}, position, severity);
  const bool had_tvd = table.Has(Column::kTvd), had_dogleg = table.Has(Column::kDogleg);
  const bool had_offsets = table.Has(Column::kNorth) && table.Has(Column::kEast);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (!had_offsets) {
      SetComputed(table, Column::kNorth, rows[i], position[i].x());
      SetComputed(table, Column::kEast, rows[i], position[i].y());
    }
    if (!had_tvd) SetComputed(table, Column::kTvd, rows[i], position[i].z());
    if (!had_dogleg) SetComputed(table, Column::kDogleg, rows[i], severity[i]);
  }
  if (!had_offsets) table.head.offsets = table.head.azimuth.north;
  if (table.head.method.empty()) table.head.method = "minimum curvature";
  return true;
}

std::optional<double> DepartureFromListed(const SurveyTable& table) {
  const SurveyHead& head = table.head;
  if (head.azimuth.north == North::kUnknown || head.offsets == North::kUnknown) return {};
  double turn = 0, worst = 0;
  if (head.offsets != head.azimuth.north) {
    try {
      turn = AzimuthFrom(head.azimuth, 0, head.azimuth.north, head.offsets);
    } catch (const std::invalid_argument&) {
      return std::nullopt;
    }
  }
  std::optional<std::size_t> last;
  Eigen::Vector3d at = Eigen::Vector3d::Zero();
  for (std::size_t row = 0; row < table.rows(); ++row) {
    const auto n = table.Get(Column::kNorth, row), e = table.Get(Column::kEast, row);
    const auto tvd = table.Get(Column::kTvd, row);
    if (!OnPath(table.status(row)) || !n || !e || !tvd) continue;
    const Eigen::Vector3d given(*n, *e, *tvd);
    if (!last) {
      at = given;
    } else {
      const auto leg =
          MinimumCurvatureLeg(table.md(row) - table.md(*last),
                              Tangent(table.inclination(*last), table.azimuth(*last) + turn),
                              Tangent(table.inclination(row), table.azimuth(row) + turn));
      if (!leg) return std::nullopt;
      at += leg->displacement;
      worst = std::max(worst, (given - at).norm());
    }
    last = row;
  }
  if (!last) return std::nullopt;
  return worst;
}

void SumAsListed(SurveyTable& table) {
  const auto north = table.Get(Column::kNorth, 0), east = table.Get(Column::kEast, 0);
  const auto tvd = table.Get(Column::kTvd, 0);
  for (const Column c :
       {Column::kTvd, Column::kNorth, Column::kEast, Column::kDogleg, Column::kNorthing,
        Column::kEasting, Column::kDown, Column::kLatitude, Column::kLongitude, Column::kTvdSubSea,
        Column::kVerticalSection, Column::kClosure, Column::kClosureAzimuth, Column::kBuild,
        Column::kTurn}) {
    table.Drop(c);
  }
  // FillPositions sums from depth zero.
  SurveyTable shifted = table;
  const double first = table.rows() > 0 ? table.md(0) : 0;
  for (std::size_t row = 0; row < shifted.rows(); ++row) {
    shifted.Set(Column::kMd, row, table.md(row) - first);
  }
  FillPositions(shifted);
  for (std::size_t row = 0; row < table.rows(); ++row) {
    const auto put = [&](Column column, double from) {
      const auto value = shifted.Get(column, row);
      if (value) SetComputed(table, column, row, *value + from);
    };
    put(Column::kNorth, north.value_or(0));
    put(Column::kEast, east.value_or(0));
    put(Column::kTvd, tvd.value_or(first));
    put(Column::kDogleg, 0);
  }
  table.head.offsets = table.head.azimuth.north;
  table.head.method = "minimum curvature";
}

void FillDerived(SurveyTable& table) {
  const SurveyHead& head = table.head;
  for (std::size_t row = 0; row < table.rows(); ++row) {
    const auto n = table.Get(Column::kNorth, row), e = table.Get(Column::kEast, row);
    const auto tvd = table.Get(Column::kTvd, row);
    if (n && e) {
      const Closure closure = ClosureOf(*n, *e);
      SetComputed(table, Column::kClosure, row, closure.distance);
      SetComputed(table, Column::kClosureAzimuth, row, closure.azimuth);
      if (head.section_azimuth) {
        SetComputed(
            table, Column::kVerticalSection, row,
            VerticalSection(*n, *e, *head.section_azimuth, head.section_north, head.section_east));
      }
    }
    if (tvd && head.datum_elevation) {
      SetComputed(table, Column::kTvdSubSea, row, TvdSubSea(*tvd, *head.datum_elevation));
    }
  }
}

SurveyTable Rounded(const SurveyTable& table) {
  SurveyTable rounded = table;
  for (const ColumnInfo& info : AllColumns()) {
    const double factor = FactorOf(info.quantity, table.head);
    for (std::size_t row = 0; row < table.rows(); ++row) {
      const auto value = table.Get(info.column, row);
      if (!value) continue;
      const double number = *value / factor;
      std::string text;
      switch (info.quantity) {
        case Quantity::kLength:
        case Quantity::kGridLength:
          text = fmt::format("{:.4f}", number);
          break;
        case Quantity::kAngle:
        case Quantity::kDirection:
        case Quantity::kCurvature:
          text = fmt::format("{:.6f}", number);
          break;
        case Quantity::kTime:
          text = fmt::format("{:.3f}", number);
          break;
        default:
          text = fmt::format("{:.9g}", number);
      }
      rounded.Set(info.column, row,
                  ValueOf(info.quantity, NumberOf(text).value_or(number), factor));
    }
  }
  return rounded;
}

}  // namespace wellgyro
