#include "wellgyro/uncertainty/expression.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <utility>

namespace wellgyro {
namespace {

// Of a formula in a file from outside: characters, steps and brackets, so that neither memory nor
// the call stack can be exhausted.
constexpr std::size_t kLongest = 2000, kMostSteps = 512;
constexpr int kDeepest = 64;

char Lower(char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; }
bool IsLetter(char c) { return (Lower(c) >= 'a' && Lower(c) <= 'z') || c == '_'; }
bool IsDigit(char c) { return c >= '0' && c <= '9'; }

/// What leaves the compiler when a text is refused; never leaves this file.
struct BadExpression {
  Fault fault;
};

}  // namespace

/// Recursive descent, writing the steps in the order in which a stack of numbers takes them.
class ExpressionCompiler {
 public:
  ExpressionCompiler(std::string_view text, std::span<const std::string_view> names)
      : text_(text), names_(names) {}

  Expression Run() {
    if (text_.size() > kLongest) Refuse("is longer than 2000 characters");
    Sum();
    Skip();
    if (at_ != text_.size()) Refuse("has something left over here");
    return std::move(made_);
  }

 private:
  using Code = Expression::Code;

  [[noreturn]] void Refuse(const std::string& why) const {
    Fault fault;
    fault.code = FaultCode::kSyntax;
    fault.text = "the formula " + why + ", at its character " + std::to_string(at_ + 1);
    throw BadExpression{std::move(fault)};
  }
  void Skip() {
    while (at_ < text_.size() && (text_[at_] == ' ' || text_[at_] == '\t')) ++at_;
  }
  bool Take(char c) {
    Skip();
    if (at_ >= text_.size() || text_[at_] != c) return false;
    ++at_;
    return true;
  }
  void Need(char c) {
    if (!Take(c)) Refuse(std::string("lacks a '") + c + "'");
  }
  void Write(Code code, double number = 0, std::size_t name = 0) {
    if (made_.steps_.size() >= kMostSteps) Refuse("has more than 512 operations");
    made_.steps_.push_back({code, number, name});
  }

  void Sum();
  void Product();
  void Signed();
  void Power();
  void Atom();
  void Number();
  void Name();
  void Call(std::string_view name);

