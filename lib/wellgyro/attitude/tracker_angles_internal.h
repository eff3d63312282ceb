#pragma once

#include <cmath>

/// Angles of one sample, to the last bits that a sum over hours needs, faster than the library's.
namespace wellgyro::tracker {

// atan2(s, c) where s^2 + c^2 = 1, to 1e-12 of it.
inline double Phase(double s, double c) {
  if (c <= 0 || std::abs(s) > 0.05) return std::atan2(s, c);
  const double q = s * s;
  return s + s * q * ((1. / 6 + q * (3. / 40)) + q * q * (5. / 112));
}

// atan2(a, b), to 1e-12 of it.
inline double NearAngle(double a, double b) {
  if (!(std::abs(a) < 0.05 * b)) return std::atan2(a, b);
  const double t = a / b, q = t * t;
  return t - t * q * ((1. / 3 - q * (1. / 5)) + q * q * (1. / 7));
}

// (x/2) / sin(x/2): what a mean over a period that turns by x falls short of. To 1e-9 up to 0.15,
// to 1e-6 up to pi/2.
inline double InverseSinc(double x) {
  const double q = x * x, q2 = q * q;
  const double small = 1 + q * (1. / 24 + q * (7. / 5760));
  if (q < 0.0225) return small;
  return small + q2 * q * ((31. / 967680 + q * (127. / 154828800)) + q2 * 2.08386e-8);
}

// Mean of u sin(x u) over [-1/2, 1/2] by the mean of cos(x u): (1 - x/2 cot(x/2)) / x.
inline double FirstMoment(double x) {
  const double q = x * x;
  return x * ((1. / 12 + q * (1. / 720)) + q * q * (1. / 30240 + q * (1. / 1209600)));
}

// (s, c) turned by d.
inline void Turn(double d, double& s, double& c) {
  double sd, cd;
  if (std::abs(d) < 0.02) {  // to 3e-11
    const double q = d * d;
    sd = d - d * q * (1. / 6);
    cd = 1 - q * (0.5 - q * (1. / 24));
  } else {
    sd = std::sin(d);
    cd = std::cos(d);
  }
  const double turned = s * cd + c * sd;
  c = c * cd - s * sd;
  s = turned;
}

}  // namespace wellgyro::tracker
