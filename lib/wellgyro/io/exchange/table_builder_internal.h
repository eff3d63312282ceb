#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "wellgyro/base/result.h"
#include "wellgyro/record/survey_table.h"

namespace wellgyro {

/// Whether a row with it is a station of the path.
inline bool OnPath(RowStatus status) { return status != RowStatus::kUnused; }

/// Adds stations to a table with the checks and repairs that every format shares. Complaints come
/// back as text for the caller to give its place; repairs are noted in the head.
///
/// Depth must change one way along the path: a survey from the bottom up is turned round. A row
/// that repeats the one before it is left out, as is one without inclination. Without azimuth, a
/// station keeps its neighbour's where the hole is vertical to 0.05 deg; elsewhere its azimuth is
/// interpolated against depth, and its status says so.
class TableBuilder {
 public:
  struct Problem {
    FaultCode code;
    std::string text;
  };

  SurveyTable table;

  /// `md` [m], angles [rad], empty where the file has none or a number that stands for nothing.
  std::optional<Problem> Add(double md, std::optional<double> inclination,
                             std::optional<double> azimuth,
                             RowStatus status = RowStatus::kSurveyed);
  /// Of the row last added; nothing happens where that was left out.
  void Set(Column column, double value);
  void Set(TextColumn column, std::string text);
  void SetStatus(RowStatus status);

  /// The table, whole. A problem where there is no azimuth at all.
  std::optional<Problem> Finish();

 private:
  std::optional<Problem> Bounds(double md, double inclination) const;
  std::optional<Problem> Order(double md, double inclination, std::optional<double> azimuth);
  void FillAzimuth(std::size_t row);
  void FillAzimuths();

  std::optional<double> last_md_, last_inclination_, last_azimuth_;
  std::vector<std::size_t> without_azimuth_;
  std::size_t repeated_ = 0, without_inclination_ = 0, text_bytes_ = 0;
  int direction_ = 0;
  bool left_out_ = false;
};

/// An inclination [rad], or none for the numbers that logs write for nothing (-999.25, -9999 ...).
std::optional<double> InclinationOf(double number, double factor);
/// An azimuth [rad] in [0, 2 pi), or none for those and for what lies outside +-360 deg.
std::optional<double> AzimuthOf(double number, double factor);
/// Where `rows` lie, in words: "MD 30.00 m", or how many from which depth to which.
std::string RowsText(const SurveyTable& table, const std::vector<std::size_t>& rows);
/// Whether a number is one that files write for nothing: -999.25, -999, -9999 ...
bool StandsForNothing(double number);

}  // namespace wellgyro
