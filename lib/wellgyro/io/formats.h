#pragma once

#include <string_view>

/// What our own files say they are, first: `format = "wellgyro.job/1"`. A released format is
/// frozen; a change is a new number.
namespace wellgyro::formats {

inline constexpr std::string_view kJob = "wellgyro.job/1";
inline constexpr std::string_view kSimulation = "wellgyro.simulation/1";
inline constexpr std::string_view kNoise = "wellgyro.noise/1";
inline constexpr std::string_view kCalibration = "wellgyro.calibration/1";
inline constexpr std::string_view kTool = "wellgyro.tool/1";
inline constexpr std::string_view kErrorModel = "wellgyro.error-model/1";
inline constexpr std::string_view kProgram = "wellgyro.program/1";
inline constexpr std::string_view kClearance = "wellgyro.clearance/1";
inline constexpr std::string_view kMerge = "wellgyro.merge/1";
inline constexpr std::string_view kPlan = "wellgyro.plan/1";
inline constexpr std::string_view kWits = "wellgyro.wits/1";
// Of results, of which runs and plans are read again.
inline constexpr std::string_view kRun = "wellgyro.run/1";
inline constexpr std::string_view kSource = "wellgyro.source/1";
inline constexpr std::string_view kUncertainty = "wellgyro.uncertainty/1";
inline constexpr std::string_view kMerged = "wellgyro.merged/1";
inline constexpr std::string_view kComparison = "wellgyro.comparison/1";
inline constexpr std::string_view kSurvey = "wellgyro.survey/1";

}  // namespace wellgyro::formats
