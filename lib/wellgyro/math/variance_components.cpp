#include "wellgyro/math/variance_components.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <utility>

#include <Eigen/Core>

#include "wellgyro/math/linear_algebra.h"
#include "wellgyro/math/statistics.h"

namespace wellgyro {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

// Where the average information is up to twice the observed one a step leaves half of the distance
// at most: 2^-60 of it in so many, below eps.
constexpr int kStepsMax = 60;
// Steps by expectation before them: the first brings a variance far above the data's square S,
// noise R, to S + R; four more share it out among the components.
constexpr int kExpectations = 5;
// Of the log-likelihood, that a further step must promise: sqrt(2 kGain) of a sigma, 4e-4 and
// 0.014.
constexpr double kGain = 1e-7, kProfileGain = 1e-4;
// Ridge, of the information's diagonal: it keeps singular directions finite, and of a component
// that is told by itself the sigma changes by 5e-7.
constexpr double kHold = 1e-6;
constexpr double kInfinite = std::numeric_limits<double>::infinity();
constexpr double kCrossed = 3e-3;  // of the root of a deviance, 1.96: a bound to 0.15 %

/// The log-likelihood with its slope and average information.
struct Slope {
  double value = 0;
  VectorXd gradient;
  MatrixXd information;
  std::vector<double> chi_square;
};

/// A cluster made ready: sources of one cell apart from the long ones.
class Cluster {
 public:
  explicit Cluster(const VarianceCluster& data);
  void Add(const VectorXd& theta, Slope& slope) const;

 private:
  struct Solved;
  /// False where a cell is singular.
  bool Factor(const VectorXd& theta, Solved& s) const;
  void AddSlopes(const Solved& s, Slope& slope) const;
  static double Of(const std::optional<std::size_t>& component, const VectorXd& theta) {
    return component ? theta(static_cast<Index>(*component)) : 1;
  }
  Index CellEnd(std::size_t c) const {
    return c + 1 < data_.cells.size() ? data_.cells[c + 1] : data_.y.size();
  }
  /// D^-1 x, D the part of V within cells.
  MatrixXd InverseTimes(const Solved& s, const MatrixXd& x) const;

  /// A component's share of a cell's own covariance, for a unit of its variance.
  struct Share {
    std::optional<std::size_t> component;
    MatrixXd cov;
  };
  void AddToCell(std::size_t cell, const VarianceSource& source);

