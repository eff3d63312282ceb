#include "wellgyro/plan/stop_pairs.h"

#include <algorithm>
#include <cmath>

#include <Eigen/LU>

#include "wellgyro/base/angle.h"
#include "wellgyro/plan/synthetic_run.h"
#include "wellgyro/uncertainty/ellipse.h"

namespace wellgyro {
namespace {

using Eigen::Matrix2d;
using Rest = StopStand::Rest;

double LargestEigenvalue(const Matrix2d& m) {
  return 0.5 * m.trace() + std::hypot(0.5 * (m(0, 0) - m(1, 1)), m(0, 1));
}

/// Two rows of rest at one place and toolface.
struct Stop {
  std::size_t place = 0;
  double turn = 0;
  Matrix2d mix = Matrix2d::Identity();  // of the gyros' own rows, Mix()'s right part
  Matrix2d with_end, own;               // covariance with the end, of the rows themselves
  // After as much time as is of use: (S + V)^-1, C (S + V)^-1, what that takes off the end.
  Matrix2d weight, gain, taken;
};

Matrix2d NoiseOf(double seconds) {
  return SyntheticRun::kRestKnot / seconds * Matrix2d::Identity();
}

class Pairs {
 public:
  Pairs(const StopInformation& info, const PlanLimits& limits, double cost_most)
      : info_(info),
        limits_(limits),
        end_(info.covariance().topLeftCorner<2, 2>()),
        cost_(cost_most) {
    const double axis = limits.ellipse / ConfidenceFactor(kConfidence, 2);
    variance_ = axis * axis;
    const int turns = limits.turns ? kToolfaces : 1;
    for (std::size_t place = 0; place < info.places(); ++place) {
      for (int i = 0; i < turns; ++i) stops_.push_back(StopAt(place, kTwoPi * i / kToolfaces));
    }
  }

  std::optional<std::vector<Rest>> Run() {
    if (limits_.fewest < 2) {
      for (const Stop& stop : stops_) TryOne(stop);
    }
    // A pair cheaper than the best so far has no stop that is longer than this.
    const double longest = LongestOfPair();
    if (longest < limits_.least_stop) return best_;
    for (Stop& stop : stops_) Weigh(longest, stop);
    for (std::size_t i = 0; i < info_.places(); ++i) {
      for (std::size_t j = i + 1; j < info_.places(); ++j) LookAt(i, j, longest);
    }
    return best_;
  }

 private:
  Stop StopAt(std::size_t place, double turn) const {
    constexpr int n = StopInformation::kBasis;
    const auto mix = StopInformation::Mix(turn);
    const Eigen::Index row = info_.place_row(place);
    Stop stop{.place = place, .turn = turn};
    stop.mix = mix.rightCols<2>();
    stop.with_end = info_.covariance().block<2, n>(0, row) * mix.transpose();
    stop.own = mix * info_.covariance().block<n, n>(row, row) * mix.transpose();
    return stop;
  }

  void Weigh(double seconds, Stop& stop) const {
    stop.weight = (stop.own + NoiseOf(seconds)).inverse();
    stop.gain = stop.with_end * stop.weight;
    stop.taken = stop.gain * stop.with_end.transpose();
  }

  double LongestOfPair() const {
    const double most = cost_ - kStopGrain - 2 * limits_.overhead - limits_.least_stop;
    return std::min(most, limits_.longest_stop);
  }

  /// Two places with the tool turned every way; S of the two stops' rows is Mix() of the places'.
  void LookAt(std::size_t i, std::size_t j, double longest) {
    constexpr int n = StopInformation::kBasis;
    const Eigen::Matrix<double, n, n> places =
        info_.covariance().block<n, n>(info_.place_row(i), info_.place_row(j));
    const std::size_t turns = stops_.size() / info_.places();
    for (std::size_t at = i * turns; at < (i + 1) * turns; ++at) {
      const Stop& a = stops_[at];
      const Eigen::Matrix<double, 2, n> a_places = StopInformation::Mix(a.turn) * places;
      for (std::size_t other = j * turns; other < (j + 1) * turns; ++other) {
        const Stop& b = stops_[other];
        const Matrix2d ab = a_places.leftCols<2>() + a_places.rightCols<2>() * b.mix.transpose();
        if (MayDo(a, b, ab, longest)) TryTwo(a, b, ab);
      }
    }
  }

