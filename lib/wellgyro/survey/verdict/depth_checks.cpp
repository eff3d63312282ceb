#include "wellgyro/survey/verdict/depth_checks.h"

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <span>

#include "wellgyro/base/units.h"
#include "wellgyro/survey/verdict/check_internal.h"

namespace wellgyro {
namespace {

// Relative deviation from a unit's own ratio within which a scale is that unit's: accelerometers
// and a cable are off by some per cent, starts and stops tell it to half of this (kToldScale). The
// next unit is off by a factor of three.
constexpr double kOtherUnit = 0.15;
// Six sigmas of the ratio, over it, below which it is judged.
constexpr double kToldScale = kOtherUnit / 2;

bool TellsScale(const DepthMotion::Found& found) {
  const double size = std::max(std::abs(found.scale), 0.1);
  return found.sigma_scale > 0 && found.sigma_scale < kToldScale * size / 6;
}

bool IsNearScale(double scale, double unit) { return std::abs(scale / unit - 1) < kOtherUnit; }

/// Marks in another unit or of another sign; nothing where the scale is that of none.
std::optional<Check> WrongUnit(const DepthMotion::Found& found, std::optional<double> lean,
                               std::int32_t run) {
  Check check = NotDone("depth_unit", run, "depths in feet are taken for metres");
  check.verdict = Verdict::kFail;
  check.value = found.scale;
  check.sigma = found.sigma_scale;
  check.unit = "1";
  if (IsNearScale(found.scale, 1 / units::kFoot)) return check;
  check.limit_source = "depths in metres are taken for feet";
  if (IsNearScale(found.scale, units::kFoot)) return check;
  if (!IsNearScale(found.scale, -1)) return std::nullopt;
  const bool up = lean && *lean > 0;
  check.code = up ? "tool_upside_down" : "depth_reversed";
  check.limit_source = up ? "f_z at rest points down, and the tool speeds up against the depth"
                          : "the tool speeds up against the depth";
  return check;
}

/// A check of axes or of the accelerometers' unit failed: the felt motion then means nothing.
bool FeelsWrong(std::span<const Check> checks, std::int32_t run) {
  return std::ranges::any_of(checks, [run](const Check& c) {
    const bool of_force = c.code == "accel_unit" || c.code.starts_with("axes");
    return c.run == run && of_force && c.verdict == Verdict::kFail;
  });
}

void AddJump(const DepthMotion::Found& found, std::int32_t run, std::vector<Check>& checks) {
  constexpr double kStep = 0.2;  // less is no matter [m]: 0.07 deg in a hole of 10 deg/30 m
  // Marks off by half a resolution each make 1/2 (1 + 3 + 3 + 1) / 2 of it of the third difference.
  const double limit = std::max({kStep, 8 * found.sigma_step, 2 * found.resolution});
  checks.push_back(CompareWith("depth_jump", run, {found.step, found.sigma_step}, limit, 1, "m",
                               "8 sigma of the marks, two of their steps, 0.2 m"));
  checks.back().md = found.step_md;
}

void AddLag(const DepthAgainstMotion& felt, std::int32_t run, std::vector<Check>& checks) {
  const DepthMotion::Found& found = felt.found;
  constexpr double kLag = 0.1;      // less is no matter [s]: 0.1 m at 1 m/s
  constexpr double kToldLag = 0.1;  // sigma of a lag that says something [s]: kLag at most
  if (!(found.sigma_lag > 0 && found.sigma_lag < kToldLag)) {
    checks.push_back(NotDone("depth_lag", run, "no starts and stops that tell it"));
    return;
  }
  // An error of the clocks' tie is the same at every start and stop: it is a lag of the marks.
  const double sigma = std::hypot(found.sigma_lag, felt.sigma_utc);
  checks.push_back(CompareWith("depth_lag", run, {found.lag, sigma}, kLag + 5 * sigma, 1, "s",
                               felt.sigma_utc > 0
                                   ? "0.1 s and 5 sigma of starts, stops and the tie of the clocks"
                                   : "0.1 s and 5 sigma of starts and stops"));
}

}  // namespace

void AddDepthChecks(const DepthAgainstMotion& felt, std::int32_t run, std::vector<Check>& checks) {
  const DepthMotion::Found& found = felt.found;
  const auto not_done = [&](std::initializer_list<const char*> codes, const char* why) {
    for (const char* code : codes) checks.push_back(NotDone(code, run, why));
  };
  if (FeelsWrong(checks, run)) {
    not_done({"depth_unit", "depth_jump", "depth_lag"},
             "first axes and accelerometers must be right");
    return;
  }
  const std::optional<Check> wrong =
      TellsScale(found) ? WrongUnit(found, felt.lean, run) : std::nullopt;
  if (wrong) {
    checks.push_back(*wrong);
    not_done({"depth_jump", "depth_lag"}, "first depth must be in its unit");
    return;
  }
  if (TellsScale(found)) {
    checks.push_back(NotDone("depth_unit", run, "no other unit fits starts and stops"));
    checks.back().verdict = Verdict::kPass;
    checks.back().value = found.scale;
    checks.back().sigma = found.sigma_scale;
    checks.back().unit = "1";
  } else {
    not_done({"depth_unit"}, "no starts and stops that tell it");
  }
  if (found.sigma_step > 0) {
    AddJump(found, run, checks);
  } else {
    not_done({"depth_jump"}, "too few marks along samples");
  }
  AddLag(felt, run, checks);
}

}  // namespace wellgyro
