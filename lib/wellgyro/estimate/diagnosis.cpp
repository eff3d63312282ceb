#include "wellgyro/estimate/diagnosis.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include <Eigen/Eigenvalues>

#include "wellgyro/estimate/bayes_factor.h"
#include "wellgyro/estimate/onset_scan.h"
#include "wellgyro/estimate/rows_without.h"
#include "wellgyro/estimate/scatter.h"

namespace wellgyro {
namespace {

using Eigen::Index;
using Eigen::Matrix3d;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Kind = CauseSpec::Kind;

// What rounding leaves of an information that the unknowns absorb: n eps = 1e-11 of sums over
// n = 5e4 knots, a hundred times that.
constexpr double kAbsorbed = 1e-9;

Index At(std::size_t i) { return static_cast<Index>(i); }

/// ln(mean of exp(x)) over the x added, scaled by the largest so far, so that nothing overflows.
class LogMean {
 public:
  void Add(double x) {
    ++count_;
    if (x <= most_) {
      sum_ += std::exp(x - most_);
      return;
    }
    sum_ = sum_ * std::exp(most_ - x) + 1;
    most_ = x;
  }
  double count() const { return count_; }
  double value() const { return count_ > 0 ? most_ + std::log(sum_ / count_) : 0; }

 private:
  double most_ = -HUGE_VAL, sum_ = 0, count_ = 0;
};

/// ln B of a size that is given: theta s - theta^2 M / 2.
double LnBayesGiven(const Score& score, double size) {
  return size * score.score - 0.5 * size * size * score.information;
}

/// The scores of one cause at every node and row where it may lie, and what they come to.
class Looks {
 public:
  Looks(const CauseSpec& spec, double ln_limit) : spec_(spec), ln_limit_(ln_limit) {}

  /// `alike`: how many onsets beside this one look the same.
  void Add(std::size_t node, const Score& score, double alike = 1, int row = 0) {
    if (!(score.information > 0)) return;
    looks_.push_back({node, score, alike, row});
  }
  void AddTo(CauseTest& test) const {
    if (looks_.empty()) return;
    LogMean mean;
    double best = -HUGE_VAL;
    for (const Look& look : looks_) {
      const double largest = kLargestFault * spec_.size;
      if (largest * largest * look.score.information < 1) {
        mean.Add(0);
        continue;
      }
      const bool given = spec_.kind == Kind::kGiven;
      const double ln_bayes = given ? LnBayesGiven(look.score, spec_.size)
                                    : LnBayes(look.score.score, look.score.information, spec_.size);
      mean.Add(ln_bayes);
      test.told = true;
      if (ln_bayes <= best) continue;
      best = ln_bayes;
      test.node = look.node;
      test.row = look.row;
      test.size = given ? spec_.size : look.score.size();
      test.sigma = 1 / std::sqrt(look.score.information);
      test.shift_W = test.size * look.score.shift_W;
    }
    test.tested = true;
    test.ln_bayes = mean.value();
    for (const Look& look : looks_) TakeHidden(look, test);
  }

 private:
  struct Look {
    std::size_t node;
    Score score;
    double alike;
    int row;
  };

  /// The smallest fault that is noticed, the limit of ln B growing by the onsets that are averaged.
  void TakeHidden(const Look& look, CauseTest& test) const {
    const double count = static_cast<double>(looks_.size());
    const double onsets = std::log(std::max(count / look.alike, 1.0));
    const double smallest = SmallestNoticed(look.score.information, spec_.size, ln_limit_ + onsets);
    const bool noticeable = smallest < kLargestFault * spec_.size;
    const Vector3d hidden = std::min(smallest, kLargestFault * spec_.size) * look.score.shift_W;
    if (test.smallest > 0 && !(hidden.norm() > test.hidden_W.norm())) return;
    test.noticeable = noticeable;
    test.smallest = smallest;
    test.smallest_node = look.node;
    test.hidden_W = hidden;
  }

