#include "wellgyro/io/result/allan_answer.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <fmt/core.h>

#include "wellgyro/io/plot/noise_plot.h"
#include "wellgyro/io/result/allan_unit_internal.h"
#include "wellgyro/io/toml/noise_file.h"
#include "wellgyro/io/words.h"
#include "wellgyro/noise/allan_confidence.h"
#include "wellgyro/noise/clean_series.h"
#include "wellgyro/noise/static_log.h"

namespace wellgyro {
namespace {

constexpr std::size_t kPlacesTold = 5;  // of a kind, then their count

class Analyst {
 public:
  Analyst(SampleSeries series, const AllanRequest& request)
      : series_(std::move(series)), request_(request) {
    const std::string own = series_.unit.empty() ? "rad_per_s" : series_.unit;
    unit_ = UnitOf(request.unit.empty() ? own : request.unit, request.unitless);
    // The sums are taken of the readings themselves: whole counts stay exact.
    si_ = request.scale * unit_.si;
  }

  Result<AllanAnswer> Answer() {
    answer_.notes = series_.notes;
    answer_.losses = series_.damaged;
    if (request_.detrend_temperature && series_.temperature.empty()) {
      return Fault{.code = FaultCode::kForeign,
                   .text = "no temperature to detrend by: name its column (--temperature)",
                   .source = request_.source};
    }
    if (request_.phases) RatesFromPhases(series_);
    Clean();
    const AllanResult octaves = OctavesOfAll();
    samples_ = octaves.samples;
    TellMissing(octaves);
    if (!HasTerms(octaves)) {
      return Fault{
          .code = FaultCode::kRange,
          .text = fmt::format("{}, {} missing: not one difference of two averages can be taken",
                              Counted(static_cast<std::size_t>(octaves.samples), "sample"),
                              octaves.missing),
          .source = request_.source};
    }
    TellFindings();
    FitModel(octaves);
    const AllanResult table = IsOctavesAsked() ? octaves : Scaled(Asked());
    rows_ = AllanTable(table, model_);
    WriteTable();
    WriteSummary(octaves);
    if (request_.plot && !rows_.empty()) WritePlot();
    if (fit_ && !unit_.plain) {
      answer_.noise = NoiseFileText(*fit_, {.accelerometer = unit_.accelerometer,
                                            .source = request_.source,
                                            .channel = request_.channel,
                                            .period = series_.period,
                                            .samples = octaves.samples,
                                            .missing = octaves.missing,
                                            .cleaned = cleaned_});
    }
    return std::move(answer_);
  }

 private:
  static bool HasTerms(const AllanResult& result) {
    return std::any_of(result.points.begin(), result.points.end(),
                       [](const AllanPoint& p) { return p.terms > 0; });
  }

  // What was asked to be left out or taken off; neither is a loss.
  void Clean() {
    missing_ = series_.gaps;
    for (const auto& [from, to] : request_.exclude) {
      const std::int64_t out = Exclude(series_, from, to);
      Cleaned(fmt::format("{} samples from {:g} to {:g} s left out, as asked", out, from, to));
    }
    if (request_.robust) {
      const std::int64_t spikes = ExcludeSpikes(series_);
      Cleaned(spikes > 0 ? fmt::format("{} left out (beyond eight robust sigmas)",
                                       Counted(static_cast<std::size_t>(spikes), "spike"))
                         : std::string("spikes were looked for: there are none"));
    }
    if (!request_.detrend_temperature) return;
    const auto trend = DetrendTemperature(series_);
    if (!trend) {
      Cleaned("the temperature does not vary: nothing is taken off");
      return;
    }
    Cleaned(
        fmt::format("what follows the temperature is taken off: slope ({} +- {}) per degC at "
                    "{:.4g} degC and bend, {:.3g} of the slow changes",
                    Reading(trend->per_degree), Reading(trend->per_degree_sigma), trend->mean,
                    trend->explained));
  }

  std::int64_t samples() const { return std::ssize(series_.values); }

  bool IsOctavesAsked() const {
    return request_.taus == AllanRequest::Taus::kOctave &&
           request_.deviation == Deviation::kOverlapped;
  }

  std::function<void(double)> Part(double from, double to) const {
    if (!request_.progress) return {};
    return [this, from, to](double part) { request_.progress(from + part * (to - from)); };
  }

