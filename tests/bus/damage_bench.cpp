// damage_bench LOG JOB COUNT: surveys of the log in which one message, at COUNT places spread over
// it, is dropped, doubled, altered or moved by ten messages: whether each made a survey, told of
// what was lost, and stayed within its own sigmas of the survey of the whole log.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <exception>
#include <optional>
#include <string>
#include <vector>

#include <fmt/core.h>

#include "wellgyro/bus/log_reader.h"
#include "wellgyro/bus/survey_log.h"
#include "wellgyro/io/toml/job_file.h"
#include "wellgyro/math/random.h"

namespace wellgyro {
namespace {

struct Message {
  std::string channel;
  std::vector<std::byte> bytes;
};

enum class Damage { kNone, kDrop, kDouble, kAlter, kMove };
constexpr const char* kNames[] = {"whole", "dropped", "doubled", "altered", "moved"};

struct FaultCount : Sink {
  void OnFault(const Fault&) override { ++faults; }
  int faults = 0;
};

/// The messages with one damaged, in the order in which they come.
std::vector<Message> Damaged(const std::vector<Message>& all, Damage damage, std::size_t at,
                             std::uint64_t chance) {
  std::vector<Message> messages = all;
  const auto place = messages.begin() + static_cast<std::ptrdiff_t>(at);
  if (damage == Damage::kDrop) messages.erase(place);
  if (damage == Damage::kDouble) messages.insert(place, all[at]);
  if (damage == Damage::kAlter) {
    std::vector<std::byte>& bytes = place->bytes;
    bytes[chance % bytes.size()] ^= static_cast<std::byte>(1U << (chance >> 32) % 8);
  }
  if (damage == Damage::kMove) {
    const std::size_t to = std::min(at + 10, all.size() - 1);
    std::rotate(place, place + 1, messages.begin() + static_cast<std::ptrdiff_t>(to) + 1);
  }
  return messages;
}

Survey SurveyOf(const JobFile& job, const std::vector<Message>& messages, FaultCount& sink) {
  Surveyor surveyor(job.job, sink);
  SurveyorListener listener(surveyor, sink);
  Feed feed(job.job.channels, listener);
  for (const Message& message : messages) {
    if (surveyor.finished()) break;
    feed.Take(message.channel, message.bytes);
  }
  surveyor.Finish();
  const std::vector<std::int32_t> tools = surveyor.tools();
  return surveyor.Current(tools.empty() ? 0 : tools.front());
}

/// How far the end of `survey` is from that of `whole`, in its own sigmas; absent: neither has one.
std::optional<double> Off(const Survey& survey, const Survey& whole) {
  if (survey.chosen.empty() || whole.chosen.empty()) return std::nullopt;
  const Station &a = survey.chosen.back(), &b = whole.chosen.back();
  if (std::abs(a.md - b.md) > 1) return std::nullopt;
  double worst = 0;
  for (int i = 0; i < 3; ++i) {
    const double sigma = std::sqrt(std::max(a.cov_p_WT_W(i, i), 1e-12));
    worst = std::max(worst, std::abs(a.p_WT_W[i] - b.p_WT_W[i]) / sigma);
  }
  return worst;
}

struct Tally {
  int surveys = 0, thrown = 0, unusable = 0, told = 0, flagged = 0, not_finite = 0;
  double worst = 0;
};

void Count(Tally& tally, const JobFile& job, const std::vector<Message>& messages,
           const Survey& whole) {
  FaultCount sink;
  ++tally.surveys;
  try {
    const Survey survey = SurveyOf(job, messages, sink);
    tally.unusable += survey.unusable.empty() ? 0 : 1;
    tally.told += sink.faults > 0 ? 1 : 0;
    bool gap = false;
    for (const Station& station : survey.passes) {
      gap = gap || Has(station.quality, Quality::kGap);
      tally.not_finite += station.p_WT_W.allFinite() && station.cov_p_WT_W.allFinite() ? 0 : 1;
    }
    tally.flagged += gap ? 1 : 0;
    if (const auto off = Off(survey, whole)) tally.worst = std::max(tally.worst, *off);
  } catch (const std::exception& error) {
    if (tally.thrown++ < 3) fmt::print("  {}\n", error.what());
  }
}

int Main(int argc, char** argv) {
  if (argc < 4) {
    fmt::print("damage_bench LOG JOB COUNT\n");
    return 1;
  }
  const Result<JobFile> job = ReadJob(argv[2]);
  Result<LogReader> reader = LogReader::Open(argv[1]);
  if (!job || !reader) {
    fmt::print("{}\n", !job ? job.fault().text : reader.fault().text);
    return 2;
  }
  std::vector<Message> all;
  LogEvent event;
  while (reader->Next(event)) {
    all.push_back({std::string(event.channel), {event.data.begin(), event.data.end()}});
  }
  FaultCount none;
  const Survey whole = SurveyOf(*job, all, none);
  fmt::print("{}: {} messages, {} stations\n", argv[1], all.size(), whole.chosen.size());
  Random random(7);
  int failed = 0;
  const auto count = static_cast<std::size_t>(std::max(std::atoi(argv[3]), 1));
  for (const Damage damage : {Damage::kDrop, Damage::kDouble, Damage::kAlter, Damage::kMove}) {
    Tally tally;
    for (std::size_t i = 0; i < count; ++i) {
      const std::size_t at = i * all.size() / count;
      Count(tally, *job, Damaged(all, damage, at, random.Bits()), whole);
    }
    fmt::print(
        "{:8} {} surveys: {} threw, {} without a survey, {} with what is no number; told of "
        "{}, gap flagged in {}; end at most {:.2f} of its sigmas off\n",
        kNames[static_cast<int>(damage)], tally.surveys, tally.thrown, tally.unusable,
        tally.not_finite, tally.told, tally.flagged, tally.worst);
    failed += tally.thrown + tally.unusable + tally.not_finite;
  }
  return failed == 0 ? 0 : 3;
}

}  // namespace
}  // namespace wellgyro

int main(int argc, char** argv) { return wellgyro::Main(argc, argv); }
