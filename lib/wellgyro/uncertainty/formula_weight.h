#pragma once

#include <array>
#include <cstddef>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include <Eigen/Core>

#include "wellgyro/base/export.h"
#include "wellgyro/base/result.h"
#include "wellgyro/uncertainty/expression.h"
#include "wellgyro/uncertainty/weight.h"

namespace wellgyro {

/// What a formula may speak of. First the names of the ISCWSA's sheets and JSON models: Inc, AzT,
/// AzM, Az (true, magnetic, the survey's own), MD, TVD, each ...Prev at the station before (the
/// first: its own), Gfield, Dip, BField, EarthRate, Latitude, NoiseReductionFactor, XCLTortuosity,
/// RAD, k (1 up to 90 deg of inclination, else -1); then those of Compass: azi, tmd, dmd, gtot,
/// mtot, lat, erot (the horizontal Earth rate), mtf (1: all is SI). Angles are radians, fields T,
/// rates rad/s.
enum class FormulaName : std::size_t {
  kInc,
  kAzT,
  kAzM,
  kAz,
  kMd,
  kTvd,
  kIncPrev,
  kAzTPrev,
  kAzMPrev,
  kAzPrev,
  kMdPrev,
  kGfield,
  kDip,
  kBField,
  kRotation,
  kLatitude,
  kNoiseReduction,
  kTortuosity,
  kRad,
  kSide,
  kAzi,
  kTmd,
  kDmd,
  kGtot,
  kMtot,
  kLat,
  kErot,
  kMtf,
  kCount,
};
inline constexpr std::size_t kFormulaNames = static_cast<std::size_t>(FormulaName::kCount);
using FormulaValues = std::array<double, kFormulaNames>;

/// The formulas of one term as they are written; empty: 0.
struct FormulaTexts {
  std::string md, inclination, azimuth;
  std::string north, east, vertical;  ///< at a vertical station, in place of the three above
  std::string lateral;  ///< Compass: across the hole, an azimuth error of this / sin(inclination)
  /// Inclinations outside which the term is 0 [rad].
  double min_inclination = 0, max_inclination = std::numeric_limits<double>::infinity();
};

/// A weighting function that came with a model.
class WELLGYRO_EXPORT FormulaWeight {
 public:
  /// Faults as Expression::Compile, each naming the formula.
  static Result<std::shared_ptr<const FormulaWeight>> Compile(const FormulaTexts& texts);

  /// Not finite where a formula has no value.
  Weights At(std::span<const double> values) const;
  /// At a vertical station: error per metre of course (north, east, down), where it has such.
  bool has_vector() const { return has_vector_; }
  Eigen::Vector3d VectorAt(std::span<const double> values) const;

  /// Whether it speaks of the latitude, or of the magnetic field or azimuth.
  bool needs_latitude() const;
  bool needs_field() const;

 private:
  bool Uses(FormulaName name) const;

  // Depth, inclination, azimuth; north, east, vertical; lateral.
  std::array<std::optional<Expression>, 7> formulas_;
  double min_inclination_ = 0, max_inclination_ = 0;
  bool has_vector_ = false;
};

/// The weighting function of terms that carry a formula of their own.
WELLGYRO_EXPORT const WeightFunction& OwnFormula();

}  // namespace wellgyro
