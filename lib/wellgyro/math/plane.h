#pragma once

#include <complex>

#include <Eigen/Core>

namespace wellgyro {

/// Vectors of a plane as complex numbers, x + i y, so that a turn by psi multiplies by e^{i psi}.
inline std::complex<double> ComplexOf(const Eigen::Ref<const Eigen::Vector2d>& v) {
  return {v.x(), v.y()};
}
inline Eigen::Vector2d VectorOf(std::complex<double> z) { return {z.real(), z.imag()}; }
/// i times it.
inline Eigen::Vector2d QuarterTurned(const Eigen::Ref<const Eigen::Vector2d>& v) {
  return {-v.y(), v.x()};
}

}  // namespace wellgyro
