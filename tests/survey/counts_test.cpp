// Counts of several tools in one batch, and samples among them that the tool model does not fit.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include <gtest/gtest.h>

#include "wellgyro/simulate/raw_counts.h"

#include "calibration/random_tool.h"
#include "support/simulated_survey.h"
#include "support/small_hole.h"

namespace wellgyro {
namespace {

using testing::CollectingSink;

constexpr test::ToolShape kHeated{.temperature = true};

/// Counts of one hole by two tools of one model, at other temperatures.
std::vector<RawSample> Counts(const Simulation& simulation, const ToolCalibration& model,
                              std::vector<SimulatedStep>& others) {
  RawCounter cold(model), warm(model);
  std::vector<RawSample> counts;
  Simulator simulator(simulation);
  SimulatedStep step;
  while (simulator.Next(step)) {
    const auto* sample = std::get_if<ImuSample>(&step);
    if (sample == nullptr) {
      others.push_back(step);
      continue;
    }
    for (RawCounter* counter : {&cold, &warm}) {
      counts.push_back(counter->Count(*sample, counter == &cold ? 40 : 140));
      counts.back().stamp.tool = counter == &cold ? 1 : 2;
    }
  }
  return counts;
}

class Counted : public ::testing::Test {
 protected:
  Counted() {
    const testing::SmallHole hole{.to_md = 120};
    Simulation simulation = SimulationOf(hole);
    simulation.tool.has_gz = true;
    job_ = JobOf(hole);
    job_.tool = test::RandomTool(5, kHeated);
    job_.tool->mag = {};
    job_.tool->gyro.heating.setConstant(1e-3);  // one tool after the other would seem to heat up
    counts_ = Counts(simulation, *job_.tool, others_);
  }

  /// Batches of so many counts.
  Survey SurveyIn(std::size_t size, std::int32_t tool, CollectingSink& sink) const {
    Surveyor surveyor(job_, sink);
    for (const SimulatedStep& step : others_) {
      std::visit([&](const auto& record) { surveyor.Push(record); }, step);
    }
    for (std::size_t i = 0; i < counts_.size(); i += size) {
      const std::size_t n = std::min(size, counts_.size() - i);
      surveyor.Push(std::span<const RawSample>(&counts_[i], n));
    }
    surveyor.Finish();
    return surveyor.Current(tool);
  }

  Job job_;
  std::vector<SimulatedStep> others_;
  std::vector<RawSample> counts_;
};

TEST_F(Counted, OneBatchMayHoldThoseOfSeveralTools) {
  for (const std::int32_t tool : {1, 2}) {
    CollectingSink alone_sink, mixed_sink;
    const Survey alone = SurveyIn(1, tool, alone_sink), mixed = SurveyIn(50, tool, mixed_sink);
    ASSERT_EQ(alone.unusable, "");
    ASSERT_EQ(alone.chosen.size(), mixed.chosen.size());
    for (std::size_t i = 0; i < alone.chosen.size(); ++i) {
      EXPECT_EQ(alone.chosen[i].azimuth, mixed.chosen[i].azimuth) << tool;
      EXPECT_EQ(alone.chosen[i].inclination, mixed.chosen[i].inclination) << tool;
    }
  }
}

TEST_F(Counted, OneThatDoesNotFitTakesNoOtherWithIt) {
  for (std::size_t i = 1'000; i < counts_.size(); i += 1'000) {
    counts_[i].n_channels = i % 2'000 == 0 ? 1 : 99;
  }
  CollectingSink sink;
  const Survey survey = SurveyIn(50, 1, sink);
  ASSERT_EQ(survey.unusable, "");
  const std::int64_t bad = static_cast<std::int64_t>((counts_.size() - 1) / 1'000);
  EXPECT_EQ(std::ranges::count_if(sink.faults,
                                  [](const Fault& fault) {
                                    return fault.text.find("channels") != std::string::npos;
                                  }),
            bad);
  EXPECT_EQ(survey.runs.at(0).samples, static_cast<std::int64_t>(counts_.size() / 2) - bad);
}

}  // namespace
}  // namespace wellgyro
