#include "wellgyro/io/result/json_columns_internal.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

namespace wellgyro {
namespace {

/// The stations of one pass by their depths, of several at one depth the first.
struct PassRows {
  std::string name;
  std::map<double, std::size_t> by_md;
};

/// By run; its passes in the order in which they come.
std::map<double, std::vector<PassRows>> PassesByRun(const Columns& passes) {
  std::map<double, std::vector<PassRows>> runs;
  for (std::size_t row = 0; row < passes.rows(); ++row) {
    const auto md = passes.Number(row, "MD[m]"), run = passes.Number(row, "RUN");
    const std::string name = passes.Text(row, "PASS");
    const bool moving = name == "in" || name == "out" || name == "repeat";
    if (!md || !run || !moving || passes.Text(row, "STATUS") == "rejected") continue;
    std::vector<PassRows>& found = runs[*run];
    auto pass = std::ranges::find(found, name, &PassRows::name);
    if (pass == found.end()) pass = found.insert(found.end(), {name, {}});
    pass->by_md.emplace(*md, row);
  }
  return runs;
}

Json NumberOrNull(std::optional<double> value, double decimals) {
  return value ? Json(std::round(*value * decimals) / decimals) : Json();
}

std::optional<double> Together(std::optional<double> a, std::optional<double> b) {
  if (!a || !b) return std::nullopt;
  return std::hypot(*a, *b);
}

Json DifferencesOf(const Columns& passes, const PassRows& first, const PassRows& other) {
  Json rows = Json::array();
  for (const auto& [md, row] : first.by_md) {
    const auto match = other.by_md.find(md);
    if (match == other.by_md.end()) continue;
    const auto of = [&passes, here = row, there = match->second](const char* name) {
      return std::pair(passes.Number(here, name), passes.Number(there, name));
    };
    const auto [inc, inc_other] = of("INC[deg]");
    const auto [azi, azi_other] = of("AZI_TRUE[deg]");
    if (!inc || !inc_other || !azi || !azi_other) continue;
    const auto sigma_inc = of("SIG_INC[deg]"), sigma_azi = of("SIG_AZI[deg]");
    constexpr double kDecimals = 1e6;  // of the file's own numbers
    rows.push_back({md, *inc, NumberOrNull(*inc_other - *inc, kDecimals),
                    NumberOrNull(std::remainder(*azi_other - *azi, 360.0), kDecimals),
                    NumberOrNull(Together(sigma_inc.first, sigma_inc.second), kDecimals),
                    NumberOrNull(Together(sigma_azi.first, sigma_azi.second), kDecimals)});
  }
  return rows;
}

}  // namespace

Columns::Columns(const Json& table) {
  if (!table.is_object()) return;
  const auto columns = table.find("columns"), rows = table.find("rows");
  if (columns == table.end() || rows == table.end() || !columns->is_array() || !rows->is_array()) {
    return;
  }
  rows_ = &*rows;
  for (std::size_t i = 0; i < columns->size(); ++i) {
    if ((*columns)[i].is_string()) index_.emplace((*columns)[i].get<std::string>(), i);
  }
}

const Json* Columns::Cell(std::size_t row, std::string_view column) const {
  const auto index = index_.find(column);
  if (index == index_.end() || row >= rows()) return nullptr;
  const Json& cells = (*rows_)[row];
  return cells.is_array() && index->second < cells.size() ? &cells[index->second] : nullptr;
}

std::optional<double> Columns::Number(std::size_t row, std::string_view column) const {
  const Json* cell = Cell(row, column);
  return cell && cell->is_number() ? std::optional(cell->get<double>()) : std::nullopt;
}

std::string Columns::Text(std::size_t row, std::string_view column) const {
  const Json* cell = Cell(row, column);
  return cell && cell->is_string() ? cell->get<std::string>() : std::string();
}

std::optional<Eigen::Matrix3d> Columns::Covariance(std::size_t row) const {
  const auto nn = Number(row, "VAR_NN[m2]"), ne = Number(row, "COV_NE[m2]"),
             nv = Number(row, "COV_NV[m2]"), ee = Number(row, "VAR_EE[m2]"),
             ev = Number(row, "COV_EV[m2]"), vv = Number(row, "VAR_VV[m2]");
  if (!nn || !ne || !nv || !ee || !ev || !vv) return std::nullopt;
  Eigen::Matrix3d cov;
  cov << *nn, *ne, *nv, *ne, *ee, *ev, *nv, *ev, *vv;
  return cov;
}

Json PassDifferences(const Json& passes) {
  const Columns columns(passes);
  Json all = Json::array();
  for (const auto& [run, found] : PassesByRun(columns)) {
    for (std::size_t i = 1; i < found.size(); ++i) {
      all.push_back(
          {{"run", run},
           {"first", found[0].name},
           {"other", found[i].name},
           {"columns",
            {"MD[m]", "INC[deg]", "D_INC[deg]", "D_AZI[deg]", "SIG_D_INC[deg]", "SIG_D_AZI[deg]"}},
           {"rows", DifferencesOf(columns, found[0], found[i])}});
    }
  }
  return all;
}

}  // namespace wellgyro
