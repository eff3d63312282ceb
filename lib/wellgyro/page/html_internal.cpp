#include "wellgyro/page/html_internal.h"

#include <cmath>
#include <cstddef>

#include <fmt/core.h>

namespace wellgyro {
namespace {

constexpr std::string_view kDash = "\u2013";

std::string WithoutMinusZero(std::string text) {
  const bool zero = text.find_first_not_of("-0.") == std::string::npos;
  return zero && text.starts_with('-') ? text.substr(1) : text;
}

}  // namespace

std::string Isolated(std::string_view text) { return "<bdi>" + Escaped(text) + "</bdi>"; }

std::string Clipped(std::string_view text, std::size_t most) {
  std::size_t characters = 0;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const bool begins = (static_cast<unsigned char>(text[i]) & 0xc0) != 0x80;
    if (begins && ++characters > most) return std::string(text.substr(0, i)) + "\u2026";
  }
  return std::string(text);
}

std::string NumberText(const std::optional<double>& value, int decimals) {
  if (!value || !std::isfinite(*value)) return std::string(kDash);
  return WithoutMinusZero(fmt::format("{:.{}f}", *value, decimals));
}

std::string ShortText(const std::optional<double>& value) {
  if (!value || !std::isfinite(*value)) return std::string(kDash);
  return WithoutMinusZero(fmt::format("{:.4g}", *value));
}

HtmlTable::HtmlTable(std::string& html, std::string_view kind, std::string_view caption,
                     std::initializer_list<std::string_view> heads)
    : html_(html) {
  html_ += fmt::format("<div class=\"wide\"><table class=\"data {}\">", kind);
  if (!caption.empty()) html_ += fmt::format("<caption>{}</caption>", Escaped(caption));
  html_ += "<thead><tr>";
  for (const std::string_view head : heads) {
    const bool number = head.starts_with('>');
    html_ += fmt::format("<th scope=\"col\"{}>{}</th>", number ? " class=\"n\"" : "",
                         Escaped(head.substr(number ? 1 : 0)));
  }
  html_ += "</tr></thead><tbody>\n";
}

HtmlTable::~HtmlTable() {
  html_ += open_ ? "</tr>\n</tbody></table></div>\n" : "</tbody></table></div>\n";
}

HtmlTable& HtmlTable::Row(std::string_view kind) {
  if (open_) html_ += "</tr>\n";
  open_ = true;
  html_ += kind.empty() ? std::string("<tr>") : fmt::format("<tr class=\"{}\">", Escaped(kind));
  return *this;
}

HtmlTable& HtmlTable::Text(std::string_view text) {
  html_ += "<td>" + (text.empty() ? std::string(kDash) : Isolated(text)) + "</td>";
  return *this;
}

HtmlTable& HtmlTable::Cell(std::string_view html) {
  html_ += fmt::format("<td>{}</td>", html);
  return *this;
}

HtmlTable& HtmlTable::Number(const std::optional<double>& value, int decimals) {
  html_ += "<td class=\"n\">" + NumberText(value, decimals) + "</td>";
  return *this;
}

HtmlTable& HtmlTable::Short(const std::optional<double>& value) {
  html_ += "<td class=\"n\">" + ShortText(value) + "</td>";
  return *this;
}

}  // namespace wellgyro
