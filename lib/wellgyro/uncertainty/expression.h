#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "wellgyro/base/export.h"
#include "wellgyro/base/result.h"

namespace wellgyro {

/// An arithmetic expression, compiled once: numbers, named values, + - * / ^, brackets, and the
/// functions abs, sin, cos, tan, asin, acos, atan, sqrt (also sqr, which the published sheets write
/// for the root), exp, ln (also log), min and max of two, and if(x, a, b), which is a where x >= 0.
/// Names do not mind their case. Angles are radians.
///
/// There is nothing to call and no way out: what does not fit the grammar is refused with its
/// column, and so are texts of more than 2000 characters, nesting beyond 64 and more than 512
/// operations.
/// `^` binds tighter than a leading sign and to the right, as on a sheet of paper.
class WELLGYRO_EXPORT Expression {
 public:
  /// `names` are the values it may speak of, in lower case. Fault kSyntax or kForeign with the
  /// column.
  static Result<Expression> Compile(std::string_view text, std::span<const std::string_view> names);

  /// Its value for the values of the names, in their order; not finite where the arithmetic is not.
  double At(std::span<const double> values) const;
  bool Uses(std::size_t name) const;  ///< whether it speaks of that name
  /// Its value, where it speaks of no name.
  std::optional<double> Constant() const;

 private:
  friend class ExpressionCompiler;
  enum class Code : std::uint8_t {
    kNumber,
    kName,
    kNegate,
    kAbs,
    kSin,
    kCos,
    kTan,
    kAsin,
    kAcos,
    kAtan,
    kSqrt,
    kExp,
    kLn,  // the last of one argument
    kAdd,
    kSubtract,
    kMultiply,
    kDivide,
    kPower,
    kMin,
    kMax,
    kIf,
  };
  struct Step {
    Code code = Code::kNumber;
    double number = 0;
    std::size_t name = 0;
  };
  static double Unary(Code code, double x);
  static double Binary(Code code, double x, double y);

  std::vector<Step> steps_;
};

}  // namespace wellgyro