  CauseSpec spec_;
  double ln_limit_;
  std::vector<Look> looks_;
};

/// P of a factor's rows: 1 - J cov J', `cov` of [node | next node | border].
Matrix3d Freedom(const Factor& f, const BlockMatrix& cov) {
  Matrix3d p = -CovarianceOf(f, cov);
  for (int i = 0; i < f.rows; ++i) p(i, i) += 1;
  return 0.5 * (p + p.transpose());
}

Diagnosis Untested(std::size_t specs) {
  Diagnosis d;
  d.tests.resize(specs);
  d.alike.setZero(At(specs), At(specs));
  return d;
}

class Diagnoser {
 public:
  Diagnoser(const LinearRun& solved, std::span<const CauseSpec> specs, double false_alarm_rate,
            const Vector3d& end_by_depth_scale_W)
      : run_(solved), specs_(specs), end_by_depth_scale_(end_by_depth_scale_W) {
    // ln B from which one cause alone raises the alarm: the odds are the mean of B over the causes.
    const double limit =
        std::log(static_cast<double>(std::max<std::size_t>(specs.size(), 1)) / false_alarm_rate);
    for (const CauseSpec& spec : specs) looks_.emplace_back(spec, limit);
  }

  Diagnosis Run(std::span<const Matrix3d> end_by_phi_W) {
    Diagnosis d = Untested(specs_.size());
    influence_.emplace(run_, end_by_phi_W);
    Forward();
    Backward();
    AddConstants();
    AddOnsets();
    for (std::size_t i = 0; i < specs_.size(); ++i) looks_[i].AddTo(d.tests[i]);
    AddScatter(d);
    d.turns = turns_.Residuals();
    d.forces = forces_.Residuals();
    CompareSignatures(d);
    AddOdds(d);
    d.done = true;
    return d;
  }

 private:
  int ColumnOfSpec(std::size_t i) const {
    const Kind kind = specs_[i].kind;
    const bool of_border = kind == Kind::kConstant || kind == Kind::kGiven || kind == Kind::kOnset;
    return of_border ? BorderColumn(run_.layout(), specs_[i].unknown) : kAbsent;
  }

  void Forward() {
    std::vector<int> unknowns;
    for (std::size_t i = 0; i < specs_.size(); ++i) {
      if (specs_[i].kind != Kind::kOnset || ColumnOfSpec(i) == kAbsent) continue;
      unknowns.push_back(ColumnOfSpec(i));
      onsets_of_.push_back(i);
    }
    scan_.emplace(run_, unknowns);
    NormalBlock rows;
    for (std::size_t k = 0; k < run_.knots(); ++k) {
      run_.BlockOf(k, rows);
      scan_->Forward(k, rows, *influence_);
    }
  }

  void Backward() {
    const Elimination& e = run_.elimination();
    const int n = run_.layout().node, m = n + run_.layout().border;
    EdgeMatrix next = e.LastCovariance();
    border_covariance_ = next.bottomRightCorner(m - n, m - n);
    scan_->Backward(run_.knots(), next);
    changes_.assign(run_.knots(), std::vector<double>(onsets_of_.size(), 0));
    for (std::size_t k = run_.knots(); k-- > 0;) {
      BehindMatrix with_next;
      const EdgeMatrix here = e.CovarianceBefore(k, e.Gain(k), next, with_next);
      LookAt(k, JointCovariance(here, with_next, next));
      scan_->Backward(k, here);
      next = here;
    }
  }

  void LookAt(std::size_t k, const BlockMatrix& joint) {
    run_.RowsOf(k, rows_);
    for (const Factor& f : rows_) {
      const bool gyro = f.kind == RowKind::kTurn || f.kind == RowKind::kStill;
      const bool accel = f.kind == RowKind::kForce;
      if (!gyro && !accel && f.kind != RowKind::kRest && f.kind != RowKind::kAzimuth) continue;
      const Matrix3d freedom = Freedom(f, joint);
      for (std::size_t i = 0; i < onsets_of_.size(); ++i) {
        const Vector3d c = ColumnOf(f, run_.layout(), ColumnOfSpec(onsets_of_[i]));
        changes_[k][i] += c.dot(freedom * c);
      }
      if (gyro) LookAtRows(Kind::kGyroSpike, 2, k, f, freedom);
      if (accel) LookAtRows(Kind::kAccelSpike, 3, k, f, freedom);
      if (f.kind == RowKind::kRest && f.rows == 3) {
        LookAtRows(Kind::kRestMotion, 3, k, f, freedom);
      }
      if (f.kind == RowKind::kAzimuth) LookAtRows(Kind::kTie, 1, k, f, freedom);
      if (gyro) turns_.Add(k, f, freedom);
      if (accel) forces_.Add(k, f, freedom);
    }
  }

