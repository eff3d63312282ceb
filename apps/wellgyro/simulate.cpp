#include <array>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <filesystem>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include <fmt/core.h>

#include "wellgyro/bus/encode.h"
#include "wellgyro/io/atomic_file.h"
#include "wellgyro/io/result/truth_csv.h"
#include "wellgyro/io/toml/plan_file.h"
#include "wellgyro/io/toml/simulation_file.h"
#include "wellgyro/io/toml/tool_file.h"
#include "wellgyro/simulate/raw_counts.h"
#include "wellgyro/simulate/sample_batcher.h"
#include "wellgyro/simulate/simulator.h"

#include "commands.h"
#include "distinct.h"
#include "on_call.h"
#include "outlet.h"
#include "report.h"

namespace wellgyro::apps {
namespace {

struct SimulateOptions {
  std::string job, out, truth, tool, plan;
  double temperature = 20;
  double speed = 1;
  bool finish = false;
};

/// Encodes what the simulator plays and sends it on.
class Recorder {
 public:
  Recorder(const SimulationFile& file, Outlet& outlet)
      : file_(file), outlet_(outlet), batcher_(file.simulation.streams, file.simulation.seed) {}

  /// From here on samples go out as the counts of `tool`, at `temperature` [degC].
  void CountAs(const ToolCalibration& tool, double temperature) {
    counter_.emplace(tool);
    temperature_ = temperature;
  }

  std::optional<Fault> Take(const ImuSample& sample) {
    now_us_ = Microseconds(sample.stamp.utc + Duration{sample.stamp.period_ns});
    if (counter_) {
      counted_.push_back(counter_->Count(sample, temperature_));
      const SimulatedStreams& streams = file_.simulation.streams;
      const std::size_t kept =
          static_cast<std::size_t>(streams.batch) + static_cast<std::size_t>(streams.overlap);
      while (counted_.size() > kept) counted_.pop_front();
    }
    return batcher_.Push(sample, batch_) ? WriteBatch() : std::nullopt;
  }
  std::optional<Fault> Take(const DepthMark& mark) {
    now_us_ = Microseconds(mark.utc);
    return Write(file_.channels.depth, mark);
  }
  std::optional<Fault> Take(const ToolMode& mode) {
    now_us_ = Microseconds(mode.utc);
    return Write(file_.channels.mode, mode);
  }
  std::optional<Fault> Take(const ToolInfo& info) {
    now_us_ = Microseconds(info.utc);
    return Write(file_.channels.tool, info);
  }
  /// Asks surveys to finish here, three times as the network may lose one.
  std::optional<Fault> Finish() {
    Command command;
    command.utc = UtcTime{now_us_ * 1000};
    command.command_id = 1;
    command.kind = Command::Kind::kFinish;
    for (int i = 0; i < 3; ++i) {
      if (auto fault = Write(file_.channels.command, command)) return fault;
    }
    return std::nullopt;
  }
  std::optional<Fault> Flush() {
    if (batcher_.Flush(batch_)) {
      if (auto fault = WriteBatch()) return fault;
    }
    return std::nullopt;
  }

 private:
  static std::int64_t Microseconds(UtcTime utc) { return utc.ns / 1000; }
  std::optional<Fault> WriteBatch() {
    outlet_.CountSamples(batch_.samples.back().stamp.seq + 1);
    if (!counter_) {
      Encode(std::span<const ImuSample>(batch_.samples), bytes_);
      return outlet_.Write(file_.channels.imu, bytes_, now_us_);
    }
    // Each sample was counted once; a batch may repeat some.
    const auto behind =
        static_cast<std::ptrdiff_t>(counted_.back().stamp.seq - batch_.samples.front().stamp.seq);
    const auto first = counted_.end() - 1 - behind;
    const std::vector<RawSample> raw(first,
                                     first + static_cast<std::ptrdiff_t>(batch_.samples.size()));
    Encode(std::span<const RawSample>(raw), bytes_);
    return outlet_.Write(file_.channels.raw, bytes_, now_us_);
  }
  template <class Record>
  std::optional<Fault> Write(const std::string& channel, const Record& record) {
    Encode(record, bytes_);
    return outlet_.Write(channel, bytes_, now_us_);
  }

