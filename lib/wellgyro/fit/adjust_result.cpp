#include <algorithm>
#include <cmath>
#include <complex>

#include <Eigen/Cholesky>

#include "wellgyro/base/angle.h"
#include "wellgyro/earth/earth.h"
#include "wellgyro/fit/adjust_result_internal.h"
#include "wellgyro/record/knot_sources.h"
#include "wellgyro/record/unknown_angle.h"

namespace wellgyro {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

// Of the inclination, what the model of a moving tool leaves out and the run cannot show. Hours of
// a tool without errors err by at most 8e-7; below a kink out of vertical the noise in common with
// the knots before is taken for less than it is.
constexpr double kInclinationFloor = 3.5e-6;  // [rad]
constexpr double kUnknownVariance = 100;      // of an unknown azimuth, in the algebra [rad^2]

double Square(double x) { return x * x; }

// State of a station: a node's unknowns and the common ones.
class States {
 public:
  States(const AdjustProblem& p, const SelectedInverse& inverse)
      : layout_(p.layout), nodes_(static_cast<int>(p.node_count())), inverse_(inverse) {
    const int common = layout_.state() - layout_.node;
    common_.resize(common, common);
    for (int i = 0; i < common; ++i) {
      for (int j = 0; j < common; ++j) common_(i, j) = inverse_.At(Common(i), Common(j));
    }
  }

  // E[x_a x_b'] of one node, or of neighbours.
  MatrixXd Cov(std::size_t a, std::size_t b) const {
    const int n = layout_.node, m = layout_.state();
    MatrixXd cov(m, m);
    cov.bottomRightCorner(m - n, m - n) = common_;
    for (int i = 0; i < n; ++i) {
      for (int j = 0; j < n; ++j) cov(i, j) = inverse_.At(Node(a, i), Node(b, j));
      for (int j = n; j < m; ++j) {
        cov(i, j) = inverse_.At(Node(a, i), Common(j - n));
        cov(j, i) = inverse_.At(Common(j - n), Node(b, i));
      }
    }
    return cov;
  }

 private:
  int Node(std::size_t k, int i) const { return static_cast<int>(k) * layout_.node + i; }
  int Common(int i) const { return nodes_ * layout_.node + i; }

