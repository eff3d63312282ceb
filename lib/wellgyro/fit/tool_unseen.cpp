#include <algorithm>
#include <cmath>
#include <map>
#include <string>
#include <utility>

#include <Eigen/Core>
#include <fmt/core.h>
#include <fmt/ranges.h>

#include "wellgyro/base/angle.h"
#include "wellgyro/fit/tool_choice_internal.h"
#include "wellgyro/fit/tool_unseen_internal.h"

namespace wellgyro {
namespace {

bool Has(const std::vector<int>& places, std::size_t place) {
  return std::find(places.begin(), places.end(), static_cast<int>(place)) != places.end();
}

bool IsPowerOfTemperature(const TermBundle& bundle) {
  if (bundle.terms.empty() || bundle.after < 0) return false;
  const ToolTerm& term = bundle.terms.front();
  return (term.kind == TermKind::kBias || term.kind == TermKind::kSensitivity) && term.power > 1;
}

// Sensitivity of an accelerometer by the scatter of its readings over that of the nominal force
// [its unit per unit of gravity's]: to misalignments squared, enough for the size of a prior.
double RoughSensitivity(const ToolReadings& readings, const ToolFitSetup& setup, int channel) {
  const int axis = readings.channels[static_cast<std::size_t>(channel)].axis;
  double n = 0, v = 0, vv = 0, u = 0, uu = 0;
  for (const ToolRow& row : readings.rows) {
    const auto at = std::find(row.channels.begin(), row.channels.end(), channel);
    if (at == row.channels.end() || row.mount >= 0) continue;
    const double read = row.v[at - row.channels.begin()];
    const double force = setup.reference.gravity * row.R_BL(axis, 2);
    n += 1;
    v += read;
    vv += read * read;
    u += force;
    uu += force * force;
  }
  const double scatter = uu - u * u / n;
  return scatter > 0 ? std::sqrt(std::max(0.0, vv - v * v / n) / scatter) : 0;
}

double PriorOf(const ToolTerm& term, const ToolReadings& readings, const ToolFitSetup& setup) {
  if (term.kind == TermKind::kForceSquare) return setup.sigma_anisoelastic;
  return setup.sigma_second_order / setup.reference.gravity *
         RoughSensitivity(readings, setup, term.uses.front().channel);
}

// Inclinations of the readings at rest among those every 45 deg.
std::vector<int> MissingInclinations(const ToolReadings& readings) {
  constexpr double kNear = FromDegrees(10);
  std::vector<int> missing;
  for (int inclination = 0; inclination <= 180; inclination += 45) {
    const bool there =
        std::any_of(readings.rows.begin(), readings.rows.end(), [&](const ToolRow& row) {
          const double its = std::atan2(row.R_BL.row(2).head<2>().norm(), row.R_BL(2, 2));
          return row.mount < 0 && std::abs(its - FromDegrees(inclination)) < kNear;
        });
    if (!there) missing.push_back(inclination);
  }
  return missing;
}

std::string WhatWouldTell(const ToolReadings& readings, const ToolTerm& term) {
  if (term.kind != TermKind::kSquare && term.kind != TermKind::kForceSquare) {
    return "read at more temperatures between the ends";
  }
  const std::vector<int> missing = MissingInclinations(readings);
  if (missing.empty()) return "read toolfaces between multiples of 90 deg, as every 60 deg";
  return fmt::format("no position lies at inclination {} deg: read some there",
                     fmt::join(missing, ", "));
}

// The parameters of the tool, without priors, that share the doubt of term k.
std::vector<std::string> Confounded(const ToolModel& model, const ToolAdjustment& a, int k) {
  // Square of a correlation: the share of a parameter's variance that the term's makes.
  constexpr double kShare = 0.25;
  std::vector<std::string> names;
  for (int i = 0; i < model.n_terms(); ++i) {
    const ToolTerm& term = model.terms()[static_cast<std::size_t>(i)];
    const double square = a.cov(i, k) * a.cov(i, k);
    if (term.prior_sigma == 0 && square > kShare * a.cov(i, i) * a.cov(k, k)) {
      names.push_back(term.name);
    }
  }
  return names;
}

}  // namespace

void GivePriors(const ToolReadings& readings, const ToolFitSetup& setup,
                std::vector<TermBundle>& bundles, std::vector<int>& seen) {
  for (std::size_t b = 0; b < bundles.size(); ++b) {
    if (Has(seen, b) || bundles[b].terms.empty()) continue;
    const TermKind kind = bundles[b].terms.front().kind;
    if (kind != TermKind::kSquare && kind != TermKind::kForceSquare) continue;
    for (ToolTerm& term : bundles[b].terms) term.prior_sigma = PriorOf(term, readings, setup);
    bundles[b].needed = true;
    seen.push_back(static_cast<int>(b));
  }
}

bool GivePriorsByPower(const ToolAdjustment& full, std::vector<TermBundle>& bundles,
                       std::vector<int>& seen) {
  const std::vector<int> in_x = seen;
  for (std::size_t b = 0; b < bundles.size(); ++b) {
    if (Has(seen, b) || !IsPowerOfTemperature(bundles[b])) continue;
    const auto base = static_cast<std::size_t>(bundles[b].after);
    if (!Has(seen, base)) continue;
    const auto places = PlacesIn(bundles, in_x, bundles[b].after);
    double sigma = bundles[base].terms.front().prior_sigma;
    if (!places.empty()) {
      sigma = full.x(places).norm() / std::sqrt(static_cast<double>(places.size()));
    }
    if (!(sigma > 0)) continue;
    for (ToolTerm& term : bundles[b].terms) term.prior_sigma = sigma;
    bundles[b].needed = true;
    seen.push_back(static_cast<int>(b));
  }
  return seen.size() > in_x.size();
}

std::vector<std::string> UntoldTerms(const ToolReadings& readings, const ToolModel& model,
                                     const ToolAdjustment& a) {
  std::map<std::string, std::vector<std::string>> names_of;  // by what is said of them
  for (int k = 0; k < model.n_terms(); ++k) {
    const ToolTerm& term = model.terms()[static_cast<std::size_t>(k)];
    // Of the prior's sigma; a bench that tells a term leaves a hundredth.
    constexpr double kLeft = 0.1;
    const double sigma = std::sqrt(std::max(0.0, a.cov(k, k)));
    if (term.kind == TermKind::kDrift || term.prior_sigma == 0) continue;
    if (!(sigma > kLeft * term.prior_sigma)) continue;
    const std::vector<std::string> with = Confounded(model, a, k);
    const std::string from = with.empty() ? "" : fmt::format(" from {}", fmt::join(with, ", "));
    names_of[fmt::format(
                 "these readings hardly tell it{}; it was taken for 0 +- {:.1g} beforehand, and {} "
                 "in doubt by what is left of that; {}",
                 from, term.prior_sigma, with.empty() ? "the tool is" : "they are",
                 WhatWouldTell(readings, term))]
        .push_back(term.name);
  }
  std::vector<std::string> remarks;
  for (const auto& [said, names] : names_of) {
    remarks.push_back(fmt::format("{}: {}", fmt::join(names, ", "), said));
  }
  return remarks;
}

}  // namespace wellgyro
