#pragma once

#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>

#include "wellgyro/page/page_internal.h"

namespace wellgyro {

/// One thing in a view of space; points are (east, north, TVD), which is no frame: left-handed.
struct SpaceSeries {
  std::string name = {};
  ChartSeries::Mark mark = ChartSeries::Mark::kLine;
  int colour = 0;
  std::vector<Eigen::Vector3d> points = {};
  std::vector<double> md = {};
};

/// Puts a view of space into the page, seen from above and the south-east, that the script lets the
/// reader turn. A box about everything carries the names of its sides.
void AddSpace(PageText& page, std::string_view id, const std::string& title,
              std::vector<SpaceSeries> series);

}  // namespace wellgyro