  /// Whether the limit is met with both of them as long as may be.
  bool MayDo(const Stop& a, const Stop& b, const Matrix2d& ab, double seconds) const {
    const Matrix2d with_end = b.with_end - a.gain * ab;
    const Matrix2d own = b.own - ab.transpose() * a.weight * ab + NoiseOf(seconds);
    const Matrix2d end = end_ - a.taken - with_end * own.inverse() * with_end.transpose();
    return LargestEigenvalue(end) <= variance_;
  }

  Matrix2d EndWith(const Stop& a, double seconds) const {
    return end_ - a.with_end * (a.own + NoiseOf(seconds)).inverse() * a.with_end.transpose();
  }

  void TryOne(const Stop& stop) {
    const double most = std::min(cost_ - kStopGrain - limits_.overhead, limits_.longest_stop);
    const auto meets = [&](double seconds) {
      return LargestEigenvalue(EndWith(stop, seconds)) <= variance_;
    };
    const std::optional<double> seconds = Least(limits_.least_stop, most, meets);
    if (!seconds) return;
    cost_ = *seconds + limits_.overhead;
    best_ = std::vector<Rest>{{stop.place, stop.turn, *seconds}};
  }

  void TryTwo(const Stop& a, const Stop& b, const Matrix2d& ab) {
    double first = 0;
    const auto meets = [&](double both) { return MeetsSplit(a, b, ab, both, first); };
    const double most =
        std::min(cost_ - kStopGrain - 2 * limits_.overhead, 2 * limits_.longest_stop);
    const std::optional<double> both = Least(2 * limits_.least_stop, most, meets);
    if (!both) return;
    meets(*both);
    cost_ = *both + 2 * limits_.overhead;
    best_ = std::vector<Rest>{{a.place, a.turn, first}, {b.place, b.turn, *both - first}};
  }

  /// The least of `least` and whole grains more that holds, where the most does.
  template <class Condition>
  std::optional<double> Least(double least, double most, const Condition& holds) const {
    if (most < least) return std::nullopt;
    const auto at = [least](int grains) { return least + kStopGrain * grains; };
    int fails = -1, does = static_cast<int>(std::floor((most - least) / kStopGrain + 1e-9));
    if (!holds(at(does))) return std::nullopt;
    while (does - fails > 1) {
      const int middle = (fails + does) / 2;
      (holds(at(middle)) ? does : fails) = middle;
    }
    return at(does);
  }

  /// By thirds, as the eigenvalue is convex along the split.
  bool MeetsSplit(const Stop& a, const Stop& b, const Matrix2d& ab, double both,
                  double& first) const {
    const double shortest = std::max(limits_.least_stop, both - limits_.longest_stop);
    const double grains = (std::min(limits_.longest_stop, both - limits_.least_stop) - shortest);
    int low = 0, high = static_cast<int>(std::floor(grains / kStopGrain + 1e-9));
    const auto excess = [&](int at) {
      first = shortest + kStopGrain * at;
      const Matrix2d weight = (a.own + NoiseOf(first)).inverse();
      const Matrix2d with_end = b.with_end - a.with_end * weight * ab;
      const Matrix2d own = b.own - ab.transpose() * weight * ab + NoiseOf(both - first);
      const Matrix2d end = end_ - a.with_end * weight * a.with_end.transpose() -
                           with_end * own.inverse() * with_end.transpose();
      return LargestEigenvalue(end) - variance_;
    };
    while (low <= high) {
      const int one = low + (high - low) / 3, two = high - (high - low) / 3;
      const double at_one = excess(one);
      if (at_one <= 0) return true;
      const double at_two = excess(two);
      if (at_two <= 0) return true;
      if (at_one <= at_two) high = two - 1;
      if (at_two <= at_one) low = one + 1;
    }
    return false;
  }

  const StopInformation& info_;
  const PlanLimits& limits_;
  const Matrix2d end_;
  double variance_ = 0, cost_;
  std::vector<Stop> stops_;
  std::optional<std::vector<Rest>> best_;
};

}  // namespace

std::optional<std::vector<Rest>> BestOfTwo(const StopInformation& info, const PlanLimits& limits,
                                           double cost_most) {
  return Pairs(info, limits, cost_most).Run();
}

}  // namespace wellgyro
