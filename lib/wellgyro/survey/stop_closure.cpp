#include "wellgyro/survey/stop_closure.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "wellgyro/base/angle.h"
#include "wellgyro/estimate/rivals.h"

namespace wellgyro {
namespace {

constexpr double kTells = 1e-3;  // of a variance, from which a stop has said something of it

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

void CloseOnWhole(std::span<const FixAtNode> fixes, std::span<const AttitudeSample> whole,
                  std::vector<NorthFix>& listed) {
  for (const FixAtNode& at : fixes) {
    if (!at.roll_hidden || at.node > whole.size()) continue;
    const auto told = std::find_if(listed.begin(), listed.end(), [&at](const NorthFix& fix) {
      return !fix.external && fix.from_samples && fix.begin == at.fix.begin;
    });
    if (told == listed.end()) continue;
    const AttitudeSample& run = whole[at.node - 1];
    const double alone = told->cov_attitude(1, 1), gained = alone - run.cov_attitude(1, 1);
    const bool doubtful = Has(told->quality, Quality::kMirror | Quality::kVertical);
    if (doubtful || !run.azimuth_known || !(gained > kTells * alone)) continue;
    told->closure = WrapPi(told->azimuth - run.azimuth);
    told->sigma_closure = std::sqrt(gained);
    told->chi_square = told->closure * told->closure / gained;
  }
}

}  // namespace wellgyro
