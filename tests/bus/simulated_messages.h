#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "wellgyro/bus/encode.h"
#include "wellgyro/simulate/sample_batcher.h"
#include "wellgyro/simulate/simulator.h"

namespace wellgyro::test {

/// Gives every message of a simulated run to `take`, in the order in which they are sent: channel,
/// bytes and the time of sending [us].
template <class Take>
void ForEachMessage(const Simulation& simulation, Take take) {
  const Channels channels;
  Simulator simulator(simulation);
  SampleBatcher batcher(simulation.streams, simulation.seed);
  SampleBatch batch;
  std::vector<std::byte> bytes;
  std::int64_t now = 0;
  const auto send = [&](const std::string& channel, const auto& record) {
    Encode(record, bytes);
    take(channel, std::span<const std::byte>(bytes), now);
  };
  SimulatedStep step;
  while (simulator.Next(step)) {
    if (const auto* sample = std::get_if<ImuSample>(&step)) {
      now = (sample->stamp.utc.ns + sample->stamp.period_ns) / 1000;
      if (batcher.Push(*sample, batch)) {
        send(channels.imu, std::span<const ImuSample>(batch.samples));
      }
    } else if (const auto* mark = std::get_if<DepthMark>(&step)) {
      now = mark->utc.ns / 1000;
      send(channels.depth, *mark);
    } else {
      send(channels.mode, std::get<ToolMode>(step));
    }
  }
  if (batcher.Flush(batch)) send(channels.imu, std::span<const ImuSample>(batch.samples));
}

}  // namespace wellgyro::test
