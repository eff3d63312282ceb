#include "wellgyro/survey/stations/choose.h"

#include <vector>

#include <gtest/gtest.h>

namespace wellgyro {
namespace {

Station ChoiceAt(double md, double variance, std::int64_t utc) {
  Station station;
  station.md = md;
  station.cov_md_inc_azi(2, 2) = variance;
  station.utc.ns = utc;
  return station;
}

using Indices = std::vector<std::size_t>;

TEST(ChooseStations, TakesTheSmallestAzimuthVarianceAtEachDepth) {
  const std::vector<Station> stations = {ChoiceAt(20, 3, 1), ChoiceAt(10, 1, 2),
                                         ChoiceAt(20.04, 2, 3), ChoiceAt(10, 5, 4)};
  EXPECT_EQ(ChooseStations(stations), (Indices{1, 2}));
}

TEST(ChooseStations, TakesTheEarlierOnATie) {
  const std::vector<Station> stations = {ChoiceAt(10, 1, 9), ChoiceAt(10, 1, 4)};
  EXPECT_EQ(ChooseStations(stations), (Indices{1}));
}

TEST(ChooseStations, NeverTakesARejectedOrSupersededOne) {
  std::vector<Station> stations = {ChoiceAt(10, 1, 1), ChoiceAt(10, 2, 2), ChoiceAt(20, 1, 3)};
  stations[0].status = StationStatus::kRejected;
  stations[2].status = StationStatus::kSuperseded;
  EXPECT_EQ(ChooseStations(stations), (Indices{1}));
}

}  // namespace
}  // namespace wellgyro
