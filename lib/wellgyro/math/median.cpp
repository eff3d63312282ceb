#include "wellgyro/math/median.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

namespace wellgyro {

double Median(std::vector<double> values) {
  if (values.empty()) return 0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

double RobustSigma(std::vector<double> sizes) {
  return kSigmaPerMedianSize * Median(std::move(sizes));
}

double RobustSigma(std::vector<double> values, double middle) {
  for (double& value : values) value = std::abs(value - middle);
  return RobustSigma(std::move(values));
}

}  // namespace wellgyro
