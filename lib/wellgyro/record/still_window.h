#pragma once

#include <cstdint>
#include <optional>

#include <Eigen/Core>

#include "wellgyro/base/time.h"
#include "wellgyro/record/quality.h"

namespace wellgyro {

/// Means over one stretch at rest, in tool axes T: found in the samples by alignment/, or sent by a
/// tool that averages down-hole (multishot, drop, gyro while drilling).
struct StillWindow {
  ToolTime begin, end;  ///< on the tool's clock, where the window rests on samples
  UtcTime utc_begin, utc_end;
  std::int64_t seq_begin = 0;  ///< first sample, where the window rests on samples
  std::int64_t seq_end = 0;    ///< one past the last
  std::int32_t session = 0;
  std::int32_t run = 0;
  std::int32_t tool = 0;
  std::int64_t samples = 0;  ///< samples in the means; 0 where the tool averaged
  Eigen::Vector3d w_IT_T = Eigen::Vector3d::Zero();        ///< mean rate [rad/s]; z where has_gz
  Eigen::Vector3d sigma_w_IT_T = Eigen::Vector3d::Zero();  ///< of the mean, noise alone [rad/s]
  Eigen::Vector3d f_T = Eigen::Vector3d::Zero();           ///< mean specific force [m/s^2]
  Eigen::Vector3d sigma_f_T = Eigen::Vector3d::Zero();     ///< of the mean, noise alone [m/s^2]
  Eigen::Vector3d b_T = Eigen::Vector3d::Zero();           ///< flux density [T]; where has_mag
  bool has_gz = false;
  bool has_mag = false;
  /// Of the toolface over the window, by gravity; absent where too short to tell [rad/s].
  std::optional<double> roll_rate;
  double sigma_roll_rate = 0;                  ///< noise alone [rad/s]
  std::optional<std::int32_t> index_position;  ///< of an indexing tool
  std::optional<double> md;                    ///< measured depth [m]
  double temperature = 0;                      ///< [degC]
  Quality quality = Quality::kGood;

  double seconds() const {
    return samples > 0 ? (end - begin).seconds() : (utc_end - utc_begin).seconds();
  }
};

}  // namespace wellgyro
