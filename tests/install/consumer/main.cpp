// A vendor's program: one sample into a surveyor, and a message that is none of ours refused by a
// feed, with installed headers.
#include <cstdio>

#include <wellgyro/base/angle.h>
#include <wellgyro/bus/survey_log.h>
#include <wellgyro/earth/grid.h>
#include <wellgyro/survey/surveyor.h>

int main() {
  wellgyro::Job job;
  job.well.latitude = wellgyro::FromDegrees(60);
  job.well.longitude = wellgyro::FromDegrees(3);
  wellgyro::Sink sink;
  wellgyro::Surveyor surveyor(job, sink);
  wellgyro::ImuSample sample;
  sample.stamp.period_ns = 10'000'000;
  sample.f_T = {0, 0, -9.82};
  surveyor.Push(sample);
  wellgyro::SurveyorListener listener(surveyor, sink);
  wellgyro::Feed feed(wellgyro::Channels{}, listener);
  feed.Take("WELLGYRO_IMU", {});
  surveyor.Finish();
  const wellgyro::Survey survey = surveyor.Current(0);
  const wellgyro::GridPoint head =
      wellgyro::ProjectToGrid(wellgyro::UtmGrid("31N"), job.well.latitude, job.well.longitude);
  std::printf("%.3f m north; %s\n", head.northing, survey.unusable.c_str());
  return survey.unusable.empty() || feed.malformed() != 1 ? 1 : 0;
}