  const AdjustLayout& layout_;
  int nodes_;
  const SelectedInverse& inverse_;
  MatrixXd common_;
};

// cov^-1 right, both sides scaled first.
MatrixXd SolveScaled(const MatrixXd& cov, const MatrixXd& right) {
  const VectorXd scale = cov.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
  const MatrixXd scaled = scale.asDiagonal() * cov * scale.asDiagonal();
  const Eigen::LDLT<MatrixXd> factor(scaled);
  return scale.asDiagonal() * factor.solve(scale.asDiagonal() * right);
}

// d(inclination, azimuth, toolface)/dx where a reading less its rows x is the truth for the
// toolface, and the estimate's own error for the two others.
MatrixXd AttitudeRows(const AdjustLayout& layout, const Knot& knot, double gravity) {
  MatrixXd rows = MatrixXd::Zero(3, layout.state());
  rows(0, AdjustLayout::kInclination) = 1;
  rows(1, AdjustLayout::kAzimuth) = 1;
  const double weight = gravity * std::max(std::sin(knot.inclination), 1e-6);
  const auto toolface = [&](Knot::Source source, double slope) {
    const int at = layout.source[static_cast<std::size_t>(source)];
    if (at >= 0) rows(2, layout.node + at) = -slope;
    if (at >= 0 && knot.axial) rows(1, layout.node + at) = slope;
  };
  if (knot.axial) {
    for (int source = 0; source < Knot::kSources; ++source) {
      toolface(static_cast<Knot::Source>(source), knot.d_toolface[source]);
    }
    return rows;
  }
  toolface(Knot::kToolfaceOffset, 1);
  toolface(Knot::kTimeSkew, knot.seconds > 0 ? knot.roll / knot.seconds : 0);
  toolface(Knot::kAccelBiasX, -std::sin(knot.toolface) / weight);
  toolface(Knot::kAccelBiasY, -std::cos(knot.toolface) / weight);
  return rows;
}

double ToolfaceGrowth(const AdjustProblem& p, const MatrixXd& rows) {
  const AdjustLayout& layout = p.layout;
  double sum = 0;
  for (int i = layout.node; i < layout.state(); ++i) {
    sum += rows(2, i) * p.common[static_cast<std::size_t>(i - layout.node)];
  }
  return sum;
}

// Of the inclination near vertical, by the priors. There neighbouring knots share their error,
// which the adjustment takes for each one's own: the knot's inclination is kept as it is.
double VarOfKnot(const AdjustLayout& layout, const Knot& knot) {
  double var = Square(knot.sigma_inclination);
  for (int source = 0; source < Knot::kSources; ++source) {
    const int at = layout.source[static_cast<std::size_t>(source)];
    if (at >= 0) var += Square(knot.d_inclination[source] * layout.sigma_common[at]);
  }
  return var;
}

// Of the node's error of inclination, how much is in that of the knot: all, or less where the
// knot's own inclination, which is told, is known better.
double ShareOfNode(double var_knot, const MatrixXd& cov) {
  const double var_node = cov(AdjustLayout::kInclination, AdjustLayout::kInclination);
  return var_knot < var_node ? std::sqrt(var_knot / var_node) : 1;
}

AttitudeSample AttitudeAt(const AdjustProblem& p, const Knot& knot, double inclination,
                          double azimuth, const MatrixXd& cov, bool known) {
  MatrixXd rows = AttitudeRows(p.layout, knot, p.history->setup.site.gravity);
  const double var_knot = VarOfKnot(p.layout, knot);
  const bool told = knot.axial && !knot.lifts;
  if (told) rows(0, AdjustLayout::kInclination) = ShareOfNode(var_knot, cov);
  AttitudeSample a;
  a.time = knot.time;
  a.inclination = told ? knot.inclination : inclination;
  const double rolled = ToolfaceGrowth(p, rows);
  a.azimuth = WrapTwoPi(knot.axial ? azimuth - rolled : azimuth);
  a.toolface = WrapPi(knot.toolface + rolled);
  a.quality = knot.quality;
  if (knot.vertical) a.quality |= Quality::kVertical;
  a.cov_attitude = rows * cov * rows.transpose();
  const double sine2 = std::max(Square(std::sin(knot.inclination)), 1e-12);
  a.cov_attitude(1, 1) += Square(p.history->setup.gyro.quantization) / sine2;
  if (knot.axial) {
    const double leans =
        told ? std::max(0.0, var_knot - a.cov_attitude(0, 0)) : Square(kInclinationFloor);
    const double beyond = std::max(0.0, knot.var_azimuth_beyond) + leans / sine2;
    const double rolls = knot.var_toolface + leans / sine2;
    a.cov_attitude(0, 0) += leans;
    a.cov_attitude(1, 1) += beyond;
    a.cov_attitude(2, 2) += rolls;
    a.cov_attitude(1, 2) -= std::min(beyond, rolls);
    a.cov_attitude(2, 1) = a.cov_attitude(1, 2);
  } else {
    a.cov_attitude(0, 0) += Square(kInclinationFloor);
    a.cov_attitude(2, 2) += std::max(Square(knot.sigma_inclination) / sine2, knot.var_toolface);
  }
  if (!known) a.cov_attitude(1, 1) += kUnknownVariance;
  a.azimuth_known =
      (knot.axial ? cov(0, 0) : a.cov_attitude(1, 1)) < kUnknownAngleVariance && known;
  CapAtUnknown(&a.cov_attitude);
  return a;
}

StationState StationAt(const AdjustProblem& p, std::size_t epoch, const AttitudeSample& attitude,
                       const MatrixXd& cov, const MatrixXd& cross) {
  const Knot& knot = p.history->epochs[epoch].knot;
  StationState station;
  station.epoch = epoch;
  station.attitude = attitude;
  station.along = knot.along;
  station.cov = cov;
  station.cov_with_previous = cross;
  station.angles.setZero(2, p.layout.state());
  station.angles(0, AdjustLayout::kInclination) = 1;
  const double variance = attitude.azimuth_known ? 0 : cov(0, 0) + kUnknownVariance;
  station.angles(1, AdjustLayout::kAzimuth) =
      variance > kUnknownAngleVariance ? std::sqrt(kUnknownAngleVariance / variance) : 1;
  const double sine2 = std::max(Square(std::sin(knot.inclination)), 1e-12);
  station.cov_white(1, 1) =
      std::min(Square(p.history->setup.gyro.quantization) / sine2, kUnknownAngleVariance);
  if (knot.axial) {
    station.angles.row(1).tail(p.layout.state() - p.layout.node) =
        AttitudeRows(p.layout, knot, p.history->setup.site.gravity)
            .row(1)
            .tail(p.layout.state() - p.layout.node);
    const double var_knot = VarOfKnot(p.layout, knot);
    const double share = knot.lifts ? 1 : ShareOfNode(var_knot, cov);
    const double told = cov(AdjustLayout::kInclination, AdjustLayout::kInclination) * share * share;
    const double leans = knot.lifts ? Square(kInclinationFloor) : std::max(0.0, var_knot - told);
    station.angles(0, AdjustLayout::kInclination) = share;
    station.cov_white(0, 0) += leans;
    station.cov_white(1, 1) +=
        std::min(std::max(0.0, knot.var_azimuth_beyond) + leans / sine2, kUnknownAngleVariance);
  }
  if (!attitude.azimuth_known) {
    station.cov(0, 0) += kUnknownVariance;
  }
  return station;
}

// Shares of the spans' growth at the end of each epoch: azimuth and inclination.
struct Within {
  std::vector<double> azimuth, inclination;
};

// The tool's errors as found, its drift where the span begins.
Knot::SourceVector FoundAt(const AdjustProblem& p, std::size_t k) {
  Knot::SourceVector found = Knot::SourceVector::Zero();
  const auto common = [&](int place) { return p.common[static_cast<std::size_t>(place)]; };
  for (int source = 0; source < Knot::kSources; ++source) {
    const int at = p.layout.source[static_cast<std::size_t>(source)];
    if (at >= 0) found[source] = common(at);
  }
  for (int i = 0; i < 2; ++i) {
    const AdjustLayout::Axis& at = p.layout.axis[static_cast<std::size_t>(i)];
    if (at.level >= 0) found[i] += p.node(k)[at.level];
    if (at.markov >= 0) found[i] += p.node(k)[at.markov];
    if (at.level_common >= 0) found[i] += common(at.level_common);
  }
  return found;
}

// What the gyros read of the growths over a knot, less the errors' share.
struct Read {
  double turn, lift;
};

Read ReadOver(const Knot& knot, bool curved, const Knot::SourceVector& errors) {
  Read read{knot.turn - knot.d_turn.dot(errors), knot.lift - knot.d_lift.dot(errors)};
  if (curved) {
    const SecondOrderShare second = SecondOrderOf(knot);
    read.turn += errors.dot(second.turn * errors);
    read.lift += errors.dot(second.lift * errors);
  }
  return read;
}

// As read, and what that leaves of the growth from node to node shared out by time.
Within PathWithin(const AdjustProblem& p, std::size_t k) {
  const AdjustSpan& span = p.spans[k];
  const double* begin = p.node(k);
  const double* end = p.node(k + 1);
  Within path;
  const double north = kEarthRate * std::cos(p.history->setup.site.latitude);
  double turned = 0, lifted = 0, seconds = 0;
  std::vector<double> share;
  const Knot::SourceVector errors = FoundAt(p, k);
  for (std::size_t i = span.epoch_begin; i < span.epoch_end; ++i) {
    const Knot& knot = p.history->epochs[i].knot;
    const bool moves = !span.still && !span.broken;
    const double start = begin[AdjustLayout::kAzimuth] + turned;
    const Read read = ReadOver(knot, span.curved, errors);
    const double earth = knot.cot * std::cos(start + read.turn / 2) +
                         (std::polar(1.0, start) * knot.axial_cot).real();
    turned += moves ? read.turn + north * earth : 0;
    lifted += moves ? read.lift : 0;
    seconds += knot.seconds;
    path.azimuth.push_back(turned);
    path.inclination.push_back(lifted);
    share.push_back(seconds / span.seconds);
  }
  const double rest_a = end[AdjustLayout::kAzimuth] - begin[AdjustLayout::kAzimuth] - turned;
  const double rest_i =
      end[AdjustLayout::kInclination] - begin[AdjustLayout::kInclination] - lifted;
  for (std::size_t j = 0; j < share.size(); ++j) {
    path.azimuth[j] += begin[AdjustLayout::kAzimuth] + share[j] * rest_a;
    path.inclination[j] += begin[AdjustLayout::kInclination] + share[j] * rest_i;
  }
  return path;
}

}  // namespace