  AllanResult Scaled(AllanResult result) const {
    for (auto& point : result.points) point.variance *= si_ * si_;
    return result;
  }

  AllanResult OctavesOfAll() {
    AllanOptions options;
    options.progress = Part(0, 0.4);
    return Scaled(AllanVariance(series_.values, series_.period, OctaveFactors(samples()), options,
                                series_.gaps));
  }

  AllanResult Asked() {
    AllanOptions options;
    options.deviation = request_.deviation;
    options.progress = Part(0.6, 1);
    std::vector<std::int64_t> factors;
    switch (request_.taus) {
      case AllanRequest::Taus::kOctave:
        factors = OctaveFactors(samples());
        break;
      case AllanRequest::Taus::kDecade:
        factors = DecadeFactors(samples());
        break;
      case AllanRequest::Taus::kList:
        factors = FactorsOf(request_.tau_list, series_.period, samples());
        if (factors.size() < request_.tau_list.size()) {
          Note(
              "averaging times that do not fit twice into the log, or fall on one number of "
              "samples, are left out");
        }
        break;
    }
    return AllanVariance(series_.values, series_.period, factors, options, series_.gaps);
  }

  void Note(std::string text) { answer_.notes.push_back(std::move(text)); }
  // For the noise file too, whose coefficients are of what is left.
  void Cleaned(std::string text) {
    cleaned_.push_back(text);
    Note(std::move(text));
  }

  std::string Place(const SampleGap& where) const {
    if (where.end - where.begin == 1) {
      return fmt::format("sample {} ({})", where.begin, Time(where.begin));
    }
    return fmt::format("samples {} to {} ({} to {})", where.begin, where.end - 1, Time(where.begin),
                       Time(where.end));
  }
  std::string Time(std::int64_t sample) const {
    return fmt::format("{:.6g} s", static_cast<double>(sample) * series_.period);
  }

  void TellList(const std::string& what, const std::vector<SampleGap>& places) {
    std::int64_t count = 0;
    for (const auto& place : places) count += place.end - place.begin;
    std::string text = fmt::format("{} {} {}: ", count, count == 1 ? "sample" : "samples", what);
    for (std::size_t i = 0; i < std::min(kPlacesTold, places.size()); ++i) {
      text += (i > 0 ? ", " : "") + Place(places[i]);
    }
    if (places.size() > kPlacesTold) {
      text += fmt::format(" and {} more places", places.size() - kPlacesTold);
    }
    Note(text);
    answer_.losses = true;
  }

  // Also puts what was found not finite among the gaps, so that it is found but once.
  void TellMissing(const AllanResult& octaves) {
    if (!missing_.empty()) TellList("missing by number", missing_);
    if (!series_.saturated.empty()) {
      TellList("saturated, as the source says", series_.saturated);
    }
    if (octaves.not_finite.empty()) return;
    std::vector<SampleGap> own;
    for (const auto& bad : octaves.not_finite) {
      const bool known = std::any_of(series_.gaps.begin(), series_.gaps.end(), [&](const auto& g) {
        return g.begin <= bad.begin && bad.end <= g.end;
      });
      if (!known) own.push_back(bad);
    }
    if (own.empty()) return;
    TellList("not finite, left out", own);
    for (const auto& bad : own) {
      for (auto i = bad.begin; i < bad.end; ++i) series_.values[static_cast<std::size_t>(i)] = 0;
    }
    series_.gaps.insert(series_.gaps.end(), own.begin(), own.end());
    std::sort(series_.gaps.begin(), series_.gaps.end(),
              [](const SampleGap& a, const SampleGap& b) { return a.begin < b.begin; });
    for (std::size_t g = 1; g < series_.gaps.size(); ++g) {
      series_.gaps[g].begin = std::max(series_.gaps[g].begin, series_.gaps[g - 1].end);
      series_.gaps[g].end = std::max(series_.gaps[g].begin, series_.gaps[g].end);
    }
  }

  std::string Reading(double value) const {
    return Shown(value * std::abs(si_), unit_.shown_si, unit_.shown);
  }

  void TellFindings() {
    StaticLogOptions options;
    options.lowest = series_.lowest;
    options.highest = series_.highest;
    options.temperature = series_.temperature;
    for (const auto& found : InspectStaticLog(series_.values, series_.gaps, options)) Tell(found);
  }

