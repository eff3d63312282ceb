#include <cmath>
#include <utility>

#include "wellgyro/survey/verdict/check_internal.h"
#include "wellgyro/survey/verdict/checks.h"

namespace wellgyro {
namespace {

// Flagged samples are isolated up to 1 in 100: one that its neighbours' mean stands for makes the
// variance of the sum of three (1.5^2 + 1.5^2) / 3 = 1.5 times theirs, of a hundred 1.015 times.
constexpr std::int64_t kShare = 100;

}  // namespace

Verdict Judge(double value, double limit) {
  const double size = std::abs(value);
  if (!(size <= limit)) return Verdict::kFail;
  return size <= limit * (2.0 / 3.0) ? Verdict::kPass : Verdict::kWarn;
}

Check CompareWith(std::string code, std::int32_t run, Measured measured, double limit, double unit,
                  std::string unit_name, std::string source) {
  Check check;
  check.code = std::move(code);
  check.run = run;
  check.value = measured.value / unit;
  check.sigma = measured.sigma / unit;
  check.limit = limit / unit;
  check.unit = std::move(unit_name);
  check.limit_source = std::move(source);
  check.verdict = Judge(measured.value, limit);
  return check;
}

Check Compare(std::string code, std::int32_t run, Measured measured, std::optional<double> accepted,
              double unit, std::string unit_name) {
  Check check =
      CompareWith(std::move(code), run, measured, accepted ? *accepted : 3 * measured.sigma, unit,
                  std::move(unit_name), accepted ? "acceptance" : "3 sigma");
  if (!accepted) check.looks = 1;
  return check;
}

Check CountOf(std::string code, std::int32_t run, std::int64_t count, std::string source) {
  Check check = CompareWith(std::move(code), run, {static_cast<double>(count), 0}, 0, 1, "1",
                            std::move(source));
  if (check.verdict == Verdict::kFail) check.verdict = Verdict::kWarn;
  return check;
}

Check ShareOf(std::string code, std::int32_t run, std::int64_t count, std::int64_t all,
              std::string source) {
  Check check = CountOf(std::move(code), run, count, std::move(source));
  if (kShare * count > all) check.verdict = Verdict::kFail;
  return check;
}

Check NotDone(std::string code, std::int32_t run, std::string why) {
  Check check;
  check.code = std::move(code);
  check.run = run;
  check.limit_source = std::move(why);
  return check;
}

}  // namespace wellgyro
