#pragma once

#include <cstdint>

#include "wellgyro/io/toml/toml_internal.h"
#include "wellgyro/record/noise.h"
#include "wellgyro/simulate/simulation.h"

/// The sections of a simulation file that name no other file; every one reads all keys of its
/// table.
namespace wellgyro {

/// By table, name or laws.
SimulatedWell ReadSimulatedWell(TomlTable& table);
/// [run]: speeds, stops, index turns and roll, step by step.
SimulatedRun ReadSimulatedRun(TomlTable table);
/// [earth]: the place, its gravity and field.
SimulatedEarth ReadSimulatedEarth(TomlTable table);
/// `noise` stands in for coefficients in the table where they come from a file.
SimulatedTool ReadSimulatedTool(TomlTable table, const NoiseCoefficients* noise,
                                std::uint64_t seed);
/// [streams]: rates, batches, overlap and losses.
SimulatedStreams ReadSimulatedStreams(TomlTable table);

}  // namespace wellgyro
