#include "wellgyro/survey/verdict/depth_slip.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

#include <Eigen/Core>
#include <Eigen/LU>
#include <fmt/core.h>

#include "wellgyro/estimate/bayes_factor.h"
#include "wellgyro/estimate/cause.h"
#include "wellgyro/math/square.h"
#include "wellgyro/survey/stations/choose.h"
#include "wellgyro/survey/verdict/check_internal.h"
#include "wellgyro/survey/verdict/run_diagnosis.h"

namespace wellgyro {
namespace {

using Eigen::VectorXd;

// Of a wheel that slips, 1 sigma [m]: what practice allows, 1 in 1000, on 1.5 km.
constexpr double kSlipSize = 1.5;
// Of depths at which one may begin, that show the largest: four in five, as often as what counts as
// noticed is.
constexpr double kShown = 0.8;
constexpr std::ptrdiff_t kLeastPairs = 5;  // size, offset and common error, and two to spare
// dI/ds of a hole that tells no slip [rad/m]: five sizes turn it by 7.5 m 1e-9 = 4e-7 deg, below
// the last digit of a listing.
constexpr double kStraight = 1e-9;

/// One depth in both passes.
struct SlipPair {
  double md, difference, variance, slope;
};

std::vector<const Station*> StationsOfPass(std::span<const Station> passes, std::int32_t run,
                                           Pass pass) {
  std::vector<const Station*> of;
  for (const Station& s : passes) {
    if (s.run == run && s.pass == pass && s.status != StationStatus::kRejected) of.push_back(&s);
  }
  std::ranges::stable_sort(of, {}, &Station::md);
  return of;
}

/// dI/ds of the way in, from a station's neighbours.
double SlopeOfWayIn(const std::vector<const Station*>& in, std::size_t i) {
  const Station& above = *in[i > 0 ? i - 1 : 0];
  const Station& below = *in[std::min(i + 1, in.size() - 1)];
  const double way = below.md - above.md;
  return way > 0 ? (below.inclination - above.inclination) / way : 0;
}

/// Of a station's own depth error, beyond those that both passes have in common.
double OwnDepthVariance(const Job& job, double sigma_scale, const Station& s) {
  const double by_scale = sigma_scale * std::max(s.md - job.tie_in.md, 0.0);
  const double common = Square(job.errors.depth_sigma) + Square(by_scale);
  return std::max(s.cov_md_inc_azi(0, 0) - common, 0.0);
}

std::vector<SlipPair> SlipPairsOf(const Job& job, double sigma_scale,
                                  std::span<const Station> passes, std::int32_t run) {
  const std::vector<const Station*> in = StationsOfPass(passes, run, Pass::kIn),
                                    out = StationsOfPass(passes, run, Pass::kOut);
  std::vector<SlipPair> pairs;
  for (std::size_t i = 0; i < in.size(); ++i) {
    const Station& a = *in[i];
    const auto b = std::ranges::lower_bound(out, a.md - kSameDepth, {}, &Station::md);
    if (b == out.end() || (*b)->md > a.md + kSameDepth) continue;
    const double slope = SlopeOfWayIn(in, i);
    double variance = 0;
    for (const Station* s : {&a, *b}) {
      variance += s->cov_md_inc_azi(1, 1) + Square(slope) * OwnDepthVariance(job, sigma_scale, *s);
    }
    if (!(variance > 0)) continue;
    pairs.push_back({a.md, (*b)->inclination - a.inclination, variance, slope});
  }
  return pairs;
}

/// Whitened differences, their projection on the nuisance parameters (offset of the passes' depths,
/// common error of inclination) taken off.
class Differences {
 public:
  Differences(const std::vector<SlipPair>& pairs, double sigma_offset)
      : n_(static_cast<Eigen::Index>(pairs.size())), slope_(n_), left_(n_), nuisance_(n_, 2) {
    const double shared = std::max(1.0, static_cast<double>(n_) / kIndependentPairs);
    double mean = 0;
    for (Eigen::Index i = 0; i < n_; ++i) {
      const SlipPair& p = pairs[static_cast<std::size_t>(i)];
      const double whiten = 1 / std::sqrt(shared * p.variance);
      slope_[i] = whiten * p.slope;
      left_[i] = whiten * p.difference;
      nuisance_.row(i) << whiten * p.slope, whiten;
      mean += p.variance / static_cast<double>(n_);
    }
    const Eigen::Vector2d prior(1 / std::max(Square(sigma_offset), 1e-12), 1 / mean);
    information_ = nuisance_.transpose() * nuisance_;
    information_.diagonal() += prior;
    left_ = Without(left_);
  }

  /// Score and information of a slip between pair t - 1 and t.
  std::pair<double, double> At(Eigen::Index t) const {
    VectorXd c = VectorXd::Zero(n_);
    c.head(t) = slope_.head(t);
    return {c.dot(left_), c.dot(Without(c))};
  }
  Eigen::Index onsets() const { return n_ - 1; }
  double squares() const { return left_.squaredNorm(); }

 private:
  VectorXd Without(const VectorXd& x) const {
    return x - nuisance_ * (information_.inverse() * (nuisance_.transpose() * x));
  }