  const VarianceCluster& data_;
  std::vector<std::vector<Share>> cells_;
  std::vector<const VarianceSource*> long_;
  MatrixXd effects_;  ///< of the long ones
};

/// V = D + S T^2 S', T the roots of the long ones' variances; V^-1 = D^-1 - B B'.
struct Cluster::Solved {
  std::vector<Cholesky> cells;
  MatrixXd whitened;  ///< L^-1 T G, G = S' D^-1 S; also B' S
  MatrixXd gram;      ///< G
  MatrixXd b;
  VectorXd alpha;  ///< V^-1 y
  double log_determinant = 0;
};

Cluster::Cluster(const VarianceCluster& data) : data_(data), cells_(data.cells.size()) {
  if (data.cells.empty() || data.cells.front() != 0) {
    throw std::invalid_argument("the cells of a cluster begin at row 0");
  }
  for (const VarianceSource& source : data.sources) {
    const Index end = source.first + source.effect.size();
    if (source.first < 0 || source.effect.size() == 0 || end > data.y.size()) {
      throw std::invalid_argument("a source of variance reaches beyond its cluster");
    }
    const auto next = std::ranges::upper_bound(data.cells, source.first);
    const auto cell = static_cast<std::size_t>(next - data.cells.begin()) - 1;
    if (end <= CellEnd(cell)) {
      AddToCell(cell, source);
    } else {
      long_.push_back(&source);
    }
  }
  effects_ = MatrixXd::Zero(data.y.size(), static_cast<Index>(long_.size()));
  for (std::size_t i = 0; i < long_.size(); ++i) {
    effects_.col(static_cast<Index>(i)).segment(long_[i]->first, long_[i]->effect.size()) =
        long_[i]->effect;
  }
}

void Cluster::AddToCell(std::size_t cell, const VarianceSource& source) {
  std::vector<Share>& shares = cells_[cell];
  auto share = std::ranges::find(shares, source.component, &Share::component);
  if (share == shares.end()) {
    const Index rows = CellEnd(cell) - data_.cells[cell];
    share = shares.insert(share, {source.component, MatrixXd::Zero(rows, rows)});
  }
  const Index at = source.first - data_.cells[cell], n = source.effect.size();
  share->cov.block(at, at, n, n) += source.effect * source.effect.transpose();
}

MatrixXd Cluster::InverseTimes(const Solved& s, const MatrixXd& x) const {
  MatrixXd result(x.rows(), x.cols());
  for (std::size_t c = 0; c < cells_.size(); ++c) {
    const Index begin = data_.cells[c], rows = CellEnd(c) - begin;
    result.middleRows(begin, rows) = s.cells[c].Solve(x.middleRows(begin, rows));
  }
  return result;
}

bool Cluster::Factor(const VectorXd& theta, Solved& s) const {
  for (std::size_t c = 0; c < cells_.size(); ++c) {
    const Index rows = CellEnd(c) - data_.cells[c];
    MatrixXd d = MatrixXd::Zero(rows, rows);
    for (const Share& share : cells_[c]) d += Of(share.component, theta) * share.cov;
    s.cells.emplace_back(d);
    if (!s.cells.back().positive()) return false;
    s.log_determinant += s.cells.back().LogDeterminant();
  }
  const auto n = static_cast<Index>(long_.size());
  VectorXd root(n);
  for (Index i = 0; i < n; ++i) {
    root(i) = std::sqrt(Of(long_[static_cast<std::size_t>(i)]->component, theta));
  }
  const MatrixXd inverse = InverseTimes(s, effects_);
  s.gram = effects_.transpose() * inverse;
  const MatrixXd scaled = root.asDiagonal() * s.gram;
  const Cholesky middle(MatrixXd::Identity(n, n) + scaled * root.asDiagonal());
  s.log_determinant += middle.LogDeterminant();
  s.whitened = middle.Whitened(scaled);
  s.b = middle.Whitened(root.asDiagonal() * inverse.transpose()).transpose();
  s.alpha = InverseTimes(s, data_.y) - s.b * (s.b.transpose() * data_.y);
  return true;
}

/// d ln L / d theta_j = (alpha' K_j alpha - tr V^-1 K_j) / 2, and (q_i' V^-1 q_j) / 2 with
/// q_j = K_j alpha.
void Cluster::AddSlopes(const Solved& s, Slope& slope) const {
  MatrixXd q = MatrixXd::Zero(data_.y.size(), slope.gradient.size());
  for (std::size_t c = 0; c < cells_.size(); ++c) {
    const Index begin = data_.cells[c], rows = CellEnd(c) - begin;
    const auto b = s.b.middleRows(begin, rows);
    const MatrixXd inverse = s.cells[c].Solve(MatrixXd::Identity(rows, rows)) - b * b.transpose();
    for (const Share& share : cells_[c]) {
      if (!share.component) continue;
      const auto j = static_cast<Index>(*share.component);
      slope.gradient(j) -= inverse.cwiseProduct(share.cov).sum() / 2;
      q.col(j).segment(begin, rows) += share.cov * s.alpha.segment(begin, rows);
    }
  }
  for (std::size_t i = 0; i < long_.size(); ++i) {
    if (!long_[i]->component) continue;
    const auto at = static_cast<Index>(i), j = static_cast<Index>(*long_[i]->component);
    slope.gradient(j) -= (s.gram(at, at) - s.whitened.col(at).squaredNorm()) / 2;
    q.col(j) += effects_.col(at).dot(s.alpha) * effects_.col(at);
  }
  slope.gradient += q.transpose() * s.alpha / 2;
  const MatrixXd across = s.b.transpose() * q;
  slope.information += (q.transpose() * InverseTimes(s, q) - across.transpose() * across) / 2;
}

void Cluster::Add(const VectorXd& theta, Slope& slope) const {
  Solved s;
  if (!Factor(theta, s)) {
    slope.value = -kInfinite;
    return;
  }
  const double chi_square = data_.y.dot(s.alpha);
  slope.chi_square.push_back(chi_square);
  slope.value -= (s.log_determinant + chi_square) / 2;
  AddSlopes(s, slope);
}

class Likelihood {
 public:
  Likelihood(std::span<const VarianceCluster> data, const VarianceStart& start);
  Slope At(const VectorXd& theta) const;
  /// From `theta` uphill over all components that are not held, until a step promises less than
  /// `gain`.
  Slope Climb(const std::vector<bool>& held, double gain, VectorXd& theta, bool& converged) const;
  /// A step of expectation and maximisation, which goes uphill from anywhere:
  /// theta_j + 2 theta_j^2 (d ln L / d theta_j) / n_j, n_j the draws of component j.
  void Expect(const std::vector<bool>& held, VectorXd& theta) const;

