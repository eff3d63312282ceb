#pragma once

#include <cstddef>

#include <Eigen/Core>

#include "wellgyro/record/along_hole.h"
#include "wellgyro/record/sample_block.h"

namespace wellgyro {

/// AlongHole at the instants of a block, member by member.
struct AlongHoleBlock {
  using Values = Eigen::Array<double, SampleBlock::kMost, 1>;

  Values md, speed, acceleration, sigma_md, sigma_speed, sigma_acceleration;
  Eigen::Array<bool, SampleBlock::kMost, 1> known;

  AlongHole At(std::size_t i) const {
    const auto k = static_cast<Eigen::Index>(i);
    if (!known[k]) return {};
    return {md[k],    speed[k],       acceleration[k],      sigma_md[k],
            known[k], sigma_speed[k], sigma_acceleration[k]};
  }
  void Set(std::size_t i, const AlongHole& along) {
    const auto k = static_cast<Eigen::Index>(i);
    md[k] = along.md;
    speed[k] = along.speed;
    acceleration[k] = along.acceleration;
    sigma_md[k] = along.sigma_md;
    known[k] = along.known;
    sigma_speed[k] = along.sigma_speed;
    sigma_acceleration[k] = along.sigma_acceleration;
  }
};

}  // namespace wellgyro
