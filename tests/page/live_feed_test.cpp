#include "wellgyro/page/live_feed.h"

#include <cstdint>
#include <string>

#include <fmt/core.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "wellgyro/base/angle.h"
#include "wellgyro/page/live_page.h"

namespace wellgyro {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;
using ::testing::StartsWith;

std::string Rest(const LiveFeed& feed, LiveFeed::Place& place) {
  std::string all;
  for (std::string part; !(part = feed.After(place, Duration{})).empty();) all += part;
  return all;
}

int Count(const std::string& text, const std::string& what) {
  int count = 0;
  for (std::size_t at = 0; (at = text.find(what, at)) != std::string::npos; ++at) ++count;
  return count;
}

Station StationAt(std::int64_t second, int revision = 0) {
  Station station;
  station.run = 1;
  station.pass = Pass::kIn;
  station.utc = {second * 1'000'000'000};
  station.md = static_cast<double>(second);
  station.revision = revision;
  return station;
}

TEST(LiveFeed, KeepsOfEachThingTheNewest) {
  LiveFeed feed(7);
  LiveFeed::Place place;
  EXPECT_THAT(feed.After(place, Duration{}), IsEmpty());
  feed.Put(Glance{.run = 3});
  feed.Put(StationAt(10));
  feed.Put(StationAt(20));
  feed.Put(Glance{.run = 4});
  feed.Put(StationAt(10, 1));
  const std::string all = Rest(feed, place);
  EXPECT_EQ(Count(all, "event: station"), 2);
  EXPECT_EQ(Count(all, "event: glance"), 1);
  EXPECT_THAT(all, HasSubstr("\"run\":4"));
  EXPECT_THAT(all, HasSubstr("\"row\":[1.0,\"in\",\"provisional\",1.0,10.0,"));
  EXPECT_THAT(feed.After(place, Duration{}), IsEmpty());
}

TEST(LiveFeed, SaysHowLongAStopMustLastForTheSigmaAsked) {
  LiveFeed feed(7);
  // N^2 / (sigma We cos L)^2 with N = sigma We 10 sqrt(s), at the equator, vertical: 100 s.
  feed.Ask({.sigma_azimuth = 0.01, .gyro = {.angle_random_walk = 7.292115e-6}, .latitude = 0});
  LiveFeed::Place place;
  feed.Put(Glance{});
  EXPECT_THAT(Rest(feed, place), HasSubstr("\"rest_asked_s\":null"));
  feed.Put(Glance{.inclination = 0.0, .azimuth = 1.0});
  EXPECT_THAT(Rest(feed, place), HasSubstr("\"rest_asked_s\":100.0"));
}

TEST(LiveFeed, SaysTheNewestAdvice) {
  LiveFeed feed(7);
  LiveFeed::Place place;
  Advice advice{.run = 1, .action = Advice::Action::kStay, .seconds = 41};
  feed.Put(advice);
  advice.action = Advice::Action::kMoveOn;
  advice.next = Advice::Next{.out = true, .md = 1650.5, .seconds = 90, .toolface = kPi};
  advice.text = "move on";
  feed.Put(advice);
  const std::string all = Rest(feed, place);
  EXPECT_EQ(Count(all, "event: advice"), 1);
  EXPECT_THAT(all, HasSubstr("\"action\":\"move_on\""));
  EXPECT_THAT(all, HasSubstr("\"next\":{\"out\":true,\"md_m\":1650.5,\"stop_s\":90.0,"
                             "\"toolface_deg\":180.0}"));
  EXPECT_THAT(all, HasSubstr("\"hidden_m\":null"));
}

TEST(LiveFeed, AStationThatIsNowOfAnotherKindIsTheSame) {
  LiveFeed feed(7);
  feed.Put(StationAt(10));
  Station revised = StationAt(10, 1);
  revised.kind = StationKind::kGyrocompass;
  feed.Put(revised);
  LiveFeed::Place place;
  EXPECT_EQ(Count(Rest(feed, place), "event: station"), 1);
}

TEST(LiveFeed, GoesOnBehindTheEventThatIsNamed) {
  LiveFeed feed(7);
  for (int i = 1; i <= 5; ++i) feed.Put(StationAt(i));
  LiveFeed::Place place = feed.PlaceOf("7-3");
  const std::string rest = Rest(feed, place);
  EXPECT_THAT(rest, StartsWith("id: 7-4\n"));
  EXPECT_EQ(Count(rest, "event: station"), 2);
  // Of another run of the program, of the future, or of nothing: from the begin.
  for (const char* id : {"8-3", "7-6", "7--1", "7-3x", "7-", "", "7", "7-99999999999999999999"}) {
    EXPECT_EQ(feed.PlaceOf(id).number, 0) << id;
  }
  EXPECT_THAT(feed.Hello(), HasSubstr("{\"epoch\":7,\"columns\":[\"RUN\",\"PASS\","));
}

TEST(LiveFeed, MemoryGrowsWithTheStationsAloneAndThoseAreBounded) {
  constexpr int kMost = 2000;
  LiveFeed feed(7, kMost);
  for (int i = 0; i < 1000; ++i) {
    feed.Say(fmt::format("sentence {}", i), i);
    feed.Put(Glance{.run = i});
    feed.Put(Status{.seq = i});
  }
  LiveFeed::Place place;
  const std::string all = Rest(feed, place);
  EXPECT_EQ(Count(all, "event: notice"), LiveFeed::kNoticesKept);
  EXPECT_EQ(Count(all, "event: "), LiveFeed::kNoticesKept + 2);
  EXPECT_THAT(all, HasSubstr("sentence 999"));
  for (int i = 0; i < kMost + 10; ++i) feed.Put(StationAt(i + 1));
  const std::string stations = Rest(feed, place);
  EXPECT_EQ(Count(stations, "event: station"), kMost);
  EXPECT_THAT(stations, Not(HasSubstr("\"key\":\"0/1/10000000000\"")));
  EXPECT_THAT(stations, HasSubstr("\"key\":\"0/1/11000000000\""));
}

TEST(LiveFeed, NoTextEndsAnEventOrTheLine) {
  LiveFeed feed(7);
  feed.Say("one\n\nevent: end\ndata: {}\n\n\xff<script>", 1);
  LiveFeed::Place place;
  const std::string all = Rest(feed, place);
  EXPECT_EQ(Count(all, "\n"), 4);  // id, event, data, and the end
  EXPECT_EQ(Count(all, "\nevent: "), 1);
}

TEST(LiveFeed, ADocumentIsToldWhenItHasChanged) {
  LiveFeed feed(7);
  LiveFeed::Place place;
  EXPECT_FALSE(feed.PutDocument("", R"({"checks": 1, "stations": [1], "run": {"verdict": 2}})"));
  const std::string told = Rest(feed, place);
  EXPECT_THAT(told, HasSubstr("\"checks\":1,"));
  EXPECT_THAT(told, HasSubstr("\"verdict\":2,"));
  EXPECT_THAT(told, Not(HasSubstr("stations")));
  EXPECT_FALSE(feed.PutDocument("", R"({"checks": 1, "stations": [2], "run": {"verdict": 2}})"));
  EXPECT_THAT(Rest(feed, place), IsEmpty());
  EXPECT_FALSE(feed.PutDocument("", R"({"checks": 2})"));
  EXPECT_EQ(Count(Rest(feed, place), "event: survey"), 1);
  for (const char* broken : {"", "[1]", "3", R"({"run": 3})", "{"}) {
    const auto fault = feed.PutDocument("", broken);
    ASSERT_TRUE(fault) << broken;
    EXPECT_EQ(fault->code, FaultCode::kSyntax);
  }
}

TEST(LiveFeed, ClosedItHoldsNobody) {
  LiveFeed feed(7);
  feed.PutEnd("finished", "pass");
  feed.Close();
  LiveFeed::Place place;
  EXPECT_THAT(feed.After(place, Duration::Seconds(100)), HasSubstr("event: end"));
  EXPECT_THAT(feed.After(place, Duration::Seconds(100)), IsEmpty());
  EXPECT_TRUE(feed.closed());
}

TEST(LivePage, ShowsAnyNameAsTextAndAsksNobodyElse) {
  const std::string name = "</script><script>alert(1)</script>";
  const auto page = LivePage({.well = name, .identity = {{"operator", name}, {"rig", name}}});
  ASSERT_TRUE(page);
  EXPECT_THAT(*page, Not(HasSubstr("<script>alert")));
  EXPECT_THAT(*page, HasSubstr("default-src 'none'; script-src 'sha256-"));
  EXPECT_THAT(*page, HasSubstr("connect-src 'self'; img-src data:; base-uri 'none'"));
  EXPECT_THAT(*page, Not(HasSubstr("<form")));
  const auto ordering = LivePage({.well = name, .orders = true});
  ASSERT_TRUE(ordering);
  EXPECT_THAT(*ordering, HasSubstr("<form id=\"order\">"));
}

TEST(LivePage, HasThePathAsPlanned) {
  const OtherWell plan{"plan", "MD[m],INC[deg],AZI[deg]\n0,0,0\n100,90,90\n"};
  const auto page = LivePage({.well = "x", .plan = plan});
  ASSERT_TRUE(page);
  EXPECT_THAT(*page, HasSubstr("\"columns\":[\"MD[m]\",\"N[m]\",\"E[m]\",\"TVD[m]\"]"));
  EXPECT_FALSE(LivePage({.well = "x", .plan = OtherWell{"plan", "no survey"}}));
}

}  // namespace
}  // namespace wellgyro
