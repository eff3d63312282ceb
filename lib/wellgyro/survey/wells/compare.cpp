#include "wellgyro/survey/wells/compare.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <stdexcept>
#include <utility>

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <fmt/core.h>

#include "wellgyro/base/angle.h"
#include "wellgyro/estimate/cause.h"
#include "wellgyro/math/linear_algebra.h"
#include "wellgyro/math/statistics.h"
#include "wellgyro/survey/hole/same_depth_internal.h"
#include "wellgyro/survey/hole/well_line.h"
#include "wellgyro/survey/verdict/verdict.h"
#include "wellgyro/survey/wells/difference_covariance_internal.h"
#include "wellgyro/trajectory/trajectory.h"

namespace wellgyro {
namespace {

using Eigen::Matrix3d;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;

constexpr std::size_t kPlacesMax = 20'000;  // the longest well by the metre, rounded up
// [rad], below it an azimuth says nothing: it is 573 times as vague as the hole's direction.
constexpr double kVertical = 0.1 * kPi / 180;

struct Common {
  double begin = 0, end = 0;  // [m]
};

/// Deepest station that something is known of.
double EndOf(const ComparedSurvey& s) {
  const std::size_t known = s.errors ? s.errors->stations : s.well.survey.size();
  if (known < 2) throw std::invalid_argument("an error model ends before its survey begins");
  return s.well.survey[known - 1].md;
}

Common CommonOf(const ComparedSurvey& first, const ComparedSurvey& second) {
  Common common;
  common.begin = std::max(first.well.survey.front().md, second.well.survey.front().md);
  common.end = std::min(EndOf(first), EndOf(second));
  if (!(common.begin < common.end)) {
    throw std::invalid_argument("the surveys have no depths in common");
  }
  return common;
}

/// A first station at MD 0 is a convention, not a measurement.
bool IsConvention(const ComparedSurvey& s, double md) {
  return md <= kRoundedDepth && s.well.survey.front().md == 0;
}

std::vector<double> StationsIn(const ComparedSurvey& s, const Common& common) {
  std::vector<double> depths;
  for (const SurveyPoint& p : s.well.survey) {
    if (p.md >= common.begin && p.md <= common.end) depths.push_back(p.md);
  }
  return depths;
}

std::vector<double> DepthsOf(const ComparedSurvey& first, const ComparedSurvey& second,
                             const Common& common, const CompareOptions& options) {
  std::vector<double> depths = options.at;
  if (options.every > 0) {
    const double begin = std::ceil(common.begin / options.every - 1e-9);
    const double count = std::floor(common.end / options.every + 1e-9) - begin;
    if (!(count < kPlacesMax))
      throw std::invalid_argument(
          "more than 20000 depths to compare: give fewer, or a wider spacing");
    for (int i = 0; i <= static_cast<int>(count); ++i)
      depths.push_back((begin + i) * options.every);
  }
  if (depths.empty()) {
    std::vector<double> of_first = StationsIn(first, common),
                        of_second = StationsIn(second, common);
    depths = of_second.size() < of_first.size() && !of_second.empty() ? of_second : of_first;
    std::erase_if(depths,
                  [&](double md) { return IsConvention(first, md) || IsConvention(second, md); });
    if (depths.empty()) throw std::invalid_argument("no station of the one lies in the other");
  }
  std::ranges::sort(depths);
  const auto same = [](double a, double b) { return b - a < kRoundedDepth; };
  depths.erase(std::unique(depths.begin(), depths.end(), same), depths.end());
  if (depths.size() > kPlacesMax)
    throw std::invalid_argument(
        "more than 20000 depths to compare: give fewer, or a wider spacing");
  for (double& md : depths) {
    if (!(md >= common.begin - kRoundedDepth && md <= common.end + kRoundedDepth)) {
      throw std::invalid_argument(fmt::format(
          "MD {} m is not in both surveys, which have {} to {} m", md, common.begin, common.end));
    }
    md = std::clamp(md, common.begin, common.end);
  }
  return depths;
}

std::vector<ComparedPlace> Listed(const ComparedSurvey& first, const ComparedSurvey& second,
                                  std::span<const double> depths) {
  const Trajectory a = LineOf(first.well), b = LineOf(second.well);
  std::vector<ComparedPlace> places;
  for (const double md : depths) {
    const TrajectoryPoint p = a.AtMd(md), q = b.AtMd(md);
    ComparedPlace place;
    place.md = md;
    place.inclination[0] = p.inclination, place.inclination[1] = q.inclination;
    place.azimuth[0] = p.azimuth, place.azimuth[1] = q.azimuth;
    place.inclination_difference = q.inclination - p.inclination;
    if (std::min(p.inclination, q.inclination) > kVertical &&
        std::max(p.inclination, q.inclination) < kPi - kVertical) {
      place.azimuth_difference = WrapPi(q.azimuth - p.azimuth);
    }
    place.position_difference_W = q.position_W - p.position_W;
    places.push_back(place);
  }
  return places;
}

void Weigh(ComparedPlace& place, const DifferenceCovariance& covariance, std::size_t row) {
  place.sigma_inclination = covariance.sigma[row].x();
  const double across = std::sin((place.inclination[0] + place.inclination[1]) / 2);
  if (place.azimuth_difference) place.sigma_azimuth = covariance.sigma[row].y() / across;
  place.between_stations_W = place.position_difference_W - covariance.summed_alike_W[row];
  place.cov_position_W = covariance.cov_p_W[row];
  const Cholesky root(place.cov_position_W);
  const bool regular = root.positive() && place.cov_position_W.determinant() >
                                              1e-12 * std::pow(place.cov_position_W.trace(), 3);
  if (regular) {
    place.position_sigmas = root.Whitened(covariance.summed_alike_W[row]).norm();
  }
}

Check CheckOf(const char* code, const char* unit) {
  Check check;
  check.code = code;
  check.unit = unit;
  check.looks = 1;
  check.verdict = Verdict::kPass;  // until ShareFalseAlarms has judged it
  return check;
}

Check NotCompared(const char* code, const char* unit, const char* why) {
  Check check = CheckOf(code, unit);
  check.looks = 0;
  check.limit_source = why;
  check.verdict = Verdict::kNotDone;
  return check;
}

/// d' C^-1 d over its degrees of freedom.
Check ChiSquare(const char* code, const VectorXd& d, const MatrixXd& cov) {
  const Cholesky root(cov);
  if (!root.positive()) return NotCompared(code, "1", "its covariance is singular");
  Check check = CheckOf(code, "1");
  check.freedom = static_cast<double>(d.size());
  check.value = root.Whitened(d).squaredNorm() / check.freedom;
  return check;
}

/// Differences of direction at the joint places, first along high side, then to the right.
VectorXd DirectionsOf(const DifferenceCovariance& covariance) {
  const auto n = static_cast<Eigen::Index>(covariance.joint.size());
  VectorXd d(2 * n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const std::size_t row = covariance.joint[static_cast<std::size_t>(i)];
    d(i) = covariance.difference[row].x();
    d(n + i) = covariance.difference[row].y();
  }
  return d;
}

/// Derivatives of the differences by an offset of the second's depth, a stretch of it about
/// `middle` and an offset of its azimuth.
MatrixXd ShapesOf(const DifferenceCovariance& covariance, std::span<const ComparedPlace> places,
                  double middle) {
  const auto n = static_cast<Eigen::Index>(covariance.joint.size());
  MatrixXd shapes = MatrixXd::Zero(2 * n, 3);
  for (Eigen::Index i = 0; i < n; ++i) {
    const std::size_t row = covariance.joint[static_cast<std::size_t>(i)];
    const Eigen::Vector2d bend = covariance.bend[row];
    const double from_middle = places[row].md - middle;
    shapes(i, 0) = -bend.x();
    shapes(n + i, 0) = -bend.y();
    shapes(i, 1) = -bend.x() * from_middle;
    shapes(n + i, 1) = -bend.y() * from_middle;
    shapes(n + i, 2) = std::sin((places[row].inclination[0] + places[row].inclination[1]) / 2);
  }
  return shapes;
}

/// By weighted least squares; a shift that the directions cannot show, as they are finite, is
/// absent.
void EstimateShifts(const VectorXd& d, const MatrixXd& cov, const MatrixXd& shapes, double length,
                    Comparison& comparison) {
  const Cholesky root(cov);
  if (!root.positive()) return;
  const MatrixXd white = root.Whitened(shapes);
  const VectorXd white_d = root.Whitened(d);
  // Sigmas beyond these say nothing of a shift, nor is it linear any more: [m], [1], [rad].
  const double greatest[] = {length, 1.0, kPi};
  std::vector<Eigen::Index> used;
  for (Eigen::Index j = 0; j < 3; ++j) {
    if (white.col(j).norm() > 1 / greatest[j]) used.push_back(j);
  }
  MatrixXd normal;
  while (!used.empty()) {
    const MatrixXd part = white(Eigen::all, used);
    normal = (part.transpose() * part).inverse();
    std::size_t worst = 0;
    double most = 0;
    for (std::size_t j = 0; j < used.size(); ++j) {
      const auto at = static_cast<Eigen::Index>(j);
      const double over = normal(at, at) / std::pow(greatest[used[j]], 2);
      if (!(over <= most)) most = over, worst = j;
    }
    if (most < 1) break;
    used.erase(used.begin() + static_cast<std::ptrdiff_t>(worst));
  }
  if (used.empty()) return;
  const VectorXd value = normal * (white(Eigen::all, used).transpose() * white_d);
  std::optional<ShiftEstimate>* const places[] = {
      &comparison.depth_offset, &comparison.depth_stretch, &comparison.azimuth_offset};
  for (std::size_t j = 0; j < used.size(); ++j) {
    const auto at = static_cast<Eigen::Index>(j);
    *places[used[j]] = ShiftEstimate{value(at), std::sqrt(normal(at, at)), 0};
  }
}

void AddShift(const char* code, const char* unit, double in_unit,
              const std::optional<ShiftEstimate>& shift, std::vector<Check>& checks) {
  if (!shift) {
    checks.push_back(NotCompared(code, unit, "the surveys cannot show it"));
    return;
  }
  Check check = CheckOf(code, unit);
  check.value = shift->value / in_unit;
  check.sigma = shift->sigma / in_unit;
  checks.push_back(check);
}

void TestJoint(const DifferenceCovariance& covariance, Comparison& comparison) {
  const auto n = static_cast<Eigen::Index>(covariance.joint.size());
  comparison.joint = covariance.joint.size();
  const VectorXd d = DirectionsOf(covariance);
  const MatrixXd& cov = covariance.cov_direction;
  comparison.checks.push_back(ChiSquare("compare_inclination", d.head(n), cov.topLeftCorner(n, n)));
  comparison.checks.push_back(ChiSquare("compare_azimuth", d.tail(n), cov.bottomRightCorner(n, n)));
  const auto& places = comparison.places;
  const double length = places.back().md - places.front().md;
  comparison.joint_middle = (places.back().md + places.front().md) / 2;
  const MatrixXd shapes = ShapesOf(covariance, places, comparison.joint_middle);
  EstimateShifts(d, cov, shapes, std::max(length, 1.0), comparison);
  AddShift("compare_depth_offset", "m", 1, comparison.depth_offset, comparison.checks);
  AddShift("compare_depth_stretch", "m/km", 1e-3, comparison.depth_stretch, comparison.checks);
  AddShift("compare_azimuth_offset", "deg", kPi / 180, comparison.azimuth_offset,
           comparison.checks);
}

/// Without known correlations: of all depths the largest difference over its sigma, as the largest
/// of so many looks.
void TestWorst(const DifferenceCovariance& covariance, Comparison& comparison) {
  const char* const codes[] = {"compare_inclination", "compare_azimuth"};
  for (int i = 0; i < 2; ++i) {
    Check check = CheckOf(codes[i], "1");
    check.looks = static_cast<double>(comparison.places.size());
    check.sigma = 1;
    for (std::size_t row = 0; row < comparison.places.size(); ++row) {
      const double sigmas = covariance.difference[row](i) / covariance.sigma[row](i);
      if (check.value && std::abs(sigmas) <= std::abs(*check.value)) continue;
      check.value = sigmas;
      check.md = comparison.places[row].md;
    }
    comparison.checks.push_back(check);
  }
  constexpr const char* kWhy = "needs an error model of each survey";
  comparison.checks.push_back(NotCompared("compare_depth_offset", "m", kWhy));
  comparison.checks.push_back(NotCompared("compare_depth_stretch", "m/km", kWhy));
  comparison.checks.push_back(NotCompared("compare_azimuth_offset", "deg", kWhy));
}

void TestPosition(Comparison& comparison) {
  const ComparedPlace& deepest = comparison.places.back();
  if (!deepest.position_sigmas) {
    comparison.checks.push_back(NotCompared("compare_position", "1", "its covariance is singular"));
    return;
  }
  Check check = CheckOf("compare_position", "1");
  check.md = deepest.md;
  check.freedom = 3;
  check.value = *deepest.position_sigmas * *deepest.position_sigmas / 3;
  comparison.checks.push_back(check);
}

/// Warns where the depths that were asked for span less than half of what both surveys have: that
/// they agree there says nothing of the rest.
void TellExtent(const std::vector<double>& depths, const Common& common, Comparison& comparison) {
  constexpr double kEnough = 0.5;  // [1], from which on what was seen is the greater part
  const double seen = (depths.back() - depths.front()) / (common.end - common.begin);
  if (seen >= kEnough) return;
  Check check = CheckOf("compare_extent", "1");
  check.looks = 0;
  check.md = depths.back();
  check.value = seen;
  check.limit = kEnough;
  check.limit_source = "of the depths that both surveys have";
  check.verdict = Verdict::kWarn;
  comparison.checks.push_back(check);
}

/// The smallest shifts that are noticed with kNoticedPower, now that the checks' limits are known.
void SaySmallest(Comparison& comparison) {
  const auto say = [&](const char* code, double in_unit, std::optional<ShiftEstimate>& shift) {
    const auto check = std::ranges::find(comparison.checks, code, &Check::code);
    if (!shift || !check->limit) return;
    shift->smallest = *check->limit * in_unit + kNoticedPower * shift->sigma;
  };
  say("compare_depth_offset", 1, comparison.depth_offset);
  say("compare_depth_stretch", 1e-3, comparison.depth_stretch);
  say("compare_azimuth_offset", kPi / 180, comparison.azimuth_offset);
}

void CheckCompared(const ComparedSurvey& s, const CompareOptions& options) {
  const std::size_t n = s.well.survey.size();
  if (n < 2 || s.well.position_W.size() != n || (!s.errors && s.own.size() != n)) {
    throw std::invalid_argument(
        "a survey to compare needs two stations, each with what is known of it");
  }
  for (const double md : options.at) {
    if (!std::isfinite(md)) throw std::invalid_argument("a depth to compare at is not a number");
  }
  if (!(options.local_sigma > 0 && options.local_sigma < 1)) {
    throw std::invalid_argument(
        fmt::format("local_sigma must lie between 0 and 1 rad, not {}", options.local_sigma));
  }
  if (!(options.every >= 0)) throw std::invalid_argument("every must not be negative");
}

}  // namespace

Comparison Compare(const ComparedSurvey& first, const ComparedSurvey& second,
                   const CompareOptions& options) {
  CheckCompared(first, options);
  CheckCompared(second, options);
  const Common common = CommonOf(first, second);
  const std::vector<double> depths = DepthsOf(first, second, common, options);
  Comparison comparison;
  comparison.places = Listed(first, second, depths);
  const DifferenceCovariance covariance =
      CovarianceOfDifference(first, second, common.begin, common.end, depths, options);
  comparison.kink = covariance.roughness.kink;
  comparison.wander = covariance.roughness.wander;
  for (std::size_t row = 0; row < depths.size(); ++row) {
    Weigh(comparison.places[row], covariance, row);
  }
  if (covariance.joint.empty()) {
    TestWorst(covariance, comparison);
  } else {
    TestJoint(covariance, comparison);
  }
  TestPosition(comparison);
  TellExtent(depths, common, comparison);
  ShareFalseAlarms(comparison.checks);
  SaySmallest(comparison);
  comparison.verdict = VerdictOfRun(comparison.checks, 0);
  if (covariance.joint.size() < depths.size() && !covariance.joint.empty()) {
    comparison.notes.push_back(
        fmt::format("{} of {} depths, evenly chosen, are in the joint statistics",
                    covariance.joint.size(), depths.size()));
  }
  return comparison;
}

}  // namespace wellgyro
