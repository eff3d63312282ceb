#include "wellgyro/trajectory/leg_arc.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include <Eigen/Geometry>

#include "wellgyro/math/sinc.h"

namespace wellgyro {
namespace {

using Eigen::Vector3d;

// Dogleg [rad] up to which an arc is its chord: its middle is L / 8 of that aside, 1e-9 m over 10
// km.
constexpr double kStraight = 1e-12;

}  // namespace

LegArc MakeLegArc(const Vector3d& begin_W, double length, const Vector3d& t1_W,
                  const Vector3d& t2_W) {
  LegArc arc;
  arc.begin_W = begin_W;
  arc.tangent_W = t1_W;
  arc.length = length;
  const Vector3d difference = t2_W - t1_W;
  const double dogleg = 2 * std::atan2(difference.norm(), (t1_W + t2_W).norm());
  if (dogleg > kStraight) {
    arc.curvature = dogleg / length;
    // From the difference, not from t2_W: near a straight leg nothing is lost.
    arc.normal_W = (difference - difference.dot(t1_W) * t1_W).normalized();
  } else {
    Vector3d axis = Vector3d::Zero();
    Eigen::Index least = 0;
    t1_W.cwiseAbs().minCoeff(&least);
    axis(least) = 1;
    arc.normal_W = (axis - axis.dot(t1_W) * t1_W).normalized();
  }
  return arc;
}

Vector3d PointOn(const LegArc& arc, double s) {
  const double half = arc.curvature * s / 2;
  const double chord = s * Sinc(half);
  return arc.begin_W + chord * (std::cos(half) * arc.tangent_W + std::sin(half) * arc.normal_W);
}

Vector3d DirectionOn(const LegArc& arc, double s) {
  const double turn = arc.curvature * s;
  return std::cos(turn) * arc.tangent_W + std::sin(turn) * arc.normal_W;
}

double NearestOn(const LegArc& arc, const Vector3d& point_W) {
  const Vector3d d = point_W - arc.begin_W;
  const double along = d.dot(arc.tangent_W), across = d.dot(arc.normal_W);
  if (arc.curvature == 0) return std::clamp(along, 0.0, arc.length);
  const double s = std::atan2(arc.curvature * along, 1 - arc.curvature * across) / arc.curvature;
  if (s >= 0 && s <= arc.length) return s;
  const double to_begin = d.squaredNorm();
  const double to_end = (point_W - PointOn(arc, arc.length)).squaredNorm();
  return to_begin <= to_end ? 0 : arc.length;
}

PlaneCrossings CrossingsOfPlane(const LegArc& arc, const Vector3d& point_W,
                                const Vector3d& across_W) {
  // With x = 2 tan(curvature s / 2) / curvature the arc is rational and the plane a quadratic.
  const double k = arc.curvature;
  const double c = (arc.begin_W - point_W).dot(across_W);
  const double b = arc.tangent_W.dot(across_W);
  const double a = k * arc.normal_W.dot(across_W) / 2 + c * k * k / 4;
  double roots[2] = {0, 0};
  int count = 0;
  if (std::abs(a) <= 1e-15 * std::abs(b)) {
    if (b != 0) roots[count++] = -c / b;
  } else if (const double d = b * b - 4 * a * c; d >= 0) {
    const double q = -(b + std::copysign(std::sqrt(d), b)) / 2;
    roots[count++] = q / a;
    if (q != 0) roots[count++] = c / q;
  }
  PlaneCrossings found;
  for (int i = 0; i < count; ++i) {
    const double s = k == 0 ? roots[i] : 2 / k * std::atan(k * roots[i] / 2);
    if (s >= 0 && s <= arc.length) found.s[found.count++] = s;
  }
  if (found.count == 2 && found.s[0] > found.s[1]) std::swap(found.s[0], found.s[1]);
  return found;
}

namespace {

// [m], to which the distance is found: intervals are halved until none may hold less. The square of
// one, 1e-14 m^2, is above the rounding of g at some metres, 1e-15 m^2.
constexpr double kGoodTo = 1e-7;

NearestPair BetweenStraights(const LegArc& a, const LegArc& b) {
  NearestPair best{0, NearestOn(b, a.begin_W), 0};
  best.distance = (PointOn(b, best.s_second) - a.begin_W).norm();
  const auto take = [&](double s, double u) {
    const double distance = (PointOn(b, u) - PointOn(a, s)).norm();
    if (distance < best.distance) best = {s, u, distance};
  };
  take(a.length, NearestOn(b, PointOn(a, a.length)));
  take(NearestOn(a, b.begin_W), 0);
  take(NearestOn(a, PointOn(b, b.length)), b.length);
  const double cosine = a.tangent_W.dot(b.tangent_W);
  const double sine2 = a.tangent_W.cross(b.tangent_W).squaredNorm();
  if (sine2 > 1e-24) {
    const Vector3d d = b.begin_W - a.begin_W;
    const double s = (d.dot(a.tangent_W) - cosine * d.dot(b.tangent_W)) / sine2;
    if (s > 0 && s < a.length) take(s, NearestOn(b, PointOn(a, s)));
  }
  return best;
}

/// The search of NearestBetween, along the first arc.
class PairSearch {
 public:
  PairSearch(const LegArc& along, const LegArc& other) : along_(along), other_(other) {}
  NearestPair Run();

