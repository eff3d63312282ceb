// Single numbers that their neighbours contradict.
#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include <fmt/core.h>

#include "wellgyro/io/exchange/column_units_internal.h"
#include "wellgyro/io/exchange/columns_internal.h"
#include "wellgyro/io/exchange/table_builder_internal.h"
#include "wellgyro/io/exchange/witness_case_internal.h"

namespace wellgyro::witness {
namespace {

// One column's remainders: given less computed along the path, leg by leg.
struct Leg {
  std::size_t row = 0;
  double length = 0, left = 0;
};

// A displacement as a column would give it.
using Computed = double (*)(const Eigen::Vector3d& moved, const PlaneFit& fit);
struct Track {
  Column column;
  Column other;  ///< the plane's other axis; the same for depths
  Column variance;
  Computed computed;
};
double Northwards(const Eigen::Vector3d& m, const PlaneFit& fit) {
  return (fit.z * std::complex<double>(m.x(), m.y())).real();
}
double Eastwards(const Eigen::Vector3d& m, const PlaneFit& fit) {
  return (fit.z * std::complex<double>(m.x(), m.y())).imag();
}
double Downwards(const Eigen::Vector3d& m, const PlaneFit&) { return m.z(); }
constexpr std::array kTracks{
    Track{Column::kTvd, Column::kTvd, Column::kVarVV, Downwards},
    Track{Column::kDown, Column::kDown, Column::kVarVV, Downwards},
    Track{Column::kTvdSubSea, Column::kTvdSubSea, Column::kVarVV, Downwards},
    Track{Column::kNorth, Column::kEast, Column::kVarNN, Northwards},
    Track{Column::kEast, Column::kNorth, Column::kVarEE, Eastwards},
    Track{Column::kNorthing, Column::kEasting, Column::kVarNN, Northwards},
    Track{Column::kEasting, Column::kNorthing, Column::kVarEE, Eastwards},
};

// Among positions the same with a plus sign too.
bool MayStandForNothing(double number) { return StandsForNothing(-std::abs(number)); }

class CellCheck {
 public:
  CellCheck(Case& c, const Track& track) : c_(c), track_(track) {
    const bool plane = track.other != track.column;
    if (plane) {
      const bool north = track.computed == Northwards;
      fit_ = FitPlane(c.table, c.stretches, north ? track.column : track.other,
                      north ? track.other : track.column);
      if (!Tells(fit_)) fit_.z = 1;
    }
    const LineFit depth = FitVertical(c.table, c.stretches, track.column);
    median_ = plane ? fit_.median : depth.median;
  }

  void TakeNothingsOut() {
    std::optional<std::size_t> last;
    std::vector<std::size_t> taken;
    double number = 0;
    for (std::size_t row = 0; row < c_.table.rows(); ++row) {
      if (!There(row)) continue;
      if (MayStandForNothing(Number(row))) {
        const bool fits = last && std::abs(LegOf(*last, row).left) <= Limit(LegOf(*last, row));
        if (!fits) {
          number = Number(row);
          taken.push_back(row);
          c_.table.Clear(track_.column, row);
          continue;
        }
      }
      last = row;
    }
    if (taken.empty()) return;
    c_.Note(fmt::format("{} of {} at {} is taken for no number", InfoOf(track_.column).text,
                        Exact(number), RowsText(c_.table, taken)));
  }

  void RefuseWrongOnes() const {
    std::optional<std::size_t> last;
    std::optional<Leg> before;
    for (std::size_t row = 0; row < c_.table.rows(); ++row) {
      if (!There(row)) continue;
      if (last) {
        const Leg leg = LegOf(*last, row);
        if (before) Compare(*before, leg);
        if (std::abs(leg.left) > Limit(leg) + leg.length) Farther(leg);
        before = leg;
      }
      last = row;
    }
    // The last number has no neighbour below it.
    if (before && std::abs(before->left) > Limit(*before) + 0.02 * before->length) Alone(*before);
  }

 private:
  bool There(std::size_t row) const {
    return c_.table.status(row) != RowStatus::kUnused && c_.table.Get(track_.column, row);
  }

  double Number(std::size_t row) const {
    const double factor = wellgyro::FactorOf(InfoOf(track_.column).quantity, c_.table.head);
    return *c_.table.Get(track_.column, row) / factor;
  }

  Leg LegOf(std::size_t from, std::size_t to) const {
    const SurveyTable& t = c_.table;
    Eigen::Vector3d moved = Eigen::Vector3d::Zero();
    for (std::size_t a = from, b = from + 1; b <= to; ++b) {
      if (t.status(b) == RowStatus::kUnused) continue;
      moved += Displacement(c_.method, t.md(b) - t.md(a), t.inclination(a), t.azimuth(a),
                            t.inclination(b), t.azimuth(b));
      a = b;
    }
    const double given = *t.Get(track_.column, to) - *t.Get(track_.column, from);
    return {to, t.md(to) - t.md(from), given - track_.computed(moved, fit_)};
  }

  /// Positions of two passes through one hole differ by what their own errors allow: by a sigma,
  /// where the file states it.
  double Limit(const Leg& leg) const {
    const SurveyTable& t = c_.table;
    double variance = 0;
    if (t.Has(track_.variance)) variance = t.Get(track_.variance, leg.row).value_or(0);
    return 10 * median_ + 0.05 + 1e-4 * leg.length + std::sqrt(std::max(variance, 0.0));
  }

  void Compare(const Leg& before, const Leg& leg) const {
    if (std::abs(before.left) <= Limit(before)) return;
    if (std::abs(before.left + leg.left) < 0.25 * std::abs(before.left)) Alone(before);
    // Wrong angles at a station bend the legs on both its sides the same way.
    const bool same = before.left * leg.left > 0;
    const double bend = std::min(std::abs(before.left) - 0.05 * before.length,
                                 std::abs(leg.left) - 0.05 * leg.length);
    if (same && bend > Limit(leg)) {
      c_.Refuse(fmt::format("the angles at MD {:.2f} m do not lead to the {} there and below",
                            c_.table.md(before.row), InfoOf(track_.column).text));
    }
  }

  [[noreturn]] void Alone(const Leg& leg) const {
    c_.Refuse(fmt::format(
        "{} of {} at MD {:.2f} m is {:.2f} m away from what its neighbours and "
        "its angles give",
        InfoOf(track_.column).text, Exact(Number(leg.row)), c_.table.md(leg.row), leg.left));
  }

  [[noreturn]] void Farther(const Leg& leg) const {
    c_.Refuse(fmt::format("{} changes by {:.1f} m more than the {:.1f} m above MD {:.2f} m allow",
                          InfoOf(track_.column).text, std::abs(leg.left), leg.length,
                          c_.table.md(leg.row)));
  }

  Case& c_;
  const Track& track_;
  PlaneFit fit_;
  double median_ = 0;
};

}  // namespace

void CheckCells(Case& c) {
  for (const Track& track : kTracks) {
    if (!c.table.Has(track.column)) continue;
    if (track.other != track.column && !c.table.Has(track.other)) continue;
    CellCheck check(c, track);
    check.TakeNothingsOut();
    check.RefuseWrongOnes();
  }
}

}  // namespace wellgyro::witness
