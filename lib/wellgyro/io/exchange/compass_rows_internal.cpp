#include "wellgyro/io/exchange/compass_rows_internal.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <map>
#include <utility>

#include "wellgyro/base/units.h"
#include "wellgyro/io/exchange/model_terms_internal.h"
#include "wellgyro/io/text_internal.h"

namespace wellgyro {
namespace {

constexpr std::size_t kMostRows = 2000;  // of a file from outside; a tool has dozens
constexpr std::size_t kLongest = 4000;   // characters of a formula with its values put in

/// Compass speaks of gyro rates in degrees where its formulas divide by a rate per hour.
double UnitOf(const CompassRow& row, const std::string& source) {
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
void AddComponent(FormulaTexts& texts, const CompassRow& row, const std::string& formula,
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
  RowsToModel(std::vector<CompassRow> rows, const std::string& source)
      : rows_(std::move(rows)), source_(source) {
    std::ranges::stable_sort(rows_, {}, &CompassRow::order);
  }

  void Into(ErrorModel& model) {
    if (rows_.empty()) RefuseModel(source_, "has no row of terms");
    if (rows_.size() > kMostRows) RefuseModel(source_, "has more than 2000 rows");
    for (CompassRow& row : rows_) {
      Resolve(row);
      if (row.tie_on == "n") {
        values_.emplace_back(
            row.name, Significant17(row.value * UnitOf(row, source_)) + "*(" + row.formula + ")");
      } else {
        groups_[{row.name, row.tie_on}].push_back(&row);
      }
    }
    // In the file's order.
    for (const CompassRow& row : rows_) {
      if (row.tie_on == "n") continue;
      const auto& group = groups_[{row.name, row.tie_on}];
      if (group.front() == &row) model.terms.push_back(Term(group));
    }
  }

 private:
  void Resolve(CompassRow& row) {
    row.formula = Lower(row.formula);
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

  ErrorTerm Term(const std::vector<CompassRow*>& group) {
    const CompassRow& first = *group.front();
    const auto propagation = ModelPropagation(first.tie_on);
    if (!propagation || first.tie_on.size() != 1) {
      RefuseModel(source_, "term " + first.name + ": no tie-on is called '" + first.tie_on + "'",
                  first.line);
    }
    FormulaTexts texts;
    for (const CompassRow* row : group) {
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

  std::vector<CompassRow> rows_;
  const std::string& source_;
  std::vector<std::pair<std::string, std::string>> values_;
  std::map<std::pair<std::string, std::string>, std::vector<CompassRow*>> groups_;
};

}  // namespace

double NumberOrRefuse(const std::string& text, const std::string& what, const std::string& source,
                      int line) {
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size() || !std::isfinite(value)) {
    RefuseModel(source, what + " '" + text + "' is no number", line);
  }
  return value;
}

void TermsOfRows(std::vector<CompassRow> rows, const std::string& source, ErrorModel& model) {
  RowsToModel(std::move(rows), source).Into(model);
}

}  // namespace wellgyro
