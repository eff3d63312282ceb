#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "wellgyro/estimate/knot_rows.h"
#include "wellgyro/estimate/layout.h"
#include "wellgyro/estimate/linear_run.h"
#include "wellgyro/estimate/node.h"
#include "wellgyro/estimate/setup.h"
#include "wellgyro/plan/plan_case.h"
#include "wellgyro/plan/run_so_far.h"
#include "wellgyro/record/run_knot.h"

namespace wellgyro {

/// The rows that the estimator would make of a run as planned: its own factors, linear about the
/// path of the plan, for increments of perfect sensors. No sample is made; what they say of the
/// unknowns depends on where the tool is and how it turns, not on what it happens to read.
///
/// Knots are of 10 s at rest.
class SyntheticRun : public RunRows {
 public:
  /// `stops` in any order, those of no length marking a node only. `setup` is taken but for site
  /// and ties. Throws as CheckPlanCase().
  SyntheticRun(const PlanCase& c, std::span<const PlannedStop> stops, EstimateSetup setup,
               const KnotLength& knots = {});
  /// What is left of a run of which so much is known, by its setup; that must outlive this object.
  /// The hole goes on to depart from its plan as it does there, a sliding tool to swing as planned.
  SyntheticRun(const PlanCase& c, std::span<const PlannedStop> stops, const RunSoFar& so_far,
               const KnotLength& knots = {});
  SyntheticRun(const SyntheticRun&) = delete;
  SyntheticRun& operator=(const SyntheticRun&) = delete;

  const Layout& layout() const override { return layout_; }
  std::size_t size() const override { return knots_.size(); }
  void FirstRows(EdgeMatrix& information, EdgeVector& gradient) const override;
  void RowsOf(std::size_t k, std::vector<Factor>& rows) override;
  void BlockOf(std::size_t k, NormalBlock& block) override;

  std::span<const RunKnot> knots() const { return knots_; }
  std::span<const Node> nodes() const { return nodes_; }
  double seconds() const { return seconds_; }  ///< of the whole run
  /// The node at which each stop is begun, in the order given.
  std::span<const std::size_t> stop_nodes() const { return stop_nodes_; }
  /// The gyros' factor of one knot of rest of `kRestKnot` seconds at this node, its attitude being
  /// the node's at both ends.
  Factor RestAt(std::size_t node);
  /// [s]: at rest the information grows with the time, however it is cut.
  static constexpr double kRestKnot = kStopGrain;

 private:
  void AddWay(std::span<const PlannedStop> stops, bool up);
  void AddMove(double to_md, double speed);
  void AddRest(double seconds);
  void AddTurn(double toolface);
  double ToolfaceNow() const;
  Eigen::Vector3d HoleTangent(double md) const;
  void AddKnot(double seconds, double to_md, double roll, bool still);
  void AddTies(std::size_t node, NormalBlock& block, int at) const;
  void MakeIncrements();

  const PlanCase& case_;
  const KnotLength longest_;
  const RunState* before_ = nullptr;
  /// Turns the hole's direction as planned to what it is where `before_` stands [rad].
  Eigen::Vector3d departs_L_ = Eigen::Vector3d::Zero();
  EstimateSetup setup_;
  Layout layout_;
  std::vector<RunKnot> knots_;
  std::vector<Node> nodes_;
  std::vector<double> rolls_;  ///< of each knot about the hole's axis, in the hole [rad]
  std::vector<KnotPlace> places_;
  std::vector<std::size_t> stop_nodes_;
  double seconds_ = 0, moving_ = 0;
  KnotRows rows_;
  NormalBlock block_;
};

/// The unknowns and noise that the estimator is set up with for such a run; what a fault may make
/// wrong that the tool is taken to be free of is an unknown too, see EstimateRun().
EstimateSetup SetupOfPlan(const PlanCase& c);

}  // namespace wellgyro
