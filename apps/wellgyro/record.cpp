#include <algorithm>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include <fmt/core.h>

#include "wellgyro/bus/feed.h"
#include "wellgyro/bus/lcm_live.h"
#include "wellgyro/bus/log_parts.h"
#include "wellgyro/bus/log_writer.h"
#include "wellgyro/bus/loss_watch.h"
#include "wellgyro/bus/stream_guard.h"
#include "wellgyro/live/notices.h"

#include "commands.h"
#include "console.h"
#include "live.h"
#include "report.h"

namespace wellgyro::apps {
namespace {

constexpr std::int64_t kSecondUs = 1'000'000;
// After a signal the recording ends when what the system still held is in the log: when nothing has
// come for kQuietMs, in which LCM's thread gets its turn on a busy machine too, or after kDrainUs.
constexpr int kQuietMs = 100;
constexpr std::int64_t kDrainUs = 300'000;

struct RecordOptions {
  std::string from, out, job;
  double rotate_mb = 0, rotate_minutes = 0;
  bool append = false;
};

class Recording {
 public:
  Recording(const RecordOptions& options, const Channels& channels, LiveBus& bus)
      : options_(options),
        bus_(bus),
        clock_(ThisClock()),
        notices_(console_, clock_),
        watch_([this](const Fault& fault) { notices_.Tell(fault); }),
        feed_(channels, watch_),
        guard_(
            channels, [this](const auto& message) { Take(message.channel, message); },
            [this](const std::string& sentence) { notices_.Say(sentence); },
            [this](const auto& message) { TakeAside(message); }) {}

  std::optional<Fault> Begin() {
    if (auto fault = Open()) return fault;
    return bus_.Subscribe({}, [this](auto channel, auto bytes, auto received_us) {
      guard_.Take({channel, bytes, received_us, bus_.heard_from()});
    });
  }

  int Run();

 private:
  std::optional<Fault> Open();
  void Take(std::string_view channel, const StreamGuard::Message& message);
  void TakeAside(const StreamGuard::Message& message);
  bool RotationIsDue() const;
  void Housekeeping();
  int Report();

