#include <algorithm>
#include <charconv>
#include <cmath>
#include <map>
#include <utility>

#include "wellgyro/base/units.h"
#include "wellgyro/io/exchange/line_reader_internal.h"
#include "wellgyro/io/exchange/model_files.h"
#include "wellgyro/io/exchange/model_terms_internal.h"
#include "wellgyro/io/exchange/xml_internal.h"

namespace wellgyro {
namespace {

constexpr std::size_t kIpmBytes = 1 << 20;  // bytes, of an .ipm
constexpr std::size_t kIpmRows = 2000;
constexpr std::size_t kLongest = 4000;  // characters of a formula with its values put in

/// One row: a component of an error source, or a value that formulas name.
struct Row {
  std::string name, vector, tie_on, unit, formula;
  double value = 0;
  double min_deg = 0, max_deg = 0;
  double order = 0;
  int line = 0;
};

std::string Trimmed(std::string_view text) {
  const auto begin = text.find_first_not_of(" \t\r");
  if (begin == std::string_view::npos) return {};
  return std::string(text.substr(begin, text.find_last_not_of(" \t\r") - begin + 1));
}

std::string LowerCase(std::string text) {
  for (char& c : text) {
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  }
  return text;
}

double NumberOrRefuse(const std::string& text, const std::string& what, const std::string& source,
                      int line) {
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size() || !std::isfinite(value)) {
    RefuseModel(source, what + " '" + text + "' is no number", line);
  }
  return value;
}

/// Compass speaks of gyro rates in degrees where its formulas divide by a rate per hour.
double UnitOf(const Row& row, const std::string& source) {
  if (row.unit == "dph" || row.unit == "deg/hr") return units::kDeg;
  const auto si = ModelUnit(row.unit);
  if (!si) RefuseModel(source, "term " + row.name + ": the unit '" + row.unit + "' is not known");
  return *si;
}

bool IsWord(char c) { return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '_'; }

/// `formula` with every whole word `name` replaced by (text). A name may hold '-'.
std::string PutIn(const std::string& formula, const std::string& name, const std::string& text) {
  std::string made;
  for (std::size_t at = 0; at < formula.size();) {
    const bool fits = formula.compare(at, name.size(), name) == 0;
    const bool begins = at == 0 || !IsWord(formula[at - 1]);
    const std::size_t end = at + name.size();
    if (fits && begins && (end >= formula.size() || !IsWord(formula[end]))) {
      made += "(" + text + ")";
      at = end;
    } else {
      made += formula[at++];
    }
  }
  return made;
}

std::string Significant17(double value) {
  char buffer[40];
  const auto [end, error] = std::to_chars(buffer, buffer + sizeof buffer, value);
  return std::string(buffer, end);
}

void AddTo(std::string& sum, const std::string& formula) {
  sum += (sum.empty() ? "(" : "+(") + formula + ")";
}

/// What a row's vector makes of it. A misalignment acts both towards the high side and across.
void AddComponent(FormulaTexts& texts, const Row& row, const std::string& formula,
                  const std::string& source) {
  const auto high = [&] { AddTo(texts.inclination, formula), AddTo(texts.north, formula); };
  const auto across = [&] { AddTo(texts.lateral, formula), AddTo(texts.east, formula); };
  if (row.vector == "a" || row.vector == "b") return AddTo(texts.azimuth, formula);
  if (row.vector == "i" || row.vector == "j") return high();
  if (row.vector == "e" || row.vector == "d") return AddTo(texts.md, formula);
  if (row.vector == "l") return across();
  if (row.vector == "m") return high(), across();
  RefuseModel(source, "term " + row.name + ": no vector is called '" + row.vector + "'", row.line);
}

class RowsToModel {
 public:
  RowsToModel(std::vector<Row> rows, const std::string& source)
      : rows_(std::move(rows)), source_(source) {
    std::ranges::stable_sort(rows_, {}, &Row::order);
  }

  void Into(ErrorModel& model) {
    if (rows_.empty()) RefuseModel(source_, "has no row of terms");
    if (rows_.size() > kIpmRows) RefuseModel(source_, "has more than 2000 rows");
    for (Row& row : rows_) {
      Resolve(row);
      if (row.tie_on == "n") {
        values_.emplace_back(
            row.name, Significant17(row.value * UnitOf(row, source_)) + "*(" + row.formula + ")");
      } else {
        groups_[{row.name, row.tie_on}].push_back(&row);
      }
    }
    // In the file's order.
    for (const Row& row : rows_) {
      if (row.tie_on == "n") continue;
      const auto& group = groups_[{row.name, row.tie_on}];
      if (group.front() == &row) model.terms.push_back(Term(group));
    }
  }

 private:
  void Resolve(Row& row) {
    row.formula = LowerCase(row.formula);
    // Longer names first, as a shorter one may begin them.
    std::ranges::sort(values_, std::ranges::greater{},
                      [](const auto& v) { return v.first.size(); });
    for (const auto& [name, text] : values_) {
      row.formula = PutIn(row.formula, name, text);
      if (row.formula.size() > kLongest) {
        RefuseModel(source_, "term " + row.name + ": its formula grows beyond 4000 characters",
                    row.line);
      }
    }
  }

