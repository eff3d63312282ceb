#pragma once

#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "wellgyro/base/export.h"
#include "wellgyro/base/result.h"
#include "wellgyro/bus/feed.h"
#include "wellgyro/survey/survey.h"
#include "wellgyro/survey/surveyor.h"

/// @file
/// An LCM log to surveys.
namespace wellgyro {

/// Hands what a Feed hears to a Surveyor: the whole way from bytes to survey. What the feed itself
/// refuses goes to `faults`, which may be the surveyor's own sink.
class WELLGYRO_EXPORT SurveyorListener : public Listener {
 public:
  /// Both must outlive this object.
  SurveyorListener(Surveyor& surveyor, Sink& faults) : surveyor_(surveyor), faults_(faults) {}

  void OnImu(std::span<const ImuSample> batch) override { surveyor_.Push(batch); }
  void OnRaw(std::span<const RawSample> batch) override { surveyor_.Push(batch); }
  void OnStill(const StillWindow& window) override { surveyor_.Push(window); }
  void OnDepth(const DepthMark& mark) override { surveyor_.Push(mark); }
  void OnMode(const ToolMode& mode) override { surveyor_.Push(mode); }
  void OnTool(const ToolInfo& info) override { surveyor_.Push(info); }
  void OnEvent(const Event& event) override { surveyor_.Push(event); }
  void OnCommand(const Command& command) override { surveyor_.Push(command); }
  void OnFault(const Fault& fault) override { faults_.OnFault(fault); }

 private:
  Surveyor& surveyor_;
  Sink& faults_;
};

/// What a log came to.
struct LogSurvey {
  std::map<std::int32_t, Survey> tools;  ///< by number of the tool in the string
  std::vector<Fault> faults;             ///< of the log and of its messages, the first 1000
  SampleTally tally;
};

/// Surveys the LCM log at `path`, with the parts behind it where it was rotated (rig.001.lcm behind
/// rig.lcm, or rig.lcm.01 behind rig.lcm.00), or a pipe, or "-" for standard input: what the
/// program's `survey` does, without its files. A Fault where the log cannot be read at all; damage
/// inside it is told in `faults`. Throws std::invalid_argument as Surveyor does.
WELLGYRO_EXPORT Result<LogSurvey> SurveyLog(const Job& job, const std::string& path);

}  // namespace wellgyro
