#include "orders.h"

#include <cstddef>
#include <map>
#include <span>
#include <string_view>
#include <utility>

#include "wellgyro/base/angle.h"
#include "wellgyro/bus/encode.h"
#include "wellgyro/bus/feed.h"
#include "wellgyro/live/operation_gate.h"

#include "live.h"

namespace wellgyro::apps {
namespace {

constexpr int kTimes = 3;                        // each message is sent, since any may be lost
constexpr std::int64_t kPatienceUs = 3'000'000;  // for a survey's status
// For it to obey: a FINISH that no sample reaches any more holds after five seconds.
constexpr std::int64_t kObeyedUs = 9'000'000;

const std::map<std::string, Event::Kind>& Events() {
  static const std::map<std::string, Event::Kind> events = {
      {"zero", Event::Kind::kDepthZero},      {"rezero", Event::Kind::kDepthRezero},
      {"tie", Event::Kind::kDepthTie},        {"return-to-zero", Event::Kind::kReturnToZero},
      {"foresight", Event::Kind::kForesight}, {"run-begin", Event::Kind::kRunBegin},
      {"run-end", Event::Kind::kRunEnd},      {"accept", Event::Kind::kAccept},
      {"reject", Event::Kind::kReject},       {"remark", Event::Kind::kRemark}};
  return events;
}

const std::map<std::string, Command::Kind>& Commands() {
  static const std::map<std::string, Command::Kind> commands = {
      {"take-station", Command::Kind::kTakeStation},
      {"adjust", Command::Kind::kAdjust},
      {"finish", Command::Kind::kFinish}};
  return commands;
}

/// Hears from a survey what time its samples have, and what it has acknowledged.
class SurveyEar : public Listener {
 public:
  void OnStatus(const Status& status) override {
    heard = true;
    acknowledged = status.last_command_id;
    newest = status.utc - Duration::Seconds(status.data_age);
  }
  bool heard = false;
  std::int32_t acknowledged = 0;
  UtcTime newest;
};

/// Waits until `done`, or as long as anyone would.
template <class Done>
bool WaitUntil(LiveBus& bus, std::int64_t patience_us, Done done) {
  const std::int64_t end = MonotonicUs() + patience_us;
  while (!done()) {
    const auto woken = bus.Wait(50);
    if (!woken || *woken == LiveBus::Woken::kStopped || MonotonicUs() > end) return false;
  }
  return true;
}

Command CommandOf(const Order& order, UtcTime utc, std::int32_t session) {
  Command command;
  command.utc = utc;
  command.session = session;
  command.command_id = order.id;
  command.kind = Commands().at(order.what);
  command.md = order.md;
  return command;
}

Event EventOf(const Order& order, UtcTime utc, std::int32_t session) {
  Event event;
  event.utc = utc;
  event.session = session;
  event.event_id = order.id;
  event.kind = Events().at(order.what);
  event.run = order.run;
  event.has_value = order.md || order.azimuth_deg;
  event.value_m = order.md.value_or(0);
  event.sigma_m = order.sigma.value_or(0);
  event.value_rad = FromDegrees(order.azimuth_deg.value_or(0));
  event.sigma_rad = FromDegrees(order.sigma_deg.value_or(0));
  event.what = order.object;
  event.who = order.who;
  event.text = order.text;
  return event;
}

struct Letter {
  std::string channel;
  std::vector<std::byte> bytes;
};

Letter LetterOf(const Order& order, const JobFile& job, UtcTime now, std::int32_t session,
                const std::optional<PrivateKey>& key) {
  const UtcTime at = order.utime_us > 0 ? UtcTime{order.utime_us * 1000} : now;
  const bool command = Commands().contains(order.what);
  Letter letter;
  if (command) {
    Encode(CommandOf(order, at, session), letter.bytes);
  } else {
    Encode(EventOf(order, at, session), letter.bytes);
  }
  letter.channel = command ? job.job.channels.command : job.job.channels.event;
  if (!key) return letter;
  SignedOperation operation{.utc = now, .session = session, .id = order.id};
  operation.key = PublicKeyOf(*key);
  operation.content = std::move(letter.bytes);
  operation.signature = Sign(*key, SignedBytes(operation, job.job.well.name));
  Encode(operation, letter.bytes);
  letter.channel = job.job.channels.command;
  return letter;
}

}  // namespace

std::vector<std::string> OrderWords() {
  std::vector<std::string> words;
  for (const auto& [word, kind] : Events()) words.push_back(word);
  for (const auto& [word, kind] : Commands()) words.push_back(word);
  return words;
}

std::string Lacks(const Order& order) {
  const std::string& what = order.what;
  const bool depth = what == "rezero" || what == "tie";
  if (depth && !order.md) return what + " needs --md-m, the depth that is true there";
  if (what == "foresight" && (!order.azimuth_deg || !order.sigma_deg)) {
    return "foresight needs --azimuth-deg and --sigma-deg";
  }
  if (what == "remark" && order.text.empty()) return "remark needs --text";
  return {};
}

Result<SentOrder> SendOrder(LiveBus& bus, Order order, const JobFile& job,
                            const std::optional<PrivateKey>& key,
                            const std::function<void(const SentOrder&)>& sent) {
  SurveyEar ear;
  Feed feed(job.job.channels, ear);
  if (auto fault = bus.Subscribe({job.job.channels.status},
                                 [&feed](std::string_view channel, std::span<const std::byte> bytes,
                                         std::int64_t) { feed.Take(channel, bytes); })) {
    return *std::move(fault);
  }
  SentOrder told;
  told.heard = WaitUntil(bus, kPatienceUs, [&ear] { return ear.heard; });
  const std::int64_t now_us = NowUs();
  const UtcTime now = told.heard && ear.newest.ns > 0 ? ear.newest : UtcTime{now_us * 1000};
  told.session = static_cast<std::int32_t>(now_us / 1'000'000 % INT32_MAX);
  if (order.id == 0) order.id = static_cast<std::int32_t>(now_us / 1000 % 1'000'000'000) + 1;
  told.id = order.id;
  const Letter letter = LetterOf(order, job, now, told.session, key);
  for (int i = 0; i < kTimes; ++i) {
    if (auto fault = bus.Publish(letter.channel, letter.bytes)) return *std::move(fault);
  }
  sent(told);
  told.obeyed =
      told.heard && WaitUntil(bus, kObeyedUs, [&] { return ear.acknowledged == order.id; });
  return told;
}

}  // namespace wellgyro::apps
