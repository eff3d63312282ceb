#include "wellgyro/bus/log_tables.h"

#include <fstream>
#include <optional>
#include <span>
#include <system_error>
#include <utility>

#include <fmt/core.h>

#include "wellgyro/bus/feed.h"
#include "wellgyro/bus/log_reader.h"

namespace wellgyro {
namespace {

// A table under a temporary name until it is whole.
class Table {
 public:
  explicit Table(std::filesystem::path path) : path_(std::move(path)) {
    partial_ = path_;
    partial_ += ".partial";
  }
  ~Table() {
    out_.close();
    std::error_code ignored;
    if (!partial_.empty()) std::filesystem::remove(partial_, ignored);
  }
  Table(const Table&) = delete;
  Table& operator=(const Table&) = delete;

  bool begun() const { return begun_; }
  void Add(const std::string& line) {
    if (!begun_) out_.open(partial_, std::ios::binary | std::ios::trunc);
    begun_ = true;
    out_ << line << '\n';
  }

  std::optional<Fault> PutInPlace() {
    if (!begun_) return std::nullopt;
    out_.close();
    std::error_code error;
    if (out_) std::filesystem::rename(partial_, path_, error);
    if (!out_ || error) {
      return Fault{.code = FaultCode::kIo, .text = "cannot be written", .source = path_.string()};
    }
    partial_.clear();
    return std::nullopt;
  }

 private:
  std::filesystem::path path_, partial_;
  std::ofstream out_;
  bool begun_ = false;
};

std::string Three(const Eigen::Vector3d& v, bool with_z) {
  return with_z ? fmt::format(",{},{},{}", v.x(), v.y(), v.z())
                : fmt::format(",{},{}", v.x(), v.y());
}

class Writer : public Listener {
 public:
  Writer(const std::filesystem::path& samples, const std::filesystem::path& depths)
      : samples_(samples), depths_(depths) {}

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

  std::optional<Fault> PutInPlace() {
    if (auto fault = samples_.PutInPlace()) return fault;
    return depths_.PutInPlace();
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
                                 const std::filesystem::path& samples,
                                 const std::filesystem::path& depths) {
  Result<LogReader> reader = LogReader::Open(log);
  if (!reader) return reader.fault();
  Writer writer(samples, depths);
  Feed feed(channels, writer);
  LogEvent event;
  while (reader->Next(event)) feed.Take(event.channel, event.data, event.data_offset);
  if (writer.tables.samples == 0) {
    return Fault{.code = FaultCode::kForeign,
                 .text = fmt::format("holds no sample in SI units on channel {}", channels.imu),
                 .source = log};
  }
  if (auto fault = writer.PutInPlace()) return *std::move(fault);
  return writer.tables;
}

}  // namespace wellgyro
