#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <string>
#include <string_view>

#include <Eigen/Core>

#include "wellgyro/io/result/json_table_internal.h"

namespace wellgyro {

/// Cells of a JsonTable by the name of their column. What is no such table has no rows. Refers to
/// it.
class Columns {
 public:
  explicit Columns(const Json& table);

  std::size_t rows() const { return rows_ ? rows_->size() : 0; }
  bool Has(std::string_view column) const { return index_.find(column) != index_.end(); }
  std::optional<double> Number(std::size_t row, std::string_view column) const;
  /// Empty where the cell is no text.
  std::string Text(std::size_t row, std::string_view column) const;
  /// Of north, east, vertical [m^2]; nothing where a cell of it is empty.
  std::optional<Eigen::Matrix3d> Covariance(std::size_t row) const;

 private:
  const Json* Cell(std::size_t row, std::string_view column) const;

  const Json* rows_ = nullptr;
  std::map<std::string, std::size_t, std::less<>> index_;
};

/// Differences between the passes of each run at the depths that both have: of each other pass less
/// the first, a list of {run, first, other, columns, rows}. Sigmas are those of both passes as if
/// they were independent: what errs alike in both stands in them twice.
Json PassDifferences(const Json& passes);

}  // namespace wellgyro