  ErrorTerm Term(const std::vector<Row*>& group) {
    const Row& first = *group.front();
    const auto propagation = ModelPropagation(first.tie_on);
    if (!propagation || first.tie_on.size() != 1) {
      RefuseModel(source_, "term " + first.name + ": no tie-on is called '" + first.tie_on + "'",
                  first.line);
    }
    FormulaTexts texts;
    for (const Row* row : group) {
      const double size = row->value * UnitOf(*row, source_);
      AddComponent(texts, *row, Significant17(size) + "*(" + row->formula + ")", source_);
    }
    // A displacement stands in place of the whole error, so it must not lose the depth's.
    if (!texts.md.empty()) texts.north.clear(), texts.east.clear();
    if (first.max_deg > first.min_deg) {
      texts.min_inclination = first.min_deg * units::kDeg;
      texts.max_inclination = first.max_deg * units::kDeg;
    }
    const bool alone = std::ranges::count_if(groups_, [&](const auto& entry) {
                         return entry.first.first == first.name;
                       }) == 1;
    const std::string name = alone ? first.name : first.name + "(" + first.tie_on + ")";
    return FormulaTerm(name, 1, *propagation, texts, source_);
  }

  std::vector<Row> rows_;
  const std::string& source_;
  std::vector<std::pair<std::string, std::string>> values_;
  std::map<std::pair<std::string, std::string>, std::vector<Row*>> groups_;
};

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
  return cells.size() == 8 && LowerCase(cells[6]).find("min") != std::string::npos &&
         LowerCase(cells[7]).find("max") != std::string::npos;
}

Row RowOf(const std::string& line, bool ranges, const std::string& source, int number) {
  std::vector<std::string> cells = Cells(line);
  while (cells.size() > 6 && cells.back().empty()) cells.pop_back();
  if (cells.size() < 6) RefuseModel(source, "a row has fewer than six cells between tabs", number);
  Row row{LowerCase(cells[0]), LowerCase(cells[1]), LowerCase(cells[2]), LowerCase(cells[3]),
          cells[5]};
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
  std::vector<Row> rows;
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
  RowsToModel(std::move(rows), source).Into(model);
  FinishModel(model, source);
  return model;
}

void Walk(pugi::xml_node node, std::vector<pugi::xml_node>& tools,
          std::vector<pugi::xml_node>& terms) {
  for (const pugi::xml_node child : node.children()) {
    const std::string_view name = child.name();
    if (name == "CD_SURVEY_TOOL") tools.push_back(child);
    if (name == "DP_TOOL_TERM") terms.push_back(child);
    Walk(child, tools, terms);
  }
}

ErrorModel ReadEdm(std::string_view text, const std::string& source, std::string_view wanted) {
  const XmlFile file(std::string(text), source);
  std::vector<pugi::xml_node> tools, terms;
  Walk(file.root(), tools, terms);
  const auto id_of = [](pugi::xml_node tool) {
    return std::string(tool.attribute("survey_tool_id").value());
  };
  const auto name_of = [](pugi::xml_node tool) {
    const std::string name = tool.attribute("tool_name").value();
    return name.empty() ? std::string(tool.attribute("name").value()) : name;
  };
  const auto fits = [&](pugi::xml_node tool) {
    return wanted.empty() || id_of(tool) == wanted ||
           LowerCase(name_of(tool)) == LowerCase(std::string(wanted));
  };
  const auto count = std::ranges::count_if(tools, fits);
  if (count != 1) {
    RefuseModel(source, "has " + std::to_string(count) + " survey tools" +
                            (wanted.empty() ? ": name the one that is wanted as FILE#TOOL"
                                            : " called " + std::string(wanted)));
  }
  const pugi::xml_node tool = *std::ranges::find_if(tools, fits);
  ErrorModel model;
  model.name = name_of(tool);
  model.description = tool.attribute("description").value();
  model.source = "EDM export, survey tool " + id_of(tool);
  std::vector<Row> rows;
  for (const pugi::xml_node term : terms) {
    if (id_of(term) != id_of(tool)) continue;
    const auto at = [&](const char* key) { return std::string(term.attribute(key).value()); };
    const auto number = [&](const char* key) {
      const std::string cell = at(key);
      return cell.empty() ? 0.0 : NumberOrRefuse(cell, key, source, 0);
    };
    Row row{LowerCase(at("term_name")), LowerCase(at("vector_type")), LowerCase(at("tie_type")),
            LowerCase(at("c_units")), at("c_formula")};
    row.value = number("c_value");
    row.min_deg = number("min_range");
    row.max_deg = number("max_range");
    row.order = number("sequence_no");
    rows.push_back(std::move(row));
  }
  RowsToModel(std::move(rows), source).Into(model);
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

Result<ErrorModel> ParseModelEdm(std::string_view text, const std::string& source,
                                 std::string_view tool) {
  try {
    return ReadEdm(text, source, tool);
  } catch (const ModelError& error) {
    return error.fault;
  } catch (const TextError& error) {
    return error.fault;
  }
}

}  // namespace wellgyro
