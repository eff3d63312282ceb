#include "intake.h"

#include <algorithm>
#include <string>
#include <utility>

#include <fmt/core.h>

#include "report.h"

namespace wellgyro::apps {
namespace {

constexpr std::size_t kToolInfosMax = 1000;

}  // namespace

void ToolBook::OnTool(const ToolInfo& info) {
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
}

void ToolBook::OnRaw(std::span<const RawSample> batch) {
  if (watch_ != nullptr) watch_->OnRaw(batch);
  SurveyorListener::OnRaw(batch);
}

void ToolBook::OnCommand(const Command& command) {
  finish_heard_ = finish_heard_ || command.kind == Command::Kind::kFinish;
  SurveyorListener::OnCommand(command);
}

Intake::Intake(const Job& job, Surveyor& surveyor)
    : listener_(surveyor, feed_faults_),
      feed_(job.channels, listener_,
            [this](MessageType type, std::string_view, std::span<const std::byte> bytes) {
              digester_.Take(type, bytes);
            }) {}

std::vector<ChannelRecord> Intake::Channels() const {
  std::vector<ChannelRecord> records;
  for (int i = 0; i < kMessageTypes; ++i) {
    const auto type = static_cast<MessageType>(i);
    // What surveys say, ours or another, is no input.
    if (type == MessageType::kStation || type == MessageType::kStatus) continue;
    if (feed_.count(type).messages == 0) continue;
    records.push_back({NameOf(feed_.channels(), type), std::string(TypeName(type)),
                       feed_.count(type).messages, digester_.HexDigest(type)});
  }
  return records;
}

void HintAtChannels(const Feed& feed) {
  for (const auto& [channel, foreign] : feed.foreign()) {
    if (!foreign.type) continue;
    Complain(
        fmt::format("channel {} carries {} messages; if they are the tool's, name it under "
                    "[channels] in the job",
                    Printable(channel), TypeName(*foreign.type)));
  }
}

}  // namespace wellgyro::apps