  Eigen::Index n_;
  VectorXd slope_, left_;
  Eigen::MatrixX2d nuisance_;
  Eigen::Matrix2d information_;
};

const Station* DeepestOfRun(std::span<const Station> passes, std::int32_t run) {
  const Station* end = nullptr;
  for (const Station& s : passes) {
    if (s.run == run && (end == nullptr || s.md > end->md)) end = &s;
  }
  return end;
}

struct SlipScan {
  double ln_bayes = -HUGE_VAL;  ///< of the likeliest onset, then of all
  double size = 0, sigma = 0, md = 0;
  std::vector<std::pair<double, double>> smallest;  ///< [m], at which MD
};

SlipScan SlipScanOf(const std::vector<SlipPair>& pairs, double sigma_offset) {
  const Differences differences(pairs, sigma_offset);
  SlipScan scan;
  std::vector<double> ln_bayes;
  const double limit =
      -std::log(kDiagnosisFalseAlarms) + std::log(static_cast<double>(differences.onsets()));
  for (Eigen::Index t = 1; t <= differences.onsets(); ++t) {
    const auto [score, information] = differences.At(t);
    // A larger one is no slip of a wheel.
    if (!(information > 0) || std::abs(score) > kLargestFault * kSlipSize * information) continue;
    const auto i = static_cast<std::size_t>(t);
    const double md = (pairs[i - 1].md + pairs[i].md) / 2;
    ln_bayes.push_back(LnBayes(score, information, kSlipSize));
    scan.smallest.emplace_back(SmallestNoticed(information, kSlipSize, limit), md);
    if (!(ln_bayes.back() > scan.ln_bayes)) continue;
    scan.ln_bayes = ln_bayes.back();
    scan.size = score / information;
    scan.sigma = 1 / std::sqrt(information);
    scan.md = md;
  }
  // Reduced chi-square of what the likeliest slip leaves: above 1 all variances are as much larger.
  const double left = differences.squares() - Square(scan.size / scan.sigma);
  const double freedom = static_cast<double>(differences.onsets()) - 1;
  const double excess = std::max(1.0, left / freedom);
  double sum = 0;
  for (double& x : ln_bayes) x /= excess;
  scan.ln_bayes /= excess;
  scan.sigma *= std::sqrt(excess);
  for (const double x : ln_bayes) sum += std::exp(x - scan.ln_bayes);
  scan.ln_bayes += std::log(sum / static_cast<double>(std::max<std::size_t>(ln_bayes.size(), 1)));
  return scan;
}

}  // namespace

RunSlip FindSlip(const Job& job, double sigma_scale, std::span<const Station> passes,
                 std::int32_t run) {
  RunSlip slip;
  RunCause& cause = slip.cause;
  cause.code = slip.reliability.code = "depth_slip";
  cause.unit = slip.reliability.unit = "m";
  cause.remedy = "compare depth with a tally or marks where it slipped, correct it, run again";
  const Station* end = DeepestOfRun(passes, run);
  if (end == nullptr) return slip;
  const double largest = kLargestFault * kSlipSize;
  slip.unseen_W = slip.reliability.shift_W = -largest * end->tangent_L;
  const std::vector<SlipPair> pairs = SlipPairsOf(job, sigma_scale, passes, run);
  const bool bends =
      std::ranges::any_of(pairs, [](const SlipPair& p) { return std::abs(p.slope) > kStraight; });
  if (std::ssize(pairs) < kLeastPairs || !bends) return slip;
  SlipScan scan = SlipScanOf(pairs, std::sqrt(2.0) * job.errors.depth_sigma);
  if (scan.smallest.empty()) return slip;
  const auto shown =
      std::ranges::count_if(scan.smallest, [&](const auto& at) { return at.first < largest; });
  const double share = static_cast<double>(shown) / static_cast<double>(std::ssize(pairs) - 1);
  if (share > kShown) slip.unseen_W.setZero();
  cause.ln_bayes = scan.ln_bayes;
  cause.size = scan.size;
  cause.sigma = scan.sigma;
  cause.begin_md = scan.md;
  cause.shift_W = -scan.size * end->tangent_L;
  const auto middle = scan.smallest.begin() + std::ssize(scan.smallest) / 2;
  std::ranges::nth_element(scan.smallest, middle);
  if (!(middle->first < largest)) return slip;
  slip.reliability.smallest = middle->first;
  slip.reliability.md = middle->second;
  slip.reliability.shift_W = -middle->first * end->tangent_L;
  return slip;
}

Check CheckSlip(const RunSlip& slip, std::int32_t run) {
  const RunCause& cause = slip.cause;
  if (!cause.ln_bayes) {
    return NotDone("depth_slip", run, "no hole that bends was passed twice");
  }
  Check check = NotDone("depth_slip", run, "");
  const double limit = -std::log(kDiagnosisFalseAlarms);
  check.value = cause.size;
  check.sigma = cause.sigma;
  check.unit = "m";
  check.verdict = *cause.ln_bayes > limit ? Verdict::kFail : Verdict::kPass;
  if (check.verdict == Verdict::kFail) check.md = cause.begin_md;
  check.limit_source = fmt::format("{:.2f} m: ln of the odds {:.1f}, noticed beyond {:.1f}",
                                   *cause.size, *cause.ln_bayes, limit);
  return check;
}

}  // namespace wellgyro
