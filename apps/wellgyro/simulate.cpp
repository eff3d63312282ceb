#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include <fmt/core.h>

#include "wellgyro/bus/encode.h"
#include "wellgyro/bus/log_writer.h"
#include "wellgyro/io/atomic_file.h"
#include "wellgyro/io/simulation_file.h"
#include "wellgyro/io/truth_csv.h"
#include "wellgyro/simulate/sample_batcher.h"
#include "wellgyro/simulate/simulator.h"

#include "commands.h"
#include "report.h"

namespace wellgyro::apps {
namespace {

struct SimulateOptions {
  std::string job, out, truth;
};

/// Encodes what the simulator plays and writes it to a log.
class Recorder {
 public:
  Recorder(const SimulationFile& file, LogWriter log)
      : file_(file),
        log_(std::move(log)),
        batcher_(file.simulation.streams, file.simulation.seed) {}

  std::optional<Fault> Take(const ImuSample& sample) {
    now_us_ = Microseconds(sample.stamp.utc + Duration{sample.stamp.period_ns});
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
  std::optional<Fault> Close() {
    if (batcher_.Flush(batch_)) {
      if (auto fault = WriteBatch()) return fault;
    }
    return log_.Close();
  }
  std::int64_t events() const { return log_.events(); }
  std::int64_t bytes() const { return log_.bytes(); }

 private:
  static std::int64_t Microseconds(UtcTime utc) { return utc.ns / 1000; }
  std::optional<Fault> WriteBatch() {
    Encode(std::span<const ImuSample>(batch_.samples), bytes_);
    return log_.Write(file_.channels.imu, bytes_, now_us_);
  }
  template <class Record>
  std::optional<Fault> Write(const std::string& channel, const Record& record) {
    Encode(record, bytes_);
    return log_.Write(channel, bytes_, now_us_);
  }

  const SimulationFile& file_;
  LogWriter log_;
  SampleBatcher batcher_;
  SampleBatch batch_;
  std::vector<std::byte> bytes_;
  std::int64_t now_us_ = 0;
};

std::optional<Fault> Play(Simulator& simulator, Recorder& recorder) {
  Progress progress("simulating");
  if (auto fault = recorder.Take(simulator.tool_info())) return fault;
  SimulatedStep step;
  std::int64_t samples = 0;
  while (simulator.Next(step)) {
    if (auto fault = std::visit([&](const auto& record) { return recorder.Take(record); }, step)) {
      return fault;
    }
    samples += std::holds_alternative<ImuSample>(step) ? 1 : 0;
    progress.Show(samples, simulator.sample_count());
  }
  return recorder.Close();
}

std::optional<Fault> WriteTruth(const std::string& name, const Truth& truth) {
  const std::filesystem::path path(name);
  const std::vector<OutputFile> files = {{path.filename().string(), TruthCsv(truth, 1.0)}};
  const std::filesystem::path folder = path.parent_path();
  return WriteFiles(folder.empty() ? std::filesystem::path(".") : folder, files);
}

int Simulate(const SimulateOptions& options) {
  const Result<SimulationFile> file = ReadSimulation(options.job);
  if (!file) {
    Complain(file.fault());
    return kUnusable;
  }
  const std::string truth = options.truth.empty() ? options.out + ".truth.csv" : options.truth;
  if (options.out == options.job || truth == options.job || options.out == truth) {
    Complain("--job, --out and --truth must be three different files");
    return kUnusable;
  }
  // What the simulation refuses is refused before a file is touched.
  Simulator simulator(file->simulation);
  const SampleBatcher batcher(file->simulation.streams, file->simulation.seed);
  Result<LogWriter> log = LogWriter::Open(options.out, IfExists::kReplace);
  if (!log) {
    Complain(log.fault());
    return kUnusable;
  }
  Recorder recorder(*file, std::move(*log));
  if (const auto fault = Play(simulator, recorder)) {
    Complain(*fault);
    return kUnusable;
  }
  if (const auto fault = WriteTruth(truth, simulator.truth())) {
    Complain(*fault);
    return kUnusable;
  }
  fmt::print("simulated {:.0f} s: {} events, {} bytes\nwrote {}\nwrote {}\n",
             simulator.truth().seconds(), recorder.events(), recorder.bytes(), options.out, truth);
  return kDone;
}

}  // namespace

void AddSimulate(CLI::App& app, int& exit_code) {
  auto options = std::make_shared<SimulateOptions>();
  CLI::App* command = app.add_subcommand(
      "simulate", "Makes the sensor stream of a tool on a run through a known hole, and the truth");
  command->add_option("--job", options->job, "Simulation file, wellgyro.simulation/1")
      ->required()
      ->type_name("FILE");
  command->add_option("--out", options->out, "LCM log to write")->required()->type_name("LOG");
  command
      ->add_option("--truth", options->truth,
                   "Truth second by second, CSV; by default the log's name with .truth.csv")
      ->type_name("FILE");
  command->footer("Example:\n  wellgyro simulate --job data/demo/simulation.toml --out tool.lcm");
  command->callback([options, &exit_code] { exit_code = Simulate(*options); });
}

}  // namespace wellgyro::apps
