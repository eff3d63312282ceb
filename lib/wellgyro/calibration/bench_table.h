#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>

namespace wellgyro {

/// Readings of a bench as it wrote them: named columns of numbers, in the units that the columns
/// say. Words are numbers here: x, y, z of an axis or channel 0, 1, 2; up and down +1 and -1.
struct BenchTable {
  std::string source;                ///< file
  std::vector<std::string> columns;  ///< names
  Eigen::MatrixXd values;            ///< a row a reading, finite
  std::vector<int> lines;            ///< of the file, one a row

  int rows() const { return static_cast<int>(values.rows()); }
  /// Place of a column.
  std::optional<int> Find(std::string_view name) const {
    for (std::size_t i = 0; i < columns.size(); ++i) {
      if (columns[i] == name) return static_cast<int>(i);
    }
    return std::nullopt;
  }
};

}  // namespace wellgyro
