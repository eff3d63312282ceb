#include "wellgyro/survey/survey_maker.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "wellgyro/math/rotation.h"
#include "wellgyro/math/square.h"
#include "wellgyro/record/run_fit.h"
#include "wellgyro/survey/hole/hole_attitude.h"
#include "wellgyro/survey/intake/station_marks.h"
#include "wellgyro/survey/run/joined_states.h"
#include "wellgyro/survey/run/mirrors.h"
#include "wellgyro/survey/stations/assemble.h"
#include "wellgyro/survey/tool_survey_internal.h"
#include "wellgyro/survey/verdict/check_internal.h"
#include "wellgyro/survey/verdict/depth_checks.h"
#include "wellgyro/survey/verdict/depth_slip.h"
#include "wellgyro/survey/verdict/run_diagnosis.h"
#include "wellgyro/survey/verdict/tie_in_check.h"
#include "wellgyro/survey/verdict/verdict.h"
#include "wellgyro/survey/wells/model_covariance.h"

namespace wellgyro {
namespace {

/// Where the hole pointed on all runs, but for those that nobody counts.
std::vector<PathStation> SeenOf(const std::vector<DraftedRun>& drafted) {
  std::vector<PathStation> seen;
  for (const DraftedRun& run : drafted) {
    if (run.misrun) continue;
    for (const Waypoint& at : run.way) seen.push_back(at.station);
  }
  return seen;
}

// A foresight holds at a knot no further away than this: knots are 1 s apart, one may be missing.
constexpr double kForesightSeconds = 2;
// From so many sigmas on two norths are not both right, P(|x| > 4) = 6.3e-5.
constexpr double kContradiction = 4;

std::int64_t WithoutAzimuth(const std::vector<DraftedRun>& drafted) {
  std::int64_t count = 0;
  for (const DraftedRun& run : drafted) count += run.without_azimuth + run.waiting_for_azimuth;
  return count;
}

Check CheckAzimuths(const std::vector<DraftedRun>& drafted) {
  std::int64_t waiting = 0;
  for (const DraftedRun& run : drafted) waiting += run.waiting_for_azimuth;
  const std::int64_t never = WithoutAzimuth(drafted) - waiting;
  if (never == 0 && waiting > 0) {
    return NotDone("stations_without_azimuth", 0,
                   fmt::format("{} stations wait for the next north of their run, which has not "
                               "ended",
                               waiting));
  }
  return CountOf("stations_without_azimuth", 0, never, "every station passed has an azimuth");
}

/// What the job states of runs that are not there and of a place that none of them reached, where
/// it states any.
std::optional<Check> CheckStated(const Job& job, const std::vector<RunSummary>& runs) {
  std::vector<std::string> unmet;
  for (const RunSpec& spec : job.runs) {
    if (std::ranges::find(runs, spec.number, &RunSummary::run) != runs.end()) continue;
    unmet.push_back(fmt::format("[[run]] number = {}", spec.number));
  }
  const AlignmentSpec& spec = job.alignment;
  const bool placed =
      spec.method == AlignmentSpec::Method::kExternal && (spec.at_md || spec.at_utc);
  const auto is_tie = [](const NorthFix& fix) { return fix.external && !fix.magnetic_azimuth; };
  const bool tied = std::ranges::any_of(
      runs, [&](const RunSummary& run) { return std::ranges::any_of(run.fixes, is_tie); });
  if (placed && !tied) unmet.emplace_back("the place of the azimuth in [alignment]");
  if (job.runs.empty() && !placed) return std::nullopt;
  return CountOf("stated_unmet", 0, static_cast<std::int64_t>(unmet.size()),
                 unmet.empty() ? "all of it was met" : fmt::format("{}", fmt::join(unmet, "; ")));
}

/// What samples and marks say of their axes, units and signs, in front of what could not be made of
/// them; what only follows comes last.
std::string WrongInput(const std::vector<Check>& checks) {
  for (const std::string_view code :
       {"accel_dead", "gyro_dead", "accel_unit", "axes", "tool_upside_down", "depth_reversed",
        "depth_unit", "gyro_unit"}) {
    const auto check = std::ranges::find_if(
        checks, [code](const Check& c) { return c.code == code && c.verdict == Verdict::kFail; });
    if (check != checks.end()) return CauseOf(*check) + "; ";
  }
  return {};
}

/// Near vertical the hole's direction is known without an azimuth.
bool HasDirection(const AttitudeSample& attitude) {
  return attitude.azimuth_known || Has(attitude.quality, Quality::kVertical);
}

struct KnotOfTime {
  RunKnot knot;
  std::size_t number = 0;
  bool before = false;
};

/// The first that does not end before `utc`, or the last, which ends before it; there is one.
KnotOfTime KnotAt(UtcTime utc, const KeptKnots& knots) {
  KnotOfTime at;
  KeptKnots::Reader reader(knots);
  for (std::size_t i = 0; const KeptKnot* kept = reader.Next(); ++i) {
    at = {kept->knot, i, kept->knot.utc < utc};
    if (!at.before) break;
  }
  return at;
}

}  // namespace

std::optional<Contradicted> Contradiction(const Job& job, const RunSummary& run) {
  if (job.alignment.method != AlignmentSpec::Method::kExternal) return std::nullopt;
  Contradicted worst;
  if (run.fit && run.fit->sigma_closure_outside > 0) {
    worst.sigmas = std::abs(run.fit->closure_outside) / run.fit->sigma_closure_outside;
  }
  for (const NorthFix& fix : run.fixes) {
    if (fix.external || !fix.chi_square || Has(fix.quality, Quality::kVertical)) continue;
    if (*fix.chi_square > Square(worst.sigmas)) worst = {std::sqrt(*fix.chi_square), fix.md};
  }
  return worst.sigmas > kContradiction ? std::optional(worst) : std::nullopt;
}

/// Where the hole points at every knot that has a depth and a direction.
std::vector<Waypoint> SurveyMaker::WayOf(const ToolRun& run) const {
  std::vector<Waypoint> way;
  way.reserve(run.survey->knots().size());
  KeptKnots::Reader reader(run.survey->knots());
  for (std::size_t i = 0; const KeptKnot* kept = reader.Next(); ++i) {
    const RunKnot& knot = kept->knot;
    const AttitudeSample& attitude = i < run.attitude.size() ? run.attitude[i] : kept->attitude;
    if (!knot.along.known || !HasDirection(attitude)) continue;
    // A UTC that has stepped back passes the same times again.
    if (!way.empty() && knot.utc < way.back().utc) continue;
    const Eigen::Vector3d tangent_L = TangentOfHole(attitude, job_.string);
    way.push_back({knot.utc, {knot.along.md, InclinationOf(tangent_L), AzimuthOf(tangent_L)}});
  }
  return way;
}

DraftedRun SurveyMaker::DraftedOf(const ToolRun& run) const {
  const RunSummary& summary = run.survey->summary();
  DraftedRun d;
  d.run = summary.run;
  d.misrun = string_.book.misrun(d.run);
  d.states = JoinStates(run.adjusted, run.survey->states());
  d.way = WayOf(run);
  if (summary.fit && summary.fit->diagnosis) {
    d.depth_scale_found = DepthScaleFound(job_, *summary.fit->diagnosis);
  }
  const bool contradicted = Contradiction(job_, summary).has_value();
  for (std::size_t i = 0; i < run.survey->drafts().size(); ++i) {
    Draft draft = run.survey->drafts()[i];
    if (contradicted) draft.station.quality |= Quality::kEarthRate;
    if (draft.state && !HasDirection(d.states[*draft.state].attitude)) {
      // The next one's covariance with this one would be taken for that with the one before.
      if (*draft.state + 1 < d.states.size()) d.states[*draft.state + 1].cov_with_previous = {};
      const bool waits =
          !parts_.finished && &run == &parts_.runs.back() && run.survey->IsUnheard(i);
      if (draft.in_survey()) ++(waits ? d.waiting_for_azimuth : d.without_azimuth);
      continue;
    }
    draft.station.status = parts_.crew.StatusOf(draft.station, i < run.adjusted_drafts);
    // The run as a whole knows one azimuth: no stop of it has two any more.
    const bool whole = draft.state && *draft.state < run.adjusted.size() && summary.fit &&
                       run.adjusted[*draft.state].attitude.azimuth_known;
    if (whole) draft.station.quality = Without(draft.station.quality, Quality::kMirror);
    d.drafts.push_back(std::move(draft));
  }
  ResolveMirrors(job_, d.drafts);
  return d;
}

std::vector<DraftedRun> SurveyMaker::Drafted() const {
  std::vector<DraftedRun> drafted;
  for (const ToolRun& run : parts_.runs) drafted.push_back(DraftedOf(run));
  return drafted;
}

std::vector<Foresight> SurveyMaker::Foresights() const {
  std::vector<Foresight> result;
  for (const Event& event : parts_.crew.foresights()) {
    Foresight foresight{event.run, event.value_rad, event.sigma_rad, std::nullopt, 0};
    for (const ToolRun& run : parts_.runs) {
      if (run.survey->summary().run != event.run || run.survey->knots().empty()) continue;
      const KnotOfTime at = KnotAt(event.utc, run.survey->knots());
      if (at.number >= run.attitude.size()) continue;
      const double away = std::abs((at.knot.utc - event.utc).seconds());
      const AlongHole& along = at.knot.along;
      const bool rests = at.knot.still || (along.known && std::abs(along.speed) <= kRestSpeed);
      const bool held = at.before && rests && away <= kHeld.seconds();
      if (away > kForesightSeconds && !held) continue;
      const AttitudeSample& attitude = run.attitude[at.number];
      if (!attitude.azimuth_known) continue;
      foresight.measured = DirectionOfMark(attitude);
      foresight.sigma_measured = std::sqrt(attitude.cov_attitude(1, 1));
    }
    result.push_back(foresight);
  }
  return result;
}

std::vector<Check> SurveyMaker::Checks(const std::vector<RunSummary>& summaries,
                                       const std::vector<Station>& passes) const {
  const std::vector<Foresight> foresights = Foresights();
  return MakeChecks(job_, {summaries, passes, foresights, parts_.crew.returns(), &string_.marks,
                           string_.refused, string_.track.Deepest(parts_.newest_used)});
}

/// Samples behind the last depth, for which marks came after all, but too late [s].
double SurveyMaker::DepthTooLate() const {
  const double unknown = parts_.runs.back().survey->depth().seconds_without();
  if (string_.track.empty() || !(unknown > 0)) return 0;
  const double until_newest = (parts_.newest_used - string_.track.newest()).seconds();
  const double late = unknown - std::max(until_newest, 0.0);
  // Between the last mark and the first sample that would have needed another.
  return late > job_.depth.max_gap ? late : 0;
}

std::vector<RunSummary> SurveyMaker::Summaries() const {
  std::vector<RunSummary> summaries;
  for (const ToolRun& run : parts_.runs) {
    RunSummary& summary = summaries.emplace_back(run.survey->summary());
    summary.misrun = string_.book.misrun(summary.run);
    summary.sample_checks = run.watch->Checks(summary.run, summary.fixes);
    if (summary.samples > 0) {
      AddDepthChecks({run.motion->found(), run.watch->lean(), string_.sigma_utc}, summary.run,
                     summary.sample_checks);
    }
    summary.remark = string_.book.remark(summary.run);
    const SampleQueue::Counts& counts = parts_.counts;
    summary.duplicates = counts.duplicates;
    summary.samples_other = counts.others;
    summary.samples_refused = counts.refused + counts.strays + counts.late + counts.others;
  }
  if (!summaries.empty()) summaries.back().seconds_without_depth += DepthTooLate();
  return summaries;
}

/// The sentence for a survey whose samples or averages no depth came with; empty where some did.
std::string SurveyMaker::WithoutDepth() const {
  bool sampled = false;
  for (const ToolRun& run : parts_.runs) {
    const RunSummary& summary = run.survey->summary();
    const bool placed =
        std::any_of(summary.fixes.begin(), summary.fixes.end(),
                    [](const NorthFix& fix) { return !fix.from_samples && fix.md; });
    const bool empty = summary.samples == 0 && summary.fixes.empty();
    if (run.survey->depth().seen() || placed || empty) return {};
    sampled = sampled || summary.samples > 0;
  }
  if (!sampled) {
    return fmt::format(
        "averages at rest came but no depth with them: give each its own, or marks on {} at both "
        "its ends that agree within 2 cm, or raise [depth] max_gap_s = {} to what lies between "
        "the marks",
        job_.channels.depth, job_.depth.max_gap);
  }
  return fmt::format(
      "samples came but no depth with them: no marks on {} at their times, or all further apart "
      "than [depth] max_gap_s = {}",
      job_.channels.depth, job_.depth.max_gap);
}

/// The sentence for a survey that lacks nothing but a north; empty where there is one.
std::string SurveyMaker::WithoutNorth(const std::vector<DraftedRun>& drafted,
                                      const Survey& survey) const {
  const bool north = std::any_of(drafted.begin(), drafted.end(), [](const DraftedRun& run) {
    return std::any_of(run.drafts.begin(), run.drafts.end(), [&run](const Draft& draft) {
      return !draft.state || run.states[*draft.state].attitude.azimuth_known;
    });
  });
  if (north || (!survey.chosen.empty() && WithoutAzimuth(drafted) == 0)) return {};
  if (job_.alignment.method == AlignmentSpec::Method::kExternal) {
    return "no north was found: the depth or time at which the job's external azimuth holds was "
           "never reached";
  }
  const auto motion = std::ranges::find(survey.checks, "rest_motion", &Check::code);
  const bool moved = motion != survey.checks.end() && motion->value && *motion->value > 0;
  std::int64_t lost = 0, came = 0;
  for (const RunSummary& run : survey.runs) {
    lost += run.samples_lost;
    came += run.samples;
  }
  // A stop with gaps is none.
  const std::string gaps =
      lost > 0 ? fmt::format("; {} of {} samples are missing", lost, lost + came) : "";
  return fmt::format(
      "no north was found: no stop of {:.0f} s at which the {}gyros tell one azimuth from its "
      "mirror, and the job gives no azimuth{}; {}, or use [alignment] method = \"external\"",
      job_.alignment.min_still, moved ? "tool is still and the " : "", gaps,
      moved ? fmt::format("it moved while its depth rested, for up to {:.0f} s: hold it still at a "
                          "stop (slips, brake, centralisers)",
                          *motion->value)
            : "log a stop");
}

Survey SurveyMaker::Make() const {
  Survey survey;
  if (parts_.runs.empty()) {
    survey.unusable = "no samples came, and no averages at rest";
    return survey;
  }
  survey.runs = Summaries();
  survey.marks_refused = string_.refused.all();
  const std::vector<DraftedRun> drafted = Drafted();
  Placed placed = Assemble(job_, drafted);
  for (std::size_t i = 0; i < survey.runs.size(); ++i) {
    RunSummary& run = survey.runs[i];
    const double sigma_scale = drafted[i].SigmaOfDepthScale(job_.errors);
    run.slip = std::make_shared<const RunSlip>(FindSlip(job_, sigma_scale, placed.passes, run.run));
  }
  survey.checks = Checks(survey.runs, placed.passes);
  survey.checks.push_back(CheckAzimuths(drafted));
  if (job_.tie_in.md > 0) survey.checks.push_back(CheckTieInWay(job_.tie_in, SeenOf(drafted)));
  if (parts_.finished) {
    if (auto check = CheckStated(job_, survey.runs)) survey.checks.push_back(*std::move(check));
  }
  if (!job_.stations.at.empty()) survey.checks.push_back(CheckAsked(job_, placed.chosen));
  survey.passes = std::move(placed.passes);
  survey.chosen = std::move(placed.chosen);
  survey.unusable = std::move(placed.unusable);
  parts_.told.KeepTo(survey.passes);
  parts_.told.KeepTo(survey.chosen);
  if (survey.unusable.empty()) survey.unusable = TakeModelCovariance(job_, survey.chosen);
  survey.accepted = std::any_of(survey.passes.begin(), survey.passes.end(), [](const Station& s) {
    return s.status == StationStatus::kDefinitive;
  });
  // What lacks altogether says more than what there is none of because of it.
  std::string lacking = WithoutDepth();
  if (lacking.empty()) lacking = WithoutNorth(drafted, survey);
  if (!lacking.empty()) survey.unusable = std::move(lacking);
  if (!survey.unusable.empty()) {
    survey.unusable = WrongInput(survey.checks) + std::move(survey.unusable);
  }
  if (!survey.unusable.empty()) survey.chosen.clear();
  ShareFalseAlarms(survey.checks);
  GiveVerdict(survey);
  return survey;
}

}  // namespace wellgyro
