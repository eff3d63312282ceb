#include "wellgyro/survey/verdict/run_diagnosis.h"

#include <algorithm>
#include <cmath>
#include <string_view>

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <fmt/core.h>

#include "wellgyro/record/run_fit.h"
#include "wellgyro/survey/verdict/check_internal.h"
#include "wellgyro/survey/verdict/known_causes_internal.h"
#include "wellgyro/survey/verdict/verdict.h"
#include "wellgyro/uncertainty/ellipse.h"

namespace wellgyro {
namespace {

using Eigen::Index;
using Kind = CauseSpec::Kind;

// Of runs, those with some fault before anything is known of them. No field statistics are
// published; by it the probabilities are stated, not what is found.
constexpr double kFaultyShare = 0.1;
// Correlation rho of two signatures beyond which they are hardly told apart: the expected logarithm
// of their odds is w^2 (1 - rho^2) / 2, w the fault's size over its sigma, and odds of 20 take
// w = sqrt(2 ln(20) / (1 - rho^2)) = 5.6 (Imparato, Teunissen and Tiberius 2019).
constexpr double kAlike = 0.9;
// Of what a fault does to the rows, squared, that its column misses: the run is made linear about a
// solution that the fault has moved.
constexpr double kNotLinear = 0.01;
constexpr double kNamed = kConfidence;  // probability of the causes named together

// [m], from a stop to what the diagnosis says began there: within a knot, 1 s at 0.5 m/s.
constexpr double kThatStop = 0.5;

/// ln(e^a + e^b).
double LogSum(double a, double b) {
  const double most = std::max(a, b);
  return most + std::log(std::exp(a - most) + std::exp(b - most));
}

/// By posteriors; where these are too small to be held, by the Bayes factors that they are of.
bool IsLikelier(const RunCause& a, const RunCause& b) {
  if (a.posterior != b.posterior) return a.posterior > b.posterior;
  return a.ln_bayes.value_or(-HUGE_VAL) > b.ln_bayes.value_or(-HUGE_VAL);
}

/// ln of the odds of something else beside the likeliest, beyond what the linear columns of a fault
/// leave of it.
double LnOddsBeside(const Diagnosis& tests) {
  if (!tests.first) return tests.ln_odds_without_first;
  return tests.ln_odds_without_first - kNotLinear * tests.tests[*tests.first].ln_bayes;
}

/// The tests with what the second look says for none of the causes: the likeliest and something
/// else at once is B(first) B(else | first), a second fault as rare beside a first as a first is.
std::vector<CauseTest> WithSomethingElse(const Diagnosis& tests) {
  std::vector<CauseTest> judged = tests.tests;
  if (!tests.first) return judged;
  CauseTest& other = judged.back();  // the last of KnownCauses()
  const double both = std::log(kFaultyShare) + judged[*tests.first].ln_bayes + LnOddsBeside(tests);
  other.ln_bayes = other.tested ? LogSum(other.ln_bayes, both) : both;
  other.tested = true;
  return judged;
}

RunCause CauseOfTest(const KnownCause& entry, const CauseTest& test,
                     std::span<const RunKnot> knots) {
  RunCause cause;
  cause.code = entry.code;
  cause.unit = entry.unit_name;
  cause.remedy = entry.remedy;
  cause.ln_bayes = test.ln_bayes;
  if (entry.kind == Kind::kOther || !test.told) return cause;
  if (entry.kind != Kind::kGiven) {
    cause.size = test.size / entry.unit;
    cause.sigma = test.sigma / entry.unit;
  }
  if (entry.kind == Kind::kGyroNoise || entry.kind == Kind::kAccelNoise) return cause;
  cause.shift_W = test.shift_W;
  const bool all_the_while = entry.kind == Kind::kConstant || entry.kind == Kind::kGiven;
  if (all_the_while || test.node >= knots.size()) return cause;
  cause.begin = knots[test.node].utc;
  if (knots[test.node].along.known) cause.begin_md = knots[test.node].along.md;
  return cause;
}

RunReliability ReliabilityOf(const KnownCause& entry, const CauseTest& test,
                             std::span<const RunKnot> knots) {
  RunReliability hidden;
  hidden.code = entry.code;
  hidden.unit = entry.unit_name;
  if (test.noticeable) hidden.smallest = test.smallest / entry.unit;
  hidden.shift_W = test.hidden_W;
  if (entry.kind != Kind::kConstant && test.smallest_node < knots.size() &&
      knots[test.smallest_node].along.known) {
    hidden.md = knots[test.smallest_node].along.md;
  }
  return hidden;
}

bool HasReliability(const KnownCause& entry, const CauseTest& test) {
  return test.tested && entry.kind != Kind::kGyroNoise && entry.kind != Kind::kAccelNoise &&
         entry.kind != Kind::kOther && entry.kind != Kind::kGiven;
}

/// The likeliest causes that together have kNamed of the probability that there is one.
std::vector<const RunCause*> Named(const std::vector<RunCause>& causes) {
  double all = 0, named = 0;
  for (const RunCause& cause : causes) all += cause.code == "none" ? 0 : cause.posterior;
  std::vector<const RunCause*> set;
  for (const RunCause& cause : causes) {
    if (cause.code == "none") continue;
    if (named >= kNamed * all) break;
    named += cause.posterior;
    set.push_back(&cause);
  }
  return set;
}

bool IsShown(const RunDiagnosis& diagnosis) {
  return !(diagnosis.ln_odds <= -std::log(kDiagnosisFalseAlarms));
}

/// One of the causes named moves the end by more than a sigma in its direction, or by what is not
/// known.
bool MovesTheEnd(const RunDiagnosis& diagnosis, std::int32_t run, std::span<const Station> passes) {
  const Station* end = nullptr;
  for (const Station& s : passes) {
    if (s.run == run && (end == nullptr || s.md > end->md)) end = &s;
  }
  if (end == nullptr) return false;
  const Eigen::LDLT<Eigen::Matrix3d> cov(end->cov_p_WT_W);
  const std::vector<const RunCause*> named = Named(diagnosis.causes);
  return std::any_of(named.begin(), named.end(), [&](const RunCause* cause) {
    return !cause->shift_W || !(cause->shift_W->dot(cov.solve(*cause->shift_W)) <= 1);
  });
}

/// The likeliest that has a name; null: there is none.
const RunCause* NearestOf(const std::vector<RunCause>& causes) {
  for (const RunCause& cause : causes) {
    if (cause.code != "none" && cause.code != "other") return &cause;
  }
  return nullptr;
}

/// The check says that the tool moved at a stop, and there the likeliest fault of the rows begins:
/// a slow motion and its end look to them as one turn that the gyros have wrong.
bool MovedAtRest(const RunSummary& run, const Check& check) {
  if (check.code != kRestMotionCause || !check.md) return false;
  if (!run.fit || !run.fit->diagnosis || !IsShown(*run.fit->diagnosis)) return false;
  const RunCause* nearest = NearestOf(run.fit->diagnosis->causes);
  return nearest != nullptr && nearest->begin_md &&
         std::abs(*nearest->begin_md - *check.md) < kThatStop;
}

/// With the likeliest cause taken out a fault shows still, which may have moved the end.
bool IsMore(const RunDiagnosis& diagnosis) {
  return diagnosis.ln_odds_without_first > -std::log(kDiagnosisFalseAlarms);
}

std::string WordsOf(const RunCause& cause, double share) {
  std::string text = fmt::format("{} ({:.2f}", cause.code, share);
  if (cause.size) {
    text += fmt::format(", {} +- {}{}", ShortNumber(*cause.size, 3),
                        ShortNumber(cause.sigma.value_or(0), 1),
                        cause.unit == "1" ? "" : " " + cause.unit);
  }
  if (cause.begin_md) text += fmt::format(", from MD {:.1f} m", *cause.begin_md);
  if (cause.shift_W) {
    text += fmt::format(", end moved by {} m", ShortNumber(cause.shift_W->norm(), 2));
  }
  return text + ")";
}

/// Where no cause alone explains the run, those that come nearest.
std::string WordsOfNearest(const RunDiagnosis& diagnosis) {
  const RunCause* nearest = NearestOf(diagnosis.causes);
  if (nearest == nullptr) return "";
  const bool then = !diagnosis.second.empty() && diagnosis.second != "other";
  return fmt::format(" explains it alone; {} comes nearest{}", nearest->code,
                     then ? ", then " + diagnosis.second : "");
}

std::string WordsOf(const RunDiagnosis& diagnosis) {
  const std::vector<const RunCause*> named = Named(diagnosis.causes);
  if (named.empty()) return "";
  double all = 0;
  for (const RunCause& cause : diagnosis.causes) {
    all += cause.code == "none" ? 0 : cause.posterior;
  }
  if (named.size() == 1 && named[0]->code == "other") {
    return "none of the faults that are known" + WordsOfNearest(diagnosis);
  }
  std::string text = named.size() > 1 ? "one of " : "";
  for (std::size_t i = 0; i < named.size(); ++i) {
    text += (i > 0 ? ", " : "") + WordsOf(*named[i], all > 0 ? named[i]->posterior / all : 0);
  }
  return text + "; if the first: " + named[0]->remedy;
}

}  // namespace

RunDiagnosis DiagnosisOf(const Diagnosis& tests, std::span<const RunKnot> knots) {
  RunDiagnosis diagnosis;
  if (!tests.done) return diagnosis;
  diagnosis.ln_odds = tests.ln_odds;
  diagnosis.ln_odds_without_first = LnOddsBeside(tests);
  if (tests.second) diagnosis.second = KnownCauses()[*tests.second].code;
  const std::vector<CauseTest> judged = WithSomethingElse(tests);
  double tested = 0;
  for (const CauseTest& test : judged) tested += test.tested ? 1 : 0;
  // ln of what p(none) + sum of p(cause) B(cause) comes to.
  const double none = std::log(1 - kFaultyShare), each = std::log(kFaultyShare / tested);
  double sum = none;
  for (const CauseTest& test : judged) {
    if (test.tested) sum = LogSum(sum, each + test.ln_bayes);
  }
  for (std::size_t i = 0; i < KnownCauses().size(); ++i) {
    const CauseTest& test = judged[i];
    if (!test.tested) continue;
    RunCause cause = CauseOfTest(KnownCauses()[i], test, knots);
    cause.posterior = std::exp(each + test.ln_bayes - sum);
    for (std::size_t j = 0; j < KnownCauses().size(); ++j) {
      const double rho = tests.alike(static_cast<Index>(i), static_cast<Index>(j));
      if (j != i && std::abs(rho) > kAlike) cause.alike.emplace_back(KnownCauses()[j].code);
    }
    // Where marks and felt motion part for a moment along the hole, either may be wrong.
    constexpr int kAlong = 2;
    if (KnownCauses()[i].kind == Kind::kAccelSpike && test.row == kAlong) {
      cause.alike.emplace_back("depth_slip");
    }
    diagnosis.causes.push_back(std::move(cause));
    if (HasReliability(KnownCauses()[i], test)) {
      diagnosis.reliability.push_back(ReliabilityOf(KnownCauses()[i], test, knots));
    }
  }
  RunCause& clean = diagnosis.causes.emplace_back();
  clean.code = "none";
  clean.ln_bayes = 0;
  clean.posterior = std::exp(none - sum);
  std::ranges::stable_sort(diagnosis.causes, IsLikelier);
  return diagnosis;
}

double DepthScaleFound(const Job& job, const RunDiagnosis& diagnosis) {
  const double prior = job.errors.depth_scale_sigma;
  if (IsShown(diagnosis)) {
    for (const RunCause* cause : Named(diagnosis.causes)) {
      if (cause->code == kDepthScaleCause) return 0;
    }
  }
  for (const RunCause& cause : diagnosis.causes) {
    if (cause.code != kDepthScaleCause || !cause.size || !cause.sigma) continue;
    // The size beyond the prior has the variance prior^2 / (1 - rest), the scale as found
    // size (1 - rest) that of prior^2 rest.
    const double told = std::min(prior * prior / (*cause.sigma * *cause.sigma), 1.0);
    return std::hypot(*cause.size * told, prior * std::sqrt(1 - told));
  }
  return 0;
}

void CheckDiagnosis(const RunSummary& run, std::span<const Station> passes,
                    std::vector<Check>& checks) {
  const RunDiagnosis* found = run.fit && run.fit->diagnosis ? &*run.fit->diagnosis : nullptr;
  if (found == nullptr || found->causes.empty()) {
    checks.push_back(NotDone("diagnosis", run.run,
                             found == nullptr ? "the run was not solved by rotations"
                                              : "the residuals of the run could not be tested"));
    return;
  }
  const double limit = -std::log(kDiagnosisFalseAlarms);
  Check check{.code = "diagnosis", .run = run.run, .value = found->ln_odds, .unit = "1"};
  const bool shown = IsShown(*found);
  const bool fails = shown && (IsMore(*found) || MovesTheEnd(*found, run.run, passes));
  check.verdict = fails ? Verdict::kFail : shown ? Verdict::kWarn : Verdict::kPass;
  // Without a limit of its own: what is told of the check are the causes.
  if (shown) {
    check.limit_source = WordsOf(*found);
  } else {
    check.limit = limit;
    check.limit_source =
        fmt::format("ln of the odds, {:g} % of clean runs", 100 * kDiagnosisFalseAlarms);
  }
  checks.push_back(check);
  for (const RunCause& cause : found->causes) {
    if (cause.code != kDepthScaleCause || !cause.size || !cause.sigma) continue;
    checks.push_back(
        Compare("depth_scale_felt", run.run, {*cause.size, *cause.sigma}, std::nullopt, 1, "1"));
  }
}

namespace {

/// The check by itself names what is wrong with samples or marks, and says that it is there. What
/// chance makes of clean runs is no such thing until it fails.
bool IsSeenInSamples(const Check& check) {
  if (RemedyOfSamples(check.code).empty()) return false;
  return check.verdict == Verdict::kFail || (check.verdict == Verdict::kWarn && check.looks == 0);
}

RunCause CauseOfSamples(const Check& check) {
  RunCause cause;
  cause.code = check.code;
  cause.begin_md = check.md;
  cause.size = check.value;
  cause.sigma = check.sigma;
  cause.unit = check.unit;
  cause.remedy = RemedyOfSamples(check.code);
  return cause;
}

/// The causes by the run's rows and that by its passes, which are other measurements: each explains
/// its own alone. Posteriors are proportional to the prior odds times B.
std::vector<RunCause> WithSlip(const RunSummary& run) {
  std::vector<RunCause> causes = run.fit->diagnosis->causes;
  if (!run.slip || !run.slip->cause.ln_bayes || causes.empty()) return causes;
  causes.push_back(run.slip->cause);
  const double none = std::log(1 - kFaultyShare);
  const double each = std::log(kFaultyShare / static_cast<double>(causes.size() - 1));
  const auto weight = [&](const RunCause& cause) {
    return (cause.code == "none" ? none : each) + cause.ln_bayes.value_or(0);
  };
  double sum = -HUGE_VAL;
  for (const RunCause& cause : causes) sum = LogSum(sum, weight(cause));
  for (RunCause& cause : causes) cause.posterior = std::exp(weight(cause) - sum);
  std::ranges::stable_sort(causes, IsLikelier);
  return causes;
}

}  // namespace

std::vector<RunCause> CausesOf(const RunSummary& run, std::span<const Check> checks) {
  const bool by_rows = run.fit && run.fit->diagnosis && IsShown(*run.fit->diagnosis);
  std::vector<RunCause> causes, beside;
  for (const Check& check : checks) {
    if (check.run != run.run || !IsSeenInSamples(check)) continue;
    const bool first = check.verdict == Verdict::kFail || !by_rows || MovedAtRest(run, check);
    (first ? causes : beside).push_back(CauseOfSamples(check));
  }
  const bool by_samples = !causes.empty();
  for (RunCause& cause : causes) cause.posterior = 1 / static_cast<double>(causes.size());
  // No fault can be tested of a run whose adjustment gave up: something is wrong without a name.
  if (!by_samples && run.fit && !run.fit->converged && !run.fit->diagnosis) {
    RunCause& cause = causes.emplace_back();
    cause.code = "other";
    cause.posterior = 1;
    cause.remedy = "survey the well again";
  }
  if (!run.fit || !run.fit->diagnosis) return causes;
  for (const RunCause& cause : WithSlip(run)) {
    causes.push_back(cause);
    if (by_samples) causes.back().posterior = 0;
  }
  causes.insert(causes.end(), beside.begin(), beside.end());
  return causes;
}

}  // namespace wellgyro
