#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/core.h>

#include "wellgyro/bus/series_log.h"
#include "wellgyro/io/atomic_file.h"
#include "wellgyro/io/result/allan_answer.h"
#include "wellgyro/io/sensor/series_file.h"

#include "choice.h"
#include "commands.h"
#include "distinct.h"
#include "on_call.h"
#include "report.h"

namespace wellgyro::apps {
namespace {

struct AllanOptions {
  std::string data, type, channel, bus_channel, sequence, temperature, time, detrend;
  std::vector<std::string> exclude;
  std::string deviation = "oadev", taus = "octave";
  std::string out, table, plot;
  double rate_hz = 0;
  std::int32_t tool = -1;
  bool has_scale = false;
  AllanRequest request;
};

std::function<void(double)> Shower(Progress& progress) {
  return [&progress](double part) { progress.Show(std::lround(1000 * part), 1000); };
}

Result<SampleSeries> ReadSeries(const AllanOptions& o) {
  std::optional<SeriesType> type = SeriesTypeOf(o.type);
  if (!type) {
    const Result<SeriesType> found = SeriesTypeOfFile(o.data);
    if (!found) return found.fault();
    type = *found;
  }
  Progress progress("reading " + o.data);
  switch (*type) {
    case SeriesType::kCsv:
      return ReadCsvSeries(o.data, {o.channel, o.sequence, o.temperature, o.time},
                           Shower(progress));
    case SeriesType::kLcm: {
      SeriesChannel channel{o.channel.empty() ? "gx" : o.channel, o.bus_channel, std::nullopt};
      if (o.tool >= 0) channel.tool = o.tool;
      return ReadLcmSeries(o.data, channel, Shower(progress));
    }
    default:
      if (!o.channel.empty()) {
        throw std::invalid_argument("--channel is for CSV files and LCM logs; " + o.data +
                                    " is read as binary numbers of one channel");
      }
      return ReadBinarySeries(o.data, *type, Shower(progress));
  }
}

// 1e-3 off is another rate, less may be rounding of a period to whole nanoseconds.
void SetPeriod(const AllanOptions& o, SampleSeries& series) {
  if (o.rate_hz == 0 && series.period == 0) {
    throw std::invalid_argument("--rate-hz is needed: " + o.data + " does not say its rate");
  }
  if (o.rate_hz > 0 && series.period > 0 && std::abs(o.rate_hz * series.period - 1) > 1e-3) {
    throw std::invalid_argument(fmt::format(
        "--rate-hz {:g} contradicts the log, which says {:g} Hz", o.rate_hz, 1 / series.period));
  }
  if (series.period == 0) series.period = 1 / o.rate_hz;
}

void CheckUnit(const AllanOptions& o, SampleSeries& series) {
  const std::string& unit = o.request.unit;
  const std::string& own = series.unit;
  const bool counts = unit == "counts" || (unit.empty() && own == "counts");
  if (counts && !o.has_scale && !o.request.unitless) {
    throw std::invalid_argument(
        "counts need --scale, rad/s of one count (or --unit deg_per_h, mps2 ... with a --scale in "
        "that unit, or --unitless)");
  }
  if (!unit.empty() && !own.empty() && own != "counts" && unit != own) {
    throw std::invalid_argument(
        fmt::format("--unit {} contradicts the log, whose channel is in {}", unit, own));
  }
  if (unit.empty() && own.empty() && !o.request.unitless) {
    series.notes.emplace_back(
        "nothing says the readings' unit: they are taken for rad/s (--unit, or a heading as "
        "GX[deg/h])");
  }
}

bool WriteOrSay(const std::string& name, const std::string& text) {
  if (name.empty()) return true;
  const std::filesystem::path path(name);
  // A device or a link to one, as /dev/stdout, is written to; whole files take the place of files.
  const auto status = std::filesystem::symlink_status(path);
  if (std::filesystem::exists(status) && !std::filesystem::is_regular_file(status)) {
    std::ofstream device(path, std::ios::binary | std::ios::app);
    if (device << text << std::flush) return true;
    Complain(name + ": cannot be written to");
    return false;
  }
  const OutputFile file{path.filename().string(), text};
  const auto folder = path.has_parent_path() ? path.parent_path() : std::filesystem::path(".");
  if (const auto fault = WriteFiles(folder, std::span(&file, 1))) {
    Complain(*fault);
    return false;
  }
  fmt::print("{}\n", name);
  return true;
}

int Tell(const AllanOptions& o, const AllanAnswer& answer) {
  fmt::print("{}", answer.summary);
  for (const auto& note : answer.notes) fmt::print(stderr, "note: {}\n", note);
  bool good = WriteOrSay(o.table, answer.table);
  if (!answer.plot.empty()) good &= WriteOrSay(o.plot, answer.plot);
  if (answer.noise) good &= WriteOrSay(o.out, *answer.noise);
  if (answer.unfit) {
    Complain(fmt::format("no coefficients: {}", answer.unfit->text));
    good &= o.out.empty();
  }
  if (!good) return kUnusable;
  return answer.losses ? kDoneWithLosses : kDone;
}

int RunAllan(AllanOptions& o) {
  RequireDistinct(std::array{NamedFile{"--data", o.data}, NamedFile{"--out", o.out},
                             NamedFile{"--table", o.table}, NamedFile{"--plot", o.plot}});
  Result<SampleSeries> series = ReadSeries(o);
  if (!series) return Unusable(series.fault());
  SetPeriod(o, *series);
  CheckUnit(o, *series);
  AllanRequest& request = o.request;
  request.source = std::filesystem::path(o.data).filename().string();
  request.channel = o.channel;
  request.plot = !o.plot.empty();
  std::optional<Result<AllanAnswer>> answer;
  {
    Progress progress("analysing");
    request.progress = Shower(progress);
    answer = AnswerAllan(std::move(*series), request);
  }
  if (!*answer) return Unusable(answer->fault());
  return Tell(o, **answer);
}

// "0:600": from and to in seconds from the first sample.
void TakeExcluded(AllanOptions& o) {
  for (const std::string& word : o.exclude) {
    const std::size_t colon = word.find(':');
    double from = 0, to = 0;
    const char* const text = word.data();
    const bool two = colon != std::string::npos;
    const auto first = std::from_chars(text, text + (two ? colon : 0), from);
    const auto last = std::from_chars(text + (two ? colon + 1 : 0), text + word.size(), to);
    if (!two || first.ec != std::errc() || first.ptr != text + colon || last.ec != std::errc() ||
        last.ptr != text + word.size() || !(from >= 0) || !(to > from)) {
      throw std::invalid_argument("--exclude takes seconds from and to, as 0:600; not " + word);
    }
    o.request.exclude.emplace_back(from, to);
  }
}

// octave, decade, or times in seconds with commas between.
void TakeTaus(AllanOptions& o) {
  AllanRequest& request = o.request;
  if (o.taus == "octave") {
    request.taus = AllanRequest::Taus::kOctave;
  } else if (o.taus == "decade") {
    request.taus = AllanRequest::Taus::kDecade;
  } else {
    request.taus = AllanRequest::Taus::kList;
    for (const char* at = o.taus.data(); at != nullptr;) {
      const char* end = o.taus.data() + o.taus.size();
      double tau = 0;
      const auto [stop, error] = std::from_chars(at, end, tau);
      if (error != std::errc() || !(tau > 0) || !std::isfinite(tau) ||
          (stop != end && *stop != ',')) {
        throw std::invalid_argument(
            "--taus is octave, decade or times in seconds as 0.1,1,10; not " + o.taus);
      }
      request.tau_list.push_back(tau);
      at = stop == end ? nullptr : stop + 1;
    }
  }
}

void TakeWords(AllanOptions& o) {
  AllanRequest& request = o.request;
  request.deviation = o.deviation == "adev"   ? Deviation::kAllan
                      : o.deviation == "mdev" ? Deviation::kModified
                                              : Deviation::kOverlapped;
  if (request.unitless && !o.out.empty()) {
    throw std::invalid_argument("--unitless gives a table and a plot; a noise file has units");
  }
  TakeTaus(o);
  TakeExcluded(o);
  o.request.detrend_temperature = o.detrend == "temperature";
}

/// Refuses nan and inf, which CLI11 takes for numbers.
CLI::Validator Finite() {
  const auto check = [](std::string& text) {
    return text.find_first_of("nN") == std::string::npos ? "" : "must be a number";
  };
  return CLI::Validator(check, "", "");
}

void AddInput(CLI::App& command, AllanOptions& o) {
  const CLI::Validator finite = Finite();
  command.add_option("--data", o.data, "the log: binary numbers, CSV, or LCM")->required();
  TakeWord(command.add_option("--type", o.type, "numbers are little-endian; default: by ending"),
           {"f64", "i16", "i32", "csv", "lcm"});
  command.add_option("--rate-hz", o.rate_hz, "samples a second; an LCM log says it itself")
      ->check(finite)
      ->check(CLI::Range(1e-9, 1e12));
  command.add_option("--channel", o.channel,
                     "CSV: column by name or number from 1; LCM: gx gy gz ax ay az (default gx) or "
                     "number of a raw channel from 0");
  command.add_option("--bus-channel", o.bus_channel, "LCM channel, where the log has several");
  command.add_option("--tool", o.tool, "LCM: tool in the string")->check(CLI::Range(0, 1000000));
  command.add_option("--sequence", o.sequence,
                     "CSV: column of sample numbers; those left out are missing");
  command.add_option("--temperature", o.temperature, "CSV: column of the temperature, degC");
  command.add_option("--time", o.time,
                     "CSV: column of each sample's time, s or as its heading says (TOOL[s] and "
                     "UTC[us] are found by themselves); gives the rate and what is missing");
  TakeWord(command.add_option(
               "--unit", o.request.unit,
               "deg_per_h, deg_per_s, rad_per_s (default, or as the heading says) or counts; "
               "accelerometers mps2, milli_g"),
           AllanUnits())
      ->type_name("UNIT");
  command
      .add_option("--scale", o.request.scale, "readings times this are in --unit; counts: in rad/s")
      ->check(finite)
      ->each([&o](const std::string&) { o.has_scale = true; });
  command.add_flag("--phase", o.request.phases, "the readings are phases (angles), not rates");
  command.add_flag("--unitless", o.request.unitless, "plain numbers: no unit in the table");
}

void AddCleaning(CLI::App& command, AllanOptions& o) {
  command
      .add_option("--exclude", o.exclude,
                  "a stretch to leave out, seconds from the first sample: 0:600; several with "
                  "commas or by repeating it")
      ->delimiter(',');
  command.add_flag("--robust", o.request.robust,
                   "leave out single readings beyond eight robust sigmas of those about them");
  TakeWord(command.add_option("--detrend", o.detrend,
                              "take off what follows it, slope and bend by least squares"),
           {"temperature"});
}

void AddAnalysis(CLI::App& command, AllanOptions& o) {
  TakeWord(
      command.add_option("--deviation", o.deviation,
                         "of the table: adev (side by side), oadev (overlapped, default) or mdev"),
      {"adev", "oadev", "mdev"});
  command.add_option("--taus", o.taus, "octave (default), decade, or seconds: 0.1,1,10");
  command.add_flag("--gauss-markov", o.request.fit.gauss_markov,
                   "fit bias instability as a Gauss-Markov process and find its time");
  command
      .add_option("--sinusoid-hz", o.request.fit.sinusoid_frequency,
                  "fit a sinusoid of this frequency as well")
      ->check(CLI::PositiveNumber);
  command.add_option("--seed", o.request.fit.seed, "of the bootstrap (default 1)");
  command.add_option("--out", o.out, "noise file (TOML) for survey and uncertainty");
  command.add_option("--table", o.table, "table (CSV)");
  command.add_option("--plot", o.plot, "picture (SVG)");
}

}  // namespace

void AddAllan(CLI::App& app, int& exit_code) {
  CLI::App* command =
      app.add_subcommand("allan", "Finds Allan deviation and noise coefficients of a static log");
  auto options = std::make_shared<AllanOptions>();
  AddInput(*command, *options);
  AddCleaning(*command, *options);
  AddAnalysis(*command, *options);
  command->footer(
      "Example:\n  wellgyro allan --data static.csv --channel gx_deg_per_h --unit deg_per_h \\\n"
      "      --rate-hz 100 --out noise.toml --table allan.csv --plot allan.svg\n"
      "The coefficients are fitted to overlapped octaves whatever the table shows.");
  OnCall(command, exit_code, [options] {
    TakeWords(*options);
    return RunAllan(*options);
  });
}

}  // namespace wellgyro::apps
