#include "wellgyro/io/result/stretches_csv.h"

#include <optional>

#include <fmt/core.h>

#include "wellgyro/base/angle.h"
#include "wellgyro/io/iso_time_internal.h"
#include "wellgyro/io/number_text_internal.h"
#include "wellgyro/record/run_fit.h"

namespace wellgyro {
namespace {

std::string Number(const std::optional<double>& v, int decimals) {
  return v ? Fixed(*v, decimals) : "";
}

}  // namespace

std::string StretchesCsv(const Survey& survey) {
  std::string text =
      "RUN,END_UTC,T[s],MD[m],SPEED[m/s],ROTATION[rpm],TEMPERATURE[degC],SAMPLES_LOST,"
      "RES_GYRO,RES_ACCEL\n";
  for (const RunSummary& run : survey.runs) {
    if (!run.fit || run.fit->stretches.empty()) continue;
    const UtcTime begin = run.fit->stretches.front().begin;
    for (const RunStretch& s : run.fit->stretches) {
      text += fmt::format(
          "{},{},{},{},{},{},{},{},{},{}\n", run.run, IsoUtc(1e-9 * static_cast<double>(s.end.ns)),
          Fixed((s.end - begin).seconds(), 3), Number(s.md, 4), Number(s.speed, 4),
          Fixed(60 * s.roll_rate / kTwoPi, 4), Fixed(s.temperature, 2), Fixed(s.samples_lost, 0),
          Number(s.residual_gyro, 4), Number(s.residual_accel, 4));
    }
  }
  return text;
}

}  // namespace wellgyro
