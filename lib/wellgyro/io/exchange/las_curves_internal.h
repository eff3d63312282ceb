#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "wellgyro/io/exchange/headings_internal.h"
#include "wellgyro/io/exchange/table_build_internal.h"

namespace wellgyro::las {

/// A header line: MNEM.UNIT DATA : DESCRIPTION, parted at the first dot, the first blank after it
/// and the last colon.
struct Line {
  std::string mnemonic, unit, data;
};
/// Nothing where the line has no dot.
std::optional<Line> LineOf(std::string_view line);

/// A column of section ~A.
struct Curve {
  std::optional<Column> column;  ///< absent: none of a survey's
  Quantity quantity = Quantity::kNumber;
  double factor = 1;  ///< from its unit to SI
};

/// The curves that section ~C names: which column each is, in which unit, from which north; by the
/// caller's options where they say so.
class Curves {
 public:
  Curves(LineReader& lines, const ReadOptions& options, Claims& claims)
      : lines_(lines), options_(options), claims_(claims) {}

  /// The next curve. What it says of units and north goes into `head`. `index_unit`: that of STRT,
  /// STOP and STEP, which with `its_own` are those of the survey's index.
  void Add(const Line& line, const std::string& index_unit, bool its_own, SurveyHead& head);
  /// Complains where the curves make no survey, or an option named none of them.
  void Check(SurveyHead& head);
  /// Forgets them all.
  void Clear();

  const std::vector<Curve>& all() const { return curves_; }
  /// Whether one of them is this column.
  bool Has(Column column) const;
  /// Depth, inclination and azimuth.
  bool MakeSurvey() const;

 private:
  /// What section ~W says of the index.
  struct Index {
    std::string unit;
    bool its_own = true;
  };

  void TakeOption(Heading& heading, const Line& line) const;
  void TakeCurve(Curve& curve, Column column, std::string unit, const Index& index,
                 SurveyHead& head);
  void TakeIndexUnit(std::optional<LengthUnit> unit, const Index& index);
  void WithoutUnit(Curve& curve, Column column, const Index& index, SurveyHead& head) const;
  void TakeNorth(North north, bool told, SurveyHead& head) const;
  std::optional<Column> AzimuthColumn(North north, SurveyHead& head);

  LineReader& lines_;
  const ReadOptions& options_;
  Claims& claims_;
  std::vector<Curve> curves_;
  std::vector<Heading> headings_;
  std::optional<LengthUnit> md_unit_;  ///< the file's, whatever an option says
  bool azimuth_seen_ = false;          ///< the first of two is the survey's
};

}  // namespace wellgyro::las
