#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include <fmt/core.h>

#include "wellgyro/bus/feed.h"
#include "wellgyro/bus/glance_channel.h"
#include "wellgyro/bus/lcm_live.h"
#include "wellgyro/live/glance_line.h"
#include "wellgyro/record/advice.h"
#include "wellgyro/record/glance.h"

#include "commands.h"
#include "console.h"
#include "live.h"
#include "live_commands.h"
#include "report.h"

namespace wellgyro::apps {
namespace {

constexpr std::int64_t kSurveySilenceUs = 5'000'000;

struct WatchOptions {
  std::string from, job;
  double seconds = 0;
};

/// Shows what a survey says of itself.
class Watch : private Listener {
 public:
  explicit Watch(const Channels& channels) : feed_(channels, *this) {}

  void Take(std::string_view channel, std::span<const std::byte> bytes) {
    feed_.Take(channel, bytes);
  }
  void Look() {
    const std::int64_t now = MonotonicUs();
    if (now - heard_us_ < kSurveySilenceUs) return;
    console_.OnNotice(fmt::format("no survey is heard for {} s", (now - begin_us_) / 1'000'000));
    heard_us_ = now;
  }
  bool heard() const { return heard_; }
  void End() { console_.End(); }

 private:
  void OnGlance(const Glance& glance) override {
    if (session_ && *session_ != glance.session) {
      console_.OnNotice(fmt::format("another survey speaks: session {}", glance.session));
    }
    session_ = glance.session;
    heard_ = true;
    begin_us_ = heard_us_ = MonotonicUs();
    console_.OnGlance(glance);
  }
  void OnAdvice(const Advice& advice) override {
    Advice shown = advice;
    shown.text = Printable(advice.text);
    console_.OnAdvice(shown);
  }
  void OnStatus(const Status& status) override {
    heard_ = true;
    begin_us_ = heard_us_ = MonotonicUs();
    if (status.text == text_ && text_ == kBusy) console_.Show(text_);
    if (status.text == text_) return;
    text_ = status.text;
    console_.OnNotice(text_.empty() ? "the survey is well again" : Printable(text_));
  }

  Console console_;
  Feed feed_;
  std::string text_;
  std::optional<std::int32_t> session_;
  std::int64_t begin_us_ = MonotonicUs(), heard_us_ = begin_us_;
  bool heard_ = false;
};

int WatchBus(const WatchOptions& options) {
  const std::optional<Channels> channels = ChannelsOf(options.job);
  if (!channels) return kUnusable;
  Result<LiveBus> bus = LiveBus::Open(UrlOr(options.from));
  if (!bus) return Unusable(bus.fault());
  const StopOnSignals stop(*bus);
  Watch watch(*channels);
  if (const auto fault =
          bus->Subscribe({channels->status, GlanceChannel(*channels), AdviceChannel(*channels)},
                         [&watch](std::string_view channel, std::span<const std::byte> bytes,
                                  std::int64_t) { watch.Take(channel, bytes); })) {
    return Unusable(*fault);
  }
  const std::int64_t begin = MonotonicUs();
  const auto most = static_cast<std::int64_t>(options.seconds * 1e6);
  while (most == 0 || MonotonicUs() - begin < most) {
    const auto woken = bus->Wait(200);
    if (!woken) return Unusable(woken.fault());
    if (*woken == LiveBus::Woken::kStopped) break;
    watch.Look();
  }
  watch.End();
  if (watch.heard()) return kDone;
  return Unusable(fmt::format("no survey was heard on {}", bus->url()));
}

}  // namespace

void AddWatch(CLI::App& app, int& exit_code) {
  auto options = std::make_shared<WatchOptions>();
  CLI::App* command =
      app.add_subcommand("watch", "Shows how a running survey stands, in a line that lives");
  command->add_option("url", options->from, "LCM URL; by default LCM_DEFAULT_URL, or LCM's own")
      ->type_name("URL")
      ->check([](const std::string& url) {
        return IsLive(url) ? std::string() : "is no LCM URL: " + url;
      });
  command->add_option("--job", options->job, "Job file, for the names of its channels")
      ->type_name("FILE");
  command->add_option("--seconds", options->seconds, "End after so long")
      ->check(CLI::PositiveNumber);
  command->footer("Example:\n  wellgyro watch udpm://239.255.76.67:7667");
  command->callback([options, &exit_code] { exit_code = WatchBus(*options); });
}

}  // namespace wellgyro::apps
