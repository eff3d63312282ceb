// hostile_bench datagrams|orders COUNT: a survey of a true stream among COUNT datagrams, or orders,
// that mean harm: what of the result has changed, what was obeyed, how much memory it took. Ends
// with 3 when anything was. The datagrams come from 300 senders of the tool's machine and others
// and, repeating numbers that it gave, from the tool's own address and port.
#include <algorithm>
#include <chrono>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <map>
#include <random>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/core.h>
#include <sys/resource.h>

#include "wellgyro/bus/encode.h"
#include "wellgyro/bus/reassembly.h"
#include "wellgyro/bus/stream_guard.h"
#include "wellgyro/io/signature.h"
#include "wellgyro/live/intake.h"

#include "bus/simulated_messages.h"
#include "support/small_hole.h"

namespace wellgyro {
namespace {

using Bytes = std::vector<std::byte>;

constexpr std::uint64_t kTool = 0x0a000001'9c40;  // 10.0.0.1:40000
constexpr std::uint64_t kOther = 0x0a000002'0400;

/// Of this process at its largest [MB].
double Resident() {
  rusage usage{};
  ::getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_maxrss) / 1000;
}

void Put(Bytes& bytes, std::uint64_t value, int size) {
  for (int i = size - 1; i >= 0; --i) bytes.push_back(static_cast<std::byte>(value >> 8 * i & 255));
}

/// One survey, from datagrams on.
class Subject {
 public:
  explicit Subject(const JobFile& job)
      : job_(job),
        surveyor_(job.job, faults_),
        in_(job, surveyor_),
        guard_(job.job.channels, [this](const auto& m) { in_.Take(m.channel, m.bytes); }) {}
  void Take(std::uint64_t sender, std::span<const std::byte> datagram, std::int64_t received_us) {
    const auto whole = reassembly_.Take(sender, datagram);
    if (whole) guard_.Take({whole->channel, whole->data, received_us, {sender, whole->number}});
  }
  void TakeMessage(std::string_view channel, std::span<const std::byte> bytes) {
    in_.Take(channel, bytes);
  }
  Survey Result() {
    guard_.Flush();
    surveyor_.Finish();
    return surveyor_.Current(0);
  }
  /// The files whose bytes must not change, by name.
  std::map<std::string, std::string> Files(const Survey& survey) const {
    std::map<std::string, std::string> all;
    for (const OutputFile& file : ResultFiles({}, {}, job_.job, survey)) {
      const bool told = file.name == "survey.csv" || file.name == "passes.csv" ||
                        file.name == "checks.csv" || file.name == "diagnosis.csv";
      if (told) all[file.name] = file.bytes;
    }
    return all;
  }
  const Intake& intake() const { return in_; }
  std::int64_t refused() const { return reassembly_.refused(); }
  std::int64_t left_out() const { return guard_.left_out(); }
  const FaultBook& faults() const { return faults_; }
  std::size_t tools() const { return surveyor_.tools().size(); }

 private:
  const JobFile& job_;
  FaultBook faults_;
  Surveyor surveyor_;
  Intake in_;
  StreamGuard guard_;
  Reassembly reassembly_;
};

struct Message {
  std::string channel;
  Bytes bytes;
  std::int64_t received_us = 0;
  std::uint32_t number = 0;
};

Bytes Framed(std::string_view channel, std::span<const std::byte> data, std::uint32_t number = 0) {
  Bytes bytes;
  Put(bytes, 0x4c433032, 4);
  Put(bytes, number, 4);
  for (const char c : channel) bytes.push_back(static_cast<std::byte>(c));
  bytes.push_back(std::byte{0});
  bytes.insert(bytes.end(), data.begin(), data.end());
  return bytes;
}

/// Datagrams of whoever means harm.
class Harm {
 public:
  explicit Harm(const std::vector<Message>& stream) : stream_(stream) {
    DepthMark mark;
    ToolInfo info;
    for (const double seconds : {1.893e9, 3e9, 1e9}) {
      mark.utc = UtcTime{static_cast<std::int64_t>(seconds * 1e9)};
      mark.md = 100;
      Keep("WELLGYRO_DEPTH", mark);
    }
    mark.utc = {};
    for (const double md : {1e300, -1e6}) {
      mark.md = md;
      Keep("WELLGYRO_DEPTH", mark);
    }
    info.sensor_below_reference = 1e300;
    Keep("WELLGYRO_TOOL", info);
    Keep("WELLGYRO_CMD", Command{.kind = Command::Kind::kFinish});
    Keep("WELLGYRO_EVENT", Event{.kind = Event::Kind::kReject});
  }