  /// An outlier in row i alone, i < count: its column c is 1 / sigma there and zero elsewhere.
  void LookAtRows(Kind kind, int count, std::size_t k, const Factor& f, const Matrix3d& freedom) {
    for (std::size_t s = 0; s < specs_.size(); ++s) {
      if (specs_[s].kind != kind) continue;
      const Matrix3d moved = influence_->Of(k, f);
      for (int i = 0; i < count; ++i) {
        const Vector3d c = f.UnitOf(i);
        if (!(f.per_unit > 0) || !(freedom(i, i) > kAbsorbed)) continue;
        looks_[s].Add(k, {c.dot(f.r), c.dot(freedom * c), -moved * c}, 1, i);
      }
    }
  }

  void AddConstants() {
    for (std::size_t s = 0; s < specs_.size(); ++s) {
      const int i = ColumnOfSpec(s);
      if (specs_[s].kind == Kind::kOnset || i == kAbsent) continue;
      const auto prior = run_.layout().information.col(i);
      const double information = prior[i] - prior.dot(border_covariance_ * prior);
      if (!(information > kAbsorbed * prior[i])) continue;
      Vector3d shift = -influence_->OfPrior(i);
      if (specs_[s].unknown == kDepthScaleError) shift += end_by_depth_scale_;
      looks_[s].Add(0, {run_.PriorScore(i), information, shift});
    }
  }

  /// Steps at every node but the first, where a step is a constant. Where the rest of the run is
  /// too short to tell one, its information is rounding of the largest.
  void AddOnsets() {
    for (std::size_t i = 0; i < onsets_of_.size(); ++i) {
      double most = 0;
      for (std::size_t t = 1; t < run_.knots(); ++t) {
        most = std::max(most, scan_->At(i, t).information);
      }
      for (std::size_t t = 1; t < run_.knots(); ++t) {
        const Score& score = scan_->At(i, t);
        if (score.information > kAbsorbed * most) {
          looks_[onsets_of_[i]].Add(t, score, AlikeAt(i, t));
        }
      }
    }
  }

  /// Onsets about node t whose Bayes factor is much the same: the signature's correlation falls in
  /// proportion to the distance, and with it the exponent, from ln(41 * 80 / 1e-3) = 15 of a fault
  /// that is just found among 41 causes and some 80 onsets.
  double AlikeAt(std::size_t i, std::size_t t) const {
    const double here = scan_->At(i, t).information, next = scan_->At(i, t + 1).information;
    if (!(here > 0) || !(next > 0)) return 1;
    const double rho =
        std::clamp((here + next - changes_[t][i]) / (2 * std::sqrt(here * next)), 0.0, 1.0);
    const double falls = 15 * (1 - rho * rho);
    return falls > 2 ? 1 : 2 / std::max(falls, 1e-6);
  }

  void AddScatter(Diagnosis& d) const {
    for (std::size_t s = 0; s < specs_.size(); ++s) {
      CauseTest& test = d.tests[s];
      if (specs_[s].kind == Kind::kGyroNoise) turns_.TestAll(test);
      if (specs_[s].kind == Kind::kAccelNoise) forces_.TestAll(test);
      if (specs_[s].kind != Kind::kOther) continue;
      LogMean mean;
      for (const Scatter* scatter : {&turns_, &forces_}) {
        for (const double ln_bayes : scatter->Stretches()) mean.Add(ln_bayes);
      }
      if (mean.count() == 0) continue;
      test.tested = true;
      test.ln_bayes = mean.value();
    }
  }

  /// Column of the prior's information for the cause's unknown, over the border.
  auto PriorOfSpec(std::size_t i) const { return run_.layout().information.col(ColumnOfSpec(i)); }
  MatrixXd CompareOnsets(const Diagnosis& d, std::span<const std::size_t> onsets,
                         MatrixXd& gram) const;
  void CompareSignatures(Diagnosis& d) const;
  static void AddOdds(Diagnosis& d);

