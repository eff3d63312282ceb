#include "wellgyro/live/intake.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include <fmt/core.h>

#include "wellgyro/live/notices.h"

namespace wellgyro {
namespace {

constexpr std::size_t kToolInfosMax = 1000;  // of tools and runs; more come from a broken sender

}  // namespace

void ToolBook::OnTool(const ToolInfo& info) {
  if (!gate_.Take(info)) return;
  SurveyorListener::OnTool(info);
  const auto key = [](const ToolInfo& i) { return std::pair(i.tool, i.run); };
  const auto at = std::ranges::lower_bound(tools_, key(info), {}, key);
  if (at != tools_.end() && key(*at) == key(info)) {
    *at = info;
  } else if (tools_.size() < kToolInfosMax) {
    tools_.insert(at, info);
  }
}

void ToolBook::OnImu(std::span<const ImuSample> batch) {
  if (watch_ != nullptr) watch_->OnImu(batch);
  SurveyorListener::OnImu(batch);
  Heard();
}

void ToolBook::OnRaw(std::span<const RawSample> batch) {
  if (watch_ != nullptr) watch_->OnRaw(batch);
  SurveyorListener::OnRaw(batch);
  Heard();
}

void ToolBook::OnStill(const StillWindow& window) {
  SurveyorListener::OnStill(window);
  gate_.HeardAt(window.utc_end);
}

void ToolBook::OnDepth(const DepthMark& mark) {
  SurveyorListener::OnDepth(mark);
  const std::optional<DepthMark> before = std::exchange(depth_.mark, mark);
  if (!before || std::abs(mark.md - depth_.rest_md) > kRestsWithin) {
    depth_.rest_md = mark.md;
    depth_.rest_begin = mark.utc;
  }
  const double seconds = before ? (mark.utc - before->utc).seconds() : 0;
  if (mark.speed) {
    depth_.speed = *mark.speed;
  } else if (seconds > 0) {
    depth_.speed = (mark.md - before->md) / seconds;
  }
}

void ToolBook::OnMode(const ToolMode& mode) {
  if (gate_.Take(mode)) SurveyorListener::OnMode(mode);
}

void ToolBook::Heard() {
  if (const auto newest = surveyor_.tally().newest) gate_.HeardAt(*newest);
}

Intake::Intake(const JobFile& job, Surveyor& surveyor)
    : listener_(job, surveyor, feed_faults_),
      feed_(job.job.channels, listener_,
            [this](MessageType type, std::string_view, std::span<const std::byte> bytes) {
              digester_.Take(type, bytes);
            }) {}

std::vector<ChannelRecord> Intake::Channels() const {
  std::vector<ChannelRecord> records;
  for (int i = 0; i < kMessageTypes; ++i) {
    const auto type = static_cast<MessageType>(i);
    // What surveys say, ours or another, is no input.
    if (type == MessageType::kStation || type == MessageType::kStatus ||
        type == MessageType::kGlance || type == MessageType::kAdvice ||
        type == MessageType::kRequest) {
      continue;
    }
    if (feed_.count(type).messages == 0) continue;
    records.push_back({NameOf(feed_.channels(), type), std::string(TypeName(type)),
                       feed_.count(type).messages, digester_.HexDigest(type)});
  }
  return records;
}

std::vector<std::string> HintsAtChannels(const Feed& feed) {
  std::vector<std::string> hints;
  for (const auto& [channel, foreign] : feed.foreign()) {
    if (!foreign.type) continue;
    hints.push_back(
        fmt::format("channel {} carries {} messages; if they are the tool's, name it under "
                    "[channels] in the job",
                    Printable(channel), TypeName(*foreign.type)));
  }
  return hints;
}

}  // namespace wellgyro
