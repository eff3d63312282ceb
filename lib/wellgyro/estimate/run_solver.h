#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <initializer_list>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "wellgyro/estimate/elimination.h"
#include "wellgyro/estimate/knot_rows.h"
#include "wellgyro/estimate/layout.h"
#include "wellgyro/estimate/linear_run.h"
#include "wellgyro/estimate/node.h"
#include "wellgyro/estimate/run_state.h"
#include "wellgyro/estimate/setup.h"
#include "wellgyro/record/run_knot.h"

namespace wellgyro {

/// How a run was solved.
struct SolveReport {
  bool converged = false;
  int iterations = 0;
  /// -2 ln of the density of the measurements with the unknowns integrated out, but for constants:
  /// what two starts or two roll walks are compared by.
  double evidence = 0;
  std::array<RowSum, kRowKinds> sums{};
  double roll_walk = 0;  ///< found [rad/s/sqrt(s)]
};

/// Start of the search for the scales of the roll's random walk.
struct RollBegin {
  /// Random walk of the roll rate [rad/s/sqrt(s)]: the lesser of this and RollWalkBy().
  double walk = HUGE_VAL;
  /// Share of SpeedStarts() in the sigma of the roll rate's change [1]; sought where such a start
  /// is hidden from gravity. From a share of 1 the robust weights of the demonstration's starts
  /// take fifty steps to settle.
  double share = 1e-2;

  bool operator==(const RollBegin&) const = default;
};
/// The least share [1]: it leaves the roll rate 1e-4 rad/s over 10 s, less than the gyros' noise
/// shows.
inline constexpr double kShareLeast = 1e-4;

/// Starts of the solver for these knots; the solution of greatest evidence counts. The evidence has
/// local maxima. About a large walk the roll rates follow the gyros' noise: times the
/// misalignments they explain that noise, and with a lean of the tool the accelerometers'. Biases
/// are then five sigmas off, and no smaller walk nearby has as much evidence. From a small walk a
/// swing is not found. So both are tried.
std::vector<RollBegin> RollBeginsOf(std::span<const RunKnot> knots);

/// All unknowns of one run: attitudes on SO(3) at the ends of its knots, drift, motion along the
/// hole, and the tool's constant errors, by Gauss-Newton over whitened factors.
///
/// Regular at every inclination: no coordinate of an attitude is an angle. Time and memory are
/// proportional to the knots.
class RunSolver : public RunRows {
 public:
  /// `knots` must outlive this object; at least one. Of a part of a run: what is known where it
  /// begins, by the same layout; it must outlive this object too.
  RunSolver(const EstimateSetup& setup, std::span<const RunKnot> knots,
            const RunState* before = nullptr);
  RunSolver(const RunSolver&) = delete;
  RunSolver& operator=(const RunSolver&) = delete;

  /// Places every node by a forward pass from this attitude of node 0, see GuessPass, with
  /// HiddenRoll() of the knots.
  void Begin(const Eigen::Matrix3d& R_LT, std::span<const double> hidden_roll);
  /// Goes into the minimum about where it stands, with the roll's scales as they begin, near enough
  /// to know it. False: there is none within `iterations` steps.
  bool Approach(int iterations, const RollBegin& begin = {});
  /// After Approach(): seeks the roll's scales and relinearises until the attitudes stay. Not to
  /// the end where the evidence stays above `least`.
  SolveReport Settle(double least = HUGE_VAL);
  /// Of the last linearisation, see SolveReport.
  double Evidence() const;
  /// The last step was of less than a sigma over all unknowns together.
  bool IsNear() const;
  /// Takes the gyros' and the accelerometers' white noise so many times as large as before and goes
  /// on from where it stands. False: it does not converge.
  bool SolveWithNoise(double gyro, double accel);

  const Layout& layout() const override { return layout_; }
  const EstimateSetup& setup() const { return setup_; }
  const RunState* before() const { return before_; }
  std::span<const RunKnot> knots() const { return knots_; }
  std::vector<Node>& nodes() { return nodes_; }
  const std::vector<Node>& nodes() const { return nodes_; }
  const BorderVector& border() const { return border_; }
  /// Of the last linearisation.
  const Elimination& elimination() const { return elimination_; }

  /// Sums up residuals anew, knot by knot in any order, each with the covariances of the nodes at
  /// its ends with the border: as they stand, and what the unknowns absorb of them.
  void BeginMeasure() { block_.ClearSums(); }
  void Measure(std::size_t knot, const EdgeMatrix& begin, const EdgeMatrix& end,
               const BehindMatrix& begin_with_end);
  const std::array<RowSum, kRowKinds>& sums() const { return block_.sums(); }

  /// Stands where `other` does, which has solved the same knots: what its setup lacks is zero.
  void TakeOver(const RunSolver& other);

  // Of the last linearisation.
  std::size_t size() const override { return knots_.size(); }
  void FirstRows(EdgeMatrix& information, EdgeVector& gradient) const override;
  void RowsOf(std::size_t knot, std::vector<Factor>& rows) override;
  void BlockOf(std::size_t knot, NormalBlock& block) override;

 private:
  /// Scales that are sought together, all of one size.
  using Scales = std::initializer_list<double*>;

  bool Linearise();
  void AddTies(std::size_t node, NormalBlock& block, int at_next);
  void Step(const std::vector<NodeVector>& steps, const BorderVector& border_step, double share);
  void BeginScales(const RollBegin& begin);
  double WalkOfUnseen(std::size_t knot) const;
  double Walk(std::size_t knot, double walk) const;
  RollChange Change(std::size_t knot) const;
  void HoldRollWeights();
  bool Advance(SolveReport& report);
  void Finish(double least, SolveReport& report);
  bool Iterate(int most, double stays, SolveReport& report, double creeps = HUGE_VAL);
  double EvidenceOf(double tried, double least, Scales scales, SolveReport& report);
  double FindDecade(double least, double most, Scales scales, SolveReport& report);
  void FindBetween(double evidence, double& scale, SolveReport& report);
  std::vector<double> Swung() const;
  std::vector<double> RollRates() const;
  void FindWalks(SolveReport& report);

  EstimateSetup setup_;
  Layout layout_;
  std::span<const RunKnot> knots_;
  const RunState* before_;
  std::vector<Node> nodes_;
  std::vector<KnotPlace> places_;
  BorderVector border_;
  RunScales scales_;
  KnotRows rows_;
  NormalBlock block_;
  Elimination elimination_;
  std::vector<NodeVector> steps_, last_steps_;
};

}  // namespace wellgyro
