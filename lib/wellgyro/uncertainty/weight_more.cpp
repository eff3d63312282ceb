#include <cmath>
#include <numbers>

#include "wellgyro/uncertainty/weight_more_internal.h"

namespace wellgyro {
namespace {

using P = WeightPlace;
using Eigen::Vector3d;
using D = Dimension;
using R = WeightRole;

/// The axial field is taken from the model, not measured: all grows towards horizontal east-west,
/// with the square of this, the sine of the angle from there.
double FromEastWest(const P& p) {
  const double s = p.sin_inc * p.sin_mag;
  return std::sqrt(std::max(0.0, 1 - s * s));
}
double SquareAt(const P& p) {
  const double f = FromEastWest(p);
  return f * f;
}
double Field(const P& p) { return p.horizontal_field * std::sqrt(1 + p.tan_dip * p.tan_dip); }
/// tan(dip) cos(I) + sin(I) cos(Am), in nearly all of them.
double Mixed(const P& p) { return p.tan_dip * p.cos_inc + p.sin_inc * p.cos_mag; }
Vector3d Across(const P& p) { return {-p.sin_hole, p.cos_hole, 0}; }

Weights Scale(const P& p, double share) {
  const double azimuth =
      -share * p.sin_inc * p.cos_inc * p.cos_inc * p.sin_mag * Mixed(p) / SquareAt(p);
  return {0, share * p.sin_inc * p.cos_inc, azimuth};
}

constexpr WeightFunction kMore[] = {
    {"ABIXY-TI1",
     D::kAcceleration,
     R::kMagnetic,
     {},
     [](const P& p) {
       const double c = p.cos_inc;
       return Weights{0, -c / p.gravity, c * c * p.sin_mag * Mixed(p) / (p.gravity * SquareAt(p))};
     },
     nullptr,
     FromEastWest},
    {"ABIXY-TI2",
     D::kAcceleration,
     R::kMagnetic,
     {},
     [](const P& p) {
       const double cot = p.cos_inc / p.sin_inc;
       return Azi(-(p.tan_dip * p.cos_mag - cot) / (p.gravity * SquareAt(p)));
     },
     [](const P& p) -> Vector3d { return Across(p) / p.gravity; },
     FromEastWest},
    {"ABIZ",
     D::kAcceleration,
     R::kMagnetic,
     {},
     [](const P& p) {
       const double azimuth = p.sin_inc * p.cos_inc * p.sin_mag * Mixed(p) / SquareAt(p);
       return Weights{0, -p.sin_inc / p.gravity, azimuth / p.gravity};
     },
     nullptr,
     FromEastWest},
    {"ASIXY-TI1",
     D::kRatio,
     R::kMagnetic,
     {},
     [](const P& p) { return Scale(p, kHalfSqrt2); },
     nullptr,
     FromEastWest},
    {"ASIXY-TI2",
     D::kRatio,
     R::kMagnetic,
     {},
     [](const P& p) { return Scale(p, 0.5); },
     nullptr,
     FromEastWest},
    {"ASIXY-TI3",
     D::kRatio,
     R::kMagnetic,
     {},
     [](const P& p) {
       return Azi((p.tan_dip * p.sin_inc * p.cos_mag - p.cos_inc) / (2 * SquareAt(p)));
     },
     nullptr,
     FromEastWest},
    {"ASIZ",
     D::kRatio,
     R::kMagnetic,
     {},
     [](const P& p) { return Scale(p, -1); },
     nullptr,
     FromEastWest},
    {"MBIXY-TI1",
     D::kField,
     R::kMagnetic,
     {},
     [](const P& p) { return Azi(-p.cos_inc * p.sin_mag / (p.horizontal_field * SquareAt(p))); },
     nullptr,
     FromEastWest},
    {"MBIXY-TI2",
     D::kField,
     R::kMagnetic,
     {},
     [](const P& p) { return Azi(p.cos_mag / (p.horizontal_field * SquareAt(p))); },
     nullptr,
     FromEastWest},
    {"MSIXY-TI1",
     D::kRatio,
     R::kMagnetic,
     {},
     [](const P& p) { return Azi(p.sin_inc * p.sin_mag * Mixed(p) * kHalfSqrt2 / SquareAt(p)); },
     nullptr,
     FromEastWest},
    {"MSIXY-TI2",
     D::kRatio,
     R::kMagnetic,
     {},
     [](const P& p) {
       const double w =
           p.tan_dip * p.sin_inc * p.cos_inc - p.cos_inc * p.cos_inc * p.cos_mag - p.cos_mag;
       return Azi(p.sin_mag * w / (2 * SquareAt(p)));
     },
     nullptr,
     FromEastWest},
    {"MSIXY-TI3",
     D::kRatio,
     R::kMagnetic,
     {},
     [](const P& p) {
       const double w = p.cos_inc * (p.cos_mag * p.cos_mag - p.sin_mag * p.sin_mag) -
                        p.tan_dip * p.sin_inc * p.cos_mag;
       return Azi(w / (2 * SquareAt(p)));
     },
     nullptr,
     FromEastWest},
    {"MFI",
     D::kField,
     R::kMagnetic,
     {},
     [](const P& p) { return Azi(-p.sin_inc * p.sin_mag * Mixed(p) / (SquareAt(p) * Field(p))); },
     nullptr,
     FromEastWest},
    {"MDI",
     D::kAngle,
     R::kMagnetic,
     {},
     [](const P& p) {
       const double w = p.cos_inc - p.tan_dip * p.sin_inc * p.cos_mag;
       return Azi(-p.sin_inc * p.sin_mag * w / SquareAt(p));
     },
     nullptr,
     FromEastWest},
    {"AMID", D::kAngle, R::kMagnetic, {}, [](const P& p) { return Azi(p.sin_inc * p.sin_mag); }},
    {"CNI", D::kAngle, R::kPlain, {}, [](const P&) { return Inc(1); }},
    {"CNA", D::kAngle, R::kPlain, {}, [](const P& p) { return Azi(1 / p.sin_inc); }, Across},
    // A tool that turns as it surveys: what is left of its cross-axis errors.
    {"ANZ",
     D::kAcceleration,
     R::kMagnetic,
     {},
     [](const P& p) {
       return Weights{0, -p.sin_inc / p.gravity, p.sin_inc * p.sin_mag * p.tan_dip / p.gravity};
     }},
    {"AXY-ATTEN",
     D::kRatio,
     R::kMagnetic,
     {},
     [](const P& p) {
       const double w = p.sin_inc * p.cos_inc;
       return Weights{0, w, -w * p.sin_mag * p.tan_dip};
     }},
    {"MXY-ATTEN",
     D::kRatio,
     R::kMagnetic,
     {},
     [](const P& p) { return Azi(p.sin_inc * p.sin_mag * Mixed(p)); }},
    {"AMXY-PS",
     D::kAngle,
     R::kMagnetic,
     {},
     [](const P& p) { return Azi(p.cos_inc - p.sin_inc * p.cos_mag * p.tan_dip); }},
};

}  // namespace

std::span<const WeightFunction> MoreWeights() { return kMore; }

}  // namespace wellgyro
