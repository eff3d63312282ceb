#include "wellgyro/page/live_feed.h"

#include <charconv>
#include <chrono>
#include <cmath>
#include <exception>
#include <utility>

#include <fmt/core.h>

#include "wellgyro/alignment/rest_needed.h"
#include "wellgyro/base/angle.h"
#include "wellgyro/io/exchange/survey_csv.h"
#include "wellgyro/io/result/json_table_internal.h"
#include "wellgyro/io/words.h"

namespace wellgyro {
namespace {

std::string Line(const Json& json) {
  return json.dump(-1, ' ', true, Json::error_handler_t::replace);
}

/// For a screen: what lies below the last digit costs bytes and is read by nobody.
Json Rounded(double value, double unit) {
  if (!std::isfinite(value)) return nullptr;
  return std::round(value / unit) * unit;
}

Json Rounded(const std::optional<double>& value, double unit) {
  return value ? Rounded(*value, unit) : Json();
}

std::optional<double> Degrees(const std::optional<double>& angle) {
  return angle ? std::optional(ToDegrees(*angle)) : std::nullopt;
}

Json MicrosecondsOf(UtcTime time) { return time.ns > 0 ? Json(time.ns / 1000) : Json(); }

constexpr double kFine = 1e-3;  // to which a page shows metres and degrees

Json JsonOf(const Glance& glance) {
  return {{"utime_us", MicrosecondsOf(glance.utc)},
          {"run", glance.run},
          {"md_m", Rounded(glance.md, kFine)},
          {"speed_mps", Rounded(glance.speed, kFine)},
          {"inclination_deg", Rounded(Degrees(glance.inclination), kFine)},
          {"azimuth_true_deg", Rounded(Degrees(glance.azimuth), kFine)},
          {"sigma_azimuth_deg", Rounded(ToDegrees(glance.sigma_azimuth), kFine)},
          {"stations", glance.stations},
          {"rests_s", Rounded(glance.still, 1)},
          {"rest_needed_s", Rounded(glance.still_needed, 1)},
          {"samples_lost", glance.samples_lost},
          {"checks_warned", glance.checks_warned},
          {"checks_failed", glance.checks_failed},
          {"turned", glance.turned}};
}

const char* WordOf(Status::State state) {
  switch (state) {
    case Status::State::kOk:
      return "ok";
    case Status::State::kDegraded:
      return "degraded";
    case Status::State::kFault:
      break;
  }
  return "fault";
}

Json JsonOf(const Status& status) {
  return {{"utime_us", MicrosecondsOf(status.utc)},
          {"state", WordOf(status.state)},
          {"samples_received", status.samples_received},
          {"samples_lost", status.samples_lost},
          {"gaps", status.gaps},
          {"malformed", status.malformed},
          {"data_age_s", Rounded(status.data_age, 0.1)},
          {"text", status.text}};
}

const char* WordOf(Advice::Action action) {
  switch (action) {
    case Advice::Action::kNone:
      return "none";
    case Advice::Action::kStop:
      return "stop";
    case Advice::Action::kStay:
      return "stay";
    case Advice::Action::kMoveOn:
      break;
  }
  return "move_on";
}

Json JsonOf(const Advice& advice) {
  Json json{{"utime_us", MicrosecondsOf(advice.utc)},
            {"run", advice.run},
            {"action", WordOf(advice.action)},
            {"more_s", Rounded(advice.seconds, 1)},
            {"toolface_deg", Rounded(Degrees(advice.toolface), 0.1)},
            {"next", nullptr},
            {"stops_left", advice.stops_left},
            {"rest_left_s", Rounded(advice.rest_left, 1)},
            {"reachable", advice.reachable},
            {"ellipse_m", Rounded(advice.ellipse, kFine)},
            {"ellipse_now_m", Rounded(advice.ellipse_now, kFine)},
            {"ellipse_limit_m", Rounded(advice.ellipse_limit, kFine)},
            {"hidden_m", Rounded(advice.hidden, kFine)},
            {"hidden_limit_m", Rounded(advice.hidden_limit, kFine)},
            {"text", advice.text}};
  if (!advice.next) return json;
  json["next"] = {{"out", advice.next->out},
                  {"md_m", Rounded(advice.next->md, kFine)},
                  {"stop_s", Rounded(advice.next->seconds, 1)},
                  {"toolface_deg", Rounded(Degrees(advice.next->toolface), 0.1)}};
  return json;
}

/// As passes.csv has it.
Json TableOf(std::span<const Station> stations) {
  return *JsonTable(PassesCsv(stations, nullptr), "passes.csv");
}

/// What tells a station from all others, and stays when it is revised. Its kind does not: what was
/// passed becomes a gyrocompassed station when the tool has stayed there for long enough.
std::string KeyOf(const Station& station) {
  return fmt::format("{}/{}/{}{}", station.tool, station.run,
                     station.kind == StationKind::kTieIn ? "tie-in/" : "", station.utc.ns);
}

/// What of a survey.json changes while the survey runs, and is no station.
Json LivePart(const Json& survey) {
  Json part = Json::object();
  for (const char* member : {"checks", "diagnosis", "pass_differences"}) {
    part[member] = survey.value(member, Json());
  }
  const Json run = survey.value("run", Json::object());
  for (const char* member : {"verdict", "operation"}) part[member] = run.value(member, Json());
  return part;
}

}  // namespace

void LiveFeed::PutIn(const std::string& slot, std::string_view event, const std::string& json) {
  const std::lock_guard lock(mutex_);
  const std::int64_t number = ++last_;
  auto text = std::make_shared<const std::string>(
      fmt::format("id: {}-{}\nevent: {}\ndata: {}\n\n", epoch_, number, event, json));
  const auto [at, is_new] = slots_.try_emplace(slot, number);
  if (!is_new) events_.erase(std::exchange(at->second, number));
  events_.emplace(number, std::move(text));
  if (!is_new || event != "station") return;
  stations_.emplace(number, slot);
  if (stations_.size() <= stations_kept_) return;
  const auto oldest = slots_.find(stations_.begin()->second);
  events_.erase(oldest->second);
  slots_.erase(oldest);
  stations_.erase(stations_.begin());
}

void LiveFeed::Put(const Station& station) {
  const std::string key = KeyOf(station);
  const Json table = TableOf({&station, 1});
  PutIn("station/" + key, "station",
        Line({{"key", key},
              {"tool", station.tool},
              {"utime_us", MicrosecondsOf(station.utc)},
              {"row", table["rows"][0]}}));
}

void LiveFeed::Put(const Glance& glance) {
  Json json = JsonOf(glance);
  if (asked_) {
    json["sigma_asked_deg"] = ToDegrees(asked_->sigma_azimuth);
    json["rest_asked_s"] = nullptr;
    if (glance.inclination && glance.azimuth) {
      json["rest_asked_s"] =
          Rounded(RestForSigma(asked_->sigma_azimuth, asked_->gyro, asked_->latitude,
                               *glance.inclination, *glance.azimuth),
                  1);
    }
  }
  PutIn("glance", "glance", Line(json));
}

void LiveFeed::Put(const Status& status) { PutIn("status", "status", Line(JsonOf(status))); }

void LiveFeed::Put(const Advice& advice) { PutIn("advice", "advice", Line(JsonOf(advice))); }

void LiveFeed::Say(std::string_view sentence, std::int64_t utc_us) {
  const std::string slot =
      fmt::format("notice/{}", notices_++ % static_cast<std::int64_t>(kNoticesKept));
  PutIn(slot, "notice", Line({{"utime_us", utc_us}, {"text", sentence}}));
}

std::optional<Fault> LiveFeed::PutDocument(const std::string& part, std::string_view survey_json) {
  Json document;
  try {
    document = LivePart(Json::parse(survey_json));
  } catch (const std::exception& error) {
    return Fault{.code = FaultCode::kSyntax, .text = error.what(), .source = "survey.json"};
  }
  document["part"] = part;
  std::string text = Line(document);
  const auto [at, is_new] = documents_.try_emplace(part);
  if (at->second == text) return std::nullopt;
  at->second = std::move(text);
  PutIn("survey/" + part, "survey", at->second);
  return std::nullopt;
}

void LiveFeed::PutEnd(std::string_view how, std::string_view verdict) {
  PutIn("end", "end", Line({{"how", how}, {"verdict", verdict}}));
}

void LiveFeed::Publish() { woken_.notify_all(); }

void LiveFeed::Close() {
  {
    const std::lock_guard lock(mutex_);
    closed_ = true;
  }
  woken_.notify_all();
}

bool LiveFeed::closed() const {
  const std::lock_guard lock(mutex_);
  return closed_;
}

LiveFeed::Place LiveFeed::PlaceOf(std::string_view last_event_id) const {
  const std::string epoch = fmt::format("{}-", epoch_);
  Place place;
  if (!last_event_id.starts_with(epoch)) return place;
  const std::string_view number = last_event_id.substr(epoch.size());
  const char* const end = number.data() + number.size();
  std::int64_t value = 0;
  const auto [rest, error] = std::from_chars(number.data(), end, value);
  const std::lock_guard lock(mutex_);
  if (error == std::errc() && rest == end && value > 0 && value <= last_) place.number = value;
  return place;
}

std::string LiveFeed::Hello() const {
  return fmt::format("event: hello\ndata: {}\n\n",
                     Line({{"epoch", epoch_}, {"columns", TableOf({})["columns"]}}));
}

std::string LiveFeed::After(Place& place, Duration wait) const {
  std::vector<Text> found;
  {
    std::unique_lock lock(mutex_);
    woken_.wait_for(lock, std::chrono::nanoseconds(wait.ns),
                    [&] { return closed_ || last_ > place.number; });
    std::size_t bytes = 0;
    for (auto at = events_.upper_bound(place.number); at != events_.end() && bytes < kAtOnce;
         ++at) {
      place.number = at->first;
      bytes += at->second->size();
      found.push_back(at->second);
    }
  }
  std::string text;
  for (const Text& event : found) text += *event;
  return text;
}

}  // namespace wellgyro
