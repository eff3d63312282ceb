#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "wellgyro/io/exchange/claims_internal.h"
#include "wellgyro/io/exchange/legs_internal.h"

/// The steps of Witness, over one survey.
namespace wellgyro::witness {

/// A survey whose positions are held against its angles, as far as it has been settled.
struct Case {
  SurveyTable& table;
  const Claims& claims;
  const std::string& source;
  std::vector<Stretch> stretches;  ///< by `method`
  Method method = Method::kMinimumCurvature;
  std::vector<std::string> agreeing;  ///< what was found to agree
  double worst = 0;                   ///< typical remainder over a stretch [m]

  /// The file left open in what the column is written.
  bool Open(Column column) const;
  void Note(std::string text) const { table.head.notes.push_back(std::move(text)); }
  /// Throws the Fault kConflict with the file's name.
  [[noreturn]] void Refuse(std::string text) const;
};

/// Whether a fit tells enough to decide by.
bool Tells(const LineFit& fit);
bool Tells(const PlaneFit& fit);
/// The same of its mirror image.
bool MirrorTells(const PlaneFit& fit);

/// What a ratio of lengths says of their units.
enum class Ratio { kSame, kFeetAsMetres, kMetresAsFeet, kOther };
Ratio RatioOf(double factor, double tolerance);

/// Units that the file left open, by what fits; Refuse where they cannot be told.
void SettleUnits(Case& c);
/// The method of calculation that fits best, and whether any does.
void SettleMethod(Case& c);
/// Depths: their rate, and the datum they count from.
void CheckVertical(Case& c);
/// Offsets and map coordinates: their axes, and the norths.
void CheckPlane(Case& c);
/// Single cells that their neighbours contradict; numbers that stand for nothing are taken out.
void CheckCells(Case& c);
/// A note where all legs agree well enough, but their sum does not.
void CheckWhole(Case& c);

}  // namespace wellgyro::witness
