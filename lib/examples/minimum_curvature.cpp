// Positions of a survey by minimum curvature: minimum_curvature
#include "wellgyro/trajectory/minimum_curvature.h"

#include <cstdio>
#include <vector>

#include "wellgyro/base/angle.h"

int main() {
  using wellgyro::FromDegrees;
  const std::vector<double> md{0, 500, 1000, 1500};
  const std::vector<double> inclination{0, FromDegrees(10), FromDegrees(35), FromDegrees(60)};
  const std::vector<double> azimuth{0, FromDegrees(40), FromDegrees(45), FromDegrees(50)};
  std::vector<Eigen::Vector3d> position(md.size());
  std::vector<double> dogleg(md.size());
  wellgyro::MinimumCurvature(md, inclination, azimuth, Eigen::Vector3d::Zero(), position, dogleg);
  for (std::size_t i = 0; i < md.size(); ++i) {
    std::printf("%7.1f m: north %8.2f east %8.2f TVD %8.2f m\n", md[i], position[i].x(),
                position[i].y(), position[i].z());
  }
}
