#include "live_survey.h"

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <optional>
#include <stdexcept>
#include <utility>
#include <vector>

#include <fmt/core.h>
#include <malloc.h>

#include "wellgyro/io/toml/plan_file.h"
#include "wellgyro/io/words.h"
#include "wellgyro/live/session.h"
#include "wellgyro/plan/live_advice.h"
#include "wellgyro/record/advice.h"
#include "wellgyro/record/glance.h"

#include "commands.h"
#include "console.h"
#include "delivery.h"
#include "live.h"
#include "report.h"
#include "result_report.h"

namespace wellgyro::apps {
namespace {

/// What a look at the whole survey took for a moment, the more the longer the run, goes back to the
/// system.
void GiveMemoryBack() {
#ifdef __GLIBC__
  ::malloc_trim(0);
#endif
}

/// A survey that adjusts when it is stopped does not hold up whoever stopped it.
class SurveyConsole : public Console {
 public:
  /// `page`, which may be null, must outlive this object.
  SurveyConsole(Says says, SurveyPage* page) : says_(says), page_(page) {}
  void OnNotice(std::string_view sentence) override {
    if (page_ != nullptr) page_->Say(sentence);
    Console::OnNotice(sentence);
  }
  void OnStation(const Station& station) override {
    if (page_ != nullptr) page_->Put(station);
  }
  void OnStatus(const Status& status) override {
    if (page_ != nullptr) page_->Put(status);
    NotifyManager("WATCHDOG=1");
    GiveMemoryBack();
    if (status.text == kBusy && says_ != Says::kNothing) Show(status.text);
  }
  void OnGlance(const Glance& glance) override {
    if (page_ != nullptr) page_->Put(glance);
    if (says_ != Says::kNothing) Console::OnGlance(glance);
  }
  void OnAdvice(const Advice& advice) override {
    if (page_ != nullptr) page_->Put(advice);
    // Sentences stand one under the other: those that say something else to do.
    if (page_ != nullptr && advice.action != advised_) page_->Say("advice: " + advice.text);
    advised_ = advice.action;
    Console::OnAdvice(advice);
  }
  void OnStuck(const std::optional<RunVerdict>& kept) override {
    End();
    int code = kUnusable;
    if (kept) {
      Complain("stopped while adjusting: the survey in the folder is whole, as of before that");
      code = Conclude(*kept, false, says_);
    } else {
      Complain("stopped while adjusting, before there was a survey");
    }
    std::fflush(stdout);
    std::_Exit(code);
  }

 private:
  Says says_;
  SurveyPage* page_;
  Advice::Action advised_ = Advice::Action::kNone;
};

/// What a survey that did not end with FINISH leaves behind; its exit code.
int Stopped(const SurveyOptions& options, const LiveOutcome& outcome) {
  if (outcome.fault) Complain(*outcome.fault);
  const char* next = options.record.empty() ? "" : "; --resume continues it";
  if (!outcome.usable()) {
    return Unusable(fmt::format("stopped before there was a survey: {}{}",
                                outcome.tools.front().survey.unusable, next));
  }
  if (outcome.fault || outcome.ended != LiveOutcome::Ended::kInterrupted) return kUnusable;
  Complain(fmt::format("stopped: the survey in {} is whole, not adjusted{}", options.out, next));
  std::vector<ToolSummary> tools;
  int report = kDone;
  for (const ToolResult& result : outcome.tools) {
    tools.push_back({.tool = result.tool, .folder = result.folder, .survey = &result.survey});
    if (!result.survey.unusable.empty()) continue;
    std::vector<std::string> untold;  // as the result's own files are
    report = std::max(report, ReportInto(result.folder, options.report, untold));
  }
  const int code =
      Conclude(WorstVerdict(outcome.tools), !outcome.recording_is_whole, options.says, tools);
  return code == kDone ? report : code;
}

LiveSetup SetupOf(const SurveyOptions& options, const JobFile& job) {
  LiveSetup setup{.job = job, .url = UrlOr(options.from), .out = options.out};
  setup.record = options.record;
  setup.resume = options.resume;
  setup.fill = options.fill;
  setup.formats = options.formats;
  setup.program = ProgramName();
  setup.clock = ThisClock();
  return setup;
}

/// The last words to those who look at the page.
void Farewell(SurveyPage& page, const LiveOutcome& outcome) {
  const char* how = outcome.ended == LiveOutcome::Ended::kFinished ? "finished and adjusted"
                    : outcome.ended == LiveOutcome::Ended::kInterrupted
                        ? "stopped, not adjusted"
                        : "the bus was lost, not adjusted";
  page.End(how, outcome.usable() ? WordOf(WorstVerdict(outcome.tools).verdict) : "none: no survey");
}

/// What the run is to be advised by; null: by nothing.
Result<std::shared_ptr<const AdviceCase>> AdviceOf(const SurveyOptions& options, const Job& job) {
  if (options.advise.empty()) return std::shared_ptr<const AdviceCase>();
  const Result<PlanFile> plan = ReadPlanFile(options.advise);
  if (!plan) return plan.fault();
  try {
    return std::shared_ptr<const AdviceCase>(
        std::make_shared<AdviceCase>(AdviceCase{CaseOf(*plan, job), plan->limits}));
  } catch (const std::invalid_argument& error) {
    return Fault{FaultCode::kConflict, error.what(), options.advise};
  }
}

/// A survey is resumed from its own log, and filled from others only then.
bool MayResume(const SurveyOptions& options) {
  const bool fills = options.resume || !options.fill.empty();
  return !fills || (options.resume && !options.record.empty());
}

/// The live page, where one is asked for; null: none is.
Result<std::unique_ptr<SurveyPage>> PageOf(const SurveyOptions& options, const JobFile& job) {
  if (options.page.address.empty()) return std::unique_ptr<SurveyPage>();
  return SurveyPage::Open(options.page, job, UrlOr(options.from), options.out);
}

/// The exit code of a session that has ended, and its last lines.
int Conclusion(const SurveyOptions& options, const JobFile& job, const LiveOutcome& outcome) {
  if (outcome.ended != LiveOutcome::Ended::kFinished) return Stopped(options, outcome);
  if (outcome.fault) return Unusable(*outcome.fault);
  return Summarise(job, outcome, options.says, options.report);
}

}  // namespace

int SurveyLive(const SurveyOptions& options, const JobFile& job) {
  if (!MayResume(options)) {
    Complain("--resume continues from the log given with --record; --fill goes with --resume");
    return kUsage;
  }
  const auto advise = AdviceOf(options, job.job);
  if (!advise) return Unusable(advise.fault());
  auto opened = PageOf(options, job);
  if (!opened) return Unusable(opened.fault());
  const std::unique_ptr<SurveyPage> page = std::move(*opened);
  SurveyConsole console(options.says, page.get());
  LiveSetup setup = SetupOf(options, job);
  setup.advise = *advise;
  auto session = LiveSession::Open(std::move(setup), console);
  if (!session) return Unusable(session.fault());
  const StopOnSignals stop([&session] { (*session)->Stop(); });
  if (options.says != Says::kNothing) SayHowHeard((*session)->bus());
  if (page) fmt::print(stderr, "page: {}\n", page->Address());
  NotifyManager("READY=1");
  const LiveOutcome outcome = (*session)->Run();
  console.End();
  if (page) Farewell(*page, outcome);
  for (const std::string& hint : outcome.hints) Complain(hint);
  return Conclusion(options, job, outcome);
}

}  // namespace wellgyro::apps
