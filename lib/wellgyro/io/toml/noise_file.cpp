#include "wellgyro/io/toml/noise_file.h"

#include "wellgyro/base/units.h"
#include "wellgyro/io/formats.h"
#include "wellgyro/io/text_file.h"
#include "wellgyro/io/toml/coefficients_internal.h"
#include "wellgyro/io/toml/toml_internal.h"
#include "wellgyro/io/toml/toml_writer_internal.h"

namespace wellgyro {
namespace {

struct Key {
  NoiseTerm term;
  const char* gyro;
  double gyro_unit;
  const char* accelerometer;  // in SI
};
constexpr Key kKeys[] = {
    {NoiseTerm::kQuantization, "quantization_arcsec", units::kArcsec, "quantization_mps"},
    {NoiseTerm::kAngleRandomWalk, "angle_random_walk_deg_per_sqrt_h", units::kDegPerSqrtHour,
     "velocity_random_walk_mps_per_sqrt_s"},
    {NoiseTerm::kBiasInstability, "bias_instability_deg_per_h", units::kDegPerHour,
     "bias_instability_mps2"},
    {NoiseTerm::kRateRandomWalk, "rate_random_walk_deg_per_h_sqrt_h", units::kDegPerHourSqrtHour,
     "acceleration_random_walk_mps2_per_sqrt_s"},
    {NoiseTerm::kRateRamp, "rate_ramp_deg_per_h2", units::kDegPerHour2, "acceleration_ramp_mps3"},
};
constexpr const char* kTimeKey = "bias_instability_correlation_time_h";

void WriteTerm(TomlWriter& toml, const std::string& key, const TermFit& term, double unit) {
  if (term.observable) {
    toml.Number(key, term.value / unit);
    toml.Number(key + "_sigma", term.sigma / unit);
  } else {
    toml.Number(key + "_upper95", term.upper95 / unit);
  }
}

void SkipLogAndFit(TomlTable& root) {
  if (auto log = root.FindTable("log")) {
    log->FindString("source");
    log->FindString("channel");
    log->FindNumber("rate_hz", kPositive);
    log->FindNumber("samples", kNotNegative);
    log->FindNumber("missing", kNotNegative);
    log->FindStrings("cleaned");
  }
  if (auto fit = root.FindTable("fit")) {
    fit->FindNumber("averaging_times", kNotNegative);
    fit->FindNumber("deviance", kNotNegative);
    fit->FindNumber(std::string(kTimeKey) + "_sigma", kNotNegative);
  }
  if (auto sinusoid = root.FindTable("sinusoid")) {
    sinusoid->FindNumber("frequency_hz", kPositive);
    for (const char* end : {"", "_sigma", "_upper95"}) {
      sinusoid->FindNumber(std::string("amplitude_deg_per_h") + end, kNotNegative);
    }
  }
}

NoiseCoefficients TakeNoise(TomlTable& root) {
  if (root.FindString("sensor").value_or("gyro") != "gyro") {
    root.Refuse("sensor",
                "is not a gyro: of an accelerometer's noise the job takes "
                "accel_noise_mps2_per_sqrt_hz under [errors], its velocity random walk",
                FaultCode::kConflict);
  }
  TomlTable table = root.Need("coefficients", root.FindTable("coefficients"));
  NoiseCoefficients coefficients = ReadCoefficients(table);
  SkipLogAndFit(root);
  return coefficients;
}

}  // namespace

std::string NoiseFileText(const NoiseFit& fit, const NoiseFileHead& head) {
  TomlWriter toml;
  toml.Text("format", formats::kNoise);
  toml.Text("sensor", head.accelerometer ? "accelerometer" : "gyro");
  toml.Table("coefficients");
  for (const auto& key : kKeys) {
    WriteTerm(toml, head.accelerometer ? key.accelerometer : key.gyro, fit.term[key.term],
              head.accelerometer ? 1 : key.gyro_unit);
  }
  const auto time = CoefficientsOf(fit).bias_instability_correlation_time;
  if (time) toml.Number(kTimeKey, *time / units::kHour);
  if (fit.model.shape.sinusoid_frequency > 0) {
    toml.Table("sinusoid");
    toml.Number("frequency_hz", fit.model.shape.sinusoid_frequency);
    WriteTerm(toml, head.accelerometer ? "amplitude_mps2" : "amplitude_deg_per_h",
              fit.term[NoiseTerm::kSinusoid], head.accelerometer ? 1 : units::kDegPerHour);
  }
  toml.Table("log");
  toml.Text("source", head.source);
  if (!head.channel.empty()) toml.Text("channel", head.channel);
  toml.Number("rate_hz", 1 / head.period);
  toml.Whole("samples", head.samples);
  toml.Whole("missing", head.missing);
  if (!head.cleaned.empty()) toml.Texts("cleaned", head.cleaned);
  toml.Table("fit");
  toml.Whole("averaging_times", fit.points);
  toml.Number("deviance", fit.deviance);
  if (time && fit.sigma_correlation_time) {
    toml.Number(std::string(kTimeKey) + "_sigma", *fit.sigma_correlation_time / units::kHour);
  }
  return toml.text();
}

Result<NoiseCoefficients> ParseNoiseFile(std::string_view text, const std::string& source) {
  return ReadTomlText<NoiseCoefficients>(text, source, formats::kNoise, TakeNoise);
}

Result<NoiseCoefficients> ReadNoiseFile(const std::filesystem::path& path) {
  const Result<std::string> text = ReadTextFile(path, 1 << 20);
  if (!text) return text.fault();
  return ParseNoiseFile(*text, path.string());
}

}  // namespace wellgyro
