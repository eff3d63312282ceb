#include "wellgyro/simulate/sample_batcher.h"

#include <set>
#include <stdexcept>
#include <vector>

#include <gtest/gtest.h>

namespace wellgyro {
namespace {

std::vector<SampleBatch> Batches(const SimulatedStreams& streams, std::int64_t samples) {
  SampleBatcher batcher(streams, 21);
  std::vector<SampleBatch> batches;
  SampleBatch batch;
  for (std::int64_t seq = 0; seq < samples; ++seq) {
    ImuSample sample;
    sample.stamp.seq = seq;
    sample.stamp.period_ns = 10'000'000;
    if (batcher.Push(sample, batch)) batches.push_back(batch);
  }
  if (batcher.Flush(batch)) batches.push_back(batch);
  EXPECT_FALSE(batcher.Flush(batch));
  return batches;
}

std::set<std::int64_t> Seen(const std::vector<SampleBatch>& batches) {
  std::set<std::int64_t> seen;
  for (const SampleBatch& batch : batches) {
    for (std::size_t i = 0; i < batch.samples.size(); ++i) {
      EXPECT_EQ(batch.samples[i].stamp.seq,
                batch.samples[0].stamp.seq + static_cast<std::int64_t>(i));
      seen.insert(batch.samples[i].stamp.seq);
    }
  }
  return seen;
}

TEST(SampleBatcher, EverySampleOnceWithoutOverlap) {
  const auto batches = Batches({.batch = 30}, 100);
  ASSERT_EQ(batches.size(), 4u);
  EXPECT_EQ(batches[2].samples.size(), 30u);
  EXPECT_EQ(batches[3].samples.size(), 10u);
  EXPECT_EQ(Seen(batches).size(), 100u);
}

TEST(SampleBatcher, OverlapRepeatsTheEndOfTheMessageBefore) {
  const auto batches = Batches({.batch = 30, .overlap = 5}, 100);
  ASSERT_EQ(batches.size(), 4u);
  EXPECT_EQ(batches[0].samples.size(), 30u);
  EXPECT_EQ(batches[1].samples.size(), 35u);
  EXPECT_EQ(batches[1].samples.front().stamp.seq, 25);
  EXPECT_EQ(batches[3].samples.size(), 15u);
  EXPECT_EQ(Seen(batches).size(), 100u);
}

TEST(SampleBatcher, OutagesTakeWholeMessages) {
  // Messages end at 0.29, 0.59, 0.89 ... s.
  const auto batches = Batches({.batch = 30, .overlap = 5, .outages = {{0.5, 0.6}}}, 120);
  ASSERT_EQ(batches.size(), 3u);
  const auto seen = Seen(batches);
  EXPECT_TRUE(seen.count(29) == 1 && seen.count(30) == 0 && seen.count(54) == 0);
  EXPECT_TRUE(seen.count(55) == 1);
}

TEST(SampleBatcher, LosesAsOftenAsTold) {
  const auto batches = Batches({.batch = 2, .loss_probability = 0.2}, 20000);
  EXPECT_NEAR(static_cast<double>(batches.size()), 8000, 4 * 40);
  EXPECT_TRUE(Batches({.batch = 2, .loss_probability = 1}, 100).empty());
}

TEST(SampleBatcher, RefusesWhatMakesNoMessage) {
  EXPECT_THROW(SampleBatcher({.batch = 0}, 0), std::invalid_argument);
  EXPECT_THROW(SampleBatcher({.batch = 10, .overlap = 11}, 0), std::invalid_argument);
  EXPECT_THROW(SampleBatcher({.loss_probability = 1.5}, 0), std::invalid_argument);
}

}  // namespace
}  // namespace wellgyro
