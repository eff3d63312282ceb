#pragma once

#include "wellgyro/record/depth.h"

namespace wellgyro {

/// Which items of a rig's WITS level 0 stream mean what. Items are numbered record * 100 + item;
/// the defaults are those of record 1 of the WITS specification.
struct WitsItems {
  int date = 105;  ///< YYMMDD
  int time = 106;  ///< HHMMSS
  int bit_depth = 108;
  double length_unit = 1;  ///< of the depth [m]
  double utc_offset = 0;   ///< of the rig's clock: its time less UTC [s]
  double sigma = 0;        ///< of a depth [m]; 0: as the survey's job has it
  DepthKind kind = DepthKind::kDrillPipe;
};

}  // namespace wellgyro