  void Tell(const LogFinding& found) {
    switch (found.kind) {
      case LogFinding::Kind::kConstant:
        Note(fmt::format("every sample reads {:g}: nothing measures here", found.size));
        break;
      case LogFinding::Kind::kSaturated:
        Note(fmt::format("saturated at a reading of {:g}: {} samples, {}", found.size,
                         found.samples, Place(found.where)));
        answer_.losses = true;
        break;
      case LogFinding::Kind::kStuck:
        Note(fmt::format("stood still at a reading of {:g}: {}", found.size, Place(found.where)));
        break;
      case LogFinding::Kind::kMoved:
        Note(
            fmt::format("moved or shook at {}: by {}, where neighbouring means differ by {}; "
                        "leave that part out",
                        Place(found.where), Reading(found.size), Reading(found.typical)));
        break;
      case LogFinding::Kind::kStep:
        Note(
            fmt::format("stepped by {} at {}, and stayed there: two logs in one; leave one out "
                        "(--exclude)",
                        Reading(found.size), Place(found.where)));
        break;
      case LogFinding::Kind::kWarmUp:
        Note(
            fmt::format("warms up: by {} with a time constant of {}; leave out the first five time "
                        "constants (--exclude 0:{:.0f})",
                        Reading(found.size), DurationText(*found.time_constant * series_.period),
                        std::ceil(5 * *found.time_constant * series_.period)));
        break;
      case LogFinding::Kind::kTemperature:
        Note(fmt::format("drifts with temperature: {} over the log, {} per degC, fastest at {}",
                         Reading(found.size), Reading(*found.per_degree), Place(found.where)));
        break;
      case LogFinding::Kind::kDrift:
        Note(fmt::format("drifts one way, as with temperature: {} over the log, fastest at {}",
                         Reading(found.size), Place(found.where)));
        break;
    }
  }

  void FitModel(const AllanResult& octaves) {
    NoiseFitOptions options = request_.fit;
    options.progress = Part(0.4, 0.6);
    Result<NoiseFit> fit = FitNoise(octaves, options);
    if (fit) {
      fit_ = *std::move(fit);
      model_ = fit_->model;
      // One an averaging time is usual; by chance four comes once in 60 000 logs of ten averaging
      // times, once in 2000 of six (chi-square).
      constexpr double kFarOff = 4;
      if (fit_->deviance > kFarOff * fit_->points) {
        Note(
            fmt::format("these terms do not explain the log (deviance {:.0f} at {} averaging "
                        "times): it moved, or holds a sinusoid or other noise; the bounds of the "
                        "coefficients mean little",
                        fit_->deviance, fit_->points));
      }
      return;
    }
    answer_.unfit = fit.fault();
    answer_.unfit->source = request_.source;
    // Bounds still want a kind of noise: white until shown otherwise.
    model_.coefficient[NoiseTerm::kAngleRandomWalk] = 1;
  }

  void WriteTable() {
    const std::string& c = unit_.column;
    answer_.table = fmt::format("tau_s,adev{0},n,edf,lower95{0},upper95{0}\n", c);
    for (const auto& row : rows_) {
      const auto deviation = [&](double variance) { return std::sqrt(variance) / unit_.shown_si; };
      answer_.table +=
          fmt::format("{},{:.15g},{},{:.6g},{:.8g},{:.8g}\n", row.point.tau,
                      deviation(row.point.variance), row.point.terms, row.edf,
                      deviation(row.interval95.lower), deviation(row.interval95.upper));
    }
  }

  std::string TermLine(NoiseTerm term) const {
    const TermFit& fit = fit_->term[term];
    const TermText text = TextOf(term, unit_);
    const std::string name = fmt::format("{} {}", text.name, text.letter);
    if (!fit.observable) {
      return fmt::format("  {:<26} not observable, below {} (95 %)\n", name,
                         Shown(fit.upper95, text.unit_si, text.unit));
    }
    return fmt::format("  {:<26} {:.4g} +- {:.2g} {}, 95 %: {:.4g} to {:.4g}\n", name,
                       fit.value / text.unit_si, fit.sigma / text.unit_si, text.unit,
                       fit.lower95 / text.unit_si, fit.upper95 / text.unit_si);
  }

