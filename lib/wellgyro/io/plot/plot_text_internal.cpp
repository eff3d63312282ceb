#include "wellgyro/io/plot/plot_text_internal.h"

#include <cmath>

namespace wellgyro {

std::string SvgText(std::string_view text) {
  std::string out;
  for (const char c : text) {
    if (c == '&') {
      out += "&amp;";
    } else if (c == '<') {
      out += "&lt;";
    } else if (c == '>') {
      out += "&gt;";
    } else if (c == '"') {
      out += "&quot;";
    } else if (static_cast<unsigned char>(c) < 0x20) {
      out += ' ';
    } else {
      out += c;
    }
  }
  return out;
}

double RoundTick(double x) {
  const double decade = std::pow(10, std::floor(std::log10(x)));
  for (const double m : {1.0, 2.0, 5.0}) {
    if (m * decade >= x * (1 - 1e-9)) return m * decade;
  }
  return 10 * decade;
}

}  // namespace wellgyro
