#include "wellgyro/base/result.h"

#include <fmt/core.h>

namespace wellgyro {

std::string SentenceOf(const Fault& fault) {
  // Some texts name their file themselves.
  const bool named = !fault.source.empty() && fault.text.starts_with(fault.source);
  std::string place = named ? std::string() : fault.source;
  if (fault.line > 0) place += fmt::format(":{}", fault.line);
  if (fault.line > 0 && fault.column > 0) place += fmt::format(":{}", fault.column);
  if (fault.offset >= 0) place += fmt::format("{}byte {}", place.empty() ? "" : ", ", fault.offset);
  return place.empty() ? fault.text : place + ": " + fault.text;
}

}  // namespace wellgyro
