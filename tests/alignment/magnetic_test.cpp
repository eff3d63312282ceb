#include "wellgyro/alignment/magnetic.h"

#include <cmath>
#include <vector>

#include <Eigen/Core>
#include <gtest/gtest.h>

#include "wellgyro/base/angle.h"

namespace wellgyro {
namespace {

/// By components on high side, right side and axis; north is the field's.
StillWindow Window(double inclination, double azimuth, double toolface, double dip) {
  const double ci = std::cos(inclination), si = std::sin(inclination);
  const double ca = std::cos(azimuth), sa = std::sin(azimuth);
  const double ct = std::cos(toolface), st = std::sin(toolface);
  const auto in_tool = [&](double n, double d) {
    const double high = ci * ca * n - si * d, right = -sa * n, along = si * ca * n + ci * d;
    return Eigen::Vector3d(ct * high + st * right, -st * high + ct * right, along);
  };
  StillWindow window;
  window.f_T = in_tool(0, -9.81);
  window.b_T = 5e-5 * in_tool(std::cos(dip), std::sin(dip));
  window.has_mag = true;
  return window;
}

TEST(MagneticAzimuth, IsTheAxisFromTheFieldInTheLevel) {
  for (const double dip : {-1.2, 0.0, 1.3}) {
    for (const double inclination : {0.02, 0.7, kPi / 2, 2.2}) {
      for (const double azimuth : {0.1, 1.6, 3.0, 5.9}) {
        const std::vector<StillWindow> windows{Window(inclination, azimuth, 0.5, dip),
                                               Window(inclination, azimuth, 3.9, dip)};
        const auto found = MagneticAzimuth(windows);
        ASSERT_TRUE(found.has_value());
        EXPECT_NEAR(*found, azimuth, 1e-12);
      }
    }
  }
}

TEST(MagneticAzimuth, IsAbsentWhereNothingPoints) {
  const auto none = [](const StillWindow& window) {
    return !MagneticAzimuth({&window, 1}).has_value();
  };
  StillWindow window = Window(0.7, 1, 0.5, 1.2);
  EXPECT_FALSE(none(window));
  EXPECT_TRUE(none(Window(0, 1, 0.5, 1.2))) << "the axis is vertical";
  EXPECT_TRUE(none(Window(0.7, 1, 0.5, kPi / 2))) << "the field is vertical";
  window.has_mag = false;
  EXPECT_TRUE(none(window));
  window.has_mag = true;
  window.f_T.setZero();
  EXPECT_TRUE(none(window));
}

}  // namespace
}  // namespace wellgyro
