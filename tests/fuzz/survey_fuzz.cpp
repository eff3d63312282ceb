#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <span>
#include <stdexcept>
#include <vector>

#include "wellgyro/bus/encode.h"
#include "wellgyro/bus/feed.h"
#include "wellgyro/bus/survey_log.h"
#include "wellgyro/io/result/run_file.h"

#include "fuzz/fuzz.h"

// The input is a stream of messages: a byte for the type, two for the size, then the message, whose
// fingerprint is put right so that what is wrong lies deeper. The survey of them must end.

namespace wellgyro {
namespace {

using Bytes = std::vector<std::byte>;

constexpr std::size_t kFingerprint = 8;

Job TheJob() {
  Job job;
  job.well.latitude = 1;
  job.noise.angle_random_walk = 3e-6;
  job.errors.accel_noise = 1e-4;
  job.alignment.min_still = 10;
  job.depth.latency = 0.5;
  return job;
}

struct Count : Sink {
  void OnStation(const Station& station) override {
    if (!station.p_WT_W.allFinite() || !(station.cov_md_inc_azi(2, 2) >= 0)) std::abort();
  }
};

void Append(std::vector<std::uint8_t>& stream, std::uint8_t type, const Bytes& message) {
  stream.push_back(type);
  stream.push_back(static_cast<std::uint8_t>(message.size() >> 8));
  stream.push_back(static_cast<std::uint8_t>(message.size()));
  for (const std::byte b : message) stream.push_back(static_cast<std::uint8_t>(b));
}

/// A stop and a short way down.
std::vector<std::uint8_t> Stream() {
  std::vector<std::uint8_t> stream;
  Bytes bytes;
  ToolInfo info;
  Encode(info, bytes);
  Append(stream, static_cast<std::uint8_t>(MessageType::kToolInfo), bytes);
  const UtcTime begin{1'700'000'000'000'000'000};
  for (int second = 0; second < 30; ++second) {
    const UtcTime utc = begin + Duration::Seconds(second);
    DepthMark mark;
    mark.utc = utc;
    mark.seq = second;
    mark.md = 100 + std::max(0, second - 15);
    Encode(mark, bytes);
    Append(stream, static_cast<std::uint8_t>(MessageType::kDepth), bytes);
    std::vector<ImuSample> batch(5);
    for (int k = 0; k < 5; ++k) {
      ImuSample& sample = batch[static_cast<std::size_t>(k)];
      sample.stamp.seq = 5 * second + k;
      sample.stamp.period_ns = 200'000'000;
      sample.stamp.tool_time = ToolTime{sample.stamp.seq * 200'000'000};
      sample.stamp.utc = utc + Duration{k * 200'000'000};
      sample.f_T = {4.9, 0, -8.5};
      sample.w_IT_T = {1e-5, 2e-5, 0};
    }
    Encode(std::span<const ImuSample>(batch), bytes);
    Append(stream, static_cast<std::uint8_t>(MessageType::kImuBatch), bytes);
  }
  Event event;
  event.utc = begin + Duration::Seconds(20);
  event.kind = Event::Kind::kDepthRezero;
  event.has_value = true;
  event.value_m = 104;
  Encode(event, bytes);
  Append(stream, static_cast<std::uint8_t>(MessageType::kEvent), bytes);
  Command command;
  command.utc = begin + Duration::Seconds(25);
  command.kind = Command::Kind::kTakeStation;
  Encode(command, bytes);
  Append(stream, static_cast<std::uint8_t>(MessageType::kCommand), bytes);
  return stream;
}

void SurveyAll(std::span<const std::byte> stream) {
  Count sink;
  Surveyor surveyor(TheJob(), sink);
  SurveyorListener listener(surveyor, sink);
  const Channels channels;
  Feed feed(channels, listener);
  Bytes message;
  while (stream.size() >= 3) {
    const auto type = static_cast<MessageType>(std::to_integer<int>(stream[0]) % kMessageTypes);
    const std::size_t size = std::min<std::size_t>(
        256 * std::to_integer<std::size_t>(stream[1]) + std::to_integer<std::size_t>(stream[2]),
        stream.size() - 3);
    message.assign(stream.begin() + 3, stream.begin() + 3 + static_cast<std::ptrdiff_t>(size));
    if (size >= kFingerprint) {
      const std::uint64_t print = Fingerprint(type);
      for (std::size_t i = 0; i < kFingerprint; ++i) {
        message[i] = static_cast<std::byte>(print >> (8 * (7 - i)));
      }
    }
    feed.Take(NameOf(channels, type), message);
    stream = stream.subspan(3 + size);
  }
  surveyor.Finish();
  for (const std::int32_t tool : surveyor.tools()) {
    const Survey survey = surveyor.Current(tool);
    const std::vector<OutputFile> files = ResultFiles({}, {}, TheJob(), survey);
    const auto empty = [](const OutputFile& file) { return file.bytes.empty(); };
    if (files.empty() || std::ranges::any_of(files, empty)) std::abort();
  }
}

}  // namespace

namespace fuzz {

std::vector<std::vector<std::uint8_t>> Seeds() { return {Stream()}; }

}  // namespace fuzz
}  // namespace wellgyro

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  wellgyro::SurveyAll(std::as_bytes(std::span(data, size)));
  return 0;
}
