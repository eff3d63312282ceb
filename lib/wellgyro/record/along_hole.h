#pragma once

namespace wellgyro {

/// Motion of the sensor point along the hole at one instant, as depth/ knows it.
struct AlongHole {
  double md = 0;                  ///< measured depth of the sensor point [m]
  double speed = 0;               ///< [m/s], positive down
  double acceleration = 0;        ///< [m/s^2]
  double sigma_md = 0;            ///< [m]
  bool known = false;             ///< false: no depth covers this instant; the rest is zero
  double sigma_speed = 0;         ///< [m/s]
  double sigma_acceleration = 0;  ///< [m/s^2]
};

}  // namespace wellgyro
