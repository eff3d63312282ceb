#include "wellgyro/io/result/allan_unit_internal.h"

#include <array>
#include <stdexcept>

#include <fmt/core.h>

#include "wellgyro/base/units.h"
#include "wellgyro/io/result/allan_answer.h"

namespace wellgyro {
namespace {

struct Word {
  std::string_view word;
  double si;
  bool accelerometer;
};
constexpr std::array kUnitWords{Word{"deg_per_h", units::kDegPerHour, false},
                                Word{"deg_per_s", units::kDeg, false},
                                Word{"rad_per_s", 1, false},
                                Word{"counts", 1, false},
                                Word{"mps2", 1, true},
                                Word{"milli_g", units::kMilliG, true}};

const Word* Find(std::string_view word) {
  for (const auto& known : kUnitWords) {
    if (known.word == word) return &known;
  }
  return nullptr;
}

}  // namespace

std::vector<std::string> AllanUnits() {
  std::vector<std::string> words;
  for (const Word& known : kUnitWords) words.emplace_back(known.word);
  return words;
}

AllanUnit UnitOf(std::string_view word, bool unitless) {
  if (unitless) return {.word = "", .plain = true};
  const Word* known = Find(word);
  if (!known) throw std::invalid_argument(fmt::format("unit {} is not known", word));
  AllanUnit unit{.word = std::string(word), .si = known->si, .accelerometer = known->accelerometer};
  unit.shown = unit.accelerometer ? "m/s2" : "deg/h";
  unit.column = unit.accelerometer ? "_mps2" : "_deg_per_h";
  unit.shown_si = unit.accelerometer ? 1 : units::kDegPerHour;
  return unit;
}

TermText TextOf(NoiseTerm term, const AllanUnit& unit) {
  const bool acc = unit.accelerometer;
  const auto in = [&](const char* gyro, double gyro_si, const char* accelerometer) {
    if (unit.plain) return std::pair<std::string, double>("", 1);
    return acc ? std::pair<std::string, double>(accelerometer, 1)
               : std::pair<std::string, double>(gyro, gyro_si);
  };
  const auto text = [](const char* name, const char* letter,
                       const std::pair<std::string, double>& u) {
    return TermText{name, letter, u.first, u.second};
  };
  switch (term) {
    case NoiseTerm::kQuantization:
      return text("quantisation", "Q", in("arcsec", units::kArcsec, "m/s"));
    case NoiseTerm::kAngleRandomWalk:
      return text(acc ? "velocity random walk" : "angle random walk", "N",
                  in("deg/sqrt(h)", units::kDegPerSqrtHour, "m/s/sqrt(s)"));
    case NoiseTerm::kBiasInstability:
      return text("bias instability", "B", in("deg/h", units::kDegPerHour, "m/s2"));
    case NoiseTerm::kRateRandomWalk:
      return text(acc ? "acceleration random walk" : "rate random walk", "K",
                  in("deg/h/sqrt(h)", units::kDegPerHourSqrtHour, "m/s2/sqrt(s)"));
    case NoiseTerm::kRateRamp:
      return text(acc ? "acceleration ramp" : "rate ramp", "R",
                  in("deg/h2", units::kDegPerHour2, "m/s3"));
    case NoiseTerm::kSinusoid:
      break;
  }
  return text("sinusoid", "A", in("deg/h", units::kDegPerHour, "m/s2"));
}

std::string Shown(double si, double unit_si, const std::string& unit) {
  return fmt::format("{:.3g}{}{}", si / unit_si, unit.empty() ? "" : " ", unit);
}

std::string DurationText(double seconds) {
  if (seconds >= 3600) return fmt::format("{:.3g} h", seconds / 3600);
  if (seconds >= 120) return fmt::format("{:.3g} min", seconds / 60);
  return fmt::format("{:.3g} s", seconds);
}

}  // namespace wellgyro
