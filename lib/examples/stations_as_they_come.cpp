// Prints every station the moment it is known, and again when it is revised:
// stations_as_they_come JOB.toml RUN.lcm
#include <cstdio>

#include "wellgyro/base/angle.h"
#include "wellgyro/bus/log_reader.h"
#include "wellgyro/bus/survey_log.h"
#include "wellgyro/io/toml/job_file.h"

struct Printer : wellgyro::Sink {
  void OnStation(const wellgyro::Station& s) override {
    std::printf("MD %.1f m, inclination %.2f deg, azimuth %.2f deg, revision %d\n", s.md,
                wellgyro::ToDegrees(s.inclination), wellgyro::ToDegrees(s.azimuth), s.revision);
  }
};

int main(int argc, char** argv) {
  if (argc != 3) return std::fputs("usage: stations_as_they_come JOB.toml RUN.lcm\n", stderr), 1;
  const auto file = wellgyro::ReadJob(argv[1]);
  if (!file) return std::fprintf(stderr, "%s\n", SentenceOf(file.fault()).c_str()), 2;
  auto log = wellgyro::LogReader::Open(argv[2]);
  if (!log) return std::fprintf(stderr, "%s\n", SentenceOf(log.fault()).c_str()), 2;
  Printer printer;
  wellgyro::Surveyor surveyor(file->job, printer);
  wellgyro::SurveyorListener listener(surveyor, printer);
  wellgyro::Feed feed(file->job.channels, listener);
  for (wellgyro::LogEvent event; log->Next(event);) feed.Take(event.channel, event.data);
  surveyor.Finish();
}