  std::string_view text_;
  std::span<const std::string_view> names_;
  std::size_t at_ = 0;
  int depth_ = 0;
  Expression made_;
};

void ExpressionCompiler::Sum() {
  if (++depth_ > kDeepest) Refuse("is nested more than 64 deep");
  Product();
  for (;;) {
    if (Take('+')) {
      Product();
      Write(Code::kAdd);
    } else if (Take('-')) {
      Product();
      Write(Code::kSubtract);
    } else {
      break;
    }
  }
  --depth_;
}

void ExpressionCompiler::Product() {
  Signed();
  for (;;) {
    if (Take('*')) {
      Signed();
      Write(Code::kMultiply);
    } else if (Take('/')) {
      Signed();
      Write(Code::kDivide);
    } else {
      break;
    }
  }
}

void ExpressionCompiler::Signed() {
  bool negative = false;
  for (;;) {
    if (Take('-')) {
      negative = !negative;
    } else if (!Take('+')) {
      break;
    }
  }
  Power();
  if (negative) Write(Code::kNegate);
}

void ExpressionCompiler::Power() {
  Atom();
  if (!Take('^')) return;
  if (++depth_ > kDeepest) Refuse("is nested more than 64 deep");
  Signed();
  --depth_;
  Write(Code::kPower);
}

void ExpressionCompiler::Atom() {
  Skip();
  if (at_ >= text_.size()) Refuse("ends too early");
  const char c = text_[at_];
  if (Take('(')) {
    Sum();
    Need(')');
  } else if (IsDigit(c) || c == '.') {
    Number();
  } else if (IsLetter(c)) {
    Name();
  } else {
    Refuse("has a sign that means nothing here");
  }
}

void ExpressionCompiler::Number() {
  double value = 0;
  const char* const begin = text_.data() + at_;
  const auto [end, error] = std::from_chars(begin, text_.data() + text_.size(), value);
  if (error != std::errc() || !std::isfinite(value)) Refuse("has a number that is none");
  at_ += static_cast<std::size_t>(end - begin);
  Write(Code::kNumber, value);
}

void ExpressionCompiler::Name() {
  std::string name;
  const std::size_t begin = at_;
  while (at_ < text_.size() && (IsLetter(text_[at_]) || IsDigit(text_[at_]))) {
    name += Lower(text_[at_++]);
  }
  Skip();
  if (at_ < text_.size() && text_[at_] == '(') return Call(name);
  if (name == "pi") return Write(Code::kNumber, 3.14159265358979323846);
  const auto found = std::ranges::find(names_, std::string_view(name));
  if (found == names_.end()) {
    at_ = begin;
    Refuse("speaks of '" + name + "', which is not known");
  }
  Write(Code::kName, 0, static_cast<std::size_t>(found - names_.begin()));
}

void ExpressionCompiler::Call(std::string_view name) {
  struct Function {
    std::string_view name;
    Code code;
    int arguments;
  };
  constexpr std::array kFunctions = {
      Function{"abs", Code::kAbs, 1},   Function{"sin", Code::kSin, 1},
      Function{"cos", Code::kCos, 1},   Function{"tan", Code::kTan, 1},
      Function{"asin", Code::kAsin, 1}, Function{"acos", Code::kAcos, 1},
      Function{"atan", Code::kAtan, 1}, Function{"sqrt", Code::kSqrt, 1},
      Function{"sqr", Code::kSqrt, 1},  Function{"exp", Code::kExp, 1},
      Function{"ln", Code::kLn, 1},     Function{"log", Code::kLn, 1},
      Function{"min", Code::kMin, 2},   Function{"max", Code::kMax, 2},
      Function{"if", Code::kIf, 3}};
  const auto* const found = std::ranges::find(kFunctions, name, &Function::name);
  if (found == kFunctions.end()) Refuse("calls '" + std::string(name) + "', which is no function");
  Need('(');
  for (int i = 0; i < found->arguments; ++i) {
    if (i > 0) Need(',');
    Sum();
  }
  Need(')');
  Write(found->code);
}

Result<Expression> Expression::Compile(std::string_view text,
                                       std::span<const std::string_view> names) {
  try {
    return ExpressionCompiler(text, names).Run();
  } catch (const BadExpression& refusal) {
    return refusal.fault;
  }
}

double Expression::Unary(Code code, double x) {
  switch (code) {
    case Code::kNegate:
      return -x;
    case Code::kAbs:
      return std::abs(x);
    case Code::kSin:
      return std::sin(x);
    case Code::kCos:
      return std::cos(x);
    case Code::kTan:
      return std::tan(x);
    case Code::kAsin:
      return std::asin(x);
    case Code::kAcos:
      return std::acos(x);
    case Code::kAtan:
      return std::atan(x);
    case Code::kSqrt:
      return std::sqrt(x);
    case Code::kExp:
      return std::exp(x);
    default:
      return std::log(x);
  }
}

double Expression::Binary(Code code, double x, double y) {
  switch (code) {
    case Code::kAdd:
      return x + y;
    case Code::kSubtract:
      return x - y;
    case Code::kMultiply:
      return x * y;
    case Code::kDivide:
      return x / y;
    case Code::kMin:
      return std::min(x, y);
    case Code::kMax:
      return std::max(x, y);
    default:
      return std::pow(x, y);
  }
}

double Expression::At(std::span<const double> values) const {
  std::array<double, kMostSteps> stack;  // no step adds more than one
  std::size_t top = 0;                   // one above the last
  for (const Step& step : steps_) {
    if (step.code == Code::kNumber) {
      stack[top++] = step.number;
    } else if (step.code == Code::kName) {
      stack[top++] = values[step.name];
    } else if (step.code <= Code::kLn) {
      stack[top - 1] = Unary(step.code, stack[top - 1]);
    } else if (step.code == Code::kIf) {
      top -= 2;
      stack[top - 1] = stack[top - 1] >= 0 ? stack[top] : stack[top + 1];
    } else {
      --top;
      stack[top - 1] = Binary(step.code, stack[top - 1], stack[top]);
    }
  }
  return stack[0];
}

bool Expression::Uses(std::size_t name) const {
  return std::ranges::any_of(
      steps_, [&](const Step& s) { return s.code == Code::kName && s.name == name; });
}

std::optional<double> Expression::Constant() const {
  if (std::ranges::any_of(steps_, [](const Step& s) { return s.code == Code::kName; })) {
    return std::nullopt;
  }
  return At({});
}

}  // namespace wellgyro
