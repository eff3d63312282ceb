#include "wellgyro/survey/run/stop_closure.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "wellgyro/base/angle.h"
#include "wellgyro/math/square.h"
#include "wellgyro/record/decides.h"

namespace wellgyro {
namespace {

// Of a variance, from which a stop has said something of it: there its closure has a sigma of
// 1 / sqrt(kTells) = 32 times what was known.
constexpr double kTells = 1e-3;

void Take(const NorthClosure& closure, NorthFix& fix) {
  fix.chi_square.reset();
  fix.closure = closure.angle;
  fix.sigma_closure = closure.sigma;
  if (closure.sigma > 0) fix.chi_square = Square(closure.angle / closure.sigma);
}

}  // namespace

void ChooseBranch(const AttitudeSample& before, NorthFix& fix) {
  if (!fix.mirror_azimuth) return;
  const double var = fix.cov_attitude(1, 1) + before.cov_attitude(1, 1);
  const auto cost = [&](double azimuth) {
    const double off = WrapPi(azimuth - before.azimuth);
    return off * off / var;
  };
  const double more = cost(*fix.mirror_azimuth) + fix.mirror_cost - cost(fix.azimuth);
  if (std::abs(more) <= kDecides) {
    fix.quality |= Quality::kMirror;
    return;
  }
  fix.quality = Without(fix.quality, Quality::kMirror);
  if (more > 0) return;
  std::swap(fix.azimuth, *fix.mirror_azimuth);
  fix.mirror_cost = -fix.mirror_cost;
}

void CloseOn(const AttitudeSample& before, const AttitudeSample& after, NorthFix& fix) {
  const double known = before.cov_attitude(1, 1), gained = known - after.cov_attitude(1, 1);
  if (!(gained > kTells * known)) return;
  const double step = WrapPi(after.azimuth - before.azimuth);
  fix.chi_square = step * step / gained;
  fix.closure = step * known / gained;
  fix.sigma_closure = known / std::sqrt(gained);
}

void CloseOnOutside(const AttitudeSample& before, NorthFix& tie) {
  if (!before.azimuth_known) return;
  tie.closure = WrapPi(tie.azimuth - before.azimuth);
  tie.sigma_closure = std::sqrt(tie.cov_attitude(1, 1) + before.cov_attitude(1, 1));
  tie.chi_square = tie.closure * tie.closure / (tie.sigma_closure * tie.sigma_closure);
}

void CloseOnWhole(const RunHistory& history, const SmoothedRun& run,
                  std::vector<NorthFix>& listed) {
  if (run.closures.size() != history.fixes.size() + history.ties.size()) return;
  auto closure = run.closures.begin();
  for (const FixAtNode& at : history.fixes) {
    const auto told = std::find_if(listed.begin(), listed.end(), [&at](const NorthFix& fix) {
      return !fix.external && fix.from_samples && fix.begin == at.fix.begin;
    });
    if (told != listed.end()) {
      const AttitudeSample& whole = run.attitude[at.node - 1];
      if (whole.azimuth_known) ChooseBranch(whole, *told);
      Take(*closure, *told);
    }
    ++closure;
  }
  auto next = listed.begin();
  for (const AzimuthTie& tie : history.ties) {
    const NorthClosure& of_tie = *closure++;
    if (tie.node == 0) continue;  // it is where the run begins, and not listed
    next = std::find_if(next, listed.end(), [](const NorthFix& fix) { return fix.external; });
    if (next == listed.end()) return;
    Take(of_tie, *next++);
  }
}

}  // namespace wellgyro
