#include "wellgyro/uncertainty/weight.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "wellgyro/uncertainty/weight_more_internal.h"

namespace wellgyro {
namespace {

using P = WeightPlace;
using Eigen::Vector3d;
using D = Dimension;
using R = WeightRole;
constexpr auto kXyz = GyroAxes::kXyz;
constexpr auto kXy = GyroAxes::kXy;
constexpr auto kZ = GyroAxes::kZ;

constexpr Weights Depth(double w) { return {w, 0, 0}; }

// Depth, sag: SPE 67616. Misalignment: SPE 90408 table 9, alternative 3.
constexpr WeightFunction kDepthAndAlignment[] = {
    {"DREF", D::kLength, R::kPlain, {}, [](const P&) { return Depth(1); }},
    {"DSF", D::kRatio, R::kPlain, {}, [](const P& p) { return Depth(p.md); }},
    {"DST", D::kPerLength, R::kPlain, {}, [](const P& p) { return Depth(p.md * p.tvd); }},
    {"SAG", D::kAngle, R::kPlain, {}, [](const P& p) { return Inc(p.sin_inc); }},
    {"VSAG", D::kAngle, R::kPlain, {}, [](const P& p) { return Inc(p.sin_inc); }},
    {"SAGE",
     D::kAngle,
     R::kPlain,
     {},
     [](const P& p) { return Inc(std::sqrt(std::sqrt(p.sin_inc))); }},
    {"XYM1", D::kAngle, R::kPlain, {}, [](const P& p) { return Inc(std::abs(p.sin_inc)); }},
    {"XYM2", D::kAngle, R::kPlain, {}, [](const P&) { return Azi(-1); }},
};

// A misalignment towards north or east, told by the hole's direction: the same for XYM3 and XYM4,
// and for their Rev 5 forms up to the factor of short courses.
Weights TowardsNorth(const P& p) {
  const double c = std::abs(p.cos_inc);
  return {0, c * p.cos_azi, -c * p.sin_azi / p.sin_inc};
}
Weights TowardsEast(const P& p) {
  const double c = std::abs(p.cos_inc);
  return {0, c * p.sin_azi, c * p.cos_azi / p.sin_inc};
}
Vector3d TrueNorth(const P& p) { return {p.cos_convergence, -p.sin_convergence, 0}; }
Vector3d TrueEast(const P& p) { return {p.sin_convergence, p.cos_convergence, 0}; }

double ShortCourse(const P& p) {
  constexpr double kShortest = 0.1;  // m; shorter ones are doubled stations (Definition 5.13)
  const bool is_short = p.course > kShortest && p.course < p.min_course_length;
  return is_short ? std::sqrt(p.min_course_length / p.course) : 1;
}
Weights Times(double factor, Weights w) {
  return {factor * w.md, factor * w.inclination, factor * w.azimuth};
}

constexpr WeightFunction kMisalignment[] = {
    {"XYM3", D::kAngle, R::kPlain, {}, TowardsNorth, TrueNorth},
    {"XYM4", D::kAngle, R::kPlain, {}, TowardsEast, TrueEast},
    {"XYM3E",
     D::kAngle,
     R::kShortCourse,
     {},
     [](const P& p) { return Times(ShortCourse(p), TowardsNorth(p)); },
     [](const P& p) -> Vector3d { return ShortCourse(p) * TrueNorth(p); }},
    {"XYM4E",
     D::kAngle,
     R::kShortCourse,
     {},
     [](const P& p) { return Times(ShortCourse(p), TowardsEast(p)); },
     [](const P& p) -> Vector3d { return ShortCourse(p) * TrueEast(p); }},
};

// Course length, SPE 187249: what a leg may have done between its stations.
Vector3d CourseAzimuth(const P& p) {
  const double swing = std::abs(p.sin_inc * std::sin(p.azimuth_change));
  const double size = p.course * std::max(swing, p.tortuosity * p.course);
  return {-size * p.sin_hole, size * p.cos_hole, 0};
}
Vector3d CourseInclination(const P& p) {
  const double build = std::abs(p.inclination - p.previous_inclination);
  const double size = p.course * std::max(build, p.tortuosity * p.course);
  return size * Vector3d(p.cos_inc * p.cos_hole, p.cos_inc * p.sin_hole, -p.sin_inc);
}

constexpr WeightFunction kCourseLength[] = {
    {"XCLA", D::kRatio, R::kCourse, {}, nullptr, CourseAzimuth},
    {"XCLH", D::kRatio, R::kCourse, {}, nullptr, CourseInclination},
};

// Accelerometers, SPE 90408 tables 1 and 2. The canted tool is turned over above 90 deg.
double Canted(const P& p) { return p.inclination - (p.cos_inc >= 0 ? p.cant : -p.cant); }
double CosCanted(const P& p) { return std::cos(Canted(p)); }

constexpr WeightFunction kAccelerometers[] = {
    {"AXYZ-XYB",
     D::kAcceleration,
     R::kPlain,
     {},
     [](const P& p) { return Inc(p.cos_inc / p.gravity); }},
    {"AXYZ-ZB",
     D::kAcceleration,
     R::kPlain,
     {},
     [](const P& p) { return Inc(p.sin_inc / p.gravity); }},
    {"AXYZ-SF",
     D::kRatio,
     R::kPlain,
     {},
     [](const P& p) { return Inc(1.3 * p.sin_inc * p.cos_inc); }},
    {"AXYZ-MS", D::kAngle, R::kPlain, {}, [](const P&) { return Inc(1); }},
    {"AXYZ-MIS", D::kAngle, R::kPlain, {}, [](const P&) { return Inc(1); }},
    {"AXY-B",
     D::kAcceleration,
     R::kCantedAccel,
     {},
     [](const P& p) { return Inc(1 / (p.gravity * CosCanted(p))); },
     nullptr,
     CosCanted},
    {"AXY-SF",
     D::kRatio,
     R::kCantedAccel,
     {},
     [](const P& p) { return Inc(std::tan(Canted(p))); },
     nullptr,
     CosCanted},
    {"AXY-MS", D::kAngle, R::kPlain, {}, [](const P&) { return Inc(1); }},
    {"AXY-MIS", D::kAngle, R::kPlain, {}, [](const P&) { return Inc(1); }},
    {"AXY-GB",
     D::kAccelerationPerG,
     R::kCantedAccel,
     {},
     [](const P& p) { return Inc(std::tan(Canted(p)) / p.gravity); },
     nullptr,
     CosCanted},
};

// Gyrocompass with three gyro axes, SPE 90408 table 3.
constexpr WeightFunction kGyroXyz[] = {
    {"GXYZ-XYB1", D::kRate, R::kStationary, kXyz,
     [](const P& p) { return Azi(p.sin_azi * p.cos_inc / p.horizontal_earth_rate); }},
    {"GXYZ-XYB2", D::kRate, R::kStationary, kXyz,
     [](const P& p) { return Azi(p.cos_azi / p.horizontal_earth_rate); }},
    {"GXYZ-XYRN", D::kRate, R::kStationaryNoise, kXyz,
     [](const P& p) {
       const double s = p.sin_azi * p.sin_inc;
       return Azi(std::sqrt(std::max(0.0, 1 - s * s)) / p.horizontal_earth_rate);
     }},
    {"GXYZ-XYG1", D::kRatePerG, R::kStationary, kXyz,
     [](const P& p) { return Azi(p.cos_azi * p.sin_inc / p.horizontal_earth_rate); }},
    {"GXYZ-XYG2", D::kRatePerG, R::kStationary, kXyz,
     [](const P& p) { return Azi(p.cos_azi * p.cos_inc / p.horizontal_earth_rate); }},
    {"GXYZ-XYG3", D::kRatePerG, R::kStationary, kXyz,
     [](const P& p) { return Azi(p.sin_azi * p.cos_inc * p.cos_inc / p.horizontal_earth_rate); }},
    {"GXYZ-XYG4", D::kRatePerG, R::kStationary, kXyz,
     [](const P& p) { return Azi(p.sin_azi * p.sin_inc * p.cos_inc / p.horizontal_earth_rate); }},
    {"GXYZ-ZB", D::kRate, R::kStationary, kXyz,
     [](const P& p) { return Azi(p.sin_azi * p.sin_inc / p.horizontal_earth_rate); }},
    {"GXYZ-ZRN", D::kRate, R::kStationaryNoise, kXyz,
     [](const P& p) { return Azi(p.sin_azi * p.sin_inc / p.horizontal_earth_rate); }},
    {"GXYZ-ZG1", D::kRatePerG, R::kStationary, kXyz,
     [](const P& p) { return Azi(p.sin_azi * p.sin_inc * p.sin_inc / p.horizontal_earth_rate); }},
    {"GXYZ-ZG2", D::kRatePerG, R::kStationary, kXyz,
     [](const P& p) { return Azi(p.sin_azi * p.sin_inc * p.cos_inc / p.horizontal_earth_rate); }},
    {"GXYZ-SF", D::kRatio, R::kStationary, kXyz,
     [](const P& p) { return Azi(p.tan_latitude * p.sin_azi * p.sin_inc * p.cos_inc); }},
    {"GXYZ-MIS", D::kAngle, R::kStationary, kXyz,
     [](const P& p) { return Azi(1 / p.cos_latitude); }},
};

// Gyrocompass with two, SPE 90408 table 4.
double CosInc(const P& p) { return p.cos_inc; }
double TanInc(const P& p) { return p.sin_inc / p.cos_inc; }

constexpr WeightFunction kGyroXy[] = {
    {"GXY-B1", D::kRate, R::kStationary, kXy,
     [](const P& p) { return Azi(p.sin_azi / (p.horizontal_earth_rate * p.cos_inc)); }, nullptr,
     CosInc},
    {"GXY-B2", D::kRate, R::kStationary, kXy,
     [](const P& p) { return Azi(p.cos_azi / p.horizontal_earth_rate); }, nullptr, CosInc},
    {"GXY-RN", D::kRate, R::kStationaryNoise, kXy,
     [](const P& p) {
       const double s = p.cos_azi * p.sin_inc;
       return Azi(std::sqrt(std::max(0.0, 1 - s * s)) / (p.horizontal_earth_rate * p.cos_inc));
     },
     nullptr, CosInc},
    {"GXY-G1", D::kRatePerG, R::kStationary, kXy,
     [](const P& p) { return Azi(p.cos_azi * p.sin_inc / p.horizontal_earth_rate); }, nullptr,
     CosInc},
    {"GXY-G2", D::kRatePerG, R::kStationary, kXy,
     [](const P& p) { return Azi(p.cos_azi * p.cos_inc / p.horizontal_earth_rate); }, nullptr,
     CosInc},
    {"GXY-G3", D::kRatePerG, R::kStationary, kXy,
     [](const P& p) { return Azi(p.sin_azi / p.horizontal_earth_rate); }, nullptr, CosInc},
    {"GXY-G4", D::kRatePerG, R::kStationary, kXy,
     [](const P& p) { return Azi(p.sin_azi * TanInc(p) / p.horizontal_earth_rate); }, nullptr,
     CosInc},
    {"GXY-SF", D::kRatio, R::kStationary, kXy,
     [](const P& p) { return Azi(p.tan_latitude * p.sin_azi * TanInc(p)); }, nullptr, CosInc},
    {"GXY-MIS", D::kAngle, R::kStationary, kXy,
     [](const P& p) { return Azi(1 / (p.cos_latitude * p.cos_inc)); }, nullptr, CosInc},
};

// External reference and continuous gyros, SPE 90408 tables 5 to 8.
constexpr WeightFunction kExternalAndContinuous[] = {
    {"EXT-REF", D::kAngle, R::kExternal, {}, [](const P&) { return Azi(1); }},
    {"EXT-TIE", D::kAngle, R::kExternal, {}, [](const P&) { return Azi(1); }},
    {"EXT-MIS",
     D::kAngle,
     R::kExternalAtTie,
     {},
     [](const P& p) { return Azi(1 / p.tie_sin_inc); },
     nullptr,
     [](const P& p) { return p.tie_sin_inc; }},
    {"GXYZ-GD", D::kRate, R::kDrift, kXyz, nullptr},
    {"GXYZ-GRW", D::kAngleWalk, R::kWalk, kXyz, nullptr},
    {"GXY-GD", D::kRate, R::kDrift, kXy, nullptr},
    {"GXY-GRW", D::kAngleWalk, R::kWalk, kXy, nullptr},
    {"GXYZ-GRR", D::kRateWalk, R::kRateWalk, kXyz, nullptr},
    {"GXYZ-GR", D::kRateRamp, R::kRamp, kXyz, nullptr},
    {"GXY-GRR", D::kRateWalk, R::kRateWalk, kXy, nullptr},
    {"GXY-GR", D::kRateRamp, R::kRamp, kXy, nullptr},
    {"GZ-GRR", D::kRateWalk, R::kRateWalk, kZ, nullptr},
    {"GZ-GR", D::kRateRamp, R::kRamp, kZ, nullptr},
    {"GZ-GD", D::kRate, R::kDrift, kZ, nullptr},
    {"GZ-GRW", D::kAngleWalk, R::kWalk, kZ, nullptr},
};

// Magnetic tools, toolface-independent: SPE 67616 as revised (ISCWSA MWD Rev 4 and 5.1).

Weights MagneticZ(const P& p) { return Azi(-p.sin_inc * p.sin_mag / p.horizontal_field); }
Weights AccelScale(const P& p, double share) {
  const double sc = p.sin_inc * p.cos_inc;
  return {0, share * sc, -share * p.tan_dip * sc * p.sin_mag};
}

constexpr WeightFunction kMagnetic[] = {
    {"ABXY-TI1",
     D::kAcceleration,
     R::kMagnetic,
     {},
     [](const P& p) {
       return Weights{0, -p.cos_inc / p.gravity, p.cos_inc * p.tan_dip * p.sin_mag / p.gravity};
     }},
    {"ABXY-TI2",
     D::kAcceleration,
     R::kMagnetic,
     {},
     [](const P& p) { return Azi((p.cos_inc / p.sin_inc - p.tan_dip * p.cos_mag) / p.gravity); },
     [](const P& p) -> Vector3d { return Vector3d(-p.sin_hole, p.cos_hole, 0) / p.gravity; }},
    {"ABZ",
     D::kAcceleration,
     R::kMagnetic,
     {},
     [](const P& p) {
       return Weights{0, -p.sin_inc / p.gravity, p.sin_inc * p.tan_dip * p.sin_mag / p.gravity};
     }},
    {"ASXY-TI1", D::kRatio, R::kMagnetic, {}, [](const P& p) { return AccelScale(p, kHalfSqrt2); }},
    {"ASXY-TI2", D::kRatio, R::kMagnetic, {}, [](const P& p) { return AccelScale(p, 0.5); }},
    {"ASXY-TI3",
     D::kRatio,
     R::kMagnetic,
     {},
     [](const P& p) { return Azi((p.tan_dip * p.sin_inc * p.cos_mag - p.cos_inc) / 2); }},
    {"ASZ", D::kRatio, R::kMagnetic, {}, [](const P& p) { return AccelScale(p, -1); }},
    {"MBXY-TI1",
     D::kField,
     R::kMagnetic,
     {},
     [](const P& p) { return Azi(-p.cos_inc * p.sin_mag / p.horizontal_field); }},
    {"MBXY-TI2",
     D::kField,
     R::kMagnetic,
     {},
     [](const P& p) { return Azi(p.cos_mag / p.horizontal_field); }},
    {"MBZ", D::kField, R::kMagnetic, {}, MagneticZ},
    {"MSXY-TI1",
     D::kRatio,
     R::kMagnetic,
     {},
     [](const P& p) {
       return Azi(p.sin_inc * p.sin_mag * kHalfSqrt2 *
                  (p.tan_dip * p.cos_inc + p.sin_inc * p.cos_mag));
     }},
    {"MSXY-TI2",
     D::kRatio,
     R::kMagnetic,
     {},
     [](const P& p) {
       return Azi(
           p.sin_mag / 2 *
           (p.tan_dip * p.sin_inc * p.cos_inc - p.cos_inc * p.cos_inc * p.cos_mag - p.cos_mag));
     }},
    {"MSXY-TI3",
     D::kRatio,
     R::kMagnetic,
     {},
     [](const P& p) {
       return Azi((p.cos_inc * (p.cos_mag * p.cos_mag - p.sin_mag * p.sin_mag) -
                   p.tan_dip * p.sin_inc * p.cos_mag) /
                  2);
     }},
    {"MSZ",
     D::kRatio,
     R::kMagnetic,
     {},
     [](const P& p) {
       return Azi(-(p.sin_inc * p.cos_mag + p.tan_dip * p.cos_inc) * p.sin_inc * p.sin_mag);
     }},
    {"AMIL", D::kField, R::kMagnetic, {}, MagneticZ},
    {"AZ", D::kAngle, R::kPlain, {}, [](const P&) { return Azi(1); }},
    {"DEC", D::kAngle, R::kPlain, {}, [](const P&) { return Azi(1); }},
    {"DBH",
     D::kAngleField,
     R::kMagnetic,
     {},
     [](const P& p) { return Azi(1 / p.horizontal_field); }},
};

template <std::size_t... N>
constexpr auto Join(const WeightFunction (&... tables)[N]) {
  std::array<WeightFunction, (N + ...)> all{};
  auto* end = all.begin();
  ((end = std::ranges::copy(tables, end).out), ...);
  return all;
}

constexpr auto kAll = Join(kDepthAndAlignment, kMisalignment, kCourseLength, kAccelerometers,
                           kGyroXyz, kGyroXy, kExternalAndContinuous, kMagnetic);

}  // namespace

const WeightFunction* FindWeight(std::string_view code) {
  const auto* found = std::ranges::find(kAll, code, &WeightFunction::code);
  if (found != kAll.end()) return found;
  const auto more = MoreWeights();
  const auto other = std::ranges::find(more, code, &WeightFunction::code);
  return other == more.end() ? nullptr : &*other;
}

}  // namespace wellgyro
