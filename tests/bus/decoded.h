#pragma once

#include <variant>

#include <gtest/gtest.h>

#include "wellgyro/bus/decode.h"
#include "wellgyro/bus/encode.h"

#include "bus/generated_messages.h"

namespace wellgyro::test {

/// What our reader gives of a message; our writer must give the same bytes again.
template <class Record>
Record Decoded(MessageType type, const Bytes& bytes) {
  const Result<Message> message = Decode(type, bytes, "CHANNEL");
  if (!message) {
    ADD_FAILURE() << message.fault().text;
    return {};
  }
  Bytes again;
  Encode(*message, again);
  EXPECT_EQ(again, bytes) << "the same bytes again";
  return std::get<Record>(*message);
}

}  // namespace wellgyro::test
