#pragma once

namespace wellgyro {

inline double Square(double x) { return x * x; }

}  // namespace wellgyro
