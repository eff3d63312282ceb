// Who may order what of a survey, live or in a log.
#include "wellgyro/live/operation_gate.h"

#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "wellgyro/bus/decode.h"
#include "wellgyro/bus/encode.h"
#include "wellgyro/io/signature.h"

#include "support/simulated_survey.h"
#include "support/small_hole.h"

namespace wellgyro {
namespace {

class Gate : public ::testing::Test {
 protected:
  Gate() {
    job_.job = JobOf(wellgyro::testing::SmallHole{});
    job_.job.well.name = "A-1";
    key_ = NewPrivateKey();
    begin_ = SimulationOf(wellgyro::testing::SmallHole{}).streams.begin_utc;
  }

  void List(const PrivateKey& key) { job_.operations.keys.push_back({"Ada", PublicKeyOf(key)}); }

  SignedOperation Signed(const PrivateKey& key, std::int32_t id, const std::string& well = "A-1",
                         double seconds = 0) {
    Event event;
    event.utc = begin_ + Duration::Seconds(seconds);
    event.kind = Event::Kind::kReject;
    event.who = "Ada";
    SignedOperation operation{.utc = event.utc, .session = 3, .id = id};
    Encode(event, operation.content);
    operation.key = PublicKeyOf(key);
    operation.signature = Sign(key, SignedBytes(operation, well));
    return operation;
  }

