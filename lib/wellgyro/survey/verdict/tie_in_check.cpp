#include "wellgyro/survey/verdict/tie_in_check.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include <Eigen/Geometry>

#include "wellgyro/base/angle.h"
#include "wellgyro/base/units.h"
#include "wellgyro/math/rotation.h"
#include "wellgyro/survey/hole/field_practice.h"
#include "wellgyro/survey/verdict/check_internal.h"

namespace wellgyro {
namespace {

// Of two surveys of one hole: twice the 0.23 deg that practice allows two passes of one tool, 0.46.
constexpr double kSurveys = FromDegrees(0.5);
constexpr double kSlot = 30;  // of a platform, from its reference, aside [m]
constexpr double kDepths = 2 * field_practice::kSlippage;  // of two surveys, over the depth [1]
constexpr double kTurned = 0.05;  // of a way, by a north 3 deg aside: 2 sin 1.5 deg
constexpr double kPlaces = 1;     // that nobody asks for; of TVD, which has no slot [m]
constexpr double kBendMost = FromDegrees(12) / 30;  // of a hole that a motor builds [rad/m]

/// Where a run itself says which way the hole goes.
struct Direction {
  double md, inclination, azimuth;
  double variance_inclination, variance_azimuth;
  std::int32_t run;
};

std::vector<Direction> DirectionsOf(std::span<const Station> stations,
                                    std::span<const RunSummary> runs) {
  std::vector<Direction> all;
  for (const Station& s : stations) {
    if (s.status == StationStatus::kRejected) continue;
    all.push_back(
        {s.md, s.inclination, s.azimuth, s.cov_md_inc_azi(1, 1), s.cov_md_inc_azi(2, 2), s.run});
  }
  for (const RunSummary& run : runs) {
    for (const NorthFix& fix : run.fixes) {
      if (run.misrun || !fix.md || fix.external) continue;
      all.push_back({*fix.md, fix.inclination, fix.azimuth, fix.cov_attitude(0, 0),
                     fix.cov_attitude(1, 1), run.run});
    }
  }
  return all;
}

// 1-sigma of the tangent: sqrt(var I + sin^2 I var A), the latter 1 at most, where A is unknown.
double SigmaOfDirection(const Direction& d) {
  const double across = std::pow(std::sin(d.inclination), 2) * d.variance_azimuth;
  return std::sqrt(d.variance_inclination + std::min(across, 1.0));
}

/// 1-sigma along `p`.
double SigmaAlong(const Eigen::Matrix3d& cov, const Eigen::Vector3d& p) {
  const Eigen::Vector3d u = p.stableNormalized();
  return std::sqrt(std::max(0.0, u.dot(cov * u)));
}

/// The check that is nearer to its limit, or further beyond it.
Check Worse(const Check& a, const Check& b) {
  return std::abs(*a.value) * *b.limit >= std::abs(*b.value) * *a.limit ? a : b;
}

}  // namespace

Check CheckTieInPlace(const TieIn& tie_in) {
  const Eigen::Vector3d p(tie_in.north, tie_in.east, tie_in.tvd.value_or(0));
  const double sigma = SigmaAlong(tie_in.cov_p_WT_W, p);
  const double sigma_tvd = std::sqrt(tie_in.cov_p_WT_W(2, 2));
  Check check = CompareWith("tie_in_place", 0, {std::max(0.0, p.norm() - tie_in.md), sigma},
                            kDepths * tie_in.md + kSlot + 3 * sigma, 1, "m",
                            ".2 % of md_m, 30 m and 3 sigma beyond it: straight is the shortest");
  check = Worse(check, CompareWith("tie_in_place", 0, {std::max(0.0, p.z() - tie_in.md), sigma_tvd},
                                   kDepths * tie_in.md + kPlaces + 3 * sigma_tvd, 1, "m",
                                   ".2 % of md_m, 1 m and 3 sigma: no TVD is beyond it"));
  if (tie_in.place_stated || check.verdict == Verdict::kFail) return check;
  const double md = tie_in.md, tvd = tie_in.tvd.value_or(0);
  const double aside = std::sqrt(std::max(0.0, (md - tvd) * (md + tvd)));
  const double sigma_aside = std::sqrt(tie_in.cov_p_WT_W.topLeftCorner<2, 2>().trace());
  check = CompareWith("tie_in_place", 0, {aside, sigma_aside}, kPlaces + 3 * sigma_aside, 1, "m",
                      "give [tie_in] north_m and east_m, taken as 0: so far may they be off");
  if (check.verdict == Verdict::kFail) check.verdict = Verdict::kWarn;
  return check;
}

Check CheckTieInWay(const TieIn& tie_in, std::vector<PathStation> seen) {
  std::erase_if(seen, [&](const PathStation& s) { return !(s.md <= tie_in.md); });
  std::ranges::sort(seen, {}, &PathStation::md);
  Eigen::Vector3d way = Eigen::Vector3d::Zero();
  for (std::size_t i = 1; i < seen.size(); ++i) {
    const PathStation &a = seen[i - 1], &b = seen[i];
    way +=
        (b.md - a.md) / 2 * (Tangent(a.inclination, a.azimuth) + Tangent(b.inclination, b.azimuth));
  }
  const double length = seen.empty() ? 0 : seen.back().md - seen.front().md;
  if (length < tie_in.md / 2) return NotDone("tie_in_way", 0, "no run over half of the way to it");
  const Eigen::Vector3d off =
      Eigen::Vector3d(tie_in.north, tie_in.east, tie_in.tvd.value_or(0)) - way;
  const double sigma = SigmaAlong(tie_in.cov_p_WT_W, off), unseen = tie_in.md - length;
  const double sigma_tvd = std::sqrt(tie_in.cov_p_WT_W(2, 2));
  // A north that is wrong turns the way and leaves its TVD.
  return Worse(CompareWith("tie_in_way", 0, {std::max(0.0, off.norm() - unseen), sigma},
                           kTurned * length + kSlot + 3 * sigma, 1, "m",
                           "5 % of the way that runs measured, 30 m and 3 sigma"),
               CompareWith("tie_in_way", 0, {std::max(0.0, std::abs(off.z()) - unseen), sigma_tvd},
                           kSurveys * length + kPlaces + 3 * sigma_tvd, 1, "m",
                           "TVD: 0.5 deg of the way that runs measured, 1 m and 3 sigma"));
}

Check CheckTieIn(const Job& job, std::span<const Station> stations,
                 std::span<const RunSummary> runs) {
  if (!job.tie_in.inclination) return NotDone("tie_in", 0, "the run itself gives its direction");
  const auto away = [&](const Direction& d) { return std::abs(d.md - job.tie_in.md); };
  const std::vector<Direction> all = DirectionsOf(stations, runs);
  const auto nearest = std::ranges::min_element(all, {}, away);
  if (nearest == all.end() || !(away(*nearest) <= units::kStand)) {
    return NotDone("tie_in", 0, "no station or stop within 30 m of it");
  }
  const Eigen::Vector3d tie = Tangent(*job.tie_in.inclination, *job.tie_in.azimuth);
  const Eigen::Vector3d run = Tangent(nearest->inclination, nearest->azimuth);
  const double angle = std::atan2(tie.cross(run).norm(), tie.dot(run));
  const double sigma = SigmaOfDirection(*nearest);
  Check check = CompareWith("tie_in", nearest->run, {angle, sigma},
                            kSurveys + kBendMost * away(*nearest) + 3 * sigma, units::kDeg, "deg",
                            "3 sigma, 0.5 deg of two surveys and 12 deg in 30 m of hole");
  check.md = nearest->md;
  return check;
}

}  // namespace wellgyro
