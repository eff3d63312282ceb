#include "wellgyro/survey/job_keys.h"

#include <array>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <utility>

#include <fmt/core.h>

#include "wellgyro/base/units.h"
#include "wellgyro/record/limits.h"
#include "wellgyro/survey/job_words.h"

namespace wellgyro {
namespace {

using units::kDeg;

template <class T>
T* Through(T& value, bool /*make*/) {
  return &value;
}
template <class T>
T* Through(std::optional<T>& value, bool make) {
  if (!value && make) value.emplace();
  return value ? &*value : nullptr;
}
template <class T>
const T* Through(const std::optional<T>& value, bool /*make*/) {
  return value ? &*value : nullptr;
}

// From member to member, through those that are optional.
template <auto first, auto... rest, class T>
auto* Walk(T& from, bool make) {
  auto* const next = Through(from.*first, make);
  if constexpr (sizeof...(rest) == 0) {
    return next;
  } else {
    return next ? Walk<rest...>(*next, make) : nullptr;
  }
}

template <auto... path>
constexpr JobKey Number(std::string_view table, std::string_view key, double unit,
                        NumberRange range, std::string_view meaning, std::string_view absent = "") {
  return {table,
          key,
          "number",
          absent,
          meaning,
          range,
          unit,
          [](const Job& job) -> const double* { return Walk<path...>(job, false); },
          [](Job& job) -> double* { return Walk<path...>(job, true); }};
}

// An external azimuth counts only where one is asked for.
template <double AlignmentSpec::*member>
constexpr JobKey External(std::string_view key, NumberRange range, std::string_view meaning) {
  JobKey found =
      Number<&Job::alignment, member>("alignment", key, kDeg, range, meaning, "required");
  found.find = [](const Job& job) -> const double* {
    const bool external = job.alignment.method == AlignmentSpec::Method::kExternal;
    return external ? &(job.alignment.*member) : nullptr;
  };
  return found;
}

// A number of one of a list of tables, of a table's own file, or of a list.
constexpr JobKey Listed(std::string_view table, std::string_view key, std::string_view type,
                        NumberRange range, std::string_view absent, std::string_view meaning) {
  return {table, key, type, absent, meaning, range};
}

constexpr JobKey Word(std::string_view table, std::string_view key, std::string_view type,
                      std::string_view absent, std::string_view meaning) {
  return {table, key, type, absent, meaning};
}

constexpr JobKey Choice(std::string_view table, std::string_view key,
                        std::span<const std::string_view> words, std::string_view absent,
                        std::string_view meaning) {
  JobKey found = Word(table, key, "", absent, meaning);
  found.words = words;
  return found;
}

// Of a gyro, in the units of data sheets: 1e6 deg/h are most of a turn in a second.
constexpr NumberRange kError{.min = 0, .max = 1e6};
// Of a size above zero, in its key's unit: in SI units a double holds it too.
constexpr NumberRange kSizeAboveZero{.min = 1e-9, .max = 1e6};
// [deg], of a tool against its hole: sag and misalignment are tenths, and no collar leaves room
// for 5.
constexpr NumberRange kTilt{.min = -5, .max = 5};
constexpr NumberRange kFraction{.min = 0, .max = 1};
constexpr NumberRange kWhole{.min = 0, .max = std::numeric_limits<std::int32_t>::max()};
// [m], of a tie-in from the well head: no hole goes 1000 km aside.
constexpr NumberRange kPlace{.min = -1e6, .max = 1e6};
constexpr NumberRange kGridPlace{.min = -1e8, .max = 1e8};  // beyond any grid on the Earth
constexpr NumberRange kDepth{.min = -limits::kMd, .max = limits::kMd};
constexpr NumberRange kSigma{.min = 0, .max = limits::kSigma};
constexpr NumberRange kCorrection{.min = -limits::kCorrection, .max = limits::kCorrection};
constexpr NumberRange kUtimeUs{.min = 0, .max = limits::kUtcUs};
constexpr NumberRange kSeq{.min = 0, .max = limits::kCount};
constexpr NumberRange kText{.max = limits::kText};

constexpr JobKey Channel(std::string_view key, std::string Channels::*name, std::string_view absent,
                         std::string_view meaning) {
  JobKey found{"channels", key,     "text that no other channel has",
               absent,     meaning, {.min = 1, .max = limits::kChannel}};
  found.channel = name;
  return found;
}

// A list of rows of two numbers.
constexpr JobKey RowsOfTwo(std::string_view table, std::string_view key, std::string_view type,
                           NumberRange first, NumberRange second, std::string_view absent,
                           std::string_view meaning) {
  JobKey found = Listed(table, key, type, first, absent, meaning);
  found.second = second;
  return found;
}

constexpr std::array kWell{
    Word("well", "name", "text", "none", "of the well, for the files"),
    // At the poles there is no azimuth to find and no meridian to carry it along.
    Number<&Job::well, &Job::Well::latitude>(
        "well", "latitude_deg", kDeg, {.min = -89.9, .max = 89.9}, "geodetic, WGS 84", "required"),
    Number<&Job::well, &Job::Well::longitude>("well", "longitude_deg", kDeg,
                                              {.min = -180, .max = 360}, "east; [grid] needs it"),
    Number<&Job::well, &Job::Well::datum_elevation>("well", "datum_elevation_m", 1,
                                                    {.min = -12'000, .max = 9'000},
                                                    "of the depth datum above mean sea level"),
};

constexpr std::array kGrid{
    Word("grid", "utm_zone", "text", "none", "as 31N; instead of all keys of a projection"),
    Choice("grid", "projection", words::kProjection, "required", "where there is no utm_zone"),
    Word("grid", "name", "text", "none", "of the system, for the files"),
    Word("grid", "epsg", "text", "none", "of the system; a label, never looked up"),
    Number<&Job::grid, &GridSpec::semi_major>("grid", "semi_major_m", 1, {.min = 1e6, .max = 1e8},
                                              "of the ellipsoid", "6378137"),
    Number<&Job::grid, &GridSpec::inverse_flattening>("grid", "inverse_flattening", 1,
                                                      {.min = 100, .max = 1e6}, "of the ellipsoid",
                                                      "298.257223563"),
    Number<&Job::grid, &GridSpec::latitude_origin>(
        "grid", "latitude_origin_deg", kDeg, {.min = -90, .max = 90}, "of the projection", "0"),
    Number<&Job::grid, &GridSpec::longitude_origin>("grid", "longitude_origin_deg", kDeg,
                                                    {.min = -180, .max = 360},
                                                    "its central meridian", "0"),
    Number<&Job::grid, &GridSpec::parallel_1>("grid", "parallel_1_deg", kDeg,
                                              {.min = -90, .max = 90},
                                              "standard parallel of a Lambert cone", "required"),
    Number<&Job::grid, &GridSpec::parallel_2>("grid", "parallel_2_deg", kDeg,
                                              {.min = -90, .max = 90}, "its second parallel",
                                              "parallel_1_deg"),
    Choice("grid", "pole", words::kPole, "required", "of a polar stereographic projection"),
    Number<&Job::grid, &GridSpec::scale_origin>(
        "grid", "scale_origin", 1, {.min = 0.5, .max = 2},
        "scale on the central meridian, the parallel or at the pole", "1"),
    Number<&Job::grid, &GridSpec::false_easting>("grid", "false_easting_m", 1, kGridPlace,
                                                 "of the natural origin", "0"),
    Number<&Job::grid, &GridSpec::false_northing>("grid", "false_northing_m", 1, kGridPlace,
                                                  "of the natural origin", "0"),
    Number<&Job::grid, &GridSpec::convergence>(
        "grid", "convergence_deg", kDeg, {.min = -180, .max = 180},
        "stated by the operator: true azimuth less grid", "the projection's"),
    Number<&Job::grid, &GridSpec::scale>("grid", "scale", 1, {.min = 0.5, .max = 2},
                                         "stated by the operator", "the projection's"),
};

constexpr std::array kTieIn{
    Word("tie_in", "survey", "text", "none",
         "survey.csv whose last station is the tie; instead of all other keys"),
    Number<&Job::tie_in, &TieIn::md>("tie_in", "md_m", 1, kDepth, "measured depth"),
    Number<&Job::tie_in, &TieIn::north>("tie_in", "north_m", 1, kPlace, "from the well head",
                                        "0; below the datum with a warning"),
    Number<&Job::tie_in, &TieIn::east>("tie_in", "east_m", 1, kPlace, "from the well head",
                                       "0; below the datum with a warning"),
    Number<&Job::tie_in, &TieIn::tvd>("tie_in", "tvd_m", 1, kDepth, "below the depth datum",
                                      "0; required beside md_m"),
    Number<&Job::tie_in, &TieIn::inclination>("tie_in", "inclination_deg", kDeg,
                                              {.min = 0, .max = 180}, "with azimuth_true_deg",
                                              "the run's own"),
    Number<&Job::tie_in, &TieIn::azimuth>("tie_in", "azimuth_true_deg", kDeg,
                                          {.min = -360, .max = 360}, "with inclination_deg",
                                          "the run's own"),
    Word("tie_in", "covariance_m2", "three rows of three numbers", "0",
         "of north, east, TVD; also under the name covariance"),
};

constexpr std::array kNoise{
    Word("noise", "file", "text", "none", "noise file, instead of all other keys"),
    Number<&Job::noise, &NoiseCoefficients::quantization>("noise", "quantization_arcsec",
                                                          units::kArcsec, kError, "Q of IEEE 952"),
    Number<&Job::noise, &NoiseCoefficients::angle_random_walk>(
        "noise", "angle_random_walk_deg_per_sqrt_h", units::kDegPerSqrtHour, kError, "N"),
    Number<&Job::noise, &NoiseCoefficients::bias_instability>("noise", "bias_instability_deg_per_h",
                                                              units::kDegPerHour, kError, "B"),
    Number<&Job::noise, &NoiseCoefficients::rate_random_walk>(
        "noise", "rate_random_walk_deg_per_h_sqrt_h", units::kDegPerHourSqrtHour, kError, "K"),
    Number<&Job::noise, &NoiseCoefficients::rate_ramp>("noise", "rate_ramp_deg_per_h2",
                                                       units::kDegPerHour2, kError, "R"),
    Number<&Job::noise, &NoiseCoefficients::bias_instability_correlation_time>(
        "noise", "bias_instability_correlation_time_h", units::kHour, kSizeAboveZero,
        "of B as a Gauss-Markov process", "B is a constant"),
};

// Without a key what the tool's file says of it holds, else survey/unstated_errors.h.
constexpr std::array kErrors{
    Number<&Job::errors, &ErrorPriors::gyro_bias_sigma>("errors", "gyro_bias_sigma_deg_per_h",
                                                        units::kDegPerHour, kError, "per axis"),
    Number<&Job::errors, &ErrorPriors::mass_unbalance_sigma>(
        "errors", "mass_unbalance_sigma_deg_per_h_per_g", units::kDegPerHourPerG, kError,
        "drift with the force along the gyro's own axis"),
    Number<&Job::errors, &ErrorPriors::quadrature_sigma>(
        "errors", "quadrature_sigma_deg_per_h_per_g", units::kDegPerHourPerG, kError,
        "drift with the force along the other axis"),
    Number<&Job::errors, &ErrorPriors::gyro_scale_sigma>("errors", "gyro_scale_sigma", 1, kFraction,
                                                         "per axis, of the rate"),
    Number<&Job::errors, &ErrorPriors::gyro_misalignment_sigma>(
        "errors", "gyro_misalignment_sigma_rad", 1, kFraction, "z into x and y"),
    Number<&Job::errors, &ErrorPriors::accel_bias_sigma>("errors", "accel_bias_sigma_mps2", 1,
                                                         {.min = 0, .max = 10}, "per axis"),
    Number<&Job::errors, &ErrorPriors::accel_scale_sigma>("errors", "accel_scale_sigma", 1,
                                                          kFraction, "per axis"),
    Number<&Job::errors, &ErrorPriors::accel_misalignment_sigma>(
        "errors", "accel_misalignment_sigma_rad", 1, kFraction, "of each axis towards each other"),
    Number<&Job::errors, &ErrorPriors::accel_noise>("errors", "accel_noise_mps2_per_sqrt_hz", 1,
                                                    {.min = 0, .max = 10}, "white"),
    Number<&Job::errors, &ErrorPriors::roll_offset_sigma>("errors", "roll_offset_sigma_deg", kDeg,
                                                          {.min = 0, .max = 180},
                                                          "accelerometers against gyros about z"),
    Number<&Job::errors, &ErrorPriors::time_skew_sigma>(
        "errors", "time_skew_sigma_s", 1, {.min = 0, .max = 10}, "accelerometers against gyros"),
    Number<&Job::errors, &ErrorPriors::depth_sigma>("errors", "depth_sigma_m", 1,
                                                    {.min = 0, .max = 1000}, "of measured depth"),
    Number<&Job::errors, &ErrorPriors::depth_scale_sigma>(
        "errors", "depth_scale_sigma", 1, kFraction, "of measured depth below the tie-in"),
    Number<&Job::errors, &ErrorPriors::latitude_sigma>(
        "errors", "latitude_sigma_deg", kDeg, {.min = 0, .max = 90}, "of the well's latitude"),
};

constexpr std::array kFilesAndChannels{
    Word("tool", "file", "text", "samples come in SI units", "tool file, wellgyro.tool/1"),
    Word("error_model", "file", "text", "the run's own covariance",
         "error model, wellgyro.error-model/1"),
    Channel("raw", &Channels::raw, "WELLGYRO_RAW", "counts"),
    Channel("imu", &Channels::imu, "WELLGYRO_IMU", "samples in SI units"),
    Channel("still", &Channels::still, "WELLGYRO_STILL", "averages at rest"),
    Channel("depth", &Channels::depth, "WELLGYRO_DEPTH", "depth marks"),
    Channel("mode", &Channels::mode, "WELLGYRO_MODE", "modes of the tool"),
    Channel("tool", &Channels::tool, "WELLGYRO_TOOL", "what the tool says of itself"),
    Channel("event", &Channels::event, "WELLGYRO_EVENT", "what people did"),
    Channel("command", &Channels::command, "WELLGYRO_CMD", "orders"),
    Channel("station", &Channels::station, "WELLGYRO_STATION", "stations, sent"),
    Channel("status", &Channels::status, "WELLGYRO_STATUS", "health, sent"),
};

constexpr std::array kAlignment{
    Choice("alignment", "method", words::kAlignment, "gyrocompass", "where north comes from"),
    Number<&Job::alignment, &AlignmentSpec::min_still>("alignment", "min_still_s", 1,
                                                       {.min = 3, .max = 86'400},
                                                       "shortest stop that is gyrocompassed"),
    External<&AlignmentSpec::azimuth>("azimuth_true_deg", {.min = -360, .max = 360},
                                      "an external azimuth"),
    External<&AlignmentSpec::sigma_azimuth>("sigma_azimuth_deg", {.min = 1e-6, .max = 180},
                                            "its sigma"),
    Choice("alignment", "of", words::kAzimuthOf, "axis", "what the external azimuth belongs to"),
    Number<&Job::alignment, &AlignmentSpec::at_md>("alignment", "at_md_m", 1, kDepth,
                                                   "depth at which it holds",
                                                   "the begin of the first sample"),
    Listed("alignment", "at_utime_us", "whole number", kUtimeUs, "the begin of the first sample",
           "time at which it holds, UTC since 1970; instead of at_md_m"),
    Word("alignment", "use_fixes", "true or false", "true",
         "whether later north fixes count beside an external azimuth"),
};

constexpr std::array kStations{
    Choice("attitude", "order", words::kOrder, "third", "in which samples are summed"),
    Number<&Job::stations, &StationSpec::every>("stations", "every_m", 1,
                                                {.min = 0.2, .max = limits::kMd, .or_zero = true},
                                                "spacing; 0: none", "10; 0 beside at_m"),
    Listed("stations", "at_m", "list of numbers that increase", kDepth, "none", "depths asked for"),
    Word("stations", "at_stops", "true or false", "false", "the gyrocompass stations too"),
    Choice("depth", "kind", words::kDepthKind, "indicated", "what the depth marks measure"),
    Number<&Job::depth, &DepthSpec::latency>("depth", "latency_s", 1, {.min = 0, .max = 600},
                                             "how late a mark may come, against the samples"),
    Number<&Job::depth, &DepthSpec::max_gap>(
        "depth", "max_gap_s", 1, {.min = 0.1, .max = 600},
        "between marks of a moving tool, above which depth is unknown"),
    RowsOfTwo("depth", "corrections", "rows of two numbers, depths increasing", kDepth, kCorrection,
              "none", "measured depth and what to add to it [m], linear between"),
};

constexpr std::array kCable{
    Number<&Job::depth, &DepthSpec::cable, &Cable::stretch>("depth.cable", "stretch_m_per_km_kn",
                                                            1e-6, {.min = 0, .max = 10}, "elastic"),
    Number<&Job::depth, &DepthSpec::cable, &Cable::weight>(
        "depth.cable", "weight_n_per_m", 1, {.min = 0, .max = 1e3}, "in the well's fluid"),
    Number<&Job::depth, &DepthSpec::cable, &Cable::tool_weight>(
        "depth.cable", "tool_weight_n", 1, {.min = 0, .max = 1e6}, "in the well's fluid"),
    Number<&Job::depth, &DepthSpec::cable, &Cable::measuring_tension>(
        "depth.cable", "measuring_tension_n", 1, {.min = 0, .max = 1e6},
        "at which the counter, or who laid the marks, measured"),
    Number<&Job::depth, &DepthSpec::cable, &Cable::expansion>(
        "depth.cable", "expansion_per_degc", 1, {.min = 0, .max = 1e-3}, "thermal"),
    Number<&Job::depth, &DepthSpec::cable, &Cable::measuring_temperature>(
        "depth.cable", "measuring_temperature_degc", 1, {.min = -100, .max = 300},
        "at which counter or marks measured"),
    Number<&Job::depth, &DepthSpec::cable, &Cable::surface_temperature>(
        "depth.cable", "surface_temperature_degc", 1, {.min = -100, .max = 300},
        "of the cable at the well head"),
    Number<&Job::depth, &DepthSpec::cable, &Cable::gradient>("depth.cable", "gradient_degc_per_km",
                                                             1e-3, {.min = -1e3, .max = 1e3},
                                                             "of temperature along the hole"),
    Number<&Job::depth, &DepthSpec::cable, &Cable::ratio_sigma>(
        "depth.cable", "stretch_sigma_ratio", 1, kFraction, "of the stretch, what is not known"),
    Number<&Job::depth, &DepthSpec::cable, &Cable::mark_spacing>(
        "depth.cable", "mark_spacing_m", 1, {.min = 1, .max = 1e3, .or_zero = true},
        "between magnetic marks; 0: there are none"),
    Number<&Job::depth, &DepthSpec::cable, &Cable::first_mark>(
        "depth.cable", "first_mark_m", 1, kDepth, "depth of one of them", "the first that passes"),
    Number<&Job::depth, &DepthSpec::cable, &Cable::sigma_mark>(
        "depth.cable", "mark_sigma_m", 1, {.min = 0, .max = 10}, "of one mark's place"),
};

constexpr std::array kStringAndChecks{
    Number<&Job::string, &StringSpec::sensor_below_reference>(
        "string", "sensor_below_reference_m", 1,
        {.min = -limits::kSensorBelowReference, .max = limits::kSensorBelowReference},
        "along hole"),
    Number<&Job::string, &StringSpec::sag>("string", "sag_deg", kDeg, kTilt,
                                           "of the tool axis, in a horizontal hole"),
    Number<&Job::string, &StringSpec::sigma_sag>("string", "sag_sigma_deg", kDeg,
                                                 {.min = 0, .max = 90}, "of sag_deg"),
    Number<&Job::string, &StringSpec::misalignment_x>("string", "misalignment_x_deg", kDeg, kTilt,
                                                      "tool axis against hole axis, towards Tx"),
    Number<&Job::string, &StringSpec::misalignment_y>("string", "misalignment_y_deg", kDeg, kTilt,
                                                      "towards Ty"),
    Number<&Job::string, &StringSpec::sigma_misalignment>("string", "misalignment_sigma_deg", kDeg,
                                                          {.min = 0, .max = 90}, "each"),
    Number<&Job::magnetic, &MagneticSpec::declination>("magnetic", "declination_deg", kDeg,
                                                       {.min = -180, .max = 180},
                                                       "true azimuth less magnetic", "required"),
    Number<&Job::magnetic, &MagneticSpec::sigma>(
        "magnetic", "sigma_deg", kDeg, {.min = 1e-6, .max = 179},
        "of an azimuth made true by it, alike at all stops", "required"),
    Word("magnetic", "tie", "true or false", "false",
         "whether the first of each run ties its azimuth"),
    Number<&Job::acceptance, &Acceptance::gravity>("acceptance", "gravity_mps2", 1, kSizeAboveZero,
                                                   "largest error", "3 sigma"),
    Number<&Job::acceptance, &Acceptance::earth_rate>("acceptance", "earth_rate_deg_per_h",
                                                      units::kDegPerHour, kSizeAboveZero,
                                                      "largest error", "3 sigma"),
    Number<&Job::acceptance, &Acceptance::inclination_difference>(
        "acceptance", "inclination_difference_deg", kDeg, kSizeAboveZero, "in-run against out-run",
        "3 sigma"),
    Number<&Job::acceptance, &Acceptance::azimuth_difference>(
        "acceptance", "azimuth_difference_deg", kDeg, kSizeAboveZero, "in-run against out-run",
        "3 sigma"),
    Number<&Job::acceptance, &Acceptance::foresight>("acceptance", "foresight_deg", kDeg,
                                                     kSizeAboveZero, "largest error", "3 sigma"),
    Number<&Job::acceptance, &Acceptance::depth_closure>(
        "acceptance", "depth_closure_m", 1, kSizeAboveZero, "at the return to zero", "3 sigma"),
};

constexpr std::array kRunsAndEvents{
    Word("operations", "unsigned_tool", "true or false", "false",
         "with [[operator]]: whether what the tool says of itself is used unsigned"),
    Word("operator", "name", "text", "required", "of the key, for the files"),
    Word("operator", "public_key", "text", "required",
         "64 hexadecimal digits, Ed25519: orders it has signed are obeyed, and no others"),
    Listed("run", "number", "whole number", {.min = 1, .max = kWhole.max}, "required",
           "of the run"),
    Listed("run", "begin_utime_us", "whole number", kUtimeUs, "none", "UTC since 1970"),
    Listed("run", "end_utime_us", "whole number", kUtimeUs, "none", "what comes later is left out"),
    Choice("run", "verdict", words::kRunVerdict, "ok", "a misrun gives no stations"),
    Word("run", "remark", "text", "none", "for the files"),
    Listed("event", "utime_us", "whole number", kUtimeUs, "required", "UTC since 1970"),
    Choice("event", "event", words::kEvent, "required", "what was done"),
    Listed("event", "seq", "whole number", kSeq, "0", "of the message"),
    Listed("event", "session", "whole number", kWhole, "0", "of the message"),
    Listed("event", "run", "whole number", kWhole, "0", "of the tool"),
    Listed("event", "event_id", "whole number", kWhole, "0", "of who sends"),
    Listed("event", "value_m", "number", kDepth, "none; 0 at a zero",
           "depth at the event; required by depth_rezero and depth_tie"),
    Listed("event", "sigma_m", "number", kSigma, "0", "its sigma"),
    Listed("event", "value_rad", "number", {.min = -limits::kAngle, .max = limits::kAngle}, "none",
           "true direction of the reference mark; required by foresight"),
    Listed("event", "sigma_rad", "number", kSigma, "0", "its sigma"),
    Listed("event", "what", "text", kText, "none", "shoe, mark ..."),
    Listed("event", "who", "text", kText, "none", "who did it"),
    Listed("event", "text", "text", kText, "none", "a remark's words"),
};

template <std::size_t... sizes>
constexpr auto Joined(const std::array<JobKey, sizes>&... parts) {
  std::array<JobKey, (sizes + ...)> all{};
  std::size_t count = 0;
  const auto add = [&](const auto& part) {
    for (const JobKey& key : part) all[count++] = key;
  };
  (add(parts), ...);
  return all;
}

constexpr auto kKeys = Joined(kWell, kGrid, kTieIn, kNoise, kErrors, kFilesAndChannels, kAlignment,
                              kStations, kCable, kStringAndChecks, kRunsAndEvents);

// From SI to the key's unit and back costs a rounding: 89.9 deg is to stay 89.9 deg.
double InUnit(double si, double unit) {
  const double value = si / unit;
  const double rounded = std::round(value * 1e9) / 1e9;
  return std::abs(rounded - value) <= 1e-14 * std::abs(value) ? rounded : value;
}

std::optional<std::string> ComplaintOfSi(double si, const JobKey& key) {
  const double value = InUnit(si, key.unit);
  // A number that is too large for a double in the key's unit is said as it was given.
  if (std::isfinite(si) && !std::isfinite(value)) {
    return fmt::format("{} in SI units is not within {}", si, TextOf(key.range));
  }
  return ComplaintOf(value, key.range);
}

}  // namespace

std::span<const JobKey> JobKeys() { return kKeys; }

const JobKey& JobKeyOf(std::string_view table, std::string_view key) {
  for (const JobKey& each : kKeys) {
    if (each.table == table && each.key == key) return each;
  }
  throw std::logic_error(fmt::format("no key {} of [{}] in the list of job keys", key, table));
}

std::optional<std::string> FindNumberComplaint(const Job& job) {
  for (const JobKey& key : kKeys) {
    const double* const value = key.find ? key.find(job) : nullptr;
    if (!value) continue;
    if (const auto complaint = ComplaintOfSi(*value, key)) {
      return fmt::format("{}.{}: {}", key.table, key.key, *complaint);
    }
  }
  return std::nullopt;
}

}  // namespace wellgyro
