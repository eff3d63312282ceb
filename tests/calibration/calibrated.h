#pragma once

#include <gtest/gtest.h>

#include "wellgyro/calibration/apply.h"

namespace wellgyro::test {

/// One sample by itself.
inline ImuSample Calibrate(const ToolCalibration& tool, const RawSample& raw) {
  SampleCalibrator calibrator(tool);
  ImuSample out;
  EXPECT_EQ(calibrator.Apply({&raw, 1}, {&out, 1}), 1u);
  return out;
}

}  // namespace wellgyro::test
