#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <fmt/core.h>

#include "wellgyro/bus/byte_stream.h"
#include "wellgyro/bus/encode.h"
#include "wellgyro/bus/lcm_live.h"
#include "wellgyro/bus/wits.h"
#include "wellgyro/io/toml/wits_file.h"
#include "wellgyro/live/notices.h"

#include "commands.h"
#include "console.h"
#include "live.h"
#include "live_commands.h"
#include "report.h"

namespace wellgyro::apps {
namespace {

constexpr std::int64_t kAgainUs = 1'000'000;         // between two tries to connect
constexpr std::int64_t kLineSilenceUs = 30'000'000;  // a line that says nothing for so long is cut
constexpr const char* kWits = "wits0:";

struct BridgeOptions {
  std::string from, to, items, job;
  int baud = ByteStream::kBaud;
};

/// Carries a rig's depth onto a bus, whatever becomes of the line.
class Bridge {
 public:
  Bridge(const BridgeOptions& options, const WitsItems& items, const std::string& channel,
         LiveBus& bus)
      : options_(options),
        channel_(channel),
        bus_(bus),
        clock_(ThisClock()),
        notices_(console_, clock_),
        reader_(
            items, static_cast<std::int32_t>(NowUs() / 1'000'000 % INT32_MAX),
            [this](const DepthMark& mark) { Publish(mark); },
            [this](const Fault& fault) { notices_.Tell(fault); }) {}

  int Run();

 private:
  void Publish(const DepthMark& mark);
  void Connect();
  void Lose(const Fault& fault);
  void Read();

  const BridgeOptions& options_;
  const std::string& channel_;
  LiveBus& bus_;
  Console console_;
  LiveClock clock_;
  Notices notices_;
  WitsReader reader_;
  std::optional<ByteStream> line_;
  std::int64_t next_try_ = 0, heard_us_ = 0;
  bool told_ = false;
  std::vector<std::byte> bytes_;
};

void Bridge::Publish(const DepthMark& mark) {
  Encode(mark, bytes_);
  if (const auto fault = bus_.Publish(channel_, bytes_)) notices_.Tell(*fault);
}

void Bridge::Connect() {
  if (MonotonicUs() < next_try_) return;
  Result<ByteStream> line =
      ByteStream::Open(options_.from.substr(std::string_view(kWits).size()), options_.baud);
  next_try_ = MonotonicUs() + kAgainUs;
  if (!line) {
    // Once, however long the rig's computer is away.
    if (!told_) notices_.Say(line.fault());
    told_ = true;
    return;
  }
  line_.emplace(std::move(*line));
  heard_us_ = MonotonicUs();
  told_ = false;
  notices_.Say(fmt::format("connected to {}", options_.from));
}

void Bridge::Lose(const Fault& fault) {
  line_.reset();
  reader_.Cut();
  next_try_ = MonotonicUs() + kAgainUs;
  notices_.Say(SentenceOf(fault) + "; connecting again");
}

void Bridge::Read() {
  const auto bytes = line_->Read(100);
  if (!bytes) return Lose(bytes.fault());
  if (!bytes->empty()) {
    heard_us_ = MonotonicUs();
    reader_.Take(*bytes);
  } else if (MonotonicUs() - heard_us_ > kLineSilenceUs) {
    Lose({FaultCode::kIo, "the line says nothing"});
  }
}

int Bridge::Run() {
  for (;;) {
    if (!line_) Connect();
    const auto woken = bus_.Wait(line_ ? 0 : 100);
    if (!woken) {
      console_.OnNotice(SentenceOf(woken.fault()));
      return kUnusable;
    }
    if (*woken == LiveBus::Woken::kStopped) break;
    if (line_) Read();
  }
  console_.End();
  fmt::print("{} depth marks, {} records left out\n", reader_.marks(), reader_.bad());
  return reader_.bad() > 0 ? kDoneWithLosses : kDone;
}

int RunBridge(const BridgeOptions& options) {
  if (!options.from.starts_with(kWits)) {
    return Misused("--from is wits0:tcp://HOST:PORT or wits0:/dev/ttyS0");
  }
  WitsItems items;
  if (!options.items.empty()) {
    const Result<WitsItems> read = ReadWitsItems(options.items);
    if (!read) return Unusable(read.fault());
    items = *read;
  }
  const std::optional<Channels> channels = ChannelsOf(options.job);
  if (!channels) return kUnusable;
  Result<LiveBus> bus = LiveBus::Open(UrlOr(options.to));
  if (!bus) return Unusable(bus.fault());
  const StopOnSignals stop(*bus);
  return Bridge(options, items, channels->depth, *bus).Run();
}

}  // namespace

void AddBridge(CLI::App& app, int& exit_code) {
  auto options = std::make_shared<BridgeOptions>();
  CLI::App* command =
      app.add_subcommand("bridge", "Brings a rig's depth, a WITS level 0 stream, onto the bus");
  command->add_option("--from", options->from, "wits0:tcp://HOST:PORT or wits0:/dev/ttyS0")
      ->required()
      ->type_name("LINE");
  command->add_option("--to", options->to, "LCM URL; by default LCM_DEFAULT_URL, or LCM's own")
      ->type_name("URL");
  command->add_option("--items", options->items, "Which items mean what, wellgyro.wits/1")
      ->type_name("FILE");
  command->add_option("--job", options->job, "Job file, for the names of its channels")
      ->type_name("FILE");
  command->add_option("--baud", options->baud, "Of a serial line")->capture_default_str();
  command->footer(
      "Example:\n  wellgyro bridge --from wits0:tcp://10.0.0.7:5000 \\\n"
      "      --to udpm://239.255.76.67:7667 --items rig.toml");
  command->callback([options, &exit_code] { exit_code = RunBridge(*options); });
}

}  // namespace wellgyro::apps
