// Wells whose positions others published, against ours. The files stay outside the project.
#include <array>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "wellgyro/base/units.h"
#include "wellgyro/trajectory/leg_geometry.h"
#include "wellgyro/trajectory/trajectory.h"

namespace wellgyro {
namespace {

const std::string kWells = WELLGYRO_REFERENCE_DIR "/wells/";

bool Absent(const std::string& name) { return !std::filesystem::exists(kWells + name); }

using Rows = std::vector<std::vector<double>>;

// Numbers of a delimited file, rows without any left out; a decimal comma where fields are parted
// by tabs.
Rows Numbers(const std::string& name, char delimiter, std::size_t columns) {
  Rows rows;
  std::ifstream file(kWells + name);
  std::string line;
  while (std::getline(file, line)) {
    if (delimiter == '\t') {
      for (char& c : line) c = c == ',' ? '.' : c;
    }
    std::istringstream cells(line);
    std::string cell;
    std::vector<double> row;
    while (std::getline(cells, cell, delimiter)) {
      double value = 0;
      const auto [end, error] = std::from_chars(cell.data(), cell.data() + cell.size(), value);
      if (error == std::errc()) row.push_back(value);
    }
    if (row.size() >= columns) rows.push_back(row);
  }
  return rows;
}

struct Survey {
  std::vector<double> md, inclination, azimuth;
};

Survey SurveyOf(const Rows& rows, double unit) {
  Survey s;
  for (const auto& row : rows) {
    s.md.push_back(row[0] * unit);
    s.inclination.push_back(FromDegrees(row[1]));
    s.azimuth.push_back(FromDegrees(row[2]));
  }
  return s;
}

// ISCWSA standard wells, TVD to 0.01 in the file's own unit. The stations at joints of the design
// are printed to 0.01 in angle and depth, which leaves up to 0.01 a leg and 0.036 at the end.
TEST(ReferenceWells, IscwsaStandardPaths) {
  for (const int well : {1, 2, 3}) {
    const std::string name = "iscwsa-" + std::to_string(well) + ".txt";
    if (Absent(name)) GTEST_SKIP() << "the reference data are not here";
    const Rows rows = Numbers(name, '\t', 4);
    ASSERT_GT(rows.size(), 50u);
    const Survey s = SurveyOf(rows, 1);
    const Trajectory path(s.md, s.inclination, s.azimuth, {0, 0, rows[0][3]});
    double worst = 0;
    for (std::size_t i = 0; i < rows.size(); ++i) {
      worst = std::max(worst, std::abs(path.station(i).position_W.z() - rows[i][3]));
    }
    EXPECT_LT(worst, well == 1 ? 0.0051 : 0.037) << "well " << well;
    RecordProperty("iscwsa_" + std::to_string(well), std::to_string(worst));
  }
}

// A Compass report of 80 stations, printed to two decimals: angles rounded so gather centimetres.
TEST(ReferenceWells, ACompassReport) {
  const std::string name = "wellpathpy/Well_Surveys_Projected_to_TD.csv";
  if (Absent(name)) GTEST_SKIP() << "the reference data are not here";
  const Rows rows = Numbers(name, ',', 7);
  ASSERT_GT(rows.size(), 10u);
  const Survey s = SurveyOf(rows, 1);
  const Trajectory path(s.md, s.inclination, s.azimuth, {0, 0, 0});
  double horizontal = 0, vertical = 0, section = 0;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const Eigen::Vector3d p = path.station(i).position_W;
    vertical = std::max(vertical, std::abs(p.z() - rows[i][3]));
    horizontal = std::max(horizontal, std::hypot(p.x() - rows[i][4], p.y() - rows[i][5]));
    // The plane of section is printed in its footnote.
    if (rows[i].size() > 7) {
      section = std::max(
          section, std::abs(VerticalSection(p.x(), p.y(), FromDegrees(302.38)) - rows[i].back()));
    }
  }
  EXPECT_LT(vertical, 0.04);
  EXPECT_LT(horizontal, 0.06);
  EXPECT_LT(section, 3.0);  // the report's own section is off its own north and east by metres
  const Closure closure = ClosureOf(path.station(rows.size() - 3).position_W.x(),
                                    path.station(rows.size() - 3).position_W.y());
  EXPECT_GT(closure.distance, 800);
}

// The array after `key` in the piece of JSON that begins at `from`.
std::vector<double> ArrayAfter(const std::string& json, const std::string& key, std::size_t from) {
  std::vector<double> values;
  std::size_t at = json.find('[', json.find("\"" + key + "\"", from)) + 1;
  while (json[at] != ']') {
    if (json[at] == '-' || (json[at] >= '0' && json[at] <= '9')) {
      double value = 0;
      const char* end = std::from_chars(&json[at], &json[json.size() - 1], value).ptr;
      at += static_cast<std::size_t>(end - &json[at]);
      values.push_back(value);
    } else {
      ++at;
    }
  }
  return values;
}

// ISCWSA's twelve clearance wells: attitudes to 0.01 deg or better, positions printed to 0.01 m.
TEST(ReferenceWells, IscwsaClearanceWells) {
  std::ifstream file(kWells + "clearance_iscwsa_well_data.json");
  if (!file) GTEST_SKIP() << "the reference data are not here";
  std::stringstream text;
  text << file.rdbuf();
  const std::string json = text.str();
  int wells = 0;
  for (std::size_t at = json.find("\"MD\""); at != std::string::npos;
       at = json.find("\"MD\"", at + 1)) {
    const std::vector<double> md = ArrayAfter(json, "MD", at);
    std::vector<double> inclination = ArrayAfter(json, "IncDeg", at);
    std::vector<double> azimuth = ArrayAfter(json, "AziDeg", at);
    const std::vector<double> tvd = ArrayAfter(json, "TVD", at);
    const std::vector<double> north = ArrayAfter(json, "N", at), east = ArrayAfter(json, "E", at);
    for (double& x : inclination) x = FromDegrees(x);
    for (double& x : azimuth) x = FromDegrees(x);
    const Trajectory well(md, inclination, azimuth, {north[0], east[0], tvd[0]});
    double worst = 0;
    for (std::size_t i = 0; i < md.size(); ++i) {
      const Eigen::Vector3d truth(north[i], east[i], tvd[i]);
      worst = std::max(worst, (well.station(i).position_W - truth).cwiseAbs().maxCoeff());
    }
    EXPECT_LT(worst, 0.0101) << "well " << wells;
    ++wells;
  }
  EXPECT_EQ(wells, 12);
}

// wellpathpy's table for one survey, leg by leg. Left out is what does not follow its own method's
// formula there: the average angle's east (half the sine of the sum for the sine of half of it) and
// all of radius of curvature, which classic_methods_test holds to the printed formula. Its minimum
// curvature takes two terms of the ratio factor's series. It averages azimuths as they stand.
TEST(ReferenceWells, ClassicMethods) {
  if (Absent("wellpathpy/mock_data_set.csv")) GTEST_SKIP() << "the reference data are not here";
  const Rows rows = Numbers("wellpathpy/mock_data_set.csv", ',', 26);
  ASSERT_GT(rows.size(), 10u);
  const Survey s = SurveyOf(rows, 1);
  struct Case {
    SurveyMethod method;
    std::size_t column;
    Eigen::Vector3d tolerance;
  };
  const Eigen::Vector3d tight(1e-11, 1e-11, 1e-11);
  for (const Case& c : {Case{SurveyMethod::kTangential, 3, tight},
                        Case{SurveyMethod::kAverageAngle, 9, {1e-11, 1, 1e-11}},
                        Case{SurveyMethod::kBalancedTangential, 12, tight},
                        Case{SurveyMethod::kMinimumCurvature, 18, {3e-7, 3e-7, 3e-7}}}) {
    std::vector<Eigen::Vector3d> position(s.md.size());
    PositionsBy(c.method, s.md, s.inclination, s.azimuth, {0, 0, 0}, position);
    int compared = 0;
    for (std::size_t i = 1; i < rows.size(); ++i) {
      if (std::abs(rows[i][2] - rows[i - 1][2]) > 180) continue;
      for (const int k : {0, 1, 2}) {
        const std::size_t column = c.column + static_cast<std::size_t>(k);
        EXPECT_NEAR(position[i][k] - position[i - 1][k], rows[i][column] - rows[i - 1][column],
                    c.tolerance[k])
            << "column " << column << ", leg " << i;
      }
      ++compared;
    }
    EXPECT_GT(compared, 90);
  }
}

}  // namespace
}  // namespace wellgyro
