// What is made of a plan that was read: a simulated run, and a case for advice.
#include <cmath>
#include <stdexcept>

#include "wellgyro/base/angle.h"
#include "wellgyro/io/toml/plan_file.h"

namespace wellgyro {
namespace {

/// Lays out the steps of a run one after the other.
class Steps {
 public:
  explicit Steps(const PlannedWay& way) : way_(way) {
    run_.start_md = md_ = way.begin_md;
    run_.start_toolface = way.toolface;
  }

  void MoveTo(double md, double speed) {
    const double seconds = std::abs(md - md_) / speed;
    if (seconds == 0) return;
    run_.steps.emplace_back(
        RunMove{.to_md = md, .speed = speed, .roll = PlannedRoll(way_, moving_)});
    md_ = md;
    moving_ += seconds;
  }
  void Rest(const PlannedStop& stop) {
    RunStop rest;
    rest.seconds = stop.seconds;
    rest.toolface = stop.toolface;
    rest.turns_back = true;
    run_.steps.emplace_back(rest);
  }
  const SimulatedRun& run() const { return run_; }

 private:
  const PlannedWay& way_;
  SimulatedRun run_;
  double md_ = 0, moving_ = 0;
};

}  // namespace

RunRoll PlannedRoll(const PlannedWay& way, double moved) {
  if (way.roll_rate != 0) return {.rate = way.roll_rate};
  return {.amplitude = way.swing,
          .period = way.swing_period,
          .phase = kTwoPi * moved / way.swing_period,
          .rests_there = true};
}

SimulatedRun RunOf(const PlanFile& plan) {
  const PlannedWay& way = plan.way;
  Steps steps(way);
  bool up = false;
  for (const PlannedStop& stop : plan.stops) {
    if (stop.out && !up) steps.MoveTo(way.end_md, way.speed_in);
    up = up || stop.out;
    steps.MoveTo(stop.md, up ? way.speed_out : way.speed_in);
    steps.Rest(stop);
  }
  if (!up) steps.MoveTo(way.end_md, way.speed_in);
  if (way.speed_out > 0) steps.MoveTo(way.begin_md, way.speed_out);
  return steps.run();
}

PlanCase CaseOf(const PlanFile& plan, const Job& job) {
  if (plan.path.empty()) throw std::invalid_argument("the plan has no [path] of the well");
  if (!(plan.limits.ellipse > 0)) throw std::invalid_argument("the plan has no limits.ellipse_m");
  std::vector<double> md, inclination, azimuth;
  for (const WellPoint& p : plan.path) {
    md.push_back(p.md);
    inclination.push_back(p.inclination);
    azimuth.push_back(p.azimuth);
  }
  PlanCase c{.well = Trajectory(md, inclination, azimuth, {0, 0, md.front()}),
             .site = SiteAt(job.well.latitude, job.well.datum_elevation),
             .gyro = job.noise,
             .errors = job.errors,
             .third_axis = job.tool && job.tool->gyro.n_channels > 2,
             .way = plan.way};
  if (job.alignment.method == AlignmentSpec::Method::kExternal) {
    c.sigma_start_azimuth = job.alignment.sigma_azimuth;
  }
  CheckPlanCase(c, plan.stops);
  return c;
}

}  // namespace wellgyro