 private:
  std::vector<Cluster> clusters_;
  VectorXd draws_;  ///< of each component
};

Likelihood::Likelihood(std::span<const VarianceCluster> data, const VarianceStart& start)
    : draws_(VectorXd::Zero(static_cast<Index>(start.value.size()))) {
  for (const VarianceCluster& cluster : data) {
    for (const VarianceSource& source : cluster.sources) {
      if (source.component && *source.component >= start.value.size()) {
        throw std::invalid_argument("a source of variance names a component that there is not");
      }
      if (source.component) ++draws_(static_cast<Index>(*source.component));
    }
    clusters_.emplace_back(cluster);
  }
  if (start.held.size() != start.value.size()) {
    throw std::invalid_argument("each component of variance is held or not");
  }
}

Slope Likelihood::At(const VectorXd& theta) const {
  Slope slope;
  slope.gradient = VectorXd::Zero(theta.size());
  slope.information = MatrixXd::Zero(theta.size(), theta.size());
  for (const Cluster& cluster : clusters_) cluster.Add(theta, slope);
  return slope;
}

/// The step to the greatest value of the quadratic model over all that stays at 0 or above, of the
/// components in `free`: those that it would take below 0 go there and the others to where they are
/// best for that. A step of them all that is cut at 0 may go downhill.
VectorXd StepOf(const Slope& slope, const VectorXd& theta, std::vector<Index> free) {
  VectorXd step = VectorXd::Zero(theta.size());
  while (!free.empty()) {
    MatrixXd information = slope.information(free, free);
    information.diagonal() *= 1 + kHold;
    const VectorXd gradient = slope.gradient(free) - slope.information(free, Eigen::all) * step;
    const VectorXd part = SolveSymmetric(information, gradient);
    std::vector<Index> still;
    for (std::size_t i = 0; i < free.size(); ++i) {
      const bool stopped = theta(free[i]) + part(static_cast<Index>(i)) < 0;
      if (stopped) step(free[i]) = -theta(free[i]);
      if (!stopped) still.push_back(free[i]);
    }
    if (still.size() == free.size()) {
      step(free) = part;
      break;
    }
    free = std::move(still);
  }
  return step;
}

Slope Likelihood::Climb(const std::vector<bool>& held, double gain, VectorXd& theta,
                        bool& converged) const {
  Slope here = At(theta);
  converged = false;
  if (here.value == -kInfinite) return here;
  for (int i = 0; i < kStepsMax && !converged; ++i) {
    std::vector<Index> free;
    for (Index j = 0; j < theta.size(); ++j) {
      if (held[static_cast<std::size_t>(j)]) continue;
      if (theta(j) > 0 || here.gradient(j) > 0) free.push_back(j);
    }
    VectorXd step = StepOf(here, theta, free);
    const double promised = here.gradient.dot(step);
    converged = promised < gain;
    for (int halved = 0; !converged && halved < 30; ++halved, step /= 2) {
      Slope next = At(theta + step);
      if (next.value < here.value + 1e-4 * here.gradient.dot(step)) continue;
      theta += step;
      here = std::move(next);
      break;
    }
  }
  return here;
}

void Likelihood::Expect(const std::vector<bool>& held, VectorXd& theta) const {
  const Slope here = At(theta);
  if (here.value == -kInfinite) return;
  for (Index j = 0; j < theta.size(); ++j) {
    if (held[static_cast<std::size_t>(j)] || draws_(j) == 0) continue;
    theta(j) = std::max(0.0, theta(j) + 2 * theta(j) * theta(j) * here.gradient(j) / draws_(j));
  }
}

VectorXd ValuesOf(const VarianceFit& fit) {
  VectorXd theta(static_cast<Index>(fit.components.size()));
  for (Index j = 0; j < theta.size(); ++j) {
    theta(j) = fit.components[static_cast<std::size_t>(j)].value;
  }
  return theta;
}

/// How far down the profile of one component goes.
class Profile {
 public:
  Profile(const Likelihood& likelihood, const VarianceStart& start, const VarianceFit& fit,
          std::size_t which)
      : likelihood_(likelihood),
        held_(start.held),
        fit_(fit),
        which_(static_cast<Index>(which)),
        theta_(ValuesOf(fit)) {
    held_[which] = true;
  }

  /// Twice what the log-likelihood loses at `value`, the others best for it.
  double Deviance(double value) {
    theta_(which_) = value;  // the others go on from where they were best before
    bool converged = false;
    const Slope best = likelihood_.Climb(held_, kProfileGain, theta_, converged);
    return std::max(0.0, 2 * (fit_.log_likelihood - best.value));
  }