  /// The next one; `sent`: how many of the stream's messages have been.
  const Bytes& Next(std::size_t sent) {
    const std::uint64_t dice = chance_();
    const unsigned kind = dice % 16;
    next_.clear();
    copy_ = kind >= 12 && kind < 15 && sent > 0;
    if (kind < 4) {
      Random(dice >> 8 & 255);
    } else if (kind < 10) {
      Fragment(dice);
    } else if (kind < 12) {
      Random(dice >> 8 & 255);
      next_ = Framed(kind == 10 ? "WELLGYRO_IMU" : "WELLGYRO_CMD", next_);
    } else if (copy_) {
      Altered(stream_[(dice >> 16) % sent]);
    } else {
      next_ = absurd_[(dice >> 16) % absurd_.size()];
    }
    return next_;
  }
  /// Of the last one. Some copies come as if they were the tool's, with the number of the first.
  std::uint64_t sender() {
    const std::uint64_t dice = chance_() % 330;
    return dice < 30 && copy_ ? kTool : (dice % 3 == 0 ? kTool : kOther) + dice;
  }

 private:
  template <class Record>
  void Keep(std::string_view channel, const Record& record) {
    Encode(record, next_);
    absurd_.push_back(Framed(channel, next_));
  }
  void Random(std::size_t size) {
    for (std::size_t i = 0; i < size; ++i) next_.push_back(static_cast<std::byte>(chance_()));
  }
  /// Sizes, offsets and counts that wrap, overlap, lie, or never end.
  void Fragment(std::uint64_t dice) {
    constexpr std::uint32_t kSizes[] = {0, 1, 4000, 1 << 20, 8 << 20, 0x7fffffff, 0xffffffff};
    constexpr std::uint32_t kOffsets[] = {0, 1, 3950, 1 << 20, 0x7fffffff, 0xffffffce};
    Put(next_, 0x4c433033, 4);
    Put(next_, dice >> 8 & 7, 4);
    Put(next_, kSizes[(dice >> 11) % 7], 4);
    Put(next_, kOffsets[(dice >> 16) % 6], 4);
    Put(next_, dice >> 24 & 3, 2);
    Put(next_, (dice >> 26 & 7) == 7 ? 0xffff : dice >> 29 & 3, 2);
    for (const char c : std::string_view("WELLGYRO_IMU"))
      next_.push_back(static_cast<std::byte>(c));
    next_.push_back(std::byte{0});
    Random(dice >> 40 & 127);
  }
  /// A copy of what has been sent, with one to three bits flipped.
  void Altered(const Message& message) {
    next_ = Framed(message.channel, message.bytes, message.number);
    const std::size_t from = next_.size() - message.bytes.size(), size = message.bytes.size();
    for (std::uint64_t flips = 1 + chance_() % 3; flips > 0; --flips) {
      next_[from + chance_() % size] ^= static_cast<std::byte>(1U << chance_() % 8);
    }
  }

