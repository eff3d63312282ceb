// Error models as Compass instrument performance models, .ipm.
#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "wellgyro/io/exchange/compass_rows_internal.h"
#include "wellgyro/io/exchange/model_files.h"
#include "wellgyro/io/exchange/model_terms_internal.h"
#include "wellgyro/io/text_internal.h"

namespace wellgyro {
namespace {

constexpr std::size_t kIpmBytes = 1 << 20;  // bytes, of an .ipm

std::string Trimmed(std::string_view text) {
  const auto begin = text.find_first_not_of(" \t\r");
  if (begin == std::string_view::npos) return {};
  return std::string(text.substr(begin, text.find_last_not_of(" \t\r") - begin + 1));
}

/// By tabs, or where there are too few of them by runs of two blanks and more; then the formula is
/// the rest of the line.
std::vector<std::string> Cells(std::string_view line) {
  std::vector<std::string> cells;
  const bool tabs = std::ranges::count(line, '\t') >= 5;
  while (!line.empty()) {
    std::size_t end = !tabs && cells.size() == 5 ? line.size() : line.find(tabs ? "\t" : "  ");
    if (end == std::string_view::npos) end = line.size();
    cells.push_back(Trimmed(line.substr(0, end)));
    line.remove_prefix(std::min(end + 1, line.size()));
    while (!tabs && !line.empty() && line.front() == ' ') line.remove_prefix(1);
  }
  return cells;
}

/// Whether the line of names says that inclinations from and to follow the formula.
bool NamesRange(std::string_view names) {
  const std::vector<std::string> cells = Cells(names);
  return cells.size() == 8 && Lower(cells[6]).find("min") != std::string::npos &&
         Lower(cells[7]).find("max") != std::string::npos;
}

CompassRow RowOf(const std::string& line, bool ranges, const std::string& source, int number) {
  std::vector<std::string> cells = Cells(line);
  while (cells.size() > 6 && cells.back().empty()) cells.pop_back();
  if (cells.size() < 6) RefuseModel(source, "a row has fewer than six cells between tabs", number);
  CompassRow row{Lower(cells[0]), Lower(cells[1]), Lower(cells[2]), Lower(cells[3]), cells[5]};
  const std::string term = "term " + row.name;
  row.value = NumberOrRefuse(cells[4], term + ": the value", source, number);
  if (ranges && cells.size() == 8) {
    row.min_deg = NumberOrRefuse(cells[6], term + ": the least inclination", source, number);
    row.max_deg = NumberOrRefuse(cells[7], term + ": the greatest inclination", source, number);
  } else if (cells.size() > 6) {
    RefuseModel(source, term + ": cells follow the formula that the line of names does not name",
                number);
  }
  row.order = number;
  row.line = number;
  return row;
}

ErrorModel ReadIpm(std::string_view text, const std::string& source) {
  ErrorModel model;
  std::vector<CompassRow> rows;
  int number = 0;
  bool ranges = false;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    const std::string line = Trimmed(text.substr(0, end));
    text.remove_prefix(std::min(end + 1, text.size()));
    ++number;
    if (line.empty()) continue;
    if (line.front() == '#') {
      ranges = ranges || NamesRange(line);
      const std::size_t colon = line.find(':');
      if (colon == std::string::npos) continue;
      const std::string key = Trimmed(std::string_view(line).substr(1, colon - 1));
      const std::string value = Trimmed(std::string_view(line).substr(colon + 1));
      if (key == "ShortName" || (key == "Tool Name" && model.name.empty())) model.name = value;
      if (key == "Description") model.description = value;
      if (key == "Remarks") model.source = value;
      continue;
    }
    rows.push_back(RowOf(line, ranges, source, number));
  }
  if (model.name.empty()) model.name = source;
  TermsOfRows(std::move(rows), source, model);
  FinishModel(model, source);
  return model;
}

}  // namespace

Result<ErrorModel> ParseModelIpm(std::string_view text, const std::string& source) {
  try {
    if (text.size() > kIpmBytes) RefuseModel(source, "is larger than 1 MiB");
    return ReadIpm(text, source);
  } catch (const ModelError& error) {
    return error.fault;
  }
}

}  // namespace wellgyro
