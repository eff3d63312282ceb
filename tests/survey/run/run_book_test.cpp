#include "wellgyro/survey/run/run_book.h"

#include <cstdint>
#include <limits>

#include <gtest/gtest.h>

namespace wellgyro {
namespace {

Event RunEvent(Event::Kind kind, std::int64_t seconds, std::int32_t run = 0) {
  Event event;
  event.kind = kind;
  event.utc = UtcTime{seconds * 1'000'000'000};
  event.run = run;
  return event;
}

UtcTime Utc(std::int64_t seconds) { return UtcTime{seconds * 1'000'000'000}; }

TEST(RunBook, EverythingIsRunOneWhereNobodySaysOtherwise) {
  const RunBook book({});
  EXPECT_EQ(book.RunAt(Utc(5), 0), 1);
  EXPECT_EQ(book.RunAt(Utc(5), 3), 3) << "a source that knows its run is believed";
}

// 2026-11-24: two events of the wire made a number that no run has, by an overflow.
TEST(RunBook, BehindTheLastNumberThereIsAnother) {
  RunBook book({});
  book.Take(RunEvent(Event::Kind::kRunBegin, 100, std::numeric_limits<std::int32_t>::max()));
  book.Take(RunEvent(Event::Kind::kRunBegin, 200));
  EXPECT_EQ(book.RunAt(Utc(250), 0), 1);
}

TEST(RunBook, EventsOpenAndCloseRuns) {
  RunBook book({});
  book.HeardAt(Utc(101));
  book.Take(RunEvent(Event::Kind::kRunBegin, 200));
  book.Take(RunEvent(Event::Kind::kRunBegin, 100));
  EXPECT_EQ(book.RunAt(Utc(150), 0), 1);
  EXPECT_EQ(book.RunAt(Utc(250), 0), 2);
  EXPECT_EQ(book.RunAt(Utc(50), 0), 1);
  Event end = RunEvent(Event::Kind::kRunEnd, 190);
  end.what = "misrun";
  end.text = "clutch slipped";
  book.Take(end);
  EXPECT_TRUE(book.misrun(1));
  EXPECT_FALSE(book.misrun(2));
  EXPECT_EQ(book.remark(1), "clutch slipped");
}

TEST(RunBook, WhatWasLoggedBeforeTheFirstBeginIsRunOne) {
  RunBook book({});
  book.Take(RunEvent(Event::Kind::kRunBegin, 200));
  book.HeardAt(Utc(10));
  EXPECT_EQ(book.RunAt(Utc(20), 0), 1);
  EXPECT_EQ(book.RunAt(Utc(201), 0), 2);
}

TEST(RunBook, TheJobsRunsHoldFromTheirBegin) {
  RunSpec first, second;
  first.number = 4;
  first.begin = Utc(10);
  first.misrun = true;
  second.number = 5;
  second.begin = Utc(20);
  const RunBook book({second, first});
  EXPECT_EQ(book.RunAt(Utc(15), 0), 4);
  EXPECT_EQ(book.RunAt(Utc(20), 0), 5);
  EXPECT_TRUE(book.misrun(4));
}

TEST(RunBook, OnlyTheJobEndsARunBeforeTheNextBegins) {
  RunSpec first;
  first.number = 1;
  first.begin = Utc(100);
  first.end = Utc(200);
  RunBook book({first});
  book.Take(RunEvent(Event::Kind::kRunEnd, 150));
  EXPECT_FALSE(book.Ended(1, Utc(199)));
  EXPECT_TRUE(book.Ended(1, Utc(200)));
  EXPECT_FALSE(book.Ended(2, Utc(200)));
}

}  // namespace
}  // namespace wellgyro
