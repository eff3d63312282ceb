// Law: how marks, events and batches of samples interleave does not matter within latency_s, for
// what is told on the way as for what is told in the end.
#include <algorithm>
#include <cstdint>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include <fmt/core.h>
#include <gtest/gtest.h>

#include "wellgyro/math/random.h"

#include "support/simulated_survey.h"
#include "support/small_hole.h"

namespace wellgyro {
namespace {

using Message = std::variant<std::vector<ImuSample>, DepthMark, Event>;
using Messages = std::vector<std::pair<double, Message>>;  // by when they come [s]

struct Case {
  const char* name;
  double depth_hz, latency;
  bool spikes;
};

UtcTime Rezeroed(const Simulation& simulation) {
  return simulation.streams.begin_utc + Duration::Seconds(200.3);
}

/// Everything that is sent, as it happens, sample by sample.
std::vector<SimulatedStep> Sent(const Simulation& simulation, const Case& c) {
  std::vector<SimulatedStep> steps;
  Simulator simulator(simulation);
  SimulatedStep step;
  for (int marks = 0; simulator.Next(step);) {
    if (auto* mark = std::get_if<DepthMark>(&step)) {
      if (c.spikes && ++marks % 37 == 0) mark->md += marks % 2 == 0 ? 4 : -30;
    }
    steps.push_back(step);
  }
  return steps;
}

/// Marks come as late as they may, batches of one to 60 samples at their end and a little later.
Messages Shuffled(const std::vector<SimulatedStep>& steps, UtcTime begin, double latency,
                  std::uint64_t seed) {
  Random random(seed);
  Messages messages;
  std::vector<ImuSample> batch;
  std::size_t size = 1;
  std::int64_t last = 0;
  for (const SimulatedStep& step : steps) {
    if (const auto* sample = std::get_if<ImuSample>(&step)) last = sample->stamp.seq;
  }
  const auto late = [&random](double most) { return 0.99 * most * random.Uniform(); };
  for (const SimulatedStep& step : steps) {
    if (const auto* mark = std::get_if<DepthMark>(&step)) {
      messages.emplace_back((mark->utc - begin).seconds() + late(latency), *mark);
    }
    const auto* sample = std::get_if<ImuSample>(&step);
    if (sample == nullptr) continue;
    batch.push_back(*sample);
    if (batch.size() < size && sample->stamp.seq != last) continue;
    const double end = (sample->stamp.utc - begin).seconds() + 1e-9 * sample->stamp.period_ns;
    messages.emplace_back(end + late(0.5 * latency), std::exchange(batch, {}));
    size = static_cast<std::size_t>(1 + 60 * random.Uniform());
  }
  std::ranges::stable_sort(messages, {}, [](const auto& m) { return m.first; });
  return messages;
}

std::string TextOf(const Station& s) {
  return fmt::format("{} {} {} {} {} {:a} {:a} {:a} {:a} {:a} {:a} {:a} {:a} {}\n", s.revision,
                     static_cast<int>(s.kind), s.utc.ns, s.imu_seq_begin, s.imu_seq_end, s.md,
                     s.inclination, s.azimuth, s.toolface, s.cov_md_inc_azi(0, 0),
                     s.cov_md_inc_azi(2, 2), s.p_WT_W.x(), s.cov_p_WT_W(2, 2),
                     static_cast<int>(s.quality));
}

/// All that is told, the depths that were refused, and what the survey makes of it.
std::string AllTold(const Simulation& simulation, const Job& job, const Messages& messages) {
  testing::CollectingSink sink;
  Surveyor surveyor(job, sink);
  for (const auto& [when, message] : messages) {
    if (const auto* samples = std::get_if<std::vector<ImuSample>>(&message)) {
      surveyor.Push(std::span<const ImuSample>(*samples));
    } else if (const auto* mark = std::get_if<DepthMark>(&message)) {
      surveyor.Push(*mark);
    } else {
      surveyor.Push(std::get<Event>(message));
    }
  }
  surveyor.Finish();
  const Survey survey = surveyor.Current(simulation.streams.tool);
  std::string text = fmt::format("{} refused, {}\n", survey.marks_refused, survey.unusable);
  for (const Station& s : sink.stations) text += TextOf(s);
  return text;
}

class Interleaving : public ::testing::TestWithParam<Case> {};

TEST_P(Interleaving, DoesNotMatterWithinTheLatency) {
  const Case& c = GetParam();
  testing::SmallHole hole;
  hole.to_md = 250;
  hole.imu_hz = 20;
  hole.depth_hz = c.depth_hz;
  Simulation simulation = SimulationOf(hole);
  simulation.tool.errors.depth_resolution = 0.01;
  Job job = JobOf(hole);
  job.depth.latency = c.latency;
  const std::vector<SimulatedStep> steps = Sent(simulation, c);
  const UtcTime begin = simulation.streams.begin_utc;
  Event rezero;
  rezero.kind = Event::Kind::kDepthRezero;
  rezero.utc = Rezeroed(simulation);
  rezero.has_value = true;
  rezero.value_m = 130;
  std::string first;
  for (std::uint64_t seed = 0; seed < 4; ++seed) {
    // The first is in order.
    Messages messages = Shuffled(steps, begin, seed == 0 ? 0 : c.latency, seed);
    const double said =
        (rezero.utc - begin).seconds() + 0.33 * static_cast<double>(seed) * c.latency;
    const auto at = std::ranges::lower_bound(messages, said, {}, &Messages::value_type::first);
    messages.insert(at, {said, rezero});
    const std::string told = AllTold(simulation, job, messages);
    EXPECT_GT(told.size(), 3000u) << told;
    if (seed == 0) first = told;
    EXPECT_EQ(told, first) << c.name << ", order " << seed;
  }
}

INSTANTIATE_TEST_SUITE_P(
    Streams, Interleaving,
    ::testing::Values(Case{"TenAndTwentyHertz", 10, 1, false}, Case{"TwoHertz", 2, 5, false},
                      Case{"OneHertz", 1, 1, false}, Case{"ThreeSeconds", 1. / 3, 2, false},
                      Case{"Spikes", 4, 2, true}, Case{"RareSpikes", 0.5, 5, true}),
    [](const auto& c) { return std::string(c.param.name); });

}  // namespace
}  // namespace wellgyro
