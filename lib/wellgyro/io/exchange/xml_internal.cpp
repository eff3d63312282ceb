#include "wellgyro/io/exchange/xml_internal.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>

#include <fmt/core.h>

#include "wellgyro/io/text_internal.h"

namespace wellgyro {
namespace {

// Elements within each other, by which reading goes down the call stack; WITSML has a dozen.
constexpr int kMostDepth = 64;

int LineAt(std::string_view bytes, std::size_t offset) {
  const auto end = bytes.begin() + static_cast<std::ptrdiff_t>(std::min(offset, bytes.size()));
  return 1 + static_cast<int>(std::count(bytes.begin(), end, '\n'));
}

Fault FaultAt(FaultCode code, std::string text, const std::string& source, std::string_view bytes,
              std::size_t offset) {
  return {.code = code,
          .text = std::move(text),
          .source = source,
          .offset = static_cast<std::int64_t>(offset),
          .line = LineAt(bytes, offset)};
}

// End of what begins at `at`, after `close`; past the end when it never closes.
std::size_t After(std::string_view bytes, std::size_t at, std::string_view close) {
  const std::size_t end = bytes.find(close, at);
  return end == std::string_view::npos ? bytes.size() : end + close.size();
}

// Reads tags alone, before anything is built: depth bounded, no document type.
void LookThrough(std::string_view bytes, const std::string& source) {
  int depth = 0;
  for (std::size_t at = bytes.find('<'); at < bytes.size(); at = bytes.find('<', at)) {
    const std::string_view rest = bytes.substr(at);
    if (rest.starts_with("<!--")) {
      at = After(bytes, at + 4, "-->");
    } else if (rest.starts_with("<![CDATA[")) {
      at = After(bytes, at, "]]>");
    } else if (rest.starts_with("<?")) {
      at = After(bytes, at, "?>");
    } else if (rest.starts_with("<!")) {
      throw TextError{FaultAt(FaultCode::kForeign,
                              "declares a document type or entities, which are not read", source,
                              bytes, at)};
    } else if (rest.starts_with("</")) {
      --depth;
      at = After(bytes, at, ">");
    } else {
      // To the end of the tag, over quoted values, which may hold '>'.
      std::size_t end = at + 1;
      while (end < bytes.size() && bytes[end] != '>') {
        const char c = bytes[end];
        end = c == '"' || c == '\'' ? After(bytes, end + 1, std::string_view(&c, 1)) : end + 1;
      }
      if (end == 0 || end > bytes.size() || bytes[end - 1] != '/') ++depth;
      if (depth > kMostDepth) {
        throw TextError{FaultAt(FaultCode::kForeign,
                                fmt::format("elements more than {} deep", kMostDepth), source,
                                bytes, at)};
      }
      at = end;
    }
    if (at >= bytes.size()) return;
  }
}

std::string Escaped(std::string_view text) {
  std::string escaped;
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if (c == '&') {
      escaped += "&amp;";
    } else if (c == '<') {
      escaped += "&lt;";
    } else if (c == '>') {
      escaped += "&gt;";
    } else if (c == '"') {
      escaped += "&quot;";
    } else if (byte >= 0x20 || c == '\t' || c == '\n') {
      escaped += c;
    }
  }
  return escaped;
}

}  // namespace

XmlFile::XmlFile(std::string bytes, std::string source)
    : bytes_(std::move(bytes)), source_(std::move(source)) {
  if (bytes_.size() > kXmlBytes) {
    throw TextError{{.code = FaultCode::kSize,
                     .text = "XML of more than 256 MiB: split the file",
                     .source = source_}};
  }
  if (bytes_.substr(0, 256).find('\0') != std::string::npos) {
    throw TextError{{.code = FaultCode::kForeign,
                     .text = "this is UTF-16 or no text: save it as UTF-8",
                     .source = source_}};
  }
  LookThrough(bytes_, source_);
  const pugi::xml_parse_result parsed = document_.load_buffer(bytes_.data(), bytes_.size());
  if (!parsed) {
    throw TextError{FaultAt(FaultCode::kSyntax, parsed.description(), source_, bytes_,
                            static_cast<std::size_t>(std::max<std::ptrdiff_t>(parsed.offset, 0)))};
  }
}

void XmlFile::Complain(FaultCode code, pugi::xml_node at, const std::string& text) const {
  std::string path;
  for (pugi::xml_node node = at; node && node.type() == pugi::node_element; node = node.parent()) {
    int number = 1;
    for (pugi::xml_node before = node.previous_sibling(node.name()); before;
         before = before.previous_sibling(node.name())) {
      ++number;
    }
    const bool alone = number == 1 && !node.next_sibling(node.name());
    path.insert(0, fmt::format("/{}{}", node.name(), alone ? "" : fmt::format("[{}]", number)));
  }
  const auto offset = static_cast<std::size_t>(std::max<std::ptrdiff_t>(at.offset_debug(), 0));
  throw TextError{FaultAt(code, path + ": " + text, source_, bytes_, offset)};
}

std::string LocalName(pugi::xml_node node) {
  std::string name = node.name();
  name.erase(0, name.find(':') + 1);
  if (!name.empty() && name[0] >= 'A' && name[0] <= 'Z') name[0] = static_cast<char>(name[0] + 32);
  return name;
}

pugi::xml_node ChildOf(pugi::xml_node node, std::string_view name) {
  for (const pugi::xml_node child : node.children()) {
    if (LocalName(child) == name) return child;
  }
  return {};
}

std::string TextOf(pugi::xml_node node) {
  std::string_view text = node.text().get();
  while (!text.empty() && static_cast<unsigned char>(text.front()) <= ' ') text.remove_prefix(1);
  while (!text.empty() && static_cast<unsigned char>(text.back()) <= ' ') text.remove_suffix(1);
  return ToUtf8(text);
}

void XmlWriter::Start(std::string_view tag, const Attributes& attributes) {
  text_.append(open_.size(), ' ');
  text_ += '<';
  text_ += tag;
  for (const auto& [name, value] : attributes) {
    if (value.empty()) continue;
    text_ += ' ';
    text_ += name;
    text_ += "=\"" + Escaped(value) + '"';
  }
  text_ += '>';
}

void XmlWriter::Open(std::string_view tag, const Attributes& attributes) {
  Start(tag, attributes);
  text_ += '\n';
  open_.emplace_back(tag);
}

void XmlWriter::Close() {
  const std::string tag = std::move(open_.back());
  open_.pop_back();
  text_.append(open_.size(), ' ');
  text_ += "</" + tag + ">\n";
}

void XmlWriter::Leaf(std::string_view tag, std::string_view text, const Attributes& attributes) {
  Start(tag, attributes);
  text_ += Escaped(text) + "</";
  text_ += tag;
  text_ += ">\n";
}

void XmlWriter::LeafIf(std::string_view tag, std::string_view text, const Attributes& attributes) {
  if (!text.empty()) Leaf(tag, text, attributes);
}

}  // namespace wellgyro