std::vector<double> AzimuthsWithin(const AdjustProblem& p, std::size_t span) {
  return PathWithin(p, span).azimuth;
}

SmoothedRun ResultOf(const AdjustProblem& p, const SelectedInverse& inverse,
                     const std::vector<bool>& known) {
  const auto& epochs = p.history->epochs;
  const States states(p, inverse);
  SmoothedRun run;
  run.attitude.reserve(epochs.size());
  MatrixXd cov = states.Cov(0, 0);
  MatrixXd since;  // E[x_station x_node'], of the last station and the node in hand; empty: none
  const auto mark = [&](std::size_t epoch, const MatrixXd& here) {
    if (!epochs[epoch].station) return;
    run.stations.push_back(StationAt(p, epoch, run.attitude[epoch], here, since));
    since = here;
  };
  std::size_t epoch = 0;
  for (; epoch < p.spans.front().epoch_begin; ++epoch) {  // without length
    run.attitude.push_back(AttitudeAt(p, epochs[epoch].knot, p.node(0)[AdjustLayout::kInclination],
                                      p.azimuth(0), cov, known[0]));
    mark(epoch, cov);
  }
  for (std::size_t k = 0; k < p.spans.size(); ++k) {
    const AdjustSpan& span = p.spans[k];
    const MatrixXd next = states.Cov(k + 1, k + 1);
    if (since.size() > 0) since = since * SolveScaled(cov, states.Cov(k, k + 1));
    const Within path = PathWithin(p, k);
    double seconds = 0;
    for (; epoch < span.epoch_end; ++epoch) {
      const std::size_t j = epoch - span.epoch_begin;
      seconds += epochs[epoch].knot.seconds;
      const double share = epoch + 1 == span.epoch_end ? 1 : seconds / span.seconds;
      const MatrixXd here = share < 1 ? MatrixXd((1 - share) * cov + share * next) : next;
      run.attitude.push_back(AttitudeAt(p, epochs[epoch].knot, path.inclination[j], path.azimuth[j],
                                        here, known[k + 1]));
    }
    mark(span.epoch_end - 1, next);
    cov = next;
  }
  return run;
}

}  // namespace wellgyro