  JobFile job_;
  PrivateKey key_;
  UtcTime begin_;
  Sink sink_;
};

TEST_F(Gate, WithoutKeysUnsignedOrdersAreObeyedOnceAndWrittenDown) {
  Surveyor surveyor(job_.job, sink_);
  OperationGate gate(job_, surveyor);
  Event event;
  event.utc = begin_;
  event.event_id = 7;
  event.session = 1;
  event.kind = Event::Kind::kReject;
  event.who = "Ada";
  for (int i = 0; i < 3; ++i) gate.Take(event);
  event.session = 2;
  gate.Take(event);
  ASSERT_EQ(gate.records().size(), 2u);
  EXPECT_TRUE(gate.records()[0].obeyed);
  EXPECT_EQ(gate.records()[0].kind, "reject");
  EXPECT_EQ(gate.records()[0].who, "Ada");
  EXPECT_EQ(gate.records()[0].effect, "all stations of all runs are rejected");
  EXPECT_TRUE(gate.Take(ToolMode{}));
  EXPECT_TRUE(gate.Take(ToolInfo{}));
}

TEST_F(Gate, WithKeysWhatIsUnsignedIsRefused) {
  List(key_);
  Surveyor surveyor(job_.job, sink_);
  OperationGate gate(job_, surveyor);
  gate.HeardAt(begin_);
  Command finish;
  finish.utc = begin_;
  finish.kind = Command::Kind::kFinish;
  gate.Take(finish);
  gate.Take(Event{});
  EXPECT_FALSE(gate.Take(ToolMode{}));
  EXPECT_FALSE(gate.Take(ToolInfo{}));
  EXPECT_EQ(gate.obeyed(), 0);
  EXPECT_EQ(gate.refused(), 4);
  EXPECT_FALSE(gate.finish_obeyed());
  EXPECT_FALSE(surveyor.finished());
  job_.operations.unsigned_tool = true;
  EXPECT_TRUE(gate.Take(ToolMode{}));
}

TEST_F(Gate, ASignedOrderIsObeyedOnce) {
  List(key_);
  Surveyor surveyor(job_.job, sink_);
  OperationGate gate(job_, surveyor);
  // Before the first sample nobody knows what time it is.
  gate.Take(Signed(key_, 4));
  EXPECT_EQ(gate.obeyed(), 0);
  gate.HeardAt(begin_);
  EXPECT_EQ(gate.obeyed(), 1);
  for (int i = 0; i < 3; ++i) gate.Take(Signed(key_, 4));
  gate.Take(Signed(key_, 5));
  EXPECT_EQ(gate.obeyed(), 2);
  EXPECT_EQ(gate.refused(), 0);
  EXPECT_EQ(gate.records()[0].key, "Ada");
  EXPECT_EQ(gate.records()[0].id, 4);
}

TEST_F(Gate, OfAnotherKeyWellOrDayItIsRefused) {
  List(key_);
  Surveyor surveyor(job_.job, sink_);
  OperationGate gate(job_, surveyor);
  gate.HeardAt(begin_);
  gate.Take(Signed(NewPrivateKey(), 1));
  gate.Take(Signed(key_, 2, "A-2"));
  gate.Take(Signed(key_, 3, "A-1", 86400));
  gate.Take(Signed(key_, 4, "A-1", -86400));
  EXPECT_EQ(gate.obeyed(), 0);
  ASSERT_EQ(gate.refused(), 4);
  EXPECT_NE(gate.records()[0].effect.find("not in the job"), std::string::npos);
  EXPECT_NE(gate.records()[1].effect.find("another well"), std::string::npos);
  EXPECT_NE(gate.records()[2].effect.find("86400 s"), std::string::npos);
  EXPECT_NE(gate.records()[3].effect.find("-86400 s"), std::string::npos);
}

TEST_F(Gate, AnOrderThatNoJobCouldHoldIsRefusedAndNamedOnce) {
  List(key_);
  Surveyor surveyor(job_.job, sink_);
  int told = 0, obeyed = 0;
  OperationGate gate(job_, surveyor, [&](const OperationRecord& record, bool) {
    ++told;
    obeyed += record.obeyed ? 1 : 0;
  });
  gate.HeardAt(begin_);
  Event event;
  event.utc = begin_;
  event.kind = Event::Kind::kDepthRezero;
  event.has_value = true;
  event.value_m = 1e300;
  SignedOperation operation{.utc = begin_, .session = 3, .id = 5};
  Encode(event, operation.content);
  operation.key = PublicKeyOf(key_);
  operation.signature = Sign(key_, SignedBytes(operation, "A-1"));
  for (int i = 0; i < 3; ++i) gate.Take(operation);
  EXPECT_EQ(told, 1);
  EXPECT_EQ(obeyed, 0);
  ASSERT_EQ(gate.records().size(), 1u);
  EXPECT_NE(gate.records()[0].effect.find("value_m"), std::string::npos)
      << gate.records()[0].effect;
}

TEST_F(Gate, AFlippedBitAnywhereMakesItWorthless) {
  List(key_);
  Surveyor surveyor(job_.job, sink_);
  OperationGate gate(job_, surveyor);
  gate.HeardAt(begin_);
  const SignedOperation good = Signed(key_, 1);
  std::vector<std::byte> bytes;
  Encode(good, bytes);
  std::int64_t decoded = 0;
  for (std::size_t bit = 0; bit < 8 * bytes.size(); ++bit) {
    std::vector<std::byte> flipped = bytes;
    flipped[bit / 8] ^= static_cast<std::byte>(1 << bit % 8);
    const Result<Message> message = Decode(MessageType::kOperation, flipped);
    if (!message) continue;
    ++decoded;
    gate.Take(std::get<SignedOperation>(*message));
  }
  EXPECT_GT(decoded, 1000);
  EXPECT_EQ(gate.obeyed(), 0);
  EXPECT_EQ(gate.refused(), decoded);
  gate.Take(good);
  EXPECT_EQ(gate.obeyed(), 1);
}

TEST_F(Gate, ForgedOrdersAreNotObeyedAndTakeNoMemory) {
  List(key_);
  Surveyor surveyor(job_.job, sink_);
  OperationGate gate(job_, surveyor);
  gate.HeardAt(begin_);
  std::mt19937 chance(5);
  SignedOperation forged = Signed(key_, 1);
  for (int i = 0; i < 2000; ++i) {
    forged.id = i;
    for (std::byte& byte : forged.signature) byte = static_cast<std::byte>(chance());
    gate.Take(forged);
  }
  EXPECT_EQ(gate.obeyed(), 0);
  EXPECT_EQ(gate.refused(), 2000);
  EXPECT_EQ(gate.records().size(), OperationGate::kKept / 2);
  gate.Take(Signed(key_, 99));
  EXPECT_EQ(gate.records().back().id, 99);
}

// What is forged before the first sample takes no room from what is true.
TEST_F(Gate, ForgedOrdersBeforeTheFirstSampleKeepNoTrueOneOut) {
  List(key_);
  Surveyor surveyor(job_.job, sink_);
  OperationGate gate(job_, surveyor);
  SignedOperation forged = Signed(key_, 1);
  forged.signature.front() ^= std::byte{1};
  for (std::size_t i = 0; i < 2 * OperationGate::kWaitMax; ++i) gate.Take(forged);
  gate.Take(Signed(key_, 2));
  EXPECT_EQ(gate.obeyed(), 0);
  gate.HeardAt(begin_);
  EXPECT_EQ(gate.obeyed(), 1);
}

// Unsigned orders, of which anyone may send any number, leave what is remembered of signed ones.
TEST_F(Gate, AFloodOfUnsignedOrdersMakesNoOrderNewAgain) {
  List(key_);
  Surveyor surveyor(job_.job, sink_);
  OperationGate gate(job_, surveyor);
  gate.HeardAt(begin_);
  Command command;
  command.session = 1;
  for (int i = 1; i <= 300'000; ++i) {
    command.command_id = i;
    gate.Take(command);
  }
  for (int i = 0; i < 3; ++i) gate.Take(Signed(key_, 4));
  EXPECT_EQ(gate.obeyed(), 1);
  gate.Take(Signed(key_, 0));
  EXPECT_EQ(gate.obeyed(), 1) << "without a number it could be sent again";
}

}  // namespace
}  // namespace wellgyro
