// Units of length and the method of calculation, by what fits.
#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/core.h>

#include "wellgyro/base/units.h"
#include "wellgyro/io/exchange/column_units_internal.h"
#include "wellgyro/io/exchange/columns_internal.h"
#include "wellgyro/io/exchange/witness_case_internal.h"

namespace wellgyro::witness {
namespace {

constexpr double kScale = 0.004;  // grids shrink lengths by as much
constexpr std::array kDepths{Column::kTvd, Column::kDown, Column::kTvdSubSea};
struct Pair {
  Column north, east;
};
constexpr std::array kPlanePairs{Pair{Column::kNorth, Column::kEast},
                                 Pair{Column::kNorthing, Column::kEasting}};

void Rescale(SurveyTable& table, Column column, double factor) {
  for (std::size_t row = 0; row < table.rows(); ++row) {
    if (const auto value = table.Get(column, row)) table.Set(column, row, *value * factor);
  }
}

// A length, given over computed, of every group of columns that can tell.
struct Found {
  Column column;
  double factor, tolerance;
};
std::vector<Found> LengthsOf(const Case& c) {
  std::vector<Found> found;
  for (const Column column : kDepths) {
    const LineFit fit = FitVertical(c.table, c.stretches, column);
    if (Tells(fit)) found.push_back({column, std::abs(fit.factor), kScale + 4 * fit.sigma});
  }
  for (const Pair& plane : kPlanePairs) {
    const PlaneFit fit = FitPlane(c.table, c.stretches, plane.north, plane.east);
    if (!Tells(fit)) continue;
    found.push_back({plane.north, std::abs(fit.z), kScale + 4 * fit.sigma});
  }
  return found;
}

// Whether measured depths without a unit are in metres or feet; taken in metres so far.
class UnitVotes {
 public:
  void Add(LengthUnit unit, const std::string& because) {
    (unit == LengthUnit::kFoot ? feet_ : metres_) = because;
  }
  std::optional<LengthUnit> unit() const {
    if (feet_.empty() == metres_.empty()) return std::nullopt;
    return feet_.empty() ? LengthUnit::kMetre : LengthUnit::kFoot;
  }
  bool split() const { return !feet_.empty() && !metres_.empty(); }
  const std::string& because() const { return feet_.empty() ? metres_ : feet_; }

