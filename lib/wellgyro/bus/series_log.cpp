#include "wellgyro/bus/series_log.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <filesystem>
#include <optional>
#include <set>
#include <system_error>
#include <utility>

#include <fmt/core.h>

#include "wellgyro/bus/decode.h"
#include "wellgyro/bus/log_reader.h"

namespace wellgyro {
namespace {

constexpr std::size_t kFaultsTold = 3;  // then their count

struct Wanted {
  bool raw = false;
  bool gyro = false;
  int axis = 0;  // or the raw channel
};

std::optional<Wanted> Understand(const std::string& name) {
  if (name.size() == 2 && (name[0] == 'g' || name[0] == 'a') && name[1] >= 'x' && name[1] <= 'z') {
    return Wanted{.gyro = name[0] == 'g', .axis = name[1] - 'x'};
  }
  Wanted wanted{.raw = true};
  const char* end = name.data() + name.size();
  const auto [stop, error] = std::from_chars(name.data(), end, wanted.axis);
  if (error != std::errc() || stop != end || wanted.axis < 0 ||
      wanted.axis >= RawSample::kChannelsMax) {
    return std::nullopt;
  }
  return wanted;
}

/// Lays samples in their places by their numbers.
class Collector {
 public:
  void Take(const SampleStamp& stamp, double value, bool saturated, bool has_temperature) {
    const auto size = std::ssize(now_.values);
    const std::int64_t ahead = stamp.seq - begin_seq_ - size;
    const bool restarted = size > 0 && (stamp.session != session_ ||
                                        stamp.period_ns != period_ns_ || ahead > kGapSamplesMost);
    if (size == 0 || restarted) {
      Restart(stamp);
    } else if (ahead < 0) {
      return;
    } else if (ahead > 0) {
      now_.gaps.push_back({size, size + ahead});
      const auto to = static_cast<std::size_t>(size + ahead);
      now_.values.resize(to, 0);
      if (has_temperature) now_.temperature.resize(to, stamp.temperature);
    }
    const auto at = std::ssize(now_.values);
    now_.values.push_back(value);
    if (has_temperature) now_.temperature.push_back(stamp.temperature);
    if (!saturated) return;
    if (!now_.saturated.empty() && now_.saturated.back().end == at) {
      ++now_.saturated.back().end;
    } else {
      now_.saturated.push_back({at, at + 1});
    }
  }

  SampleSeries Longest() {
    KeepLonger();
    if (stretches_ > 1) {
      longest_.notes.push_back(
          fmt::format("the source restarted, or its period changed: the longest of {} stretches is "
                      "taken, session {} from sample number {}",
                      stretches_, longest_session_, longest_seq_));
    }
    return std::move(longest_);
  }

 private:
  void Restart(const SampleStamp& stamp) {
    KeepLonger();
    ++stretches_;
    now_ = {};
    session_ = stamp.session;
    period_ns_ = stamp.period_ns;
    begin_seq_ = stamp.seq;
    now_.period = 1e-9 * stamp.period_ns;
  }
  void KeepLonger() {
    if (now_.values.size() <= longest_.values.size()) return;
    longest_ = std::move(now_);
    longest_session_ = session_;
    longest_seq_ = begin_seq_;
  }

  SampleSeries now_;
  SampleSeries longest_;
  std::int32_t session_ = 0;
  std::int32_t period_ns_ = 0;
  std::int64_t begin_seq_ = 0;
  std::int32_t longest_session_ = 0;
  std::int64_t longest_seq_ = 0;
  int stretches_ = 0;
};

class SeriesReader {
 public:
  SeriesReader(Wanted wanted, const SeriesChannel& channel) : wanted_(wanted), channel_(channel) {}

  void Take(const LogEvent& event) {
    const bool named = !channel_.bus_channel.empty();
    if (named && event.channel != channel_.bus_channel) return;
    const auto type = wanted_.raw ? MessageType::kRawBatch : MessageType::kImuBatch;
    if (TypeOf(event.data) != type) return;
    // Without a name, the first channel that has the type.
    if (!named) {
      if (heard_.empty()) heard_ = event.channel;
      if (event.channel != heard_) {
        others_.insert(std::string(event.channel));
        return;
      }
    }
    if (wanted_.raw) {
      const auto batch = DecodeRawBatch(event.data, raw_, event.channel);
      if (batch) {
        for (const auto& sample : *batch) TakeRaw(sample);
      } else {
        Refuse(batch.fault());
      }
    } else {
      std::optional<Fault> damage;
      const auto batch = DecodeImuBatch(event.data, imu_, event.channel, &damage);
      if (batch) {
        for (const auto& sample : *batch) TakeImu(sample);
      } else {
        damage = batch.fault();
      }
      if (damage) Refuse(*damage);
    }
  }

