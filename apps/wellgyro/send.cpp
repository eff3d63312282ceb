#include <array>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>

#include "wellgyro/base/angle.h"
#include "wellgyro/bus/encode.h"
#include "wellgyro/bus/feed.h"
#include "wellgyro/bus/lcm_live.h"
#include "wellgyro/io/signature.h"
#include "wellgyro/io/toml/job_file.h"
#include "wellgyro/live/operation_gate.h"

#include "commands.h"
#include "live.h"
#include "live_commands.h"
#include "report.h"

namespace wellgyro::apps {
namespace {

constexpr int kTimes = 3;                        // each message is sent, since any may be lost
constexpr std::int64_t kPatienceUs = 3'000'000;  // for a survey's status
// For it to obey: a FINISH that no sample reaches any more holds after five seconds.
constexpr std::int64_t kObeyedUs = 9'000'000;

struct SendOptions {
  std::string what, to, job, key, who, text, object;
  std::optional<double> md, sigma, azimuth_deg, sigma_deg;
  std::int32_t run = 0;
  std::int64_t utime_us = 0;
  std::int32_t id = 0;
};

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

Command CommandOf(const SendOptions& options, UtcTime utc, std::int32_t session) {
  Command command;
  command.utc = utc;
  command.session = session;
  command.command_id = options.id;
  command.kind = Commands().at(options.what);
  command.md = options.md;
  return command;
}

Event EventOf(const SendOptions& options, UtcTime utc, std::int32_t session) {
  Event event;
  event.utc = utc;
  event.session = session;
  event.event_id = options.id;
  event.kind = Events().at(options.what);
  event.run = options.run;
  event.has_value = options.md || options.azimuth_deg;
  event.value_m = options.md.value_or(0);
  event.sigma_m = options.sigma.value_or(0);
  event.value_rad = FromDegrees(options.azimuth_deg.value_or(0));
  event.sigma_rad = FromDegrees(options.sigma_deg.value_or(0));
  event.what = options.object;
  event.who = options.who;
  event.text = options.text;
  return event;
}

/// What an order lacks; empty where it can be given.
std::string Lacks(const SendOptions& options) {
  const std::string& what = options.what;
  const bool depth = what == "rezero" || what == "tie";
  if (depth && !options.md) return what + " needs --md-m, the depth that is true there";
  if (what == "foresight" && (!options.azimuth_deg || !options.sigma_deg)) {
    return "foresight needs --azimuth-deg and --sigma-deg";
  }
  if (what == "remark" && options.text.empty()) return "remark needs --text";
  return {};
}

struct Order {
  std::string channel;
  std::vector<std::byte> bytes;
};

Order OrderOf(const SendOptions& options, const JobFile& job, UtcTime now, std::int32_t session,
              const std::optional<PrivateKey>& key) {
  const UtcTime at = options.utime_us > 0 ? UtcTime{options.utime_us * 1000} : now;
  const bool command = Commands().contains(options.what);
  Order order;
  if (command) {
    Encode(CommandOf(options, at, session), order.bytes);
  } else {
    Encode(EventOf(options, at, session), order.bytes);
  }
  order.channel = command ? job.job.channels.command : job.job.channels.event;
  if (!key) return order;
  SignedOperation operation{.utc = now, .session = session, .id = options.id};
  operation.key = PublicKeyOf(*key);
  operation.content = std::move(order.bytes);
  operation.signature = Sign(*key, SignedBytes(operation, job.job.well.name));
  Encode(operation, order.bytes);
  order.channel = job.job.channels.command;
  return order;
}

int SendOver(LiveBus& bus, SendOptions options, const JobFile& job,
             const std::optional<PrivateKey>& key) {
  SurveyEar ear;
  Feed feed(job.job.channels, ear);
  if (const auto fault =
          bus.Subscribe({job.job.channels.status},
                        [&feed](std::string_view channel, std::span<const std::byte> bytes,
                                std::int64_t) { feed.Take(channel, bytes); })) {
    Complain(*fault);
    return kUnusable;
  }
  const bool there = WaitUntil(bus, kPatienceUs, [&ear] { return ear.heard; });
  if (!there) Complain("no survey is heard: the order is sent with this machine's time");
  const std::int64_t now_us = NowUs();
  const UtcTime now = there && ear.newest.ns > 0 ? ear.newest : UtcTime{now_us * 1000};
  const auto session = static_cast<std::int32_t>(now_us / 1'000'000 % INT32_MAX);
  if (options.id == 0) options.id = static_cast<std::int32_t>(now_us / 1000 % 1'000'000'000) + 1;
  const Order order = OrderOf(options, job, now, session, key);
  for (int i = 0; i < kTimes; ++i) {
    if (const auto fault = bus.Publish(order.channel, order.bytes)) {
      Complain(*fault);
      return kUnusable;
    }
  }
  fmt::print("sent {} as session {}, number {}{}\n", options.what, session, options.id,
             key ? ", signed" : "");
  if (!there) return kUnusable;
  if (WaitUntil(bus, kObeyedUs, [&] { return ear.acknowledged == options.id; })) {
    fmt::print("the survey has obeyed\n");
    return kDone;
  }
  Complain(
      "the survey has not said that it obeyed: it refused, or waits for samples of that time; its "
      "terminal and run.toml say which");
  return kUnusable;
}

int Send(const SendOptions& options) {
  if (const std::string lacks = Lacks(options); !lacks.empty()) {
    Complain(lacks);
    return kUsage;
  }
  const Result<JobFile> job = ReadJob(options.job);
  if (!job) {
    Complain(job.fault());
    return kUnusable;
  }
  std::optional<PrivateKey> key;
  if (!options.key.empty()) {
    Result<PrivateKey> read = ReadPrivateKey(options.key);
    if (!read) {
      Complain(read.fault());
      return kUnusable;
    }
    key = std::move(*read);
  }
  Result<LiveBus> bus = LiveBus::Open(UrlOr(options.to));
  if (!bus) {
    Complain(bus.fault());
    return kUnusable;
  }
  const StopOnSignals stop(*bus);
  return SendOver(*bus, options, *job, key);
}

/// A new key, and what the job says of it.
int MakeKey(const std::string& path) {
  const PrivateKey key = NewPrivateKey();
  if (const auto fault = WritePrivateKey(key, path)) {
    Complain(*fault);
    return kUnusable;
  }
  fmt::print(
      "wrote {}; keep it secret, and put into the job:\n[[operator]]\nname = \"...\"\n"
      "public_key = \"{}\"\n",
      path, HexOf(PublicKeyOf(key)));
  return kDone;
}

std::vector<std::string> Words() {
  std::vector<std::string> words;
  for (const auto& [word, kind] : Events()) words.push_back(word);
  for (const auto& [word, kind] : Commands()) words.push_back(word);
  return words;
}

void AddOrderOptions(CLI::App& command, SendOptions& options) {
  command.add_option("--to", options.to, "LCM URL; by default LCM_DEFAULT_URL, or LCM's own")
      ->type_name("URL");
  command.add_option("--job", options.job, "Job of the survey: its well and channels")
      ->type_name("FILE");
  command.add_option("--key", options.key, "Private key in PEM; without it the order is unsigned")
      ->type_name("PEM");
  command.add_option("--md-m", options.md, "Depth that is true, or at which stations are meant");
  command.add_option("--sigma-m", options.sigma, "Of that depth");
  command.add_option("--azimuth-deg", options.azimuth_deg, "Of a foresight, true");
  command.add_option("--sigma-deg", options.sigma_deg, "Of that azimuth");
  command.add_option("--run", options.run, "Run that is meant; 0: the one at that time, or all");
  command.add_option("--what", options.object, "Shoe, tag, mark; of run-end: misrun");
  command.add_option("--who", options.who, "Your name");
  command.add_option("--text", options.text, "A remark");
  command.add_option("--at-utime-us", options.utime_us, "When it holds; by default now");
  command.add_option("--id", options.id, "Number; the same number again is the same order");
}

}  // namespace

void AddSend(CLI::App& app, int& exit_code) {
  auto options = std::make_shared<SendOptions>();
  auto new_key = std::make_shared<std::string>();
  CLI::App* command = app.add_subcommand("send", "Orders something of a running survey, signed");
  auto* what = command
                   ->add_option("what", options->what,
                                fmt::format("What is ordered: {}", fmt::join(Words(), ", ")))
                   ->check(CLI::IsMember(Words()))
                   ->option_text("WHAT");
  AddOrderOptions(*command, *options);
  auto* make = command->add_option("--new-key", *new_key, "Makes a key instead, into this file")
                   ->type_name("PEM");
  what->excludes(make);
  command->footer(
      "Example:\n  wellgyro send --new-key console.pem\n"
      "  wellgyro send finish --who Ada --job job.toml --key console.pem --to "
      "udpm://239.255.76.67:7667");
  command->callback([options, new_key, &exit_code] {
    if (!new_key->empty()) {
      exit_code = MakeKey(*new_key);
    } else if (options->what.empty() || options->job.empty()) {
      Complain("send needs what to order, and --job");
      exit_code = kUsage;
    } else {
      exit_code = Send(*options);
    }
  });
}

}  // namespace wellgyro::apps