  const LinearRun& run_;
  std::span<const CauseSpec> specs_;
  Vector3d end_by_depth_scale_;
  std::vector<Looks> looks_;
  std::optional<EndInfluence> influence_;
  std::optional<OnsetScan> scan_;
  std::vector<std::size_t> onsets_of_;        ///< specs, in the order of the scan
  std::vector<std::vector<double>> changes_;  ///< information of one knot's part of the column
  MatrixXd border_covariance_;
  Scatter turns_{kStretchKnots}, forces_{kStretchKnots};
  mutable std::vector<Factor> rows_;
};

/// Of onsets at their likeliest nodes, by one pass forward with J'c a column each: adds
/// c_i'c_j - (J'c_i)' N^-1 J'c_j to `gram` but for what the prior's rows have in it, and returns
/// N^-1 J'c of the border.
MatrixXd Diagnoser::CompareOnsets(const Diagnosis& d, std::span<const std::size_t> onsets,
                                  MatrixXd& gram) const {
  const Layout& layout = run_.layout();
  const int n = layout.node, m = n + layout.border;
  if (onsets.empty()) return MatrixXd(layout.border, 0);
  MatrixXd x = MatrixXd::Zero(n + m, At(onsets.size()));
  MatrixXd known = MatrixXd::Zero(x.cols(), x.cols());
  for (std::size_t q = 0; q < onsets.size(); ++q) {
    x.col(At(q)).tail(layout.border) = PriorOfSpec(onsets[q]);
  }
  NormalBlock rows;
  std::size_t last = 0;
  for (const std::size_t i : onsets) last = std::max(last, d.tests[i].node);
  for (std::size_t k = 0; k < run_.knots(); ++k) {
    const auto before = [&](std::size_t i) { return k < d.tests[i].node; };
    if (k < last) run_.BlockOf(k, rows);
    for (std::size_t q = 0; q < onsets.size(); ++q) {
      if (!before(onsets[q])) continue;
      const NormalBlock::Vector column = rows.Column(2 * n + ColumnOfSpec(onsets[q]));
      x.col(At(q)) += column;
      for (const std::size_t j : onsets) {
        if (before(j)) gram(At(onsets[q]), At(j)) += column[2 * n + ColumnOfSpec(j)];
      }
    }
    run_.elimination().Eliminate(k, x);
    known.noalias() += x.topRows(n).transpose().lazyProduct(x.topRows(n));
    x.topRows(n) = x.middleRows(n, n).eval();
    x.middleRows(n, n).setZero();
  }
  MatrixXd edge(m, x.cols());
  edge << x.topRows(n), x.bottomRows(m - n);
  const MatrixXd solved = run_.elimination().LastCovariance() * edge;
  known += edge.transpose() * solved;
  for (std::size_t p = 0; p < onsets.size(); ++p) {
    for (std::size_t q = 0; q < onsets.size(); ++q) {
      gram(At(onsets[p]), At(onsets[q])) -= known(At(p), At(q));
    }
  }
  return solved.bottomRows(m - n);
}

/// Of constants and onsets at their likeliest nodes c_i'P c_j. A constant's c is its prior's row
/// alone, which onsets have too.
void Diagnoser::CompareSignatures(Diagnosis& d) const {
  std::vector<std::size_t> constants, onsets;
  for (std::size_t s = 0; s < specs_.size(); ++s) {
    // A size that is given is told from others by the size.
    const bool given = specs_[s].kind == Kind::kGiven;
    if (!d.tests[s].told || given || ColumnOfSpec(s) == kAbsent) continue;
    (specs_[s].kind == Kind::kOnset ? onsets : constants).push_back(s);
  }
  MatrixXd gram = MatrixXd::Zero(At(specs_.size()), At(specs_.size()));
  for (const auto* some : {&constants, &onsets}) {
    for (const std::size_t i : *some) {
      for (const auto* others : {&constants, &onsets}) {
        for (const std::size_t j : *others) {
          gram(At(i), At(j)) += PriorOfSpec(i)[ColumnOfSpec(j)];
        }
      }
    }
  }
  const MatrixXd border = CompareOnsets(d, onsets, gram);
  for (const std::size_t i : constants) {
    for (const std::size_t j : constants) {
      gram(At(i), At(j)) -= PriorOfSpec(i).dot(border_covariance_ * PriorOfSpec(j));
    }
    for (std::size_t q = 0; q < onsets.size(); ++q) {
      gram(At(i), At(onsets[q])) -= PriorOfSpec(i).dot(border.col(At(q)));
      gram(At(onsets[q]), At(i)) = gram(At(i), At(onsets[q]));
    }
  }
  for (Index i = 0; i < gram.rows(); ++i) {
    for (Index j = 0; j < gram.cols(); ++j) {
      const double by = std::sqrt(gram(i, i) * gram(j, j));
      if (by > 0) d.alike(i, j) = std::clamp(gram(i, j) / by, -1.0, 1.0);
    }
  }
}

void Diagnoser::AddOdds(Diagnosis& d) {
  LogMean all;
  for (const CauseTest& test : d.tests) {
    if (test.tested) all.Add(test.ln_bayes);
  }
  d.ln_odds = all.value();
}

/// The error source whose growth, with time or temperature, the unknown is; else the unknown.
int ErrorOf(int unknown) {
  switch (unknown) {
    case kRampX:
    case kWarmthX:
      return kGyroBiasX;
    case kRampY:
    case kWarmthY:
      return kGyroBiasY;
    case kRampZ:
    case kWarmthZ:
      return kGyroBiasZ;
    default:
      return unknown;
  }
}

/// Whether two causes are variants of one fault: of one error source, be it constant, from some
/// node on, or growing; or of one kind of row. A second fault is none of the first one's variants.
bool IsKin(const CauseSpec& a, const CauseSpec& b) {
  const auto of_unknown = [](Kind kind) {
    return kind == Kind::kConstant || kind == Kind::kGiven || kind == Kind::kOnset;
  };
  if (!of_unknown(a.kind) || !of_unknown(b.kind)) return a.kind == b.kind;
  return ErrorOf(a.unknown) == ErrorOf(b.unknown);
}

std::size_t LikeliestOf(const Diagnosis& d) {
  const auto first = std::ranges::max_element(d.tests, [](const CauseTest& a, const CauseTest& b) {
    return b.tested && (!a.tested || a.ln_bayes < b.ln_bayes);
  });
  return static_cast<std::size_t>(first - d.tests.begin());
}

/// The second look: P of the rows without the likeliest cause is that of the run in which it is an
/// unknown, and all tests are made of it anew.
void LookAgain(const LinearRun& solved, std::span<const CauseSpec> specs,
               std::span<const Matrix3d> end_by_phi_W, double false_alarm_rate, Diagnosis& d) {
  if (!(d.ln_odds > -std::log(false_alarm_rate))) return;
  const std::size_t first = LikeliestOf(d);
  const CauseTest& found = d.tests[first];
  if (!CanBeTakenOut(specs[first])) return;
  d.first = first;
  std::vector<CauseSpec> others;
  std::vector<std::size_t> place;
  for (std::size_t i = 0; i < specs.size(); ++i) {
    if (IsKin(specs[i], specs[first])) continue;
    others.push_back(specs[i]);
    place.push_back(i);
  }
  RowsWithout rows(solved.rows(), {specs[first], found.node, found.row, found.size});
  LinearRun without(rows);
  // Where the run does not solve without it nothing else can be told.
  if (others.empty() || !without.Solve()) return;
  const Diagnosis rest =
      Diagnoser(without, others, false_alarm_rate, Vector3d::Zero()).Run(end_by_phi_W);
  d.ln_odds_without_first = rest.ln_odds;
  d.second = place[LikeliestOf(rest)];
}

}  // namespace

Diagnosis Diagnose(RunRows& rows, std::span<const CauseSpec> specs,
                   std::span<const Matrix3d> end_by_phi_W, double false_alarm_rate,
                   const Vector3d& end_by_depth_scale_W) {
  LinearRun run(rows);
  if (!run.Solve()) return Untested(specs.size());
  return Diagnose(run, specs, end_by_phi_W, false_alarm_rate, end_by_depth_scale_W);
}

Diagnosis Diagnose(const LinearRun& solved, std::span<const CauseSpec> specs,
                   std::span<const Matrix3d> end_by_phi_W, double false_alarm_rate,
                   const Vector3d& end_by_depth_scale_W) {
  Diagnosis d = Diagnoser(solved, specs, false_alarm_rate, end_by_depth_scale_W).Run(end_by_phi_W);
  LookAgain(solved, specs, end_by_phi_W, false_alarm_rate, d);
  return d;
}

}  // namespace wellgyro
