#include "wellgyro/io/exchange/sheet_internal.h"

#include <algorithm>
#include <cstddef>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include <fmt/core.h>
#include <zip.h>

#include "wellgyro/io/exchange/xml_internal.h"
#include "wellgyro/io/text_internal.h"

namespace wellgyro {
namespace {

constexpr zip_uint64_t kPartBytes = 1 << 26;                     // of a part, unpacked
constexpr std::size_t kMostColumns = 1024, kMostRows = 1 << 20;  // rows as a spreadsheet has them

[[noreturn]] void Refuse(FaultCode code, std::string text, const std::string& source,
                         int line = 0) {
  throw TextError{{.code = code, .text = std::move(text), .source = source, .line = line}};
}

struct Closer {
  void operator()(zip_t* archive) const { zip_discard(archive); }
  void operator()(zip_file_t* file) const { zip_fclose(file); }
};

class Archive {
 public:
  Archive(const std::string& bytes, const std::string& source) : source_(source) {
    zip_error_t error;
    zip_error_init(&error);
    zip_source_t* const buffer = zip_source_buffer_create(bytes.data(), bytes.size(), 0, &error);
    if (buffer) archive_.reset(zip_open_from_source(buffer, ZIP_RDONLY, &error));
    if (buffer && !archive_) zip_source_free(buffer);
    zip_error_fini(&error);
    if (!archive_) Refuse(FaultCode::kForeign, "a damaged or cut zip archive", source);
  }

  bool Has(const std::string& name) const {
    return zip_name_locate(archive_.get(), name.c_str(), 0) >= 0;
  }

  /// Checked against the archive's own sum.
  std::string Part(const std::string& name) const {
    const std::unique_ptr<zip_file_t, Closer> file(zip_fopen(archive_.get(), name.c_str(), 0));
    if (!file) Refuse(FaultCode::kForeign, "the workbook has no readable " + name, source_);
    std::string text;
    std::vector<char> piece(1 << 16);
    for (;;) {
      const zip_int64_t got = zip_fread(file.get(), piece.data(), piece.size());
      if (got < 0) Refuse(FaultCode::kSyntax, name + " is damaged", source_);
      if (got == 0) return text;
      text.append(piece.data(), static_cast<std::size_t>(got));
      if (text.size() > kPartBytes) Refuse(FaultCode::kSize, name + " is too large", source_);
    }
  }

 private:
  std::string source_;
  std::unique_ptr<zip_t, Closer> archive_;
};

// Text in one piece or in runs; how it is to be spoken is none.
std::string RichText(pugi::xml_node node) {
  std::string text;
  for (const pugi::xml_node child : node.children()) {
    const std::string name = LocalName(child);
    if (name == "t") text += ToUtf8(child.text().get());
    if (name == "r") text += ToUtf8(ChildOf(child, "t").text().get());
  }
  return text;
}

// "BC12" is column 54, from 0; nothing where there are no letters or too many.
std::optional<std::size_t> ColumnOf(std::string_view reference) {
  std::size_t column = 0, letters = 0;
  while (letters < reference.size() && reference[letters] >= 'A' && reference[letters] <= 'Z') {
    column = column * 26 + static_cast<std::size_t>(reference[letters] - 'A') + 1;
    if (++letters > 3) return std::nullopt;
  }
  if (letters == 0) return std::nullopt;
  return column - 1;
}

std::string Cell(std::string text) {
  std::replace_if(
      text.begin(), text.end(), [](char c) { return c == '\t' || c == '\n' || c == '\r'; }, ' ');
  return text.find('"') == std::string::npos ? text : CsvQuoted(text);
}

class Workbook {
 public:
  Workbook(const std::string& bytes, const std::string& source)
      : archive_(bytes, source), source_(source) {
    if (!archive_.Has("xl/workbook.xml")) {
      Refuse(FaultCode::kForeign, "a zip archive that is no workbook", source);
    }
    const XmlFile book(archive_.Part("xl/workbook.xml"), source);
    const XmlFile links(archive_.Part("xl/_rels/workbook.xml.rels"), source);
    for (const pugi::xml_node sheet : ChildOf(book.root(), "sheets").children()) {
      const std::string id = IdOf(sheet);
      for (const pugi::xml_node link : links.root().children()) {
        if (id != link.attribute("Id").value()) continue;
        const std::string target = link.attribute("Target").value();
        sheets_.emplace_back(ToUtf8(sheet.attribute("name").value()),
                             target.starts_with('/') ? target.substr(1) : "xl/" + target);
      }
    }
    if (!archive_.Has("xl/sharedStrings.xml")) return;
    const XmlFile strings(archive_.Part("xl/sharedStrings.xml"), source);
    for (const pugi::xml_node item : strings.root().children()) {
      if (LocalName(item) == "si") strings_.push_back(RichText(item));
    }
  }

