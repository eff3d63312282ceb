#include "wellgyro/estimate/second_order.h"

#include <complex>

#include "wellgyro/math/plane.h"
#include "wellgyro/math/sinc.h"

namespace wellgyro {
namespace {

using Complex = std::complex<double>;
constexpr Complex kI(0, 1);

/// Products of f_x, f_y, f_z in the order xx, yy, zz, xy, yz, zx.
struct Products {
  Complex turned[6];  ///< mean of e^{i psi} times each
  double mean[6];
};

Products ProductsOf(const Increment& inc) {
  const Complex F = ComplexOf(inc.force_M.head<2>()),
                unit = ComplexOf(inc.ForceBy(kAccelBiasX).head<2>()),
                fx = ComplexOf(inc.ForceBy(kAccelScaleX).head<2>()),
                fy = -kI * ComplexOf(inc.ForceBy(kAccelScaleY).head<2>());
  const double z = inc.force_M.z(), square = std::norm(F);
  const double roll = inc.roll(), ahead = inc.roll_after - inc.roll_before;
  const Complex thrice = Sinc(1.5 * roll) * std::polar(1., 1.5 * ahead);
  // Means of e^{i psi} f^2 and of e^{i psi} conj(f)^2, with f = F e^{-i psi} the force across in T.
  const Complex with = F * F * std::conj(unit), against = std::conj(F * F) * thrice;
  const Complex cosine = 0.5 * (with + against), sine = -0.5 * kI * (with - against);
  const Complex twice = F * std::conj(2. * fx - F);
  const double x = inc.ForceBy(kAccelMisalignmentZX).z(), y = inc.ForceBy(kAccelMisalignmentZY).z();
  return {{0.5 * (square * unit + cosine), 0.5 * (square * unit - cosine), z * z * unit, 0.5 * sine,
           z * fy, z * fx},
          {0.5 * (square + twice.real()), 0.5 * (square - twice.real()), z * z, 0.5 * twice.imag(),
           z * y, z * x}};
}

}  // namespace

Eigen::Matrix<double, 3, kSecondOrderSources> ForceBySecondOrder(const Increment& inc) {
  const Products products = ProductsOf(inc);
  Eigen::Matrix<double, 3, kSecondOrderSources> by_error;
  for (int p = 0; p < 6; ++p) {
    const Complex of_x = products.turned[p], of_y = kI * of_x;
    by_error.col(p) << of_x.real(), of_x.imag(), 0;
    by_error.col(6 + p) << of_y.real(), of_y.imag(), 0;
    by_error.col(12 + p) << 0, 0, products.mean[p];
  }
  return by_error;
}

}  // namespace wellgyro