  const RecordOptions& options_;
  LiveBus& bus_;
  Console console_;
  LiveClock clock_;
  Notices notices_;
  LossWatch watch_;
  Feed feed_;
  StreamGuard guard_;
  std::optional<LogWriter> log_;
  std::optional<Fault> fault_;
  std::map<std::string, std::int64_t, std::less<>> messages_;  ///< by channel
  int number_ = 0;
  std::int64_t opened_us_ = 0, next_second_ = 0;
  std::int64_t events_ = 0, bytes_ = 0, drops_ = 0;
};

std::optional<Fault> Recording::Open() {
  // Numbers of an earlier recording under the same name are passed over when appending.
  const IfExists if_exists = options_.append ? IfExists::kAppend : IfExists::kRefuse;
  Result<LogWriter> log = LogWriter::Open(LogPart(options_.out, number_), if_exists);
  if (!log) return log.fault();
  log_.emplace(std::move(*log));
  opened_us_ = MonotonicUs();
  return std::nullopt;
}

/// What a survey would not read is kept under a name that it does not read either.
void Recording::TakeAside(const StreamGuard::Message& message) {
  constexpr std::size_t kNameMax = 63, kSenderMax = 22;
  const std::string_view channel = message.channel.substr(0, kNameMax - kSenderMax);
  Take(fmt::format("{}~{}", channel, NameOf(message.by)), message);
}

void Recording::Take(std::string_view channel, const StreamGuard::Message& message) {
  const auto& [original, bytes, received_us, by] = message;
  if (fault_) return;
  if (channel.empty()) return;  // LCM lets a datagram without a name through
  if (log_->events() > 0 && RotationIsDue()) {
    fault_ = log_->Close();
    ++number_;
    if (!fault_) fault_ = Open();
    if (fault_) return;
  }
  fault_ = log_->Write(channel, bytes, received_us);
  ++events_;
  bytes_ += static_cast<std::int64_t>(bytes.size());
  constexpr std::size_t kChannelsMax = 1000;
  const auto found = messages_.find(channel);
  if (found != messages_.end()) {
    ++found->second;
  } else if (messages_.size() < kChannelsMax) {
    messages_.try_emplace(std::string(channel), 1);
  }
  feed_.Take(channel, bytes);
}

bool Recording::RotationIsDue() const {
  const double minutes = static_cast<double>(MonotonicUs() - opened_us_) / (60.0 * kSecondUs);
  return (options_.rotate_mb > 0 &&
          static_cast<double>(log_->bytes()) >= options_.rotate_mb * 1e6) ||
         (options_.rotate_minutes > 0 && minutes >= options_.rotate_minutes);
}

void Recording::Housekeeping() {
  // To the system at once: who reads the log while it grows, and whoever kills us, finds it there.
  if (!fault_) fault_ = log_->Flush();
  const std::int64_t now = MonotonicUs();
  if (now < next_second_) return;
  next_second_ = now + kSecondUs;
  if (!fault_ && !log_->InPlace()) {
    console_.OnNotice(
        fmt::format("{} was moved or removed: a new one begins", LogPart(options_.out, number_)));
    fault_ = log_->Close();
    if (!fault_) fault_ = Open();
  }
  const std::int64_t drops = bus_.kernel_drops().value_or(0);
  if (drops > drops_) {
    console_.OnNotice(
        fmt::format("the system has thrown away {} datagrams: its receive buffer was full", drops));
  }
  drops_ = drops;
}

int Recording::Run() {
  for (;;) {
    Housekeeping();
    if (fault_) break;
    const auto woken = bus_.Wait(200);
    if (!woken) {
      console_.OnNotice(SentenceOf(woken.fault()));
      break;
    }
    if (*woken != LiveBus::Woken::kStopped) continue;
    DrainStopped(bus_, kQuietMs, kDrainUs);
    break;
  }
  return Report();
}

int Recording::Report() {
  guard_.Flush();
  watch_.Settle();
  console_.End();
  if (!fault_) fault_ = log_->Close();
  if (fault_) Complain(*fault_);
  for (const auto& [channel, count] : messages_) {
    fmt::print("{:10} on {}\n", count, Printable(channel));
  }
  fmt::print("recorded {} messages, {} bytes, {} samples; {} samples lost\n", events_, bytes_,
             watch_.samples(), watch_.lost());
  for (int i = 0; i <= number_; ++i) fmt::print("wrote {}\n", LogPart(options_.out, i));
  if (fault_) return kUnusable;
  return watch_.lost() > 0 || drops_ > 0 ? kDoneWithLosses : kDone;
}

int Record(const RecordOptions& options) {
  const std::optional<Channels> channels = ChannelsOf(options.job);
  if (!channels) return kUnusable;
  Result<LiveBus> bus = LiveBus::Open(UrlOr(options.from));
  if (!bus) return Unusable(bus.fault());
  const StopOnSignals stop(*bus);
  Recording recording(options, *channels, *bus);
  if (const auto fault = recording.Begin()) return Unusable(*fault);
  SayHowHeard(*bus);
  return recording.Run();
}

}  // namespace

void AddRecord(CLI::App& app, int& exit_code) {
  auto options = std::make_shared<RecordOptions>();
  CLI::App* command = app.add_subcommand(
      "record", "Writes every message to an LCM log and says which samples did not come");
  command
      ->add_option("--from", options->from,
                   "LCM URL as udpm://239.255.76.67:7667; by default LCM_DEFAULT_URL, or LCM's own")
      ->type_name("URL")
      ->check([](const std::string& url) {
        return IsLive(url) ? std::string() : "is no LCM URL: " + url;
      });
  command->add_option("--out", options->out, "LCM log to write; it must not exist")
      ->required()
      ->type_name("LOG");
  command->add_option("--job", options->job, "Job file, for the names of its channels")
      ->type_name("FILE");
  command->add_option("--rotate-mb", options->rotate_mb, "Begin a new log after so many megabytes")
      ->check(CLI::PositiveNumber);
  command->add_option("--rotate-minutes", options->rotate_minutes, "... or so many minutes")
      ->check(CLI::PositiveNumber);
  command->add_flag("--append", options->append, "Continue behind what the log holds");
  command->footer(
      "Example:\n  wellgyro record --from udpm://239.255.76.67:7667 --out rig.lcm \\\n"
      "      --rotate-mb 1000");
  command->callback([options, &exit_code] { exit_code = Record(*options); });
}

}  // namespace wellgyro::apps
