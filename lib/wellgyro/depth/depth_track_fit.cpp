#include <algorithm>
#include <cmath>

#include "wellgyro/depth/depth_track.h"

namespace wellgyro {
namespace {

constexpr double kEnough = 8;  // degrees of freedom n that tell a scatter, to 1 / sqrt(2 n) = 1/4
constexpr double kSure = 4;    // times the variance: chi-square of one degree at 95.4 %
// Marks that the rounding counts for where none scatter: half or twice as many, and half or twice
// kSure, move the ends of three clean runs by less than 0.001 sigma.
constexpr double kRounding = 0.05;

}  // namespace

AlongHole DepthTrack::Fitted(UtcTime utc, Span span) const {
  const Window window = WindowAt(utc);
  const double w = window.half, md0 = marks_[span.begin].md;
  double low = md0, high = md0, values = 1, last = md0;
  LocalFit fit;
  for (std::size_t i = span.begin; i < span.end; ++i) {
    const double u = (marks_[i].utc - utc).seconds() / w, v = u - window.middle, md = marks_[i].md;
    fit.Add(u, md - md0, 1 - v * v);
    low = std::min(low, md);
    high = std::max(high, md);
    if (md != last) ++values;
    last = md;
  }
  if (fit.count() < 3) return Join(utc, span);
  const LocalFit::Value y = fit.Fit(2);
  Scatter scatter{y.scatter * y.scatter * y.freedom, y.freedom};
  if (scatter.freedom < kEnough) scatter = ScatterAbout(utc);
  // Marks that repeat each other are rounded alike: fewer than there are tell something.
  const double noise = Noise(scatter) * static_cast<double>(span.end - span.begin) / values;
  const Bend bend = BendOf(utc, span, y, noise);
  const double md = std::clamp(md0 + y.value, low, high);
  // Held back from what the fit says, as behind the last mark of a string in motion, depth is a
  // guess that may be off by as much.
  const double held = md - md0 - y.value;
  return {
      .md = md,
      .speed = y.slope / w,
      .acceleration = y.curvature / (w * w),
      .sigma_md = std::sqrt(Common(scatter) + noise * y.variance_value + bend.value + held * held),
      .known = true,
      .sigma_speed = std::sqrt(noise * y.variance_slope + bend.slope) / w,
      .sigma_acceleration = std::sqrt(noise * y.variance_curvature + bend.curvature) / (w * w)};
}

/// From third differences, free of any acceleration, of the marks behind and of the window.
DepthTrack::Scatter DepthTrack::ScatterAbout(UtcTime utc) const {
  const std::size_t end = After(utc + AheadAt(utc));
  const double gap = kDense * 2 * setup_.half_window.seconds();
  Scatter scatter;
  for (std::size_t i = end - std::min(end, kMemory); i + 3 < end; ++i) {
    const Mark* m = &marks_[i];
    if (m[1].jumps || m[2].jumps || m[3].jumps || Segment(m[0].utc) != Segment(m[3].utc)) continue;
    const double t1 = (m[1].utc - m[0].utc).seconds(), t2 = (m[2].utc - m[0].utc).seconds(),
                 t3 = (m[3].utc - m[0].utc).seconds();
    if (!(t1 > 0 && t2 > t1 && t3 > t2) || std::max({t1, t2 - t1, t3 - t2}) > gap) continue;
    // Times t1 t2 t3, divided differences.
    const double c1 = t2 * t3 / ((t2 - t1) * (t3 - t1)), c2 = -t1 * t3 / ((t2 - t1) * (t3 - t2)),
                 c3 = t1 * t2 / ((t3 - t1) * (t3 - t2));
    const double left =
        c1 * (m[1].md - m[0].md) + c2 * (m[2].md - m[0].md) + c3 * (m[3].md - m[0].md);
    scatter.squares += left * left / (1 + c1 * c1 + c2 * c2 + c3 * c3);
    scatter.freedom += 1;
  }
  // Third differences of white noise are correlated by -15, 6, -1 to 20 with the next ones: n of
  // them tell its variance as n / (1 + 2 (15^2 + 6^2 + 1) / 20^2) independent ones.
  const double share = 0.43;
  scatter.squares *= share;
  scatter.freedom *= share;
  return scatter;
}

/// Variance of one mark's noise: squares / (freedom - 1.5), near the mean of its posterior given
/// the scatter; kRounding of the encoder's variance is a prior that keeps it above 0.
double DepthTrack::Noise(Scatter scatter) const {
  const double reading = setup_.sigma_reading * setup_.sigma_reading;
  return (kRounding * reading + scatter.squares) / std::max(0.5, scatter.freedom - 1.5);
}

/// Variance of quantisation common to all marks: the encoder's less what shows as scatter.
double DepthTrack::Common(Scatter scatter) const {
  const double reading = setup_.sigma_reading * setup_.sigma_reading;
  return std::max(0.0, reading - scatter.squares / std::max(1.0, scatter.freedom));
}

/// Squared truncation errors of the parabola `y`: cubic and quartic terms of the residuals, as far
/// as they exceed kSure times what noise of variance `noise` makes of them. Polynomials orthogonal
/// under the weight 1 - v^2: P3 = v^3 - 3v/7 and P4 = v^4 - 2v^2/3 + 1/21.
DepthTrack::Bend DepthTrack::BendOf(UtcTime utc, Span span, const LocalFit::Value& y,
                                    double noise) const {
  double norm3 = 0, norm4 = 0, sum3 = 0, sum4 = 0, var3 = 0, var4 = 0;
  const Window window = WindowAt(utc);
  const double md0 = marks_[span.begin].md;
  for (std::size_t i = span.begin; i < span.end; ++i) {
    const double u = (marks_[i].utc - utc).seconds() / window.half, v = u - window.middle,
                 v2 = v * v;
    const double weight = 1 - v2;
    if (!(weight > 0)) continue;
    const double left = marks_[i].md - md0 - (y.value + u * (y.slope + 0.5 * u * y.curvature));
    const double third = weight * v * (v2 - 3. / 7);
    const double fourth = weight * (v2 * (v2 - 2. / 3) + 1. / 21);
    sum3 += third * left;
    sum4 += fourth * left;
    var3 += third * third;
    var4 += fourth * fourth;
    norm3 += third * third / weight;
    norm4 += fourth * fourth / weight;
  }
  const auto beyond = [noise](double sum, double var, double norm) {
    return norm > 0 ? std::max(0.0, sum * sum - kSure * noise * var) / (norm * norm) : 0;
  };
  const double third = beyond(sum3, var3, norm3), fourth = beyond(sum4, var4, norm4);
  const double v = -window.middle, v2 = v * v;  // of the instant
  const double p3 = v * (v2 - 3. / 7), p4 = v2 * (v2 - 2. / 3) + 1. / 21;
  const double slope3 = 3 * v2 - 3. / 7, slope4 = v * (4 * v2 - 4. / 3);
  const double curvature3 = 6 * v, curvature4 = 12 * v2 - 4. / 3;
  // A cubic term seldom comes without a quartic one, and the other way round.
  const auto both = [&](double a, double b) { return (third + fourth) * std::max(a * a, b * b); };
  return {third * p3 * p3 + fourth * p4 * p4, both(slope3, slope4), both(curvature3, curvature4)};
}

}  // namespace wellgyro
