#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <string>

#include "wellgyro/base/export.h"
#include "wellgyro/record/sample.h"
#include "wellgyro/record/tool_calibration.h"

namespace wellgyro {

/// What makes `tool` unusable, in one sentence that names group and member; nothing when it is
/// whole.
WELLGYRO_EXPORT std::optional<std::string> FindComplaint(const ToolCalibration& tool);

/// Turns a tool's counts into SI units and tool axes by the formula of SensorGroup, solved for u:
/// three channels exactly, four by least squares, two for the rates across the tool (has_gz is then
/// false and what the channels see of w_z stays in the rates: AxialCoupling). Right to 5e-11 of u
/// where no term goes with temperature and |K u| stays below 0.2 |S|.
///
/// Between temperatures at which the formula is solved in full its numbers are interpolated: to
/// 1e-9 of the larger of u and 1 deg/s, 1 g, 50 uT, terms of second order, in the force and in
/// heating to 1e-5 of themselves. That costs the same, to a tenth, whether the temperature changes
/// with every sample or not. Beyond the calibrated range temperatures stay at its end and
/// `temperature_outside` is set. The result does not depend on how samples are cut into batches.
/// Nothing is allocated.
class WELLGYRO_EXPORT SampleCalibrator {
 public:
  /// Throws std::invalid_argument with FindComplaint's sentence.
  explicit SampleCalibrator(const ToolCalibration& tool);
  ~SampleCalibrator();
  SampleCalibrator(SampleCalibrator&&) noexcept;
  SampleCalibrator& operator=(SampleCalibrator&&) noexcept;

  /// Calibrates raw[i] into out[i] and gives how many: raw.size(), or less where a sample has fewer
  /// channels or thermometers than the model names; it stands at that sample. `out` holds at least
  /// as many as `raw`, else std::invalid_argument. Samples come in their order, for the term in the
  /// heating rate.
  std::size_t Apply(std::span<const RawSample> raw, std::span<ImuSample> out);

  /// By how much four gyro channels contradict each other: the component of what they read along
  /// the one direction in which no rate moves them, in the channels' unit; at the temperature of
  /// the sample that Apply saw last. Nothing for fewer channels or a sample that does not fit.
  std::optional<double> Parity(const RawSample& raw) const;

  /// Why Apply stopped at this sample: a sentence for the Fault.
  std::string WhyNot(const RawSample& raw) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace wellgyro
