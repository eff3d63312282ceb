// One's own samples into a Surveyor: a tool at rest, 30 deg from vertical towards north.
#include <cmath>
#include <cstdio>

#include "wellgyro/base/angle.h"
#include "wellgyro/earth/earth.h"
#include "wellgyro/survey/surveyor.h"

struct Fixes : wellgyro::Sink {
  void OnNorthFix(const wellgyro::NorthFix& fix) override {
    std::printf("azimuth %.3f deg\n", wellgyro::ToDegrees(fix.azimuth));
  }
};

int main() {
  wellgyro::Job job;
  job.well.latitude = wellgyro::FromDegrees(60);
  job.noise.angle_random_walk = wellgyro::FromDegrees(0.01) / 60;
  Fixes fixes;
  wellgyro::Surveyor surveyor(job, fixes);
  const wellgyro::Site site = wellgyro::SiteAt(job.well.latitude, 0);
  const double tilt = wellgyro::FromDegrees(30), rise = tilt - job.well.latitude;
  for (wellgyro::ImuSample sample; sample.stamp.seq < 3000; ++sample.stamp.seq) {
    sample.stamp.period_ns = 100'000'000;
    sample.stamp.tool_time.ns = sample.stamp.utc.ns = sample.stamp.seq * 100'000'000;
    sample.f_T = site.gravity * Eigen::Vector3d(std::sin(tilt), 0, -std::cos(tilt));
    sample.w_IT_T = wellgyro::kEarthRate * Eigen::Vector3d(std::cos(rise), 0, std::sin(rise));
    surveyor.Push(sample);
  }
  surveyor.Finish();
}
