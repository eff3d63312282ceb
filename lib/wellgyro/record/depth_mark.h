#pragma once

#include <cstdint>
#include <optional>

#include "wellgyro/base/depth.h"
#include "wellgyro/base/time.h"

namespace wellgyro {

/// One reading of the depth system: along-hole depth of the tool string's reference point.
struct DepthMark {
  UtcTime utc;
  std::int64_t seq = 0;
  std::int32_t session = 0;
  std::int32_t run = 0;
  DepthKind kind = DepthKind::kIndicated;
  double md = 0;                  ///< [m], positive down
  std::optional<double> speed;    ///< [m/s], positive down
  std::optional<double> tension;  ///< [N]
  std::optional<double> sigma;    ///< [m]
  bool stopped = false;
  bool corrected = false;      ///< corrections are already in `md`
  bool manual = false;         ///< typed by a person
  bool magnetic_mark = false;  ///< a magnetic mark passed the counter
};

}  // namespace wellgyro
