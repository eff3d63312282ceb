#include "wellgyro/page/html_head_internal.h"

#include <cstddef>
#include <cstdint>

#include <fmt/core.h>

#include "wellgyro/io/sha256.h"
#include "wellgyro/page/assets_internal.h"
#include "wellgyro/page/html_internal.h"

namespace wellgyro {
namespace {

/// Base64 (RFC 4648) of a SHA-256, as policies name what may run.
std::string PolicyHash(std::string_view script) {
  constexpr std::string_view kDigits =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  const std::string hex = Sha256Hex(script);
  std::string base64 = "'sha256-";
  for (std::size_t i = 0; i < hex.size(); i += 6) {
    const std::string part = hex.substr(i, 6);
    const auto bits = static_cast<std::uint32_t>(
        std::stoul(part + std::string(6 - part.size(), '0'), nullptr, 16));
    const std::size_t digits = part.size() == 6 ? 4 : part.size() / 2 + 1;
    for (std::size_t k = 0; k < 4; ++k) {
      base64 += k < digits ? kDigits[(bits >> (18 - 6 * k)) & 63u] : '=';
    }
  }
  return base64 + "'";
}

}  // namespace

std::string HeadElement(std::string_view title, std::string_view style,
                        const std::vector<std::string_view>& scripts, std::string_view connect) {
  std::string hashes;
  for (const std::string_view script : scripts) hashes += ' ' + PolicyHash(script);
  const std::string policy = fmt::format(
      "default-src 'none'; script-src{}; style-src {}; connect-src {}; img-src data:; base-uri "
      "'none'; form-action 'none'",
      hashes, PolicyHash(style), connect);
  return fmt::format(
      "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
      "<meta http-equiv=\"Content-Security-Policy\" content=\"{}\">\n"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
      "<link rel=\"icon\" href=\"data:,\">\n<title>{}</title>\n"
      "<style>{}</style>\n</head>\n<body>\n",
      policy, Escaped(title), style);
}

std::string InScript(const Json& json) {
  std::string text = json.dump(-1, ' ', true, Json::error_handler_t::replace), safe;
  for (const char c : text) {
    if (c == '<') {
      safe += "\\u003c";
    } else {
      safe += c;
    }
  }
  return safe;
}

std::string TailElements(const std::vector<std::string_view>& scripts) {
  std::string html =
      "<details class=\"licence\"><summary>Licence of the charts' library D3, which is part of "
      "this page</summary><pre>";
  for (const char c : D3Licence()) html += c == '\n' ? std::string("\n") : Escaped({&c, 1});
  html += "</pre></details>\n";
  for (const std::string_view script : scripts)
    html += fmt::format("<script>{}</script>\n", script);
  return html + "</body>\n</html>\n";
}

}  // namespace wellgyro
