#include "wellgyro/earth/magnetic.h"

#include <charconv>
#include <cmath>

#include <GeographicLib/MagneticModel.hpp>
#include <fmt/core.h>

#include "wellgyro/base/units.h"

namespace wellgyro {
namespace {

Fault Refusal(FaultCode code, std::string text, std::string source) {
  Fault fault;
  fault.code = code;
  fault.text = std::move(text);
  fault.source = std::move(source);
  return fault;
}

bool IsLeap(int year) { return year % 4 == 0 && (year % 100 != 0 || year % 400 == 0); }

}  // namespace

Result<MagneticField> MagneticFieldAt(const std::string& name, const std::string& folder,
                                      const GeodeticPoint& place, double height, double year) {
  if (!(std::abs(place.latitude) <= kPi / 2) || !std::isfinite(place.longitude) ||
      !std::isfinite(height) || !std::isfinite(year)) {
    return Refusal(FaultCode::kRange, "the magnetic field: no such place or date", name);
  }
  const bool plain = name.find_first_of("/\\") == std::string::npos;
  if (!plain) return Refusal(FaultCode::kRange, "a magnetic model's name holds no folder", name);
  try {
    const GeographicLib::MagneticModel model(name, folder);
    if (year < model.MinTime() || year > model.MaxTime()) {
      return Refusal(FaultCode::kRange,
                     fmt::format("{} holds from {:g} to {:g}, not in {:.2f}", name, model.MinTime(),
                                 model.MaxTime(), year),
                     name);
    }
    if (height < model.MinHeight() || height > model.MaxHeight()) {
      return Refusal(FaultCode::kRange, fmt::format("{} does not reach {:g} m", name, height),
                     name);
    }
    double east = 0, north = 0, up = 0;
    model(year, place.latitude / units::kDeg, place.longitude / units::kDeg, height, east, north,
          up);
    const double horizontal = std::hypot(east, north);  // [nT]
    MagneticField field;
    field.declination = std::atan2(east, north);
    field.dip = std::atan2(-up, horizontal);
    field.field = std::hypot(horizontal, up) * units::kNanotesla;
    field.sigma_declination =
        horizontal > 0 ? std::min(kPi, std::hypot(0.26, 5417 / horizontal) * units::kDeg) : kPi;
    field.sigma_dip = 0.20 * units::kDeg;
    field.sigma_field = 138 * units::kNanotesla;
    return field;
  } catch (const GeographicLib::GeographicErr& error) {
    return Refusal(FaultCode::kIo,
                   std::string("the magnetic model cannot be read: ") + error.what(), name);
  }
}

Result<double> DecimalYear(const std::string& date) {
  int part[3] = {0, 0, 0};
  const char* at = date.data();
  const char* const end = at + date.size();
  bool good = date.size() == 10;
  for (int i = 0; i < 3 && good; ++i) {
    const char* const stop = at + (i == 0 ? 4 : 2);
    const auto [rest, error] = std::from_chars(at, stop, part[i]);
    good = error == std::errc() && rest == stop && (i == 2 || *rest == '-');
    at = stop + 1;
  }
  constexpr int kDays[] = {31, 28, 31, 30, 31, 30, 31, 31, 30, 31, 30, 31};
  const int leap = good && IsLeap(part[0]) ? 1 : 0;
  good = good && at == end + 1 && part[1] >= 1 && part[1] <= 12 && part[2] >= 1 &&
         part[2] <= kDays[part[1] - 1] + (part[1] == 2 ? leap : 0);
  if (!good) {
    return Refusal(FaultCode::kSyntax, "'" + date + "' is no date: write YYYY-MM-DD", date);
  }
  int day = part[2] - 1;
  for (int m = 1; m < part[1]; ++m) day += kDays[m - 1] + (m == 2 ? leap : 0);
  return part[0] + static_cast<double>(day) / (365 + leap);
}

}  // namespace wellgyro