  void WriteSummary(const AllanResult& octaves) {
    auto& text = answer_.summary;
    text = fmt::format("{}: {} samples at {:g} Hz, {}\n", request_.source, octaves.samples,
                       1 / series_.period,
                       DurationText(static_cast<double>(octaves.samples) * series_.period));
    if (!fit_) return;
    for (const auto term : kAllNoiseTerms) {
      const bool asked = term != NoiseTerm::kSinusoid || model_.shape.sinusoid_frequency > 0;
      if (asked) text += TermLine(term);
    }
    const auto time = CoefficientsOf(*fit_).bias_instability_correlation_time;
    if (time) {
      text += fmt::format("  {:<26} {} +- {}\n", "correlation time of B", DurationText(*time),
                          DurationText(fit_->sigma_correlation_time.value_or(0)));
    }
  }

  void WritePlot() {
    NoisePlotLabels labels;
    const char* kind = request_.deviation == Deviation::kModified     ? "modified Allan deviation"
                       : request_.deviation == Deviation::kOverlapped ? "overlapped Allan deviation"
                                                                      : "Allan deviation";
    labels.title =
        request_.channel.empty() ? request_.source : request_.source + ", " + request_.channel;
    labels.deviation =
        unit_.shown.empty() ? std::string(kind) : fmt::format("{} [{}]", kind, unit_.shown);
    labels.deviation_si = unit_.shown_si;
    // The modified deviation of the terms is another than the one that was fitted.
    const bool with_fit = fit_ && request_.deviation != Deviation::kModified;
    for (const auto term : kAllNoiseTerms) {
      if (!with_fit || !fit_->term[term].observable) continue;
      const TermText text = TextOf(term, unit_);
      labels.term[term] = fmt::format("{} {}\n{:.4g} \u00b1 {:.2g} {}", text.name, text.letter,
                                      fit_->term[term].value / text.unit_si,
                                      fit_->term[term].sigma / text.unit_si, text.unit);
    }
    SayBesides(labels);
    answer_.plot = NoisePlotSvg(rows_, with_fit ? &*fit_ : nullptr, labels);
  }

  /// Length and rate of the log, what it cannot show, and what is wrong with it.
  void SayBesides(NoisePlotLabels& labels) const {
    labels.facts = {
        fmt::format("{} at {:g} Hz", DurationText(static_cast<double>(samples_) * series_.period),
                    1 / series_.period),
        "\u00b1 is one sigma, the band 95 %"};
    if (request_.deviation == Deviation::kModified) {
      labels.facts.emplace_back("the fitted terms are of another deviation");
    }
    for (const auto term : kAllNoiseTerms) {
      const bool asked = term != NoiseTerm::kSinusoid || model_.shape.sinusoid_frequency > 0;
      if (!fit_ || !asked || fit_->term[term].observable) continue;
      const TermText text = TextOf(term, unit_);
      labels.bounds.push_back(fmt::format("{} not observable,", text.name));
      labels.bounds.push_back(fmt::format(
          "   below {} (95 %)", Shown(fit_->term[term].upper95, text.unit_si, text.unit)));
    }
    labels.warnings = answer_.notes;
    if (answer_.unfit) labels.warnings.push_back("no fit: " + answer_.unfit->text);
  }

  SampleSeries series_;
  std::int64_t samples_ = 0;  ///< of the log, the missing ones too
  const AllanRequest& request_;
  AllanUnit unit_;
  double si_ = 1;
  std::vector<SampleGap> missing_;    ///< before anything was left out on purpose
  std::vector<std::string> cleaned_;  ///< what was, and what was taken off
  std::optional<NoiseFit> fit_;
  NoiseModel model_;
  std::vector<AllanRow> rows_;
  AllanAnswer answer_;
};

}  // namespace

Result<AllanAnswer> AnswerAllan(SampleSeries series, const AllanRequest& request) {
  if (!(series.period > 0)) {
    throw std::invalid_argument("AnswerAllan: the series has no period");
  }
  if (!(std::abs(request.scale) > 0) || !std::isfinite(request.scale)) {
    throw std::invalid_argument(fmt::format("scale {} is not a number to scale by", request.scale));
  }
  return Analyst(std::move(series), request).Answer();
}

}  // namespace wellgyro
