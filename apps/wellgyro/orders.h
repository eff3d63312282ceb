#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "wellgyro/base/result.h"
#include "wellgyro/bus/lcm_live.h"
#include "wellgyro/io/signature.h"
#include "wellgyro/io/toml/job_file.h"

namespace wellgyro::apps {

/// What a person orders of a running survey, in the words of the command line.
struct Order {
  std::string what;  ///< of OrderWords()
  std::string who, text, object;
  std::optional<double> md, sigma, azimuth_deg, sigma_deg;
  std::int32_t run = 0;
  std::int64_t utime_us = 0;  ///< when it holds; 0: now
  std::int32_t id = 0;        ///< 0: a new number
};

std::vector<std::string> OrderWords();

/// What an order lacks; empty where it can be given.
std::string Lacks(const Order& order);

/// What became of an order.
struct SentOrder {
  std::int32_t session = 0, id = 0;
  bool heard = false;   ///< a survey was, before
  bool obeyed = false;  ///< the survey said so, within nine seconds
};

/// Sends `order`, signed where there is a `key`, over a bus that serves nothing else before or
/// after, and
/// waits for the survey's word. `sent` hears of it at once, before that. A Fault of the bus.
/// Throws std::invalid_argument where a text is longer than a message may be.
Result<SentOrder> SendOrder(LiveBus& bus, Order order, const JobFile& job,
                            const std::optional<PrivateKey>& key,
                            const std::function<void(const SentOrder&)>& sent);

}  // namespace wellgyro::apps
