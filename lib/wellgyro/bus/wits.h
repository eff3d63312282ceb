#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <string_view>

#include "wellgyro/base/export.h"
#include "wellgyro/base/result.h"
#include "wellgyro/record/depth.h"
#include "wellgyro/record/wits_items.h"

namespace wellgyro {

/// Depth marks out of a WITS level 0 stream: records between "&&" and "!!", a line each with two
/// digits of the record, two of the item, and the value. Whatever else the line brings costs its
/// own record only: one that has a wrong line, no time, no depth (-9999 and -8888 are none) or no
/// end is left out and told.
/// A mark's time is the record's own, whole seconds of the rig's clock; of records within one
/// second the first counts.
///
/// Wellsite Information Transfer Specification, level 0 (IADC / API).
class WELLGYRO_EXPORT WitsReader {
 public:
  static constexpr std::size_t kLineMax = 256;   ///< [bytes]
  static constexpr std::size_t kItemsMax = 200;  ///< of one record

  using Use = std::function<void(const DepthMark&)>;
  using Tell = std::function<void(const Fault&)>;

  /// `session` tells this stream of marks from another of the same program.
  WitsReader(const WitsItems& items, std::int32_t session, Use use, Tell tell)
      : items_(items), session_(session), use_(std::move(use)), tell_(std::move(tell)) {}

  void Take(std::string_view bytes);
  /// The line was cut: what follows begins a new record.
  void Cut();

  std::int64_t marks() const { return marks_; }
  std::int64_t bad() const { return bad_; }  ///< records left out

 private:
  void TakeLine();
  void EndRecord();
  void Bad(const std::string& why);
  std::optional<UtcTime> Time() const;
  std::optional<double> Number(int item) const;

  WitsItems items_;
  std::int32_t session_;
  Use use_;
  Tell tell_;
  std::string line_;
  bool line_too_long_ = false;
  bool inside_ = false;
  std::string wrong_;  ///< of the record that is open
  std::map<int, std::string> values_;
  std::optional<UtcTime> last_;
  std::int64_t seq_ = 0, marks_ = 0, bad_ = 0;
};

}  // namespace wellgyro
