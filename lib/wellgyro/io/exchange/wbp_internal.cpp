#include "wellgyro/io/exchange/wbp_internal.h"

#include <string>
#include <vector>

#include "wellgyro/base/units.h"
#include "wellgyro/io/exchange/column_units_internal.h"
#include "wellgyro/io/exchange/table_builder_internal.h"
#include "wellgyro/io/text_internal.h"

namespace wellgyro {
namespace {

// Well plans of Landmark's .wbp files: lines of a letter, a colon and numbers. "P:" a point of the
// plan and "S:" a surveyed one (MD, azimuth, inclination), "L:" where it is (east, north, up), "W:"
// the plan that they belong to. "DEPTH n" says which of feet and metres hold across and in depth.
class WbpReader {
 public:
  WbpReader(LineReader& lines, const ReadOptions& options) : lines_(lines), options_(options) {}

  SurveyTable Read() {
    std::string_view line;
    while (lines_.Next(line)) {
      const std::string_view text = Trim(line);
      if (text.empty() || text.front() == '!') continue;
      if (text.starts_with("DEPTH")) {
        TakeUnits(Trim(text.substr(5)));
      } else if (text.starts_with("WELLPLANS:")) {
        plans_ = true;
      } else if (plans_ && text.size() > 1 && text[1] == ':') {
        Take(text[0], line.substr(line.find(':') + 1));
      }
    }
    Conclude();
    return std::move(build_.table);
  }

 private:
  void TakeUnits(std::string_view key) {
    const auto number = IntegerOf(key);
    if (!number || *number < 1 || *number > 4) {
      lines_.Complain(FaultCode::kSyntax, "units 1 to 4 are known after DEPTH");
    }
    SurveyHead& head = build_.table.head;
    const bool feet_across = *number == 1 || *number == 3, feet_deep = *number == 1 || *number == 4;
    head.grid_unit = feet_across ? LengthUnit::kFoot : LengthUnit::kMetre;
    head.md_unit = feet_deep ? LengthUnit::kFoot : LengthUnit::kMetre;
    units_ = true;
  }

  void Take(char letter, std::string_view rest) {
    if (letter == 'W') return TakePlan(rest);
    if (!chosen_) return;
    if (letter == 'P') TakePoint(rest, RowStatus::kPlanned);
    if (letter == 'S') TakePoint(rest, RowStatus::kSurveyed);
    if (letter == 'L') TakePlace(rest);
    covariances_ = covariances_ || letter == 'X';
  }

  // The names stand in columns 24 to 84 and 85 to 144 of the line, whose first two are "W:".
  void TakePlan(std::string_view rest) {
    const std::string name(rest.size() > 21 ? Trim(rest.substr(21, 61)) : std::string_view());
    names_.push_back(name);
    chosen_ = options_.trajectory.empty() ? names_.size() == 1 : name == options_.trajectory;
    if (chosen_) build_.table.head.names.survey = name;
    if (names_.size() > 10'000) lines_.Complain(FaultCode::kSize, "more than 10 000 plans");
  }

  std::vector<double> Numbers(std::string_view rest, std::size_t least) const {
    std::vector<std::string_view> fields;
    Split(rest, ' ', fields);
    if (fields.size() < least) lines_.Complain(FaultCode::kSyntax, "the line is cut short");
    std::vector<double> numbers;
    for (std::size_t i = 0; i < least; ++i) {
      const auto number = NumberOf(fields[i]);
      if (!number) {
        lines_.Complain(FaultCode::kSyntax,
                        "'" + std::string(fields[i].substr(0, 40)) + "' is not a number");
      }
      numbers.push_back(*number);
    }
    return numbers;
  }

  void TakePoint(std::string_view rest, RowStatus status) {
    if (!units_) lines_.Complain(FaultCode::kSyntax, "no line DEPTH says the units");
    const std::vector<double> p = Numbers(rest, 3);
    planned_ = planned_ || status == RowStatus::kPlanned;
    const auto problem =
        build_.Add(p[0] * FactorOf(build_.table.head.md_unit), InclinationOf(p[2], units::kDeg),
                   AzimuthOf(p[1], units::kDeg), status);
    if (problem) lines_.Complain(problem->code, problem->text);
    points_ = true;
  }

  void TakePlace(std::string_view rest) {
    if (!points_) return;
    const std::vector<double> p = Numbers(rest, 3);
    const double across = FactorOf(build_.table.head.grid_unit);
    build_.Set(Column::kEasting, p[0] * across);
    build_.Set(Column::kNorthing, p[1] * across);
    build_.Set(Column::kDown, -p[2] * FactorOf(build_.table.head.md_unit));
  }

  void Conclude() {
    std::string names;
    for (const std::string& name : names_) AddName(name, names);
    if (options_.trajectory.empty() && names_.size() > 1) {
      lines_.Complain(FaultCode::kConflict,
                      "well plans in it: " + names + "; say which by --trajectory");
    }
    if (build_.table.rows() == 0) {
      lines_.Complain(FaultCode::kForeign,
                      options_.trajectory.empty()
                          ? "not a single point of a plan"
                          : "no plan is called " + options_.trajectory + ": it has " + names);
    }
    if (const auto problem = build_.Finish()) lines_.Complain(problem->code, problem->text);
    SurveyHead& head = build_.table.head;
    head.planned = planned_;
    if (covariances_) {
      head.notes.emplace_back(
          "covariances of its surveyed points are left out: which of their "
          "axes is north is not published");
    }
    head.notes.emplace_back("nothing in it says where the plan ends: a cut could not be seen");
  }

  LineReader& lines_;
  const ReadOptions& options_;
  TableBuilder build_;
  std::vector<std::string> names_;
  bool units_ = false, plans_ = false, chosen_ = false, points_ = false;
  bool planned_ = false, covariances_ = false;
};

}  // namespace

bool IsWbp(std::string_view head) { return head.find("\nWELLPLANS:") != std::string_view::npos; }

SurveyTable ReadWbp(LineReader& lines, const ReadOptions& options) {
  return WbpReader(lines, options).Read();
}

}  // namespace wellgyro
