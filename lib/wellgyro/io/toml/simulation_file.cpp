#include "wellgyro/io/toml/simulation_file.h"

#include <cstdint>
#include <limits>
#include <optional>
#include <string>

#include "wellgyro/io/exchange/well_table_internal.h"
#include "wellgyro/io/formats.h"
#include "wellgyro/io/sha256.h"
#include "wellgyro/io/toml/coefficients_internal.h"
#include "wellgyro/io/toml/fault_section_internal.h"
#include "wellgyro/io/toml/job_sections_internal.h"
#include "wellgyro/io/toml/named_file_internal.h"
#include "wellgyro/io/toml/simulation_sections_internal.h"
#include "wellgyro/io/toml/toml_internal.h"

namespace wellgyro {
namespace {

SimulatedWell TakeWell(TomlTable table, NamedFiles& files) {
  Eigen::Vector3d begin = Eigen::Vector3d::Zero();
  table.Read("begin_north_m", begin.x());
  table.Read("begin_east_m", begin.y());
  table.Read("begin_tvd_m", begin.z());
  SimulatedWell well;
  if (const auto name = table.FindString("stations")) {
    auto stations = ParseWellTable(files.Take("well", *name), files.PathOf(*name).string());
    if (!stations) throw TomlError{stations.fault()};
    well.stations = *std::move(stations);
  } else {
    well = ReadSimulatedWell(table);
  }
  well.begin_p_WT_W = begin;
  return well;
}

SimulatedTool TakeTool(TomlTable table, NamedFiles& files, std::uint64_t seed) {
  std::optional<NoiseCoefficients> noise;
  if (const auto name = table.FindString("noise")) noise = NoiseOfFile(*name, files);
  return ReadSimulatedTool(table, noise ? &*noise : nullptr, seed);
}

SimulationFile TakeSimulation(TomlTable& root, NamedFiles& files, const SimulatedRun* run) {
  SimulationFile file;
  Simulation& s = file.simulation;
  s.seed = static_cast<std::uint64_t>(
      root.FindInteger("seed", 0, std::numeric_limits<std::int64_t>::max()).value_or(0));
  s.well = TakeWell(root.Need("well", root.FindTable("well")), files);
  if (run != nullptr) {
    if (auto own = root.FindTable("run")) own->Verbatim();
    s.run = *run;
  } else {
    s.run = ReadSimulatedRun(root.Need("run", root.FindTable("run")));
  }
  s.earth = ReadSimulatedEarth(root.Need("earth", root.FindTable("earth")));
  if (const auto table = root.FindTable("tool")) s.tool = TakeTool(*table, files, s.seed);
  if (const auto table = root.FindTable("streams")) s.streams = ReadSimulatedStreams(*table);
  for (const TomlTable& table : root.FindTables("fault")) s.faults.push_back(ReadFault(table));
  if (const auto table = root.FindTable("channels")) file.channels = ReadChannels(*table);
  return file;
}

}  // namespace

Result<SimulationFile> ParseSimulation(std::string_view text, const std::filesystem::path& source,
                                       const std::filesystem::path& folder,
                                       const SimulatedRun* run) {
  NamedFiles files(folder);
  files.Note("simulation", source, text);
  Result<SimulationFile> file = ReadTomlText<SimulationFile>(
      text, source.string(), formats::kSimulation,
      [&](TomlTable& root) { return TakeSimulation(root, files, run); });
  if (file) file->files = files.all();
  return file;
}

Result<SimulationFile> ReadSimulation(const std::filesystem::path& path, const SimulatedRun* run) {
  const Result<std::string> text = ReadTextFile(path);
  if (!text) return text.fault();
  return ParseSimulation(*text, path, path.parent_path(), run);
}

}  // namespace wellgyro
