#include "wellgyro/estimate/roll_change.h"

#include <cmath>

#include "wellgyro/math/sinc.h"

namespace wellgyro {

using Eigen::Vector2d;

std::optional<double> FrequencyOf(const EstimateSetup& setup, const Layout& layout,
                                  const BorderVector& border) {
  if (layout.frequency == kAbsent) return std::nullopt;
  return *setup.swing + border[layout.frequency];
}

Vector2d SwingAfter(double frequency, double seconds, const Vector2d& a) {
  const double c = std::cos(frequency * seconds), s = std::sin(frequency * seconds);
  return {c * a.x() + s * a.y(), c * a.y() - s * a.x()};
}

Vector2d SwingByFrequency(double frequency, double seconds, const Vector2d& a) {
  const Vector2d after = SwingAfter(frequency, seconds, a);
  return seconds * Vector2d(after.y(), -after.x());
}

Vector2d MeanOfSwing(double frequency, double seconds) {
  const double angle = frequency * seconds, half = std::sin(0.5 * angle);
  return {Sinc(angle), 2 * half * half / angle};
}

Vector2d MeanByFrequency(double frequency, double seconds) {
  const double angle = frequency * seconds;
  return (Vector2d(std::cos(angle), std::sin(angle)) - MeanOfSwing(frequency, seconds)) / frequency;
}

RollSquares RollSquaresOf(std::optional<double> frequency, double seconds, double axial_change,
                          const RollChange& roll, const Node& begin, const Node& end) {
  const double rate = (end.roll_rate - begin.roll_rate - axial_change) / roll.sigma;
  RollSquares squares{rate * rate, 0};
  if (frequency) {
    const Vector2d change = end.swing - SwingAfter(*frequency, seconds, begin.swing);
    squares.swing = change.squaredNorm() / (roll.swing_sigma * roll.swing_sigma);
  }
  return squares;
}

}  // namespace wellgyro