 private:
  struct Sample {
    double s = 0, u = 0;
    double square = 0;  ///< g [m^2]
    double slope = 0;   ///< half its derivative [m]
  };
  struct Interval {
    Sample begin, end;
  };

  Sample At(double s);
  void CloseIn(const Interval& in);
  bool MayHoldNearer(const Interval& in) const;

  const LegArc& along_;
  const LegArc& other_;
  Sample best_;
  double closed_in_on_ = -1;
};

PairSearch::Sample PairSearch::At(double s) {
  const Vector3d here = PointOn(along_, s);
  const double u = NearestOn(other_, here);
  const Vector3d d = here - PointOn(other_, u);
  const Sample sample{s, u, d.squaredNorm(), d.dot(DirectionOn(along_, s))};
  if (sample.square < best_.square) best_ = sample;
  return sample;
}

/// A minimum lies where the slope goes from below to above zero; a change of the nearest place on
/// the other arc only makes the slope fall, so bisection ends at one.
void PairSearch::CloseIn(const Interval& in) {
  const bool known = closed_in_on_ >= in.begin.s && closed_in_on_ <= in.end.s;
  if (in.begin.slope >= 0 || in.end.slope <= 0 || known) return;
  double low = in.begin.s, high = in.end.s;
  for (int i = 0; i < 60 && high - low > 1e-9 * (1 + high); ++i) {
    const Sample middle = At((low + high) / 2);
    (middle.slope < 0 ? low : high) = middle.s;
  }
  closed_in_on_ = low;
}

bool PairSearch::MayHoldNearer(const Interval& in) const {
  const double h = in.end.s - in.begin.s;
  const double nearest = std::sqrt(best_.square);
  if (nearest <= kGoodTo) return false;
  const double farthest = std::sqrt(std::min(in.begin.square, in.end.square)) + 2 * h;
  const double bend = 2 * (1 + along_.curvature * farthest);
  const double rise = in.end.square - in.begin.square;
  const double x = std::clamp(h / 2 - rise / (bend * h), 0.0, h);
  const double least = in.begin.square + rise * x / h - bend * x * (h - x) / 2;
  return least < (nearest - kGoodTo) * (nearest - kGoodTo);
}

NearestPair PairSearch::Run() {
  constexpr int kFirst = 4;  // for a good first bound; what may hold a nearer pair is halved on
  best_.square = (PointOn(along_, 0) - other_.begin_W).squaredNorm();
  std::vector<Interval> open;
  Sample from = At(0);
  best_ = from;
  for (int i = 1; i <= kFirst; ++i) {
    const Sample to = At(along_.length * i / kFirst);
    open.push_back({from, to});
    from = to;
  }
  for (const Interval& in : open) CloseIn(in);
  while (!open.empty()) {
    const Interval in = open.back();
    open.pop_back();
    if (!MayHoldNearer(in)) continue;
    const Sample middle = At((in.begin.s + in.end.s) / 2);
    const Interval halves[] = {{in.begin, middle}, {middle, in.end}};
    for (const Interval& half : halves) {
      CloseIn(half);
      open.push_back(half);
    }
  }
  return {best_.s, best_.u, std::sqrt(best_.square)};
}

}  // namespace

NearestPair NearestBetween(const LegArc& first, const LegArc& second) {
  if (first.curvature == 0 && second.curvature == 0) return BetweenStraights(first, second);
  if (first.curvature <= second.curvature) return PairSearch(first, second).Run();
  const NearestPair turned = PairSearch(second, first).Run();
  return {turned.s_second, turned.s_first, turned.distance};
}

}  // namespace wellgyro