  /// The value where it is `limit`, outside `inside`, first looked for at `outside`; absent beyond
  /// `most`. The root of the deviance is nearly straight in the root of the variance.
  std::optional<double> Cross(double inside, double outside, double most, double limit) {
    const auto over = [&](double root) {
      return std::sqrt(Deviance(root * root)) - std::sqrt(limit);
    };
    double a = std::sqrt(inside), b = std::sqrt(outside), at_a = -std::sqrt(limit), at_b = over(b);
    const double end = std::sqrt(most);
    while (at_b < 0) {
      if (b == end) return std::nullopt;
      const double next = b + 2 * (b - a);
      a = b, at_a = at_b;
      b = b < end ? std::min(next, end) : std::max(next, end);
      at_b = over(b);
    }
    for (int i = 0; i < 40 && std::abs(at_b) > kCrossed; ++i) {
      // Illinois' false position; by halves from where there is no likelihood.
      const double x = std::isfinite(at_b) ? (a * at_b - b * at_a) / (at_b - at_a) : (a + b) / 2;
      const double at_x = over(x);
      if (at_x * at_b < 0) {
        a = b, at_a = at_b;
      } else if (std::isfinite(at_b)) {
        at_a /= 2;
      }
      b = x, at_b = at_x;
    }
    return b * b;
  }

 private:
  const Likelihood& likelihood_;
  std::vector<bool> held_;
  const VarianceFit& fit_;
  Index which_;
  VectorXd theta_;
};

/// Of each free component, by the information at the maximum.
std::vector<double> SigmasOf(const Slope& slope, const VarianceStart& start) {
  std::vector<Index> free;
  for (std::size_t j = 0; j < start.held.size(); ++j) {
    if (!start.held[j]) free.push_back(static_cast<Index>(j));
  }
  std::vector<double> sigmas(start.held.size(), 0.0);
  if (free.empty()) return sigmas;
  MatrixXd information = slope.information(free, free);
  information.diagonal() *= 1 + kHold;
  const VectorXd cov = InverseOfSymmetric(information).diagonal();
  for (std::size_t i = 0; i < free.size(); ++i) {
    const double variance = cov(static_cast<Index>(i));
    sigmas[static_cast<std::size_t>(free[i])] = variance > 0 ? std::sqrt(variance) : 0;
  }
  return sigmas;
}

}  // namespace

VarianceFit FitVariances(std::span<const VarianceCluster> clusters, const VarianceStart& start) {
  const Likelihood likelihood(clusters, start);
  VectorXd theta =
      Eigen::Map<const VectorXd>(start.value.data(), static_cast<Index>(start.value.size()));
  VarianceFit fit;
  // The average information leads astray where variances are much greater than the data's.
  for (int i = 0; i < kExpectations; ++i) likelihood.Expect(start.held, theta);
  Slope slope = likelihood.Climb(start.held, kGain, theta, fit.converged);
  if (slope.value == -kInfinite) {
    throw std::invalid_argument("nothing scatters some rows of a cluster by themselves");
  }
  fit.log_likelihood = slope.value;
  fit.sigma = SigmasOf(slope, start);
  fit.chi_square = std::move(slope.chi_square);
  for (Index j = 0; j < theta.size(); ++j) fit.components.push_back({theta(j), 0, {}});
  return fit;
}

std::vector<VarianceEstimate> VarianceIntervals(std::span<const VarianceCluster> clusters,
                                                const VarianceStart& start, const VarianceFit& fit,
                                                double probability) {
  const Likelihood likelihood(clusters, start);
  const double limit = ChiSquareQuantile(probability, 1);
  std::vector<VarianceEstimate> all = fit.components;
  for (std::size_t j = 0; j < all.size(); ++j) {
    if (start.held[j]) continue;
    VarianceEstimate& e = all[j];
    const double reach = std::sqrt(limit) * std::max(fit.sigma[j], 1e-3 * start.value[j]);
    const double root = std::sqrt(e.value);
    if (e.value > 0) {
      const double from = std::max(0.0, root - reach / (2 * root));
      Profile below(likelihood, start, fit, j);
      e.lower = below.Cross(e.value, from * from, 0, limit).value_or(0);
    }
    // A million times the start is as good as no bound.
    const double most = 1e6 * std::max(start.value[j], e.value);
    const double to = root > 0 ? std::min(root + reach / (2 * root), 2 * root) : std::sqrt(reach);
    Profile above(likelihood, start, fit, j);
    e.upper = above.Cross(e.value, std::min(to * to, most), most, limit);
  }
  return all;
}

double VarianceDeviance(std::span<const VarianceCluster> clusters, const VarianceStart& start,
                        const VarianceFit& fit, std::size_t which, double value) {
  const Likelihood likelihood(clusters, start);
  return Profile(likelihood, start, fit, which).Deviance(value);
}

}  // namespace wellgyro
