#include "wellgyro/bus/log_tables.h"

#include <algorithm>
#include <cstddef>
#include <iterator>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <fmt/core.h>

#include "wellgyro/bus/feed.h"
#include "wellgyro/bus/log_parts.h"
#include "wellgyro/bus/log_reader.h"

namespace wellgyro {
namespace {

// A table, handed over in pieces as it grows.
class Table {
 public:
  explicit Table(const TextSink& sink) : sink_(sink) {}

  bool begun() const { return begun_; }
  void Add(const std::string& line) {
    begun_ = true;
    lines_ += line;
    lines_ += '\n';
    if (lines_.size() >= kPiece) HandOver();
  }

  std::optional<Fault> End() {
    if (!lines_.empty()) HandOver();
    return fault_;
  }

 private:
  static constexpr std::size_t kPiece = 1 << 20;  // [bytes] that are handed over at once

  void HandOver() {
    if (!fault_) fault_ = sink_(lines_);
    lines_.clear();
  }

  const TextSink& sink_;
  std::string lines_;
  std::optional<Fault> fault_;  // the first, after which nothing more is handed over
  bool begun_ = false;
};

std::string Three(const Eigen::Vector3d& v, bool with_z) {
  return with_z ? fmt::format(",{},{},{}", v.x(), v.y(), v.z())
                : fmt::format(",{},{}", v.x(), v.y());
}

class Writer : public Listener {
 public:
  Writer(const TextSink& samples, const TextSink& depths) : samples_(samples), depths_(depths) {}

  void OnImu(std::span<const ImuSample> batch) override {
    for (const ImuSample& sample : batch) Add(sample);
  }

  void OnDepth(const DepthMark& mark) override {
    if (!depths_.begun()) {
      has_sigma_ = mark.sigma.has_value();
      has_tension_ = mark.tension.has_value();
      depths_.Add(std::string("UTC[us],MD[m],STOPPED,MARK,CORRECTED") +
                  (has_sigma_ ? ",SIG_MD[m]" : "") + (has_tension_ ? ",TENSION[N]" : ""));
    }
    std::string row =
        fmt::format("{},{},{},{},{}", mark.utc.ns / 1000, mark.md, mark.stopped ? 1 : 0,
                    mark.magnetic_mark ? 1 : 0, mark.corrected ? 1 : 0);
    if (has_sigma_) row += mark.sigma ? fmt::format(",{}", *mark.sigma) : ",";
    if (has_tension_) row += mark.tension ? fmt::format(",{}", *mark.tension) : ",";
    depths_.Add(row);
    ++tables.marks;
  }

  void OnFault(const Fault& /*fault*/) override { ++tables.left_out; }

  std::optional<Fault> End() {
    if (auto fault = samples_.End()) return fault;
    return depths_.End();
  }

  LogTables tables;

 private:
  void Add(const ImuSample& sample) {
    if (!samples_.begun()) {
      first_ = sample;
      samples_.Add(std::string("TOOL[ns],UTC[us],GX[rad/s],GY[rad/s]") +
                   (sample.has_gz ? ",GZ[rad/s]" : "") + ",AX[m/s2],AY[m/s2],AZ[m/s2]" +
                   (sample.has_mag ? ",MX[T],MY[T],MZ[T]" : "") + ",TEMP[degC],RUN,TOOL_NUMBER");
    }
    if (sample.stamp.tool != first_.stamp.tool || sample.has_gz != first_.has_gz ||
        sample.has_mag != first_.has_mag) {
      ++tables.left_out;
      return;
    }
    samples_.Add(
        fmt::format("{},{}", sample.stamp.tool_time.ns, sample.stamp.utc.ns / 1000) +
        Three(sample.w_IT_T, first_.has_gz) + Three(sample.f_T, true) +
        (first_.has_mag ? Three(sample.b_T, true) : "") +
        fmt::format(",{},{},{}", sample.stamp.temperature, sample.stamp.run, sample.stamp.tool));
    ++tables.samples;
  }

  Table samples_, depths_;
  ImuSample first_;
  bool has_sigma_ = false, has_tension_ = false;
};

}  // namespace

Result<LogTables> WriteLogTables(const std::string& log, const Channels& channels,
                                 const TextSink& samples, const TextSink& depths) {
  const Result<std::vector<std::string>> parts = LogParts(log);
  if (!parts) return parts.fault();
  Writer writer(samples, depths);
  Feed feed(channels, writer);
  std::vector<Fault> damage;
  for (const std::string& part : *parts) {
    Result<LogReader> reader = LogReader::Open(part);
    if (!reader) return reader.fault();
    LogEvent event;
    while (reader->Next(event)) feed.Take(event.channel, event.data, event.data_offset);
    std::ranges::move(reader->Faults(), std::back_inserter(damage));
  }
  if (writer.tables.samples == 0) {
    return Fault{.code = FaultCode::kForeign,
                 .text = fmt::format("holds no sample in SI units on channel {}", channels.imu),
                 .source = log};
  }
  if (auto fault = writer.End()) return *std::move(fault);
  writer.tables.damage = std::move(damage);
  return writer.tables;
}

}  // namespace wellgyro
