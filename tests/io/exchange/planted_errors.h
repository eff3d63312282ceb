#pragma once

#include <functional>
#include <string>
#include <vector>

#include "foreign_files.h"

namespace wellgyro::foreign {

/// An error that a file may come with.
struct Planted {
  std::string name;
  bool map;  ///< wants map coordinates beside
  std::function<void(Sheet&, const Well&)> plant;
};

// By what they are of: units of lengths, norths, the datum of depths, offsets and map coordinates,
// cells that stand for nothing.
std::vector<Planted> UnitErrors();
std::vector<Planted> NorthErrors();
std::vector<Planted> DatumErrors();
std::vector<Planted> OffsetErrors();
std::vector<Planted> NullErrors();

}  // namespace wellgyro::foreign