 private:
  std::string feet_, metres_;
};

void VoteByCurvature(const Case& c, UnitVotes& votes) {
  const LineFit fit = FitCurvature(c.table);
  if (!Tells(fit)) return;
  // Nearest of the ratios looked for: (100/30) / (1/0.3048) = 1.016, of which this is less than
  // half.
  constexpr double kNear = 0.007;
  const auto is = [&](double wanted) { return std::abs(fit.factor / wanted - 1) < kNear; };
  if (is(1) || is(1.0 / 3)) votes.Add(LengthUnit::kMetre, "dogleg severity");
  if (c.claims.curvature_unit ? is(1 / 0.3048) : is(100.0 / 30) || is(1 / 0.3048)) {
    votes.Add(LengthUnit::kFoot, "dogleg severity");
  }
}

UnitVotes VotesFor(const Case& c) {
  UnitVotes votes;
  for (const Found& found : LengthsOf(c)) {
    if (c.Open(found.column)) continue;
    const std::string name(InfoOf(found.column).text);
    const Ratio ratio = RatioOf(found.factor, found.tolerance);
    if (ratio == Ratio::kSame) votes.Add(LengthUnit::kMetre, name);
    if (ratio == Ratio::kMetresAsFeet) votes.Add(LengthUnit::kFoot, name);
  }
  VoteByCurvature(c, votes);
  const auto& elevation = c.table.head.datum_elevation;
  if (elevation && c.claims.sum_of_tvd_and_z && std::abs(*elevation) > 1) {
    const Ratio ratio = RatioOf(*elevation / *c.claims.sum_of_tvd_and_z, 1e-3);
    if (ratio == Ratio::kSame) votes.Add(LengthUnit::kMetre, "the elevation of its datum");
    if (ratio == Ratio::kMetresAsFeet) votes.Add(LengthUnit::kFoot, "the elevation of its datum");
  }
  return votes;
}

void SettleDepthUnit(Case& c) {
  const UnitVotes votes = VotesFor(c);
  const auto unit = votes.unit();
  if (!unit) {
    c.Refuse(votes.split() ? "the unit of measured depth is not stated, and both metres and feet "
                             "fit something in the file: say --depth-unit m or ft"
                           : "the unit of measured depth is not stated, and nothing in the file "
                             "tells it: say --depth-unit m or ft");
  }
  c.table.head.md_unit = *unit;
  c.Note(fmt::format("measured depth is in {}, as {} shows",
                     *unit == LengthUnit::kFoot ? "feet" : "metres", votes.because()));
  if (*unit == LengthUnit::kMetre) return;
  Rescale(c.table, Column::kMd, units::kFoot);
  for (const Column column : c.claims.open) Rescale(c.table, column, units::kFoot);
  c.stretches = StretchesOf(c.table, c.method, 2048);
}

void SettleOpenColumns(Case& c) {
  const double md = FactorOf(c.table.head.md_unit);
  for (const Found& found : LengthsOf(c)) {
    const std::string name(InfoOf(found.column).text);
    const Ratio ratio = RatioOf(found.factor, found.tolerance);
    if (ratio == Ratio::kSame) continue;
    const Ratio other = md == 1 ? Ratio::kFeetAsMetres : Ratio::kMetresAsFeet;
    if (!c.Open(found.column) || ratio != other) {
      c.Refuse(fmt::format(
          "{} changes {:.4g} times as fast as measured depth, inclination and azimuth say: one of "
          "them is in another unit or column than the file says; say --depth-unit, or the column "
          "with its unit by --columns",
          name, found.factor));
    }
    // Taken in the unit of MD, it is in the other one.
    const bool feet = md == 1;
    const double factor = feet ? units::kFoot : 1 / md;
    c.Note(fmt::format("{} is in {}, as measured depth, inclination and azimuth show", name,
                       feet ? "feet" : "metres"));
    for (const Pair& plane : kPlanePairs) {
      if (plane.north == found.column) Rescale(c.table, plane.east, factor);
    }
    Rescale(c.table, found.column, factor);
    if (found.column == Column::kNorthing) {
      c.table.head.grid_unit = feet ? LengthUnit::kFoot : LengthUnit::kMetre;
    }
  }
}

void SettleCurvature(Case& c) {
  const LineFit fit = FitCurvature(c.table);
  if (!Tells(fit)) {
    // Without a unit it could be anything.
    if (!c.claims.curvature_unit) c.table.Drop(Column::kDogleg);
    return;
  }
  const auto is = [&](double wanted) { return std::abs(fit.factor / wanted - 1) < 0.007; };
  if (c.claims.curvature_unit) {
    if (is(1)) {
      c.agreeing.emplace_back("dogleg severity");
    } else if (is(1 / 0.3048) || is(0.3048) || is(100.0 / 30) || is(0.3)) {
      c.Refuse(fmt::format(
          "dogleg severity is {:.4g} times what measured depth, inclination and azimuth give: "
          "depths in another unit than the file says? say --depth-unit m or ft",
          fit.factor));
    }
    return;
  }
  if (is(1)) return c.agreeing.emplace_back("dogleg severity"), void();
  const double hundred_feet = units::kDegPer100ft / units::kDegPer30m;
  if (is(1 / hundred_feet)) {
    Rescale(c.table, Column::kDogleg, hundred_feet);
    c.table.head.curvature_unit = CurvatureUnit::kDegPer100ft;
    c.Note("dogleg severity is in deg/100ft, as measured depth, inclination and azimuth show");
    c.agreeing.emplace_back("dogleg severity");
  } else {
    c.table.Drop(Column::kDogleg);
    c.Note("dogleg severity is left out: its unit is not stated and none fits");
  }
}

/// Refuses positions that part by `worst` from those of any method over legs of `leg` [m], and
/// notes a method that is not the usual one.
void SayMethod(double worst, double leg, Case& c) {
  if (worst > 0.05 * leg + 0.5) {
    c.Refuse(fmt::format(
        "its positions do not follow from measured depth, inclination and azimuth by any method: "
        "they part by {:.3g} m over {:.4g} m; name the columns by --columns",
        worst, leg));
  }
  if (c.method != Method::kMinimumCurvature) {
    c.Note(fmt::format("its positions were summed by the method {}", WordOf(c.method)));
    if (c.table.head.method.empty()) c.table.head.method = WordOf(c.method);
  }
}

}  // namespace

void SettleUnits(Case& c) {
  if (!c.claims.md_unit) SettleDepthUnit(c);
  SettleOpenColumns(c);
  if (c.table.Has(Column::kDogleg)) SettleCurvature(c);
}

void SettleMethod(Case& c) {
  const std::size_t legs = std::max<std::size_t>(c.stretches.size(), 1);
  const double leg =
      std::abs(c.table.md(c.table.rows() - 1) - c.table.md(0)) / static_cast<double>(legs);
  double best = 0;
  for (const Method method : kMethods) {
    const auto stretches = StretchesOf(c.table, method, 2048);
    double remains = 0;
    bool any = false;
    for (const Pair& plane : kPlanePairs) {
      const PlaneFit fit = FitPlane(c.table, stretches, plane.north, plane.east);
      if (!Tells(fit)) continue;
      remains = std::max(remains, std::min(fit.median, fit.mirrored_median));
      any = true;
    }
    const LineFit fit = FitVertical(c.table, stretches, Column::kTvd);
    if (Tells(fit)) {
      remains = std::max(remains, fit.median);
      any = true;
    }
    if (!any) return;
    const bool first = method == Method::kMinimumCurvature;
    if (!first && !(remains < 0.5 * best)) continue;
    best = remains;
    c.method = method;
    c.stretches = stretches;
    // Within the rounding of any file that people exchange.
    if (first && remains < 0.02 + 1e-4 * leg) break;
  }
  c.worst = best;
  SayMethod(best, leg, c);
}

}  // namespace wellgyro::witness
