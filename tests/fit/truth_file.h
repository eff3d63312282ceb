#pragma once

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include <Eigen/Core>
#include <gtest/gtest.h>

#include "wellgyro/calibration/fit_report.h"
#include "wellgyro/io/sensor/bench_data.h"

namespace wellgyro::test {

/// The reference bench data, where the machine has them.
inline std::filesystem::path BenchDir() {
  return std::filesystem::path(WELLGYRO_REFERENCE_DIR) / "calibration" / "bench";
}

inline std::string TextOf(const std::filesystem::path& path) {
  std::ifstream file(path);
  std::stringstream text;
  text << file.rdbuf();
  return text.str();
}

/// All numbers behind "key" in a truth.json, up to the end of its value, in their order.
inline Eigen::VectorXd TruthOf(const std::string& json, const std::string& key) {
  std::size_t at = json.find("\"" + key + "\":");
  if (at == std::string::npos) throw std::runtime_error("no " + key);
  at += key.size() + 3;
  std::vector<double> numbers;
  int depth = 0;
  while (at < json.size()) {
    const char c = json[at];
    if (c == '[') ++depth;
    if (c == ']' && --depth == 0) break;
    if (c == '-' || (c >= '0' && c <= '9')) {
      char* end = nullptr;
      numbers.push_back(std::strtod(json.c_str() + at, &end));
      at = static_cast<std::size_t>(end - json.c_str());
      if (depth == 0) break;
      continue;
    }
    ++at;
  }
  return Eigen::Map<const Eigen::VectorXd>(numbers.data(),
                                           static_cast<Eigen::Index>(numbers.size()));
}

inline bool HasResult(const FitReport& report, const std::string& name) {
  for (const FitQuantity& quantity : report.result) {
    if (quantity.name == name) return true;
  }
  return false;
}

/// A quantity of a result, row by row.
inline Eigen::VectorXd Found(const FitReport& report, const std::string& name, bool sigma = false) {
  for (const FitQuantity& quantity : report.result) {
    if (quantity.name != name) continue;
    const Eigen::MatrixXd turned = (sigma ? quantity.sigma : quantity.value).transpose();
    return turned.reshaped();
  }
  ADD_FAILURE() << "no " << name << " in the result";
  return {};
}

/// Largest difference, relative to the largest of the truth.
inline double Apart(const Eigen::VectorXd& found, const Eigen::VectorXd& truth) {
  if (found.size() != truth.size()) return 1e9;
  return (found - truth).cwiseAbs().maxCoeff() / truth.cwiseAbs().maxCoeff();
}

}  // namespace wellgyro::test
