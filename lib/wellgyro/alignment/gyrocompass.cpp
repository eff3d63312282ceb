#include "wellgyro/alignment/gyrocompass.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "wellgyro/alignment/gyrocompass_internal.h"
#include "wellgyro/alignment/magnetic.h"
#include "wellgyro/base/angle.h"
#include "wellgyro/math/rotation.h"
#include "wellgyro/record/decides.h"
#include "wellgyro/record/force_errors.h"
#include "wellgyro/record/unknown_angle.h"

namespace wellgyro {
namespace {

using Eigen::Index;
using Eigen::Matrix3d;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using gyrocompass::HeadingFrom;
using gyrocompass::Problem;
using gyrocompass::Solution;

// Of a cost, the chi-square of one unknown, the heading: two sigmas. Two minima with more between
// them are two candidates.
constexpr double kBarrier = 4;

/// The minima of the cost over all headings, best first. Two axes leave up to two.
std::vector<Solution> Minima(const Problem& problem) {
  // Of two axes and a vertical that is known the cost has harmonics of the heading up to the
  // second: 36 samples to the period of that.
  constexpr int kHeadings = 72;
  std::array<double, kHeadings> cost;
  const auto azimuth = [](int i) { return kTwoPi * i / kHeadings; };
  for (int i = 0; i < kHeadings; ++i) {
    cost[static_cast<std::size_t>(i)] = problem.Profile(azimuth(i));
  }
  std::vector<Solution> found;
  for (int i = 0; i < kHeadings; ++i) {
    const auto at = [&](int k) {
      return cost[static_cast<std::size_t>((k + kHeadings) % kHeadings)];
    };
    if (at(i) > at(i - 1) || at(i) >= at(i + 1)) continue;
    Solution solution = problem.Descend(problem.Start(azimuth(i)));
    const bool known = std::ranges::any_of(found, [&](const Solution& other) {
      return std::abs(HeadingFrom(other.state, solution.state)) < 1e-4;
    });
    if (!known) found.push_back(std::move(solution));
  }
  // Where every heading costs the same.
  if (found.empty()) found.push_back(problem.Descend(problem.Start(0)));
  std::ranges::sort(found, {}, &Solution::cost);
  return found;
}

/// The posterior of the heading about a minimum, over the headings that hang together with it:
/// between them the cost rises by less than kBarrier. Two minima may do so, as near east-west
/// and horizontal, and the curvature at the bottom of one says nothing of the other.
struct Basin {
  double low = 0, high = 0;  ///< against the minimum [rad]
  double mean = 0;           ///< likewise [rad]
  double variance = 0;       ///< about the mean [rad^2]
};

Basin BasinAbout(const Problem& problem, const std::vector<Solution>& minima) {
  const Solution& solution = minima.front();
  const double parabola = solution.cov(2, 2);
  // Within so narrow a minimum, and no other beside it, the cost is a parabola: (1 - cos x) is one
  // to x^2 / 12 = 1e-4 at four sigmas, 2 deg.
  constexpr double kNarrow = FromDegrees(0.5);
  // Minima farther apart than 12 of such sigmas have more than kBarrier between them.
  const bool alone = std::none_of(minima.begin() + 1, minima.end(), [&](const Solution& other) {
    return std::abs(HeadingFrom(solution.state, other.state)) < 12 * std::sqrt(parabola);
  });
  if (alone && parabola < kNarrow * kNarrow) return {.variance = parabola};
  // Beyond it the density is below exp(-12 / 2) = 0.25 % of that at the minimum.
  constexpr double kCost = 12;
  const double centre = HeadingFrom(problem.Start(0), solution.state);
  const double step = std::clamp(std::sqrt(parabola) / 4, FromDegrees(0.25), FromDegrees(2));
  Basin basin;
  double weights = 1, first = 0, second = 0;
  const double best = problem.Profile(centre);
  for (const int side : {-1, 1}) {
    double last = 0;
    for (double away = step; away <= kPi; away += step) {
      const double cost = problem.Profile(centre + side * away) - best;
      if (cost > kCost || (cost > kBarrier && cost < last)) break;
      (side < 0 ? basin.low : basin.high) = side * away;
      const double weight = std::exp(-cost / 2);
      weights += weight;
      first += weight * side * away;
      second += weight * away * away;
      last = cost;
    }
  }
  basin.mean = first / weights;
  basin.variance = std::min(second / weights - basin.mean * basin.mean, kUnknownAngleVariance);
  return basin;
}

/// Covariance of (inclination, azimuth, toolface of the last window) from that of the rotation in L
/// and the rolls. Near vertical azimuth and toolface alone run to the uniform distribution's
/// variance while their sum keeps its own.
Matrix3d EulerCovariance(const Solution& solution, std::size_t windows, bool& vertical) {
  const Vector3d t = solution.state.R_LT.col(2);
  const double sine = std::max(std::hypot(t.x(), t.y()), 1e-9);
  const double azimuth = std::atan2(t.y(), t.x());
  const Vector3d h(t.z() * std::cos(azimuth), t.z() * std::sin(azimuth), -sine);
  const Vector3d r(-std::sin(azimuth), std::cos(azimuth), 0);
  MatrixXd J = MatrixXd::Zero(3, solution.cov.rows());
  J.row(0).head<3>() = r.transpose();
  // The measured sine is too large by its own noise, and 1 / sine so much too sure.
  const Matrix3d rotation = solution.cov.topLeftCorner<3, 3>();
  const double noise = rotation(0, 0) + rotation(1, 1);
  const double lever = std::sqrt(std::max(sine * sine - noise, 1e-4 * sine * sine));
  J.row(1).head<3>() = -h.transpose() / lever;
  J.row(2).head<3>() = t.transpose() + h.transpose() * (t.z() / lever);
  if (windows > 1) J(2, static_cast<Index>(windows) + 1) = 1;
  Matrix3d cov = J * solution.cov * J.transpose();
  vertical = std::sqrt(r.dot(rotation * r)) > sine / 3;
  if (cov(1, 1) <= kUnknownAngleVariance && cov(2, 2) <= kUnknownAngleVariance) return cov;
  const double sign = t.z() >= 0 ? 1 : -1;  // beyond horizontal the difference is the regular one
  const double sum = std::min(cov(1, 1) + cov(2, 2) + 2 * sign * cov(1, 2), kUnknownAngleVariance);
  Matrix3d capped = Matrix3d::Zero();
  capped(0, 0) = cov(0, 0);
  capped(1, 1) = std::min(cov(1, 1), kUnknownAngleVariance);
  capped(2, 2) = std::min(cov(2, 2), kUnknownAngleVariance);
  capped(1, 2) = capped(2, 1) = sign * (sum - capped(1, 1) - capped(2, 2)) / 2;
  return capped;
}

/// The mean over the windows of |f_T| against gravity. Its error is to first order the mean of
/// u' e(f), u the direction of f_T and e what the accelerometers' constants add to it.
void CheckGravity(std::span<const StillWindow> windows, const Site& site,
                  const GyrocompassSetup& setup, NorthFix& fix) {
  const double n = static_cast<double>(windows.size());
  double noise = 0;
  Eigen::RowVector<double, kForceErrors> constants = Eigen::RowVector<double, kForceErrors>::Zero();
  for (const StillWindow& window : windows) {
    const Vector3d u = window.f_T.normalized();
    fix.gravity += window.f_T.norm() / n;
    noise += u.cwiseProduct(window.sigma_f_T).squaredNorm() / (n * n);
    constants += u.transpose() * ForceErrors(setup.errors, window.f_T) / n;
  }
  fix.gravity_ref = site.gravity;
  fix.sigma_gravity = std::hypot(std::sqrt(noise), constants.norm(), setup.sigma_gravity_ref);
  if (std::abs(fix.gravity - fix.gravity_ref) > 3 * fix.sigma_gravity) {
    fix.quality |= Quality::kGravity;
  }
}

void TakeBiases(const Problem& problem, const Solution& solution, NorthFix& fix) {
  const auto x = problem.Alone(solution, gyrocompass::kBiasX);
  const auto y = problem.Alone(solution, gyrocompass::kBiasY);
  if (!x || !y) return;
  fix.gyro_bias = Eigen::Vector2d(x->first, y->first);
  fix.sigma_gyro_bias = {x->second, y->second};
}

void CheckEarthRate(const Problem& problem, const Solution& solution, NorthFix& fix) {
  const auto [ratio, sigma] = problem.RateRatio(solution.state);
  fix.earth_rate_ref = kEarthRate;
  if (!(sigma < 1)) return;  // these windows do not see it
  fix.earth_rate = ratio * kEarthRate;
  fix.sigma_earth_rate = sigma * kEarthRate;
  if (std::abs(ratio - 1) > 3 * sigma) fix.quality |= Quality::kEarthRate;
}

void Check(std::span<const StillWindow> windows, const Site& site) {
  const auto refuse = [](const std::string& what) {
    throw std::invalid_argument("Gyrocompass: " + what);
  };
  if (windows.empty()) refuse("no windows");
  if (!(std::abs(site.latitude) <= kPi / 2)) refuse("site.latitude is outside [-pi/2, pi/2]");
  for (std::size_t k = 0; k < windows.size(); ++k) {
    const StillWindow& w = windows[k];
    const std::string which = "window " + std::to_string(k);
    if (!w.w_IT_T.allFinite() || !w.f_T.allFinite()) refuse(which + " has means not finite");
    if (!w.sigma_w_IT_T.allFinite() || !w.sigma_f_T.allFinite()) {
      refuse(which + " has sigmas not finite");
    }
    if (!(w.f_T.norm() > 0)) refuse(which + " has no specific force");
    if (!(w.seconds() > 0)) refuse(which + " has no length");
  }
}

NorthFix Frame(std::span<const StillWindow> windows) {
  const StillWindow &first = windows.front(), &last = windows.back();
  NorthFix fix;
  fix.begin = first.begin;
  fix.end = last.end;
  fix.utc_begin = first.utc_begin;
  fix.utc_end = last.utc_end;
  fix.seq_begin = first.seq_begin;
  fix.seq_end = last.seq_end;
  fix.run = last.run;
  fix.tool = last.tool;
  fix.md = last.md;
  fix.magnetic_azimuth = MagneticAzimuth(windows);
  fix.from_samples = std::ranges::all_of(windows, [](const auto& w) { return w.samples > 0; });
  fix.roll_windows = 0;
  for (const StillWindow& window : windows) {
    fix.quality |= window.quality;
    if (!window.roll_rate) continue;
    ++fix.roll_windows;
    const bool more = !fix.roll_rate || std::abs(*window.roll_rate) * fix.sigma_roll_rate >
                                            std::abs(*fix.roll_rate) * window.sigma_roll_rate;
    if (!more) continue;
    fix.roll_rate = window.roll_rate;
    fix.sigma_roll_rate = window.sigma_roll_rate;
  }
  return fix;
}

}  // namespace

NorthFix Gyrocompass(std::span<const StillWindow> windows, const Site& site,
                     const GyrocompassSetup& setup) {
  Check(windows, site);
  NorthFix fix = Frame(windows);
  const Problem problem(windows, site, setup);
  std::vector<Solution> minima = Minima(problem);
  Solution& best = minima.front();
  TakeBiases(problem, best, fix);
  CheckGravity(windows, site, setup, fix);
  CheckEarthRate(problem, best, fix);

  const Basin basin = BasinAbout(problem, minima);
  const auto rival = std::find_if(minima.begin() + 1, minima.end(), [&](const Solution& other) {
    const double away = HeadingFrom(best.state, other.state);
    return other.cost - best.cost < kDecides && (away < basin.low || away > basin.high);
  });
  if (rival != minima.end()) {
    fix.mirror_azimuth = AzimuthOf(rival->state.R_LT.col(2));
    fix.mirror_cost = rival->cost - best.cost;
    fix.quality |= Quality::kMirror;
  }
  best.state.R_LT = RotationZ(basin.mean) * best.state.R_LT;
  // Where the posterior is not the parabola's, neither are the parabola's correlations.
  const double ratio = basin.variance / best.cov(2, 2);
  const double cross = std::sqrt(ratio) * std::min(ratio, 1 / ratio);
  best.cov.row(2) *= cross;
  best.cov.col(2) *= cross;
  best.cov(2, 2) = basin.variance;

  const Matrix3d R_LT = best.state.R_LT_at(windows.size() - 1);
  const Vector3d t = R_LT.col(2);
  fix.inclination = InclinationOf(t);
  fix.azimuth = AzimuthOf(t);
  fix.toolface = std::atan2(R_LT(2, 1), -R_LT(2, 0));
  bool vertical = false;
  fix.cov_attitude = EulerCovariance(best, windows.size(), vertical);
  if (vertical) fix.quality |= Quality::kVertical;
  return fix;
}

}  // namespace wellgyro
