#include "wellgyro/io/exchange/witness_internal.h"

#include <algorithm>
#include <cmath>
#include <string>

#include <fmt/core.h>

#include "wellgyro/io/exchange/line_reader_internal.h"
#include "wellgyro/io/exchange/witness_case_internal.h"

namespace wellgyro {
namespace witness {

bool Case::Open(Column column) const {
  return std::find(claims.open.begin(), claims.open.end(), column) != claims.open.end();
}

void Case::Refuse(std::string text) const {
  throw TextError{{.code = FaultCode::kConflict, .text = std::move(text), .source = source}};
}

bool Tells(const LineFit& fit) { return fit.pairs > 0 && fit.reach > 1e-3 && fit.sigma < 0.05; }
bool Tells(const PlaneFit& fit) {
  return fit.pairs > 0 && fit.reach > 1 && fit.sigma < 0.05 * std::abs(fit.z);
}

bool MirrorTells(const PlaneFit& fit) {
  return fit.pairs > 0 && fit.reach > 1 && fit.mirrored_sigma < 0.05 * std::abs(fit.mirrored);
}

Ratio RatioOf(double factor, double tolerance) {
  const auto is = [&](double wanted) { return std::abs(factor / wanted - 1) <= tolerance; };
  if (is(1)) return Ratio::kSame;
  if (is(1 / 0.3048)) return Ratio::kFeetAsMetres;
  if (is(0.3048)) return Ratio::kMetresAsFeet;
  return Ratio::kOther;
}

}  // namespace witness

void Witness(SurveyTable& table, const Claims& claims, const std::string& source) {
  // Of longer surveys legs are joined: so many tell a factor of lengths as well as all would, in a
  // time that does not grow.
  constexpr std::size_t kMostStretches = 2048;
  if (claims.position_log) return;
  witness::Case c{table, claims, source, {}, {}, {}, 0};
  if (table.rows() < 2) {
    if (!claims.md_unit) witness::SettleUnits(c);
    return;
  }
  c.stretches = witness::StretchesOf(table, c.method, kMostStretches);
  witness::SettleUnits(c);
  c.stretches = witness::StretchesOf(table, c.method, kMostStretches);
  witness::SettleMethod(c);
  witness::CheckVertical(c);
  witness::CheckPlane(c);
  if (c.agreeing.empty()) {
    const bool some = table.Has(Column::kTvd) || table.Has(Column::kNorth) ||
                      table.Has(Column::kNorthing) || table.Has(Column::kDown);
    c.Note(std::string("nothing in the file checks its depths and directions: ") +
           (some ? "its positions are too few or too near" : "it has no positions beside them"));
    return;
  }
  witness::CheckCells(c);
  std::string what;
  for (const std::string& each : c.agreeing) what += (what.empty() ? "" : ", ") + each;
  c.Note(fmt::format("MD, inclination and azimuth agree by {} with {}", WordOf(c.method), what));
  witness::CheckWhole(c);
}

}  // namespace wellgyro