  std::string Chosen(const std::string& wanted) const {
    std::string names, chosen;
    std::size_t found = 0;
    for (const auto& [name, part] : sheets_) {
      if (!wanted.empty() && name != wanted) continue;
      if (!archive_.Has(part)) continue;  // a sheet of a chart
      std::string text = TextOfSheet(part);
      if (text.find_first_not_of("\t\n ") == std::string::npos) continue;
      ++found;
      AddName(name, names);
      chosen = std::move(text);
    }
    if (found == 1) return chosen;
    if (found > 1) {
      Refuse(FaultCode::kConflict, "several sheets: " + names + "; say which by --trajectory",
             source_);
    }
    Refuse(FaultCode::kForeign,
           wanted.empty() ? "a workbook with nothing in it" : "no sheet is called " + wanted,
           source_);
  }

 private:
  // The attribute r:id, whatever its prefix.
  static std::string IdOf(pugi::xml_node sheet) {
    for (const pugi::xml_attribute a : sheet.attributes()) {
      if (std::string_view(a.name()).ends_with(":id")) return a.value();
    }
    return {};
  }

  std::string TextOfSheet(const std::string& part) const {
    const XmlFile sheet(archive_.Part(part), source_);
    std::string text;
    std::size_t rows = 0;
    for (const pugi::xml_node row : ChildOf(sheet.root(), "sheetData").children()) {
      const std::size_t number = row.attribute("r").as_ullong(rows + 1);
      if (number <= rows || number > kMostRows) {
        Refuse(FaultCode::kSyntax, "rows out of order in " + part, source_, static_cast<int>(rows));
      }
      text.append(number - rows - 1, '\n');
      rows = number;
      text += RowText(row, static_cast<int>(number)) + '\n';
    }
    return text;
  }

  std::string RowText(pugi::xml_node row, int number) const {
    std::string text;
    std::size_t at = 0;
    bool first = true;
    for (const pugi::xml_node cell : row.children()) {
      const auto column = ColumnOf(cell.attribute("r").value());
      const std::size_t next = column.value_or(first ? 0 : at + 1);
      if (next >= kMostColumns || (!first && next <= at)) {
        Refuse(FaultCode::kSyntax, "columns out of order or beyond 1024", source_, number);
      }
      text.append(next - at, '\t');
      at = next;
      first = false;
      text += Cell(CellText(cell, number));
    }
    return text;
  }

  std::string CellText(pugi::xml_node cell, int number) const {
    const std::string_view type = cell.attribute("t").value();
    if (type == "inlineStr") return RichText(ChildOf(cell, "is"));
    const std::string value = ToUtf8(ChildOf(cell, "v").text().get());
    if (type != "s") return value;
    const auto index = IntegerOf(value);
    if (!index || *index < 0 || static_cast<std::size_t>(*index) >= strings_.size()) {
      Refuse(FaultCode::kSyntax, "a text that the workbook does not hold", source_, number);
    }
    return strings_[static_cast<std::size_t>(*index)];
  }

  Archive archive_;
  std::string source_;
  std::vector<std::pair<std::string, std::string>> sheets_;  // name and part
  std::vector<std::string> strings_;
};

}  // namespace

bool IsWorkbook(std::string_view head) { return head.starts_with("PK\x03\x04"); }

std::string SheetText(const std::string& bytes, const std::string& source,
                      const std::string& wanted) {
  return Workbook(bytes, source).Chosen(wanted);
}

}  // namespace wellgyro
