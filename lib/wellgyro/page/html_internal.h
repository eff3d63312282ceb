#pragma once

#include <initializer_list>
#include <optional>
#include <string>
#include <string_view>

#include "wellgyro/io/html_text_internal.h"

namespace wellgyro {

/// Escaped and isolated, so that text that runs from right to left leaves what stands beside it
/// alone.
std::string Isolated(std::string_view text);

/// The first `most` characters of UTF-8 text, with an ellipsis where there are more.
std::string Clipped(std::string_view text, std::size_t most);

/// Fixed decimals; a dash where there is no number.
std::string NumberText(const std::optional<double>& value, int decimals);
/// Few significant digits, for values of any size.
std::string ShortText(const std::optional<double>& value);

/// Writes a table into `html`; the end of its life closes it. A head that begins with '>' stands
/// over numbers, at their right.
class HtmlTable {
 public:
  HtmlTable(std::string& html, std::string_view kind, std::string_view caption,
            std::initializer_list<std::string_view> heads);
  ~HtmlTable();
  HtmlTable(const HtmlTable&) = delete;
  HtmlTable& operator=(const HtmlTable&) = delete;

  HtmlTable& Row(std::string_view kind = {});
  HtmlTable& Text(std::string_view text);
  HtmlTable& Cell(std::string_view html);  ///< as it is
  HtmlTable& Number(const std::optional<double>& value, int decimals);
  HtmlTable& Short(const std::optional<double>& value);

 private:
  std::string& html_;
  bool open_ = false;
};

}  // namespace wellgyro
