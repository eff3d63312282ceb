#include "wellgyro/io/exchange/petra_internal.h"

#include "wellgyro/io/text_internal.h"

namespace wellgyro {
namespace {

bool IsAcross(std::string_view name) {
  for (const std::string_view across : {"EW", "NS", "XOFF", "YOFF", "X", "Y"}) {
    if (EqualNoCase(name, across)) return true;
  }
  return false;
}

bool IsDepth(std::string_view name) {
  return EqualNoCase(name, "MD") || EqualNoCase(name, "TVD") || EqualNoCase(name, "SSTVD");
}

}  // namespace

bool PetraHead::Take(std::string_view text, const LineReader& lines) {
  if (!text.starts_with('*')) return false;
  std::vector<std::string_view> words;
  Split(text, ' ', words);
  const std::string_view first = words.front().substr(1);
  if (!in_columns_ && !EqualNoCase(first, "WELL") && !EqualNoCase(first, "XYUNITS") &&
      !EqualNoCase(first, "DEPUNITS") && !EqualNoCase(first, "COLUMNS")) {
    return false;
  }
  for (std::size_t i = 0; i < words.size(); ++i) {
    const std::string_view word = words[i];
    if (!word.starts_with('*')) continue;
    const std::string_view name = word.substr(1);
    const std::string_view value = i + 1 < words.size() ? words[i + 1] : std::string_view();
    if (EqualNoCase(name, "WELL")) {
      in_columns_ = false;
      well_ = value.starts_with('*') ? std::string_view() : value;
    } else if (EqualNoCase(name, "XYUNITS") || EqualNoCase(name, "DEPUNITS")) {
      const bool feet = EqualNoCase(value, "F") || EqualNoCase(value, "FT");
      if (!feet && !EqualNoCase(value, "M")) {
        lines.Complain(FaultCode::kSyntax, "a unit that is neither F nor M");
      }
      (EqualNoCase(name, "XYUNITS") ? across_ : depths_) = feet ? "ft" : "m";
    } else if (EqualNoCase(name, "COLUMNS")) {
      in_columns_ = true;
      columns_.clear();
    } else if (in_columns_ && columns_.size() < 1000) {
      columns_.emplace_back(name);
    }
  }
  return true;
}

std::vector<std::string> PetraHead::Headings() const {
  std::vector<std::string> headings;
  for (const std::string& name : columns_) {
    const std::string unit = IsAcross(name) ? across_ : IsDepth(name) ? depths_ : "";
    headings.push_back(unit.empty() ? name : name + "[" + unit + "]");
  }
  return headings;
}

}  // namespace wellgyro
