#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "wellgyro/base/export.h"
#include "wellgyro/base/result.h"
#include "wellgyro/io/text_file.h"
#include "wellgyro/record/channels.h"
#include "wellgyro/simulate/simulation.h"

namespace wellgyro {

/// A simulation, the channels its messages go to, and the files it was read from.
struct SimulationFile {
  Simulation simulation;
  Channels channels;
  std::vector<InputFile> files;  ///< the simulation itself first
};

/// Reads a simulation, `format = "wellgyro.simulation/1"`, and the files it names, relative to its
/// own folder.
///
///     seed = 1
///     [well]     stations = FILE (columns MD[m],INC[deg],AZI_TRUE[deg] first), or
///                table = [[md_m, inc_deg, azi_deg], ...], or name = "vertical", "slant",
///                "build_hold", or name = "laws" with [well.inclination], [well.azimuth]
///     [run]      start_md_m, start_toolface_deg, roll_reference, and [[run.step]]: to_md_m with
///                speed_mps, roll_rpm ..., or stop_s with index_angles_deg, mode ...
///     [earth]    latitude_deg, longitude_deg, height_m, field_nt = [north, east, down]
///     [tool]     sigmas by the names of a job's [errors], from which one tool is drawn by `seed`;
///                noise coefficients by the names of noise files, or noise = FILE; actual errors
///                by the names without sigma, which win
///     [streams]  imu_hz, depth_hz, batch, overlap, loss_probability, outages_s = [[begin, end]]
///     [channels] as in a job
///
/// Mistakes are Faults with line and column; what contradicts itself beyond single values is left
/// to the Simulator.
/// `run`: in place of [run], which may then be absent.
WELLGYRO_EXPORT Result<SimulationFile> ReadSimulation(const std::filesystem::path& path,
                                                      const SimulatedRun* run = nullptr);

/// The same of text that came from elsewhere; files it names are relative to `folder`.
WELLGYRO_EXPORT Result<SimulationFile> ParseSimulation(std::string_view text,
                                                       const std::filesystem::path& source,
                                                       const std::filesystem::path& folder,
                                                       const SimulatedRun* run = nullptr);

/// The causes that a `[[fault]]` may have, one a line, with their keys.
WELLGYRO_EXPORT std::string FaultHelp();

}  // namespace wellgyro
