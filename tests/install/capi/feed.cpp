// Writes the samples and depths of a log as structs of wellgyro.h, surveys them by C++ and prints
// every station that came as the words of a wellgyro_directed_station, then survey.csv and the
// verdict: feed JOB.toml RUN.lcm STREAM
#include <array>
#include <bit>
#include <cinttypes>
#include <cstdio>
#include <fstream>
#include <vector>

#include <wellgyro.h>
#include <wellgyro/bus/feed.h>
#include <wellgyro/bus/log_reader.h>
#include <wellgyro/earth/grid.h>
#include <wellgyro/io/exchange/survey_csv.h>
#include <wellgyro/io/toml/job_file.h>
#include <wellgyro/survey/surveyor.h>

namespace {

class Printer : public wellgyro::Sink {
 public:
  void OnStation(const wellgyro::Station& from) override {
    wellgyro_directed_station directed{};
    wellgyro_station& to = directed.station;
    to = {.utime_us = from.utc.ns / 1000,
          .tool = from.tool,
          .run = from.run,
          .pass = static_cast<std::int32_t>(from.pass),
          .pass_number = from.pass_number,
          .number = from.number,
          .revision = from.revision,
          .status = static_cast<std::int32_t>(from.status),
          .kind = static_cast<std::int32_t>(from.kind),
          .quality = static_cast<std::uint32_t>(from.quality),
          .md_m = from.md,
          .inclination_rad = from.inclination,
          .azimuth_true_rad = from.azimuth,
          .toolface_rad = from.toolface,
          .north_m = from.p_WT_W.x(),
          .east_m = from.p_WT_W.y(),
          .tvd_m = from.p_WT_W.z()};
    for (int i = 0; i < 9; ++i) {
      to.cov_md_inc_azi[i] = from.cov_md_inc_azi(i / 3, i % 3);
      to.cov_position_m2[i] = from.cov_p_WT_W(i / 3, i % 3);
      directed.cov_tangent_rad2[i] = from.cov_tangent_L(i / 3, i % 3);
    }
    for (int i = 0; i < 3; ++i) directed.tangent[i] = from.tangent_L[i];
    for (const std::uint64_t word : std::bit_cast<std::array<std::uint64_t, 43>>(directed)) {
      std::printf("%016" PRIX64 " ", word);
    }
    std::printf("\n");
  }
};

class Copier : public wellgyro::Listener {
 public:
  Copier(wellgyro::Surveyor& surveyor, const char* path)
      : surveyor_(surveyor), out_(path, std::ios::binary) {}

  void OnImu(std::span<const wellgyro::ImuSample> batch) override {
    for (const wellgyro::ImuSample& from : batch) {
      wellgyro_imu to{};
      to.tool_ns = from.stamp.tool_time.ns;
      to.utime_us = from.stamp.utc.ns / 1000;
      to.seq = from.stamp.seq;
      to.session = from.stamp.session;
      to.run = from.stamp.run;
      to.tool = from.stamp.tool;
      to.period_ns = from.stamp.period_ns;
      to.temperature_degc = from.stamp.temperature;
      for (int i = 0; i < 3; ++i) {
        to.rate_rad_per_s[i] = from.w_IT_T[i];
        to.force_mps2[i] = from.f_T[i];
      }
      Write(0, &to, sizeof to);
      wellgyro::ImuSample plain;
      plain.stamp = {.tool_time = from.stamp.tool_time,
                     .utc = {to.utime_us * 1000},
                     .seq = to.seq,
                     .session = to.session,
                     .run = to.run,
                     .tool = to.tool,
                     .period_ns = to.period_ns,
                     .temperature = to.temperature_degc};
      plain.w_IT_T = from.w_IT_T;
      plain.f_T = from.f_T;
      surveyor_.Push(plain);
    }
  }

  void OnDepth(const wellgyro::DepthMark& from) override {
    wellgyro_depth to{};
    to.utime_us = from.utc.ns / 1000;
    to.seq = from.seq;
    to.session = from.session;
    to.run = from.run;
    to.md_m = from.md;
    to.sigma_m = from.sigma.value_or(-1);
    to.kind = static_cast<std::int32_t>(from.kind);
    Write(1, &to, sizeof to);
    wellgyro::DepthMark plain;
    plain.utc.ns = to.utime_us * 1000;
    plain.seq = to.seq;
    plain.session = to.session;
    plain.run = to.run;
    plain.md = to.md_m;
    if (to.sigma_m >= 0) plain.sigma = to.sigma_m;
    plain.kind = from.kind;
    surveyor_.Push(plain);
  }

 private:
  void Write(std::int32_t kind, const void* bytes, std::size_t size) {
    out_.write(reinterpret_cast<const char*>(&kind), sizeof kind);
    out_.write(static_cast<const char*>(bytes), static_cast<std::streamsize>(size));
  }

  wellgyro::Surveyor& surveyor_;
  std::ofstream out_;
};

}  // namespace

int main(int argc, char** argv) {
  if (argc != 4) return 1;
  const auto file = wellgyro::ReadJob(argv[1]);
  auto reader = wellgyro::LogReader::Open(argv[2]);
  if (!file || !reader) return 2;
  const wellgyro::Job& job = file->job;
  Printer printer;
  wellgyro::Surveyor surveyor(job, printer);
  Copier copier(surveyor, argv[3]);
  wellgyro::Feed feed(job.channels, copier);
  wellgyro::LogEvent event;
  while (reader->Next(event)) feed.Take(event.channel, event.data);
  surveyor.Adjust();
  surveyor.Finish();
  const wellgyro::WellGrid grid(*job.grid,
                                {.latitude = job.well.latitude, .longitude = job.well.longitude});
  const wellgyro::Survey survey = surveyor.Current(0);
  std::fputs(wellgyro::SurveyCsv(survey.chosen, &grid).c_str(), stdout);
  std::printf("%d ", static_cast<int>(survey.verdict.verdict));
  for (std::size_t i = 0; i < survey.verdict.causes.size(); ++i) {
    std::printf("%s%s", i > 0 ? "\n" : "", survey.verdict.causes[i].c_str());
  }
  std::printf("\n");
}
