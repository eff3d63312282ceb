#include "cases.h"

#include <cmath>
#include <fstream>
#include <sstream>

#include <gtest/gtest.h>

#include "wellgyro/base/units.h"
#include "wellgyro/io/toml/error_model_file.h"
#include "wellgyro/trajectory/minimum_curvature.h"

namespace wellgyro::test {
namespace {

std::vector<std::string> Words(const std::string& line) {
  std::istringstream stream(line);
  std::vector<std::string> words;
  for (std::string word; stream >> word;) words.push_back(word);
  return words;
}

/// Lines of a case file whose first word is `kind`, without it.
std::vector<std::vector<std::string>> Lines(const std::string& name, const std::string& kind) {
  std::ifstream file(CasePath(name));
  EXPECT_TRUE(file) << name;
  std::vector<std::vector<std::string>> lines;
  for (std::string line; std::getline(file, line);) {
    std::vector<std::string> words = Words(line);
    if (words.empty() || words[0] != kind) continue;
    words.erase(words.begin());
    lines.push_back(std::move(words));
  }
  return lines;
}

}  // namespace

std::filesystem::path CasePath(const std::string& name) {
  return std::filesystem::path(WELLGYRO_DATA_DIR) / "../tests/uncertainty/cases" / name;
}

std::filesystem::path ModelPath(const std::string& name) {
  return std::filesystem::path(WELLGYRO_DATA_DIR) / "models" / (name + ".toml");
}

ErrorModel Model(const std::string& name) {
  Result<ErrorModel> model = ReadErrorModelFile(ModelPath(name));
  if (!model) {
    ADD_FAILURE() << name << " line " << model.fault().line << ": " << model.fault().text;
    return {};
  }
  return *std::move(model);
}

void AddDepths(std::vector<SurveyPoint>& survey) {
  std::vector<double> md, inclination, azimuth;
  for (const SurveyPoint& p : survey) {
    md.push_back(p.md);
    inclination.push_back(p.inclination);
    azimuth.push_back(p.azimuth);
  }
  std::vector<Eigen::Vector3d> position(survey.size());
  MinimumCurvature(md, inclination, azimuth, {0, 0, survey.front().tvd}, position);
  for (std::size_t k = 0; k < survey.size(); ++k) survey[k].tvd = position[k].z();
}

std::size_t CaseWell::StationAt(double md) const {
  std::size_t k = 0;
  while (k + 1 < survey.size() && survey[k].md / unit < md - 1e-6) ++k;
  EXPECT_NEAR(survey[k].md / unit, md, 0.6);
  return k;
}

CaseWell StandardWell(int number, const std::string& name) {
  CaseWell well;
  for (const auto& words : Lines(name, "well")) {
    if (std::stoi(words.at(0)) != number) continue;
    well.unit = words.at(1) == "ft" ? units::kFoot : 1;
    well.place.latitude = std::stod(words.at(2)) * units::kDeg;
    if (words.size() == 4) {
      well.place.convergence = std::stod(words.at(3)) * units::kDeg;
    } else {
      well.place.field = std::stod(words.at(3)) * units::kNanotesla;
      well.place.dip = std::stod(words.at(4)) * units::kDeg;
      well.place.declination = std::stod(words.at(5)) * units::kDeg;
    }
  }
  std::ifstream file(CasePath("iscwsa-well-" + std::to_string(number) + ".csv"));
  std::string line;
  std::getline(file, line);
  while (std::getline(file, line)) {
    for (char& c : line) c = c == ',' ? ' ' : c;
    const std::vector<std::string> words = Words(line);
    well.survey.push_back({std::stod(words.at(0)) * well.unit, std::stod(words.at(1)) * units::kDeg,
                           std::stod(words.at(2)) * units::kDeg, 0});
  }
  AddDepths(well.survey);
  return well;
}

std::vector<std::vector<std::string>> CaseValues(const std::string& name) {
  return Lines(name, "value");
}

}  // namespace wellgyro::test
