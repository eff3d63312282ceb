#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <pugixml.hpp>

#include "wellgyro/io/exchange/line_reader_internal.h"

namespace wellgyro {

/// Largest file [bytes], held whole: 256 MiB, and several times that as a document.
inline constexpr std::size_t kXmlBytes = std::size_t{1} << 28;

/// Foreign XML, whole in memory: at most 2^28 bytes and 64 levels, no document type, hence no
/// entities but XML's own five. Throws TextError with the line.
class XmlFile {
 public:
  XmlFile(std::string bytes, std::string source);

  pugi::xml_node root() const { return document_.document_element(); }
  [[noreturn]] void Complain(FaultCode code, pugi::xml_node at, const std::string& text) const;

 private:
  std::string bytes_, source_;
  pugi::xml_document document_;
};

/// Name without prefix, first letter small: WITSML 1.4 and 2 differ in that alone.
std::string LocalName(pugi::xml_node node);
/// First child of that local name; an empty node when there is none.
pugi::xml_node ChildOf(pugi::xml_node node, std::string_view name);
/// Its trimmed text, as UTF-8.
std::string TextOf(pugi::xml_node node);

/// Writes elements, indented, with text escaped and characters that XML forbids left out.
class XmlWriter {
 public:
  using Attributes = std::vector<std::pair<std::string_view, std::string>>;

  XmlWriter() : text_("<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n") {}

  void Open(std::string_view tag, const Attributes& attributes = {});
  void Close();
  void Leaf(std::string_view tag, std::string_view text, const Attributes& attributes = {});
  /// The same, unless the text is empty.
  void LeafIf(std::string_view tag, std::string_view text, const Attributes& attributes = {});

  std::string Take() { return std::move(text_); }

 private:
  void Start(std::string_view tag, const Attributes& attributes);

  std::string text_;
  std::vector<std::string> open_;
};

}  // namespace wellgyro