  Result<SampleSeries> Finish(const std::vector<Fault>& log_faults) {
    SampleSeries series = collector_.Longest();
    if (series.values.empty()) return NothingFound();
    for (const auto& fault : log_faults) Refuse(fault);
    if (refused_ > 0) {
      series.damaged = true;
      std::string text = fmt::format("{} damaged places or messages in the log", refused_);
      for (const auto& told : told_) text += "; " + told;
      series.notes.push_back(text);
    }
    if (!others_.empty() || !other_tools_.empty()) {
      series.notes.push_back("the log has more such samples, of other bus channels or tools");
    }
    series.unit = wanted_.raw ? "counts" : wanted_.gyro ? "rad_per_s" : "mps2";
    return series;
  }

 private:
  bool IsTool(const SampleStamp& stamp) {
    if (!tool_) tool_ = channel_.tool.value_or(stamp.tool);
    if (stamp.tool != *tool_) other_tools_.insert(stamp.tool);
    return stamp.tool == *tool_;
  }

  void TakeImu(const ImuSample& sample) {
    if (!IsTool(sample.stamp)) return;
    if (wanted_.gyro && wanted_.axis == 2 && !sample.has_gz) return;
    const double value = wanted_.gyro ? sample.w_IT_T(wanted_.axis) : sample.f_T(wanted_.axis);
    const bool saturated =
        wanted_.gyro ? sample.stamp.gyro_saturated : sample.stamp.accel_saturated;
    collector_.Take(sample.stamp, value, saturated, true);
  }

  void TakeRaw(const RawSample& sample) {
    if (!IsTool(sample.stamp)) return;
    if (wanted_.axis >= sample.n_channels) return;
    // Which sensor a raw channel belongs to stands in the tool model, not here.
    const bool saturated = sample.stamp.gyro_saturated || sample.stamp.accel_saturated;
    collector_.Take(sample.stamp, sample.counts[static_cast<std::size_t>(wanted_.axis)], saturated,
                    false);
  }

  void Refuse(const Fault& fault) {
    ++refused_;
    if (told_.size() < kFaultsTold) {
      told_.push_back(fault.offset >= 0 ? fmt::format("byte {}: {}", fault.offset, fault.text)
                                        : fault.text);
    }
  }

  Fault NothingFound() const {
    std::string text = fmt::format("no sample of channel {} is in this log", channel_.name);
    if (!channel_.bus_channel.empty()) text += " on " + channel_.bus_channel;
    if (refused_ > 0) text += fmt::format("; {} messages could not be read", refused_);
    return Fault{.code = FaultCode::kForeign, .text = text};
  }

  Wanted wanted_;
  const SeriesChannel& channel_;
  Collector collector_;
  std::vector<ImuSample> imu_;
  std::vector<RawSample> raw_;
  std::string heard_;
  std::set<std::string> others_;
  std::optional<std::int32_t> tool_;
  std::set<std::int32_t> other_tools_;
  std::int64_t refused_ = 0;
  std::vector<std::string> told_;
};

}  // namespace

Result<SampleSeries> ReadLcmSeries(const std::string& path, const SeriesChannel& channel,
                                   const std::function<void(double)>& progress) {
  const std::optional<Wanted> wanted = Understand(channel.name);
  if (!wanted) {
    return Fault{.code = FaultCode::kRange,
                 .text = fmt::format("channel \"{}\" is not gx, gy, gz, ax, ay, az or the number "
                                     "of a raw channel, 0 to {}",
                                     channel.name, RawSample::kChannelsMax - 1),
                 .source = path};
  }
  Result<LogReader> log = LogReader::Open(path);
  if (!log) return log.fault();
  std::error_code ignored;
  const auto size = static_cast<double>(std::filesystem::file_size(path, ignored));
  SeriesReader reader(*wanted, channel);
  std::int64_t events = 0;
  for (LogEvent event; log->Next(event);) {
    reader.Take(event);
    if (progress && ++events % 4096 == 0) progress(static_cast<double>(event.data_offset) / size);
  }
  Result<SampleSeries> series = reader.Finish(log->Faults());
  if (series) return series;
  Fault fault = series.fault();
  fault.source = path;
  return fault;
}

}  // namespace wellgyro
