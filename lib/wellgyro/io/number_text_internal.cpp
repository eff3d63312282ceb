#include "wellgyro/io/number_text_internal.h"

#include <cassert>
#include <cmath>

#include <fmt/core.h>

#include "wellgyro/base/angle.h"

namespace wellgyro {
namespace {

std::string WithoutMinusZero(std::string text) {
  const bool zero = text.find_first_not_of("-0.") == std::string::npos;
  return zero && text.front() == '-' ? text.substr(1) : text;
}

}  // namespace

std::string Fixed(double value, int decimals) {
  assert(std::isfinite(value));
  return WithoutMinusZero(fmt::format("{:.{}f}", value, decimals));
}

std::string Significant(double value) {
  assert(std::isfinite(value));
  return WithoutMinusZero(fmt::format("{:.9g}", value));
}

std::string Metres(double value) { return Fixed(value, 4); }

std::string AngleDeg(double radians) { return Fixed(ToDegrees(radians), 6); }

std::string AzimuthDeg(double radians) { return AzimuthText(radians, 6); }

std::string AzimuthText(double radians, int decimals) {
  std::string text = Fixed(ToDegrees(WrapTwoPi(radians)), decimals);
  return text.starts_with("360") ? Fixed(0, decimals) : text;
}

}  // namespace wellgyro
