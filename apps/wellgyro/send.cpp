#include <cstdint>
#include <cstdio>
#include <memory>
#include <optional>
#include <string>

#include <fmt/format.h>

#include "wellgyro/bus/lcm_live.h"
#include "wellgyro/io/signature.h"
#include "wellgyro/io/toml/job_file.h"

#include "choice.h"
#include "commands.h"
#include "live.h"
#include "live_commands.h"
#include "orders.h"
#include "report.h"

namespace wellgyro::apps {
namespace {

struct SendOptions {
  Order order;
  std::string to, job, key;
};

int SendOver(LiveBus& bus, const SendOptions& options, const JobFile& job,
             const std::optional<PrivateKey>& key) {
  const auto sent = SendOrder(bus, options.order, job, key, [&](const SentOrder& told) {
    if (!told.heard) Complain("no survey is heard: the order is sent with this machine's time");
    fmt::print("sent {} as session {}, number {}{}\n", options.order.what, told.session, told.id,
               key ? ", signed" : "");
    std::fflush(stdout);
  });
  if (!sent) return Unusable(sent.fault());
  if (!sent->heard) return kUnusable;
  if (sent->obeyed) {
    fmt::print("the survey has obeyed\n");
    return kDone;
  }
  Complain(
      "the survey has not said that it obeyed: it refused, or waits for samples of that time; its "
      "terminal and run.toml say which");
  return kUnusable;
}

int Send(const SendOptions& options) {
  if (const std::string lacks = Lacks(options.order); !lacks.empty()) return Misused(lacks);
  const Result<JobFile> job = ReadJob(options.job);
  if (!job) return Unusable(job.fault());
  std::optional<PrivateKey> key;
  if (!options.key.empty()) {
    Result<PrivateKey> read = ReadPrivateKey(options.key);
    if (!read) return Unusable(read.fault());
    key = std::move(*read);
  }
  Result<LiveBus> bus = LiveBus::Open(UrlOr(options.to));
  if (!bus) return Unusable(bus.fault());
  const StopOnSignals stop(*bus);
  return SendOver(*bus, options, *job, key);
}

/// A new key, and what the job says of it.
int MakeKey(const std::string& path) {
  const PrivateKey key = NewPrivateKey();
  if (const auto fault = WritePrivateKey(key, path)) return Unusable(*fault);
  fmt::print(
      "wrote {}; keep it secret, and put into the job:\n[[operator]]\nname = \"...\"\n"
      "public_key = \"{}\"\n",
      path, HexOf(PublicKeyOf(key)));
  return kDone;
}

void AddOrderOptions(CLI::App& command, SendOptions& options) {
  command.add_option("--to", options.to, "LCM URL; by default LCM_DEFAULT_URL, or LCM's own")
      ->type_name("URL");
  command.add_option("--job", options.job, "Job of the survey: its well and channels")
      ->type_name("FILE");
  command.add_option("--key", options.key, "Private key in PEM; without it the order is unsigned")
      ->type_name("PEM");
  command.add_option("--md-m", options.order.md,
                     "Depth that is true, or at which stations are meant");
  command.add_option("--sigma-m", options.order.sigma, "Of that depth");
  command.add_option("--azimuth-deg", options.order.azimuth_deg, "Of a foresight, true");
  command.add_option("--sigma-deg", options.order.sigma_deg, "Of that azimuth");
  command.add_option("--run", options.order.run,
                     "Run that is meant; 0: the one at that time, or all");
  command.add_option("--what", options.order.object, "Shoe, tag, mark; of run-end: misrun");
  command.add_option("--who", options.order.who, "Your name");
  command.add_option("--text", options.order.text, "A remark");
  command.add_option("--at-utime-us", options.order.utime_us, "When it holds; by default now")
      ->check(CLI::PositiveNumber);
  command.add_option("--id", options.order.id, "Number; the same number again is the same order");
}

}  // namespace

void AddSend(CLI::App& app, int& exit_code) {
  auto options = std::make_shared<SendOptions>();
  auto new_key = std::make_shared<std::string>();
  CLI::App* command = app.add_subcommand("send", "Orders something of a running survey, signed");
  auto* what = command
                   ->add_option("what", options->order.what,
                                fmt::format("What is ordered: {}", fmt::join(OrderWords(), ", ")))
                   ->option_text("WHAT");
  TakeWord(what, OrderWords());
  AddOrderOptions(*command, *options);
  auto* make = command->add_option("--new-key", *new_key, "Makes a key instead, into this file")
                   ->type_name("PEM");
  what->excludes(make);
  command->footer(
      "Example:\n  wellgyro send --new-key console.pem\n"
      "  wellgyro send finish --who Ada --job job.toml --key console.pem \\\n"
      "      --to udpm://239.255.76.67:7667");
  command->callback([options, new_key, &exit_code] {
    if (!new_key->empty()) {
      exit_code = MakeKey(*new_key);
    } else if (options->order.what.empty() || options->job.empty()) {
      Complain("send needs what to order, and --job");
      exit_code = kUsage;
    } else {
      exit_code = Send(*options);
    }
  });
}

}  // namespace wellgyro::apps