  const SimulationFile& file_;
  Outlet& outlet_;
  SampleBatcher batcher_;
  SampleBatch batch_;
  std::optional<RawCounter> counter_;
  double temperature_ = 20;
  std::deque<RawSample> counted_;
  std::vector<std::byte> bytes_;
  std::int64_t now_us_ = 0;
};

std::optional<Fault> Play(Simulator& simulator, Recorder& recorder, Outlet& outlet, bool finish) {
  Progress progress("simulating");
  if (auto fault = recorder.Take(simulator.tool_info())) return fault;
  SimulatedStep step;
  std::int64_t samples = 0;
  while (!outlet.stopped() && simulator.Next(step)) {
    if (auto fault = std::visit([&](const auto& record) { return recorder.Take(record); }, step)) {
      return fault;
    }
    samples += std::holds_alternative<ImuSample>(step) ? 1 : 0;
    progress.Show(samples, simulator.sample_count());
  }
  if (auto fault = recorder.Flush()) return fault;
  if (finish && !outlet.stopped()) {
    if (auto fault = recorder.Finish()) return fault;
  }
  return outlet.Close();
}

std::optional<Fault> WriteTruth(const std::string& name, const Truth& truth) {
  const std::filesystem::path path(name);
  const std::vector<OutputFile> files = {{path.filename().string(), TruthCsv(truth, 1.0)}};
  const std::filesystem::path folder = path.parent_path();
  return WriteFiles(folder.empty() ? std::filesystem::path(".") : folder, files);
}

/// The tool as whose counts samples go out; none where no file is named.
Result<std::optional<ToolCalibration>> CountingTool(const SimulateOptions& options,
                                                    const SimulatedTool& simulated) {
  if (options.tool.empty()) return std::optional<ToolCalibration>();
  auto tool = ReadToolFile(options.tool);
  if (!tool) return tool.fault();
  if (!simulated.has_gz || (tool->mag.n_channels > 0 && !simulated.has_mag)) {
    return Fault{
        .code = FaultCode::kConflict,
        .text = fmt::format("counts need what their channels may feel: set {} = true under [tool]",
                            simulated.has_gz ? "has_mag" : "has_gz"),
        .source = options.job};
  }
  return std::optional<ToolCalibration>(*std::move(tool));
}

/// The simulation, its run that of a plan where one is named.
Result<SimulationFile> ReadWithPlan(const SimulateOptions& options) {
  if (options.plan.empty()) return ReadSimulation(options.job);
  const Result<PlanFile> plan = ReadPlanFile(options.plan);
  if (!plan) return plan.fault();
  const SimulatedRun run = RunOf(*plan);
  return ReadSimulation(options.job, &run);
}

/// What a simulation refuses is refused before a file is touched.
Result<Simulator> SimulatorOf(const SimulationFile& file, const std::string& path) {
  try {
    const SampleBatcher batcher(file.simulation.streams, file.simulation.seed);
    return Simulator(file.simulation);
  } catch (const std::invalid_argument& refused) {
    return Fault{.code = FaultCode::kRange, .text = refused.what(), .source = path};
  }
}

std::optional<Fault> Simulate(const SimulateOptions& options) {
  const bool live = options.out.find("://") != std::string::npos;
  const std::string truth =
      options.truth.empty() && !live ? options.out + ".truth.csv" : options.truth;
  RequireDistinct(std::array{NamedFile{"--job", options.job}, NamedFile{"--plan", options.plan},
                             NamedFile{"--tool", options.tool},
                             NamedFile{"--out", live ? "" : options.out},
                             NamedFile{"--truth", truth}});
  const Result<SimulationFile> file = ReadWithPlan(options);
  if (!file) return file.fault();
  const auto tool = CountingTool(options, file->simulation.tool);
  if (!tool) return tool.fault();
  Result<Simulator> simulator = SimulatorOf(*file, options.job);
  if (!simulator) return simulator.fault();
  auto outlet = live ? OpenLiveOutlet(options.out, file->channels, options.speed)
                     : OpenLogOutlet(options.out);
  if (!outlet) return outlet.fault();
  Recorder recorder(*file, **outlet);
  if (*tool) recorder.CountAs(**tool, options.temperature);
  if (auto fault = Play(*simulator, recorder, **outlet, options.finish)) return fault;
  if (!truth.empty()) {
    if (auto fault = WriteTruth(truth, simulator->truth())) return fault;
  }
  fmt::print("simulated {:.0f} s: {} events, {} bytes\n{} {}\n", simulator->truth().seconds(),
             (*outlet)->events(), (*outlet)->bytes(), live ? "sent to" : "wrote", options.out);
  if (!truth.empty()) fmt::print("wrote {}\n", truth);
  return std::nullopt;
}

/// Behind the options: an example, and every fault that a file may have with its keys.
std::string Help() {
  return std::string(
             "Example:\n  wellgyro simulate --job data/demo/simulation.toml --out tool.lcm\n"
             "  wellgyro simulate --job data/demo/simulation.toml \\\n"
             "      --out udpm://239.255.76.67:7667 --speed 10\n\n"
             "[[fault]] in the file: cause, its keys, begin_s and end_s since the begin of the "
             "run, "
             "every_s\n"
             "for what repeats (spikes, swing, vibration, whirl)\n") +
         FaultHelp();
}

/// The tool through whose calibration samples become counts.
void AddTool(CLI::App& command, SimulateOptions& o) {
  command
      .add_option("--tool", o.tool,
                  "Tool file, wellgyro.tool/1: samples go out as its counts (raw_batch_t)")
      ->type_name("FILE");
  command.add_option("--temperature-degc", o.temperature, "Of that tool's sensors, default 20");
}

}  // namespace

void AddSimulate(CLI::App& app, int& exit_code) {
  auto options = std::make_shared<SimulateOptions>();
  CLI::App* command = app.add_subcommand(
      "simulate", "Makes the sensor stream of a tool on a run through a known hole, and the truth");
  command->add_option("--job", options->job, "Simulation file, wellgyro.simulation/1")
      ->required()
      ->type_name("FILE");
  command->add_option("--out", options->out, "LCM log to write, or LCM URL to send to")
      ->required()
      ->type_name("LOG|URL");
  command
      ->add_option("--speed", options->speed,
                   "With a URL: simulated seconds a second; 0: as fast as receivers keep up")
      ->check(CLI::NonNegativeNumber);
  command->add_flag("--finish", options->finish, "End with the command FINISH to the survey");
  command
      ->add_option("--truth", options->truth,
                   "Truth second by second, CSV; by default the log's name with .truth.csv, "
                   "and none with a URL")
      ->type_name("FILE");
  command
      ->add_option(
          "--plan", options->plan,
          "Plan file, wellgyro.plan/1: its way and its stops, in place of the file's [run]")
      ->type_name("FILE");
  AddTool(*command, *options);
  command->footer(Help());
  OnCall(command, exit_code, [options] { return Concluded(Simulate(*options)); });
}

}  // namespace wellgyro::apps
