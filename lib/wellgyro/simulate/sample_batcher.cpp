#include "wellgyro/simulate/sample_batcher.h"

#include <algorithm>
#include <cstddef>
#include <stdexcept>

#include <fmt/core.h>

#include "wellgyro/simulate/random_stream.h"

namespace wellgyro {
namespace {

constexpr std::uint64_t kLossStream = 3000;  // a number that no other draw has

}  // namespace

SampleBatcher::SampleBatcher(const SimulatedStreams& streams, std::uint64_t seed)
    : streams_(streams), loss_(RandomStream(seed, kLossStream)) {
  if (streams.batch < 1) {
    throw std::invalid_argument(fmt::format("[streams] batch: {} is not positive", streams.batch));
  }
  if (streams.overlap < 0 || streams.overlap > streams.batch) {
    throw std::invalid_argument(fmt::format("[streams] overlap: {} is not within 0 and batch {}",
                                            streams.overlap, streams.batch));
  }
  if (!(streams.loss_probability >= 0 && streams.loss_probability <= 1)) {
    throw std::invalid_argument(
        fmt::format("[streams] loss_probability: {} is no probability", streams.loss_probability));
  }
  held_.reserve(static_cast<std::size_t>(streams.batch) +
                static_cast<std::size_t>(streams.overlap));
}

bool SampleBatcher::Push(const ImuSample& sample, SampleBatch& batch) {
  held_.push_back(sample);
  return ++fresh_ == static_cast<std::size_t>(streams_.batch) && Complete(batch);
}

bool SampleBatcher::Flush(SampleBatch& batch) { return fresh_ > 0 && Complete(batch); }

bool SampleBatcher::Complete(SampleBatch& batch) {
  const ImuSample& last = held_.back();
  // By the sample's own number, since its clocks are part of what is simulated.
  const double time = static_cast<double>(last.stamp.seq) * last.stamp.period_ns * 1e-9;
  const bool unlucky = loss_.Uniform() < streams_.loss_probability;
  const bool out = std::any_of(streams_.outages.begin(), streams_.outages.end(),
                               [&](const Outage& o) { return time >= o.begin && time < o.end; });
  const bool arrives = !unlucky && !out;
  if (arrives) batch.samples.assign(held_.begin(), held_.end());
  const auto keep = std::min(held_.size(), static_cast<std::size_t>(streams_.overlap));
  held_.erase(held_.begin(), held_.end() - static_cast<std::ptrdiff_t>(keep));
  fresh_ = 0;
  return arrives;
}

}  // namespace wellgyro