  const std::vector<Message>& stream_;
  std::vector<Bytes> absurd_;
  std::mt19937_64 chance_{9};
  Bytes next_;
  bool copy_ = false;
};

std::vector<Message> Stream(const testing::SmallHole& hole) {
  std::vector<Message> stream;
  test::ForEachMessage(SimulationOf(hole), [&](const auto& channel, auto bytes, std::int64_t us) {
    const auto number = static_cast<std::uint32_t>(7 + stream.size());
    stream.push_back({channel, {bytes.begin(), bytes.end()}, us, number});
  });
  return stream;
}

JobFile JobWithKey(const testing::SmallHole& hole, const PrivateKey& key) {
  JobFile job;
  job.job = JobOf(hole);
  job.operations.keys.push_back({"Ada", PublicKeyOf(key)});
  return job;
}

int Datagrams(std::int64_t count) {
  const testing::SmallHole hole;
  const JobFile job = JobWithKey(hole, NewPrivateKey());
  const std::vector<Message> stream = Stream(hole);
  Subject alone(job), among(job);
  Harm harm(stream);
  std::int64_t sent = 0;
  const auto begin = std::chrono::steady_clock::now();
  for (std::size_t i = 0; i < stream.size(); ++i) {
    const auto until =
        static_cast<std::int64_t>(static_cast<double>(count) * static_cast<double>(i + 1) /
                                  static_cast<double>(stream.size()));
    const Message& message = stream[i];
    const Bytes framed = Framed(message.channel, message.bytes, message.number);
    // Half of them before the message that is true, so that some are there before the tool is.
    const std::int64_t half = sent + (until - sent) / 2;
    for (; sent < half; ++sent) {
      const Bytes& datagram = harm.Next(i);
      among.Take(harm.sender(), datagram, message.received_us);
    }
    alone.Take(kTool, framed, message.received_us);
    among.Take(kTool, framed, message.received_us);
    for (; sent < until; ++sent) {
      const Bytes& datagram = harm.Next(i + 1);
      among.Take(harm.sender(), datagram, message.received_us);
    }
  }
  const std::chrono::duration<double> took = std::chrono::steady_clock::now() - begin;
  const Survey told = among.Result();
  const auto expected = alone.Files(alone.Result()), found = among.Files(told);
  std::string other;
  for (const auto& [name, bytes] : expected) {
    if (found.at(name) != bytes) other += " " + name;
  }
  const bool same = other.empty();
  fmt::print(
      "{} hostile datagrams among {} true ones in {:.0f} s: {} refused unread, {} of other "
      "senders, {} malformed, {} orders refused, {} obeyed, {} tools, {} faults told of; {:.0f} MB "
      "resident at most; the survey is {}\n",
      sent, stream.size(), took.count(), among.refused(), among.left_out(),
      among.intake().feed().malformed(), among.intake().operations().refused(),
      among.intake().operations().obeyed(), among.tools(), among.faults().count(), Resident(),
      same ? "the same" : "ANOTHER:" + other);
  for (std::size_t i = 0; i < std::min<std::size_t>(among.faults().faults().size(), 3); ++i) {
    fmt::print("  {}\n", among.faults().faults()[i].text);
  }
  return same && Resident() < 100 && among.intake().operations().obeyed() == 0 ? 0 : 3;
}

/// Orders that are not obeyed among a hundred that are.
int Orders(std::int64_t count) {
  constexpr int kTrue = 100;
  const testing::SmallHole hole;
  const PrivateKey key = NewPrivateKey(), other = NewPrivateKey();
  const JobFile job = JobWithKey(hole, key);
  Subject survey(job);
  const std::vector<Message> stream = Stream(hole);
  for (const Message& message : stream) survey.TakeMessage(message.channel, message.bytes);
  std::mt19937_64 chance(4);
  Event event;
  event.utc = SimulationOf(hole).streams.begin_utc + Duration::Seconds(300);
  event.kind = Event::Kind::kRemark;
  const auto signed_by = [&](const PrivateKey& by, std::int32_t id, const std::string& well) {
    SignedOperation operation{.utc = event.utc, .session = 3, .id = id};
    Encode(event, operation.content);
    operation.key = PublicKeyOf(by);
    operation.signature = Sign(by, SignedBytes(operation, well));
    Bytes bytes;
    Encode(operation, bytes);
    return bytes;
  };
  const auto& gate = survey.intake().operations();
  const std::vector<Bytes> models = {signed_by(key, 7, ""), signed_by(key, 8, "another well"),
                                     signed_by(other, 9, "")};
  const auto begin = std::chrono::steady_clock::now();
  int obeyed = 0;
  for (std::int64_t i = 0; i < count; ++i) {
    Bytes forged = models[chance() % models.size()];
    forged[8 + chance() % (forged.size() - 8)] ^= static_cast<std::byte>(1U << chance() % 8);
    survey.TakeMessage("WELLGYRO_CMD", forged);
    if ((i + 1) * kTrue / count == obeyed) continue;
    // Each three times, as they are sent.
    const Bytes order = signed_by(key, 1000 + obeyed++, "");
    for (int again = 0; again < 3; ++again) survey.TakeMessage("WELLGYRO_CMD", order);
  }
  const std::chrono::duration<double> took = std::chrono::steady_clock::now() - begin;
  const auto named = std::ranges::count_if(gate.records(), &OperationRecord::obeyed);
  fmt::print(
      "{} forged orders among {} signed ones in {:.0f} s: {} obeyed, each named: {}, {} refused, "
      "{} malformed; {:.0f} MB resident at most\n",
      count, obeyed, took.count(), gate.obeyed(), named, gate.refused(),
      survey.intake().feed().malformed(), Resident());
  return gate.obeyed() == obeyed && named == obeyed ? 0 : 3;
}

int Main(int argc, char** argv) {
  const std::string_view what = argc > 1 ? argv[1] : "";
  const std::int64_t count = argc > 2 ? std::atoll(argv[2]) : 0;
  if (count > 0 && what == "datagrams") return Datagrams(count);
  if (count > 0 && what == "orders") return Orders(count);
  fmt::print("hostile_bench datagrams|orders COUNT\n");
  return 1;
}

}  // namespace
}  // namespace wellgyro

int main(int argc, char** argv) { return wellgyro::Main(argc, argv); }
