#include "wellgyro/survey/verdict/checks.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string>
#include <utility>

#include <fmt/core.h>

#include "wellgyro/base/angle.h"
#include "wellgyro/base/units.h"
#include "wellgyro/calibration/field_checks.h"
#include "wellgyro/earth/grid.h"
#include "wellgyro/math/square.h"
#include "wellgyro/survey/hole/field_practice.h"
#include "wellgyro/survey/stations/choose.h"
#include "wellgyro/survey/verdict/check_internal.h"
#include "wellgyro/survey/verdict/depth_slip.h"
#include "wellgyro/survey/verdict/run_checks_internal.h"
#include "wellgyro/survey/verdict/run_diagnosis.h"
#include "wellgyro/survey/verdict/tie_in_check.h"

namespace wellgyro {
namespace {

void CheckFixes(const Job& job, const RunSummary& run, std::vector<Check>& checks) {
  bool earth_rate = false, compared = false;
  for (const NorthFix& fix : run.fixes) {
    if (fix.chi_square && !Has(fix.quality, Quality::kVertical)) {
      compared = true;
      Check closure =
          Compare("azimuth_closure", run.run, {std::sqrt(*fix.chi_square), 1}, 3.0, 1, "1");
      closure.md = fix.md;
      closure.limit_source = "3 sigma of the run against the fix";
      closure.looks = 1;
      checks.push_back(closure);
    }
    if (fix.external) continue;
    Check gravity = Compare("gravity", run.run, {fix.gravity - fix.gravity_ref, fix.sigma_gravity},
                            job.acceptance.gravity, 1, "m/s2");
    gravity.md = fix.md;
    checks.push_back(gravity);
    if (!fix.earth_rate) continue;
    earth_rate = true;
    Check rate =
        Compare("earth_rate", run.run, {*fix.earth_rate - fix.earth_rate_ref, fix.sigma_earth_rate},
                job.acceptance.earth_rate, units::kDegPerHour, "deg/h");
    rate.md = fix.md;
    checks.push_back(rate);
  }
  if (!compared) checks.push_back(NotDone("azimuth_closure", run.run, "no two independent norths"));
  const bool none = std::all_of(run.fixes.begin(), run.fixes.end(),
                                [](const NorthFix& fix) { return fix.external; });
  if (none) checks.push_back(NotDone("gravity", run.run, "no stop long enough"));
  if (!earth_rate) {
    checks.push_back(NotDone("earth_rate", run.run,
                             none
                                 ? "no stop long enough"
                                 : "the errors that the job allows the gyros hide the Earth's rate "
                                   "at every stop: index positions or a third axis show it"));
  }
}

/// Of one run and pass, by depth.
std::vector<const Station*> StationsOf(std::span<const Station> stations, std::int32_t run,
                                       Pass pass) {
  std::vector<const Station*> found;
  for (const Station& s : stations) {
    if (s.run == run && s.pass == pass && s.status != StationStatus::kRejected) found.push_back(&s);
  }
  std::ranges::stable_sort(found, {}, [](const Station* s) { return s->md; });
  return found;
}

/// The pairs of stations at one depth, one of each.
template <class Take>
void ForPairs(std::span<const Station* const> first, std::span<const Station* const> second,
              Take take) {
  for (const Station* s : first) {
    const auto at = std::ranges::lower_bound(second, s->md - kSameDepth, {},
                                             [](const Station* x) { return x->md; });
    if (at != second.end() && (*at)->md <= s->md + kSameDepth) take(*s, **at);
  }
}

/// Variance of a station's angle (1: inclination, 2: azimuth), with what its depth error adds to it
/// where the hole turns.
double AngleVariance(const Station& s, int angle) {
  const double sine = angle == 2 ? std::max(std::sin(s.inclination), 1e-3) : 1.0;
  const double slope = s.dogleg_severity / sine;
  return s.cov_md_inc_azi(angle, angle) + slope * slope * s.cov_md_inc_azi(0, 0);
}

/// A_b - A_a with the sigma that puts it in the ratio of its lateral chord
///   v = (sin I_a + sin I_b) sin((A_b - A_a) / 2)
/// to the tangents' sigma across the bisector of the azimuths. |v| is no more than the chord of the
/// tangents, and normal where these lean by many sigmas; by one, 2.9e-4 exceed four sigmas, normal
/// errors 6.3e-5. An azimuth itself exceeds any. The depth's error moves a tangent by the hole's
/// turn.
Measured AzimuthDifference(const Station& a, const Station& b) {
  const double half = WrapPi(b.azimuth - a.azimuth) / 2, middle = a.azimuth + half;
  const Eigen::Vector3d across_L(-std::sin(middle), std::cos(middle), 0);
  double variance = 0;
  for (const Station* s : {&a, &b}) {
    variance += across_L.dot(s->cov_tangent_L * across_L) +
                Square(s->dogleg_severity) * s->cov_md_inc_azi(0, 0);
  }
  const double per_chord = (half == 0 ? 1 : half / std::sin(half)) * 2 /
                           (std::sin(a.inclination) + std::sin(b.inclination));
  return {2 * half, std::sqrt(variance) * per_chord};
}

/// The pair with the largest |difference| / sigma, var = var_a + var_b. Two passes of one tool
/// share instrument errors: in a difference these cancel where they have one sign in both passes.
void CheckPasses(const Job& job, std::span<const Station* const> first,
                 std::span<const Station* const> second, std::int32_t run, const std::string& name,
                 std::vector<Check>& checks) {
  struct Worst {
    Measured difference;
    double md = 0;
    void Take(const Measured& other, double at) {
      if (std::abs(other.value) * difference.sigma < std::abs(difference.value) * other.sigma) {
        return;
      }
      difference = other;
      md = at;
    }
  };
  Worst inclination, azimuth;
  int pairs = 0;
  ForPairs(first, second, [&](const Station& a, const Station& b) {
    ++pairs;
    const double var_inclination = AngleVariance(a, 1) + AngleVariance(b, 1);
    inclination.Take({b.inclination - a.inclination, std::sqrt(var_inclination)}, a.md);
    if (Has(a.quality | b.quality, Quality::kVertical)) return;
    azimuth.Take(AzimuthDifference(a, b), a.md);
  });
  if (pairs == 0) {
    checks.push_back(NotDone("inclination_" + name, run, "no depth seen in both passes"));
    checks.push_back(NotDone("azimuth_" + name, run, "no depth seen in both passes"));
    return;
  }
  const auto add = [&](const std::string& code, const Worst& worst,
                       const std::optional<double>& accepted) {
    Check check = Compare(code + name, run, worst.difference, accepted, units::kDeg, "deg");
    check.md = worst.md;
    // Errors are correlated along the hole: at most so many pairs count as independent trials.
    check.looks = accepted ? 0 : std::min(pairs, kIndependentPairs);
    checks.push_back(check);
  };
  add("inclination_", inclination, job.acceptance.inclination_difference);
  add("azimuth_", azimuth, job.acceptance.azimuth_difference);
}

/// Field practice; but at low inclination azimuths that may differ by more without a fault tell
/// nothing.
void CheckPractice(std::span<const Station* const> in, std::span<const Station* const> out,
                   std::int32_t run, std::vector<Check>& checks) {
  namespace practice = field_practice;
  constexpr double kInclination = FromDegrees(practice::kInclinationDeg);
  constexpr double kLow = FromDegrees(practice::kSteepDeg);
  struct Worst {
    double value = 0, limit = 0, md = 0;
    int pairs = 0;
    void Take(double v, double l, double at) {
      ++pairs;
      if (limit > 0 && std::abs(v) * limit <= std::abs(value) * l) return;
      value = v;
      limit = l;
      md = at;
    }
  };
  Worst inclination, azimuth;
  ForPairs(in, out, [&](const Station& a, const Station& b) {
    inclination.Take(b.inclination - a.inclination, kInclination, a.md);
    if (Has(a.quality | b.quality, Quality::kVertical)) return;
    const bool low = a.inclination < kLow;
    const double limit = FromDegrees(low ? practice::kLowAzimuthDeg : practice::kAzimuthDeg);
    const double sigma = std::sqrt(AngleVariance(a, 2) + AngleVariance(b, 2));
    if (low && 3 * sigma > limit) return;
    azimuth.Take(WrapPi(b.azimuth - a.azimuth), limit, a.md);
  });
  const auto add = [&](const char* code, const Worst& worst, const char* too_few) {
    if (worst.pairs < practice::kDepths) {
      checks.push_back(NotDone(code, run, too_few));
      return;
    }
    checks.push_back(Compare(code, run, {worst.value, 0}, worst.limit, units::kDeg, "deg"));
    checks.back().sigma.reset();
    checks.back().limit_source = "field practice";
    checks.back().md = worst.md;
  };
  const char* const few = "fewer than 10 depths seen in both passes";
  add("inclination_in_out_practice", inclination, few);
  add("azimuth_in_out_practice", azimuth,
      inclination.pairs < practice::kDepths
          ? few
          : "fewer than 10 depths where the azimuth is sure enough");
}

/// A run against itself, on its way out and in its repeat section, and against the runs before it.
void CheckAgainstOthers(const Job& job, const CheckInputs& inputs, const RunSummary& run,
                        std::vector<Check>& checks) {
  const auto of = [&](std::int32_t number, Pass pass) {
    return StationsOf(inputs.passes, number, pass);
  };
  const std::vector<const Station*> in = of(run.run, Pass::kIn), out = of(run.run, Pass::kOut);
  CheckPasses(job, in, out, run.run, "in_out", checks);
  CheckPractice(in, out, run.run, checks);
  CheckPasses(job, in, of(run.run, Pass::kRepeat), run.run, "repeat", checks);
  std::vector<const Station*> before;
  for (const RunSummary& other : inputs.runs) {
    if (other.run == run.run) break;
    const std::vector<const Station*> theirs = of(other.run, Pass::kIn);
    if (!other.misrun) before.insert(before.end(), theirs.begin(), theirs.end());
  }
  if (!before.empty() && !run.misrun) CheckPasses(job, before, in, run.run, "runs", checks);
}

/// Depth lost on the way there and back, per kilometre of way, against field practice.
void CheckSlippage(const CheckInputs& inputs, const ReturnToZero& back,
                   std::vector<Check>& checks) {
  double deepest = 0;
  for (const Station& s : inputs.passes) {
    if (s.run == back.run) deepest = std::max(deepest, s.md);
  }
  const double way = 2 * (deepest - back.value_md);
  if (!back.read_md || !(way > 0)) {
    checks.push_back(NotDone("depth_slippage", back.run, "no way known from zero and back"));
    return;
  }
  const double slip = (*back.read_md - back.value_md) / way;
  checks.push_back(Compare("depth_slippage", back.run, {slip, back.sigma / way},
                           field_practice::kSlippage, 1e-3, "m/km"));
  checks.back().limit_source = "field practice";
}

void CheckForesights(const Job& job, const CheckInputs& inputs, std::vector<Check>& checks) {
  if (inputs.foresights.empty()) {
    checks.push_back(NotDone("foresight", 0, "no foresight taken"));
  }
  for (const Foresight& foresight : inputs.foresights) {
    if (!foresight.measured) {
      checks.push_back(NotDone("foresight", foresight.run,
                               "the run has no azimuth at the time of the foresight"));
      continue;
    }
    const Measured difference{WrapPi(*foresight.measured - foresight.stated),
                              std::hypot(foresight.sigma_measured, foresight.sigma_stated)};
    checks.push_back(Compare("foresight", foresight.run, difference, job.acceptance.foresight,
                             units::kDeg, "deg"));
  }
}

void CheckReturns(const Job& job, const CheckInputs& inputs, std::vector<Check>& checks) {
  if (inputs.returns.empty()) {
    checks.push_back(NotDone("depth_closure", 0, "no return to zero noted"));
  }
  for (const ReturnToZero& back : inputs.returns) {
    if (!back.read_md) {
      checks.push_back(NotDone("depth_closure", back.run, "no depth at the return to zero"));
      continue;
    }
    CheckSlippage(inputs, back, checks);
    const Measured difference{*back.read_md - back.value_md,
                              std::hypot(back.sigma, job.errors.depth_sigma)};
    if (difference.sigma > 0 || job.acceptance.depth_closure) {
      checks.push_back(
          Compare("depth_closure", back.run, difference, job.acceptance.depth_closure, 1, "m"));
    } else {
      checks.push_back(NotDone("depth_closure", back.run,
                               "no limit: give acceptance.depth_closure_m or depth_sigma_m"));
      checks.back().value = difference.value;
      checks.back().unit = "m";
    }
  }
}

/// What the counter loses or gains between two magnetic marks.
void CheckMarks(const Job& job, const CableMarks* marks, std::vector<Check>& checks) {
  const Cable& cable = job.depth.cable;
  if (cable.mark_spacing <= 0 || marks == nullptr || marks->passed() < 2) {
    checks.push_back(NotDone("magnetic_marks", 0, "no two magnetic marks passed"));
    return;
  }
  const double sigma = std::sqrt(2.0) * cable.sigma_mark;
  const double limit = 1e-3 * cable.mark_spacing + 3 * sigma;
  checks.push_back(Compare("magnetic_marks", 0, {marks->largest_change(), sigma}, limit, 1, "m"));
  checks.back().limit_source = "3 sigma of two marks and 1 in 1000 of slip between them";
  if (marks->left_out() > 0) {
    checks.push_back(CountOf("magnetic_marks_left_out", 0, marks->left_out(),
                             "every mark within a quarter of the spacing"));
  }
}

/// Nothing in a run tells the scale of its depth; its sigma stands in every station's.
void CheckDepthScale(const Job& job, const CableMarks* marks, std::vector<Check>& checks) {
  if (marks != nullptr && job.depth.cable.mark_spacing > 0 && marks->passed() >= 2) return;
  checks.push_back(NotDone("depth_scale", 0,
                           fmt::format("unverified: no magnetic marks passed; {:g} of depth stands "
                                       "in every sigma",
                                       job.errors.depth_scale_sigma)));
}

void CheckRefused(const Job& job, const MarksRefused& refused, std::vector<Check>& checks) {
  checks.push_back(CountOf("depth_refused", 0, refused.all(),
                           refused.late > 0
                               ? fmt::format("marks in time: [depth] latency_s = {} is too "
                                             "little, or their clock is behind",
                                             job.depth.latency)
                               : "every mark is a depth near its neighbours"));
}

void CheckGrid(const Job& job, std::vector<Check>& checks) {
  if (!job.grid || (!job.grid->convergence && !job.grid->scale)) {
    checks.push_back(NotDone("grid_convergence", 0, "the job states no convergence"));
    return;
  }
  const GridPoint head = ProjectToGrid(*job.grid, job.well.latitude, job.well.longitude);
  if (job.grid->convergence) {
    Check check = Compare("grid_convergence", 0, {*job.grid->convergence - head.convergence, 0},
                          0.01 * units::kDeg, units::kDeg, "deg");
    check.limit_source = "stated against the projection's own at the well head";
    checks.push_back(check);
  }
  if (job.grid->scale) {
    Check check = Compare("grid_scale", 0, {*job.grid->scale - head.scale, 0}, 1e-5, 1, "1");
    check.limit_source = "stated against the projection's own at the well head";
    checks.push_back(check);
  }
}

void CheckNoise(const Job& job, std::vector<Check>& checks) {
  if (job.noise_stated) return;
  checks.push_back(
      NotDone("noise_stated", 0, "give [noise]: taken as that of the example tools of SPE 90408"));
  checks.back().verdict = Verdict::kWarn;
}

/// Where marks are far apart, as [depth] max_gap_s may allow, depth between them is a guess at how
/// the tool moved: a warning where that is worse than the depths that the job states.
void CheckDepthSure(const Job& job, const RunSummary& run, const CheckInputs& inputs,
                    std::vector<Check>& checks) {
  constexpr double kLeast = 1;  // [m], as winches and pipe give it where they move
  const Station* worst = nullptr;
  for (const Station& s : inputs.passes) {
    if (s.run != run.run || s.kind != StationKind::kContinuous) continue;
    if (!worst || s.cov_md_inc_azi(0, 0) > worst->cov_md_inc_azi(0, 0)) worst = &s;
  }
  if (!worst) return;
  const double way = worst->md - job.tie_in.md;
  const double stated = std::hypot(job.errors.depth_sigma, job.errors.depth_scale_sigma * way);
  Check check = CompareWith("depth_unsure", run.run, {std::sqrt(worst->cov_md_inc_azi(0, 0)), 0},
                            3 * std::max(stated, kLeast), 1, "m",
                            "three sigmas of depth as the job states it: marks are too far apart");
  if (check.verdict == Verdict::kFail) check.verdict = Verdict::kWarn;
  check.md = worst->md;
  checks.push_back(check);
}

/// Time without depth; and hole that marks of the same time reached, of which there is no station,
/// as of a tool whose UTC has jumped ahead of them.
void CheckDepthKnown(const Job& job, const RunSummary& run, const CheckInputs& inputs,
                     std::vector<Check>& checks) {
  if (run.samples == 0 && !(run.seconds_without_depth > 0)) return;
  Check unknown = Compare("depth_unknown", run.run, {run.seconds_without_depth, 0}, 0.0, 1, "s");
  unknown.limit_source = "marks no further apart than [depth] max_gap_s";
  const bool lacks = unknown.verdict == Verdict::kFail;
  if (lacks) {
    unknown.verdict = Verdict::kWarn;
    unknown.limit_source +=
        fmt::format(" = {}, and no later than latency_s = {}: raise what is too little for them",
                    job.depth.max_gap, job.depth.latency);
  }
  checks.push_back(unknown);
  CheckDepthSure(job, run, inputs, checks);
  // Stations that are asked for one by one have a check of their own.
  const bool evenly = job.stations.every > 0 && job.stations.at.empty();
  if (!lacks || !inputs.deepest_mark || !evenly) return;
  double deepest = job.tie_in.md;
  for (const Station& station : inputs.passes) deepest = std::max(deepest, station.md);
  const double limit = std::max(units::kStand, 2 * job.stations.every);
  checks.push_back(Compare("depth_without_station", run.run, {*inputs.deepest_mark - deepest, 0},
                           limit, 1, "m"));
  checks.back().limit_source =
      fmt::format("marks reach {:.2f} m, stations {:.2f} m: look at the UTC of samples and marks",
                  *inputs.deepest_mark, deepest);
}

}  // namespace

Check CheckAsked(const Job& job, std::span<const Station> chosen) {
  int missing = 0;
  std::optional<double> first;
  for (double md : job.stations.at) {
    if (md <= job.tie_in.md + kSameDepth) continue;
    const bool there = std::any_of(chosen.begin(), chosen.end(), [md](const Station& s) {
      return s.kind != StationKind::kTieIn && std::abs(s.md - md) <= kSameDepth;
    });
    if (there) continue;
    ++missing;
    if (!first) first = md;
  }
  Check check = CountOf("stations_asked", 0, missing, "every depth asked for has a station");
  check.md = first;
  return check;
}

std::vector<Check> MakeChecks(const Job& job, const CheckInputs& inputs) {
  std::vector<Check> checks;
  for (const RunSummary& run : inputs.runs) {
    // What the samples themselves say comes first: other checks fail of it too, and blame others.
    checks.insert(checks.end(), run.sample_checks.begin(), run.sample_checks.end());
    if (job.tool && (job.tool->calibrated || job.tool->expires)) {
      checks.push_back(CheckCalibrationDate(*job.tool, run.begin));
      checks.back().run = run.run;
    }
    if (run.slip) checks.push_back(CheckSlip(*run.slip, run.run));
    CheckDiagnosis(run, inputs.passes, checks);
    CheckFixes(job, run, checks);
    checks.insert(checks.end(), run.stop_checks.begin(), run.stop_checks.end());
    CheckStops(job, run, checks);
    CheckAgainstOthers(job, inputs, run, checks);
    checks.push_back(CountOf("samples_lost", run.run, run.samples_lost, "none may be lost"));
    CheckDepthKnown(job, run, inputs, checks);
    CheckSamples(job, run, checks);
    CheckFit(job, run, checks);
  }
  CheckReturns(job, inputs, checks);
  CheckRefused(job, inputs.marks_refused, checks);
  CheckMarks(job, inputs.marks, checks);
  CheckDepthScale(job, inputs.marks, checks);
  CheckForesights(job, inputs, checks);
  CheckGrid(job, checks);
  checks.push_back(CheckTieIn(job, inputs.passes, inputs.runs));
  if (job.tie_in.md > 0) checks.push_back(CheckTieInPlace(job.tie_in));
  CheckNoise(job, checks);
  return checks;
}

}  // namespace wellgyro
