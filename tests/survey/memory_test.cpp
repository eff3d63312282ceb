// What a run leaves in memory until its end: knots and stations, and nothing of its samples.
#include <cstddef>
#include <cstdio>
#include <variant>

#include <gtest/gtest.h>
#include <malloc.h>

#include "support/simulated_survey.h"
#include "support/small_hole.h"

namespace wellgyro {
namespace {

double HeapInUse() {
  const struct mallinfo2 heap = ::mallinfo2();
  return static_cast<double>(heap.uordblks + heap.hblkhd);
}

/// Bytes of the heap that a run of `seconds` holds when its last sample has come.
double Held(double seconds, double every) {
  testing::SmallHole hole;
  hole.imu_hz = 20;
  hole.to_md = seconds;
  hole.accel_noise_g = 1e-5;
  hole.stations_every = every;
  Simulation simulation = SimulationOf(hole);
  std::get<RunMove>(simulation.run.steps[1]).speed = 1;
  simulation.run.steps.pop_back();
  Sink sink;
  const double before = HeapInUse();
  Surveyor surveyor(JobOf(hole), sink);
  testing::Play(simulation, surveyor);
  return HeapInUse() - before;
}

// Vectors that grow hold up to twice what is in them: these lengths are just below a power of two.
// A station of a run of n errors holds two matrices of n by n, here of few.
TEST(Memory, GrowsByKnotsAndStationsAlone) {
  if (HeapInUse() == 0) GTEST_SKIP() << "the allocator does not tell";
  constexpr double kShort = 900, kLong = 1900;  // [s], a knot and at 1 m/s a metre each
  const double none = (Held(kLong, 5000) - Held(kShort, 5000)) / (kLong - kShort);
  const double every = (Held(kLong, 1) - Held(kShort, 1)) / (kLong - kShort);
  std::printf("a knot of 1 s holds %.0f bytes, a station %.0f\n", none, every - none);
  // Half an hour of 10 kHz, with a station every 30 m of it: less than 1 MB.
  EXPECT_LT(1800 * none + 60 * (every - none), 1e6);
  EXPECT_LT(every - none, 3000);
}

}  // namespace
}  // namespace wellgyro
