#include "wellgyro/io/toml/error_model_file.h"

#include <cmath>
#include <filesystem>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "wellgyro/base/units.h"
#include "wellgyro/io/text_file.h"
#include "wellgyro/io/toml/model_catalogue.h"
#include "wellgyro/uncertainty/formula_weight.h"

namespace wellgyro {
namespace {

using testing::AllOf;
using testing::HasSubstr;

const std::filesystem::path kModels = std::filesystem::path(WELLGYRO_DATA_DIR) / "models";

constexpr const char* kGood = R"toml(format = "wellgyro.error-model/1"
name = "small"
revision = "1"
source = "nobody"
inclination_max_deg = 150.0
vertical_limit_deg = 0.0001
surface_tie_on = "doubled"

[stationary]
axes = "xy"
end_deg = 15.0
initialise_deg = 15.0
noise_reduction = 0.5

[[continuous]]
axes = "xy"
begin_deg = 15.0
end_deg = 150.0
speed_m_per_h = 3600.0

[[term]]
name = "GXY-B1S"
weight = "GXY-B1"
magnitude = 0.15
unit = "deg/h"
propagation = "systematic"

[[term]]
name = "GXY-GRW"
weight = "GXY-GRW"
magnitude = 0.25
unit = "deg/sqrt(h)"
propagation = "systematic"
)toml";

std::string With(std::string from, const std::string& to) {
  std::string text = kGood;
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return text.replace(at, from.size(), to);
}

TEST(ErrorModelFile, TakesEveryValueIntoSi) {
  const auto model = ReadErrorModel(kGood, "small.toml");
  ASSERT_TRUE(model) << model.fault().text;
  ASSERT_EQ(model->terms.size(), 2u);
  EXPECT_EQ(model->terms[0].weight, FindWeight("GXY-B1"));
  EXPECT_DOUBLE_EQ(model->terms[0].magnitude, 0.15 * units::kDegPerHour);
  EXPECT_DOUBLE_EQ(model->terms[1].magnitude, 0.25 * units::kDegPerSqrtHour);
  EXPECT_DOUBLE_EQ(model->continuous[0].speed, 1);
  EXPECT_DOUBLE_EQ(*model->stationary->initialise, 15 * units::kDeg);
  EXPECT_DOUBLE_EQ(model->max_inclination, 150 * units::kDeg);
}

TEST(ErrorModelFile, EveryModelOfTheProjectCanBeUsed) {
  int count = 0;
  for (const auto& entry : std::filesystem::directory_iterator(kModels)) {
    if (entry.path().extension() != ".toml") continue;
    const auto model = ReadErrorModelFile(entry.path());
    EXPECT_TRUE(model) << entry.path() << ":" << (model ? 0 : model.fault().line) << " "
                       << (model ? "" : model.fault().text);
    ++count;
  }
  EXPECT_EQ(count, 13);
}

struct Mistake {
  const char* from;
  const char* to;
  int line;
  const char* says;
};

// What a surveyor gets wrong in a model: each names line and term.
const Mistake kMistakes[] = {
    {"weight = \"GXY-B1\"", "weight = \"GXY-B9\"", 23, "term GXY-B1S"},
    {"weight = \"GXY-B1\"", "weight = \"GXY-B9\"", 23, "\"GXY-B9\""},
    {"weight = \"GXY-B1\"\n", "", 21, "term GXY-B1S"},
    {"unit = \"deg/h\"\n", "", 24, "without its 'unit'"},
    {"unit = \"deg/h\"\n", "", 24, "term GXY-B1S"},
    {"unit = \"deg/h\"", "unit = \"deg\"", 25, "deg/h"},
    {"unit = \"deg/h\"", "unit = \"deg\"", 25, "term GXY-B1S"},
    {"magnitude = 0.15\n", "", 21, "term GXY-B1S"},
    {"magnitude = 0.15", "magnitude = nan", 24, "term GXY-B1S"},
    {"magnitude = 0.15", "magnitude = -0.15", 24, "magnitude"},
    {"magnitude = 0.15", "magnitude = \"0.15\"", 24, "number"},
    {"propagation = \"systematic\"", "propagation = \"sometimes\"", 26, "sometimes"},
    {"propagation = \"systematic\"", "propagatoin = \"systematic\"", 26, "term GXY-B1S"},
    {"speed_m_per_h = 3600.0\n", "", 15, "speed_m_per_h"},
    {"initialise_deg = 15.0\n", "", 1, "initialise_deg"},
    {"end_deg = 15.0", "end_deg = 15.0\nend_deq = 3", 12, "end_deq"},
    {"GXY-GRW\"\nmagn", "GXYZ-GRW\"\nmagn", 28, "term GXY-GRW"},
    {"name = \"GXY-GRW\"", "name = \"GXY-B1S\"", 28, "twice"},
    {"name = \"GXY-GRW\"", "name = \"A,B\"", 29, "plain"},
    {"GXY-GRW\"\nmagnitude = 0.25\nunit = \"deg/sqrt(h)", "GXY-RN\"\nmagnitude = 1\nunit = \"deg/h",
     0, ""},
    {"/1\"", "/2\"", 1, "wellgyro.error-model/2"},
    {"surface_tie_on = \"doubled\"\n", "", 1, "surface_tie_on"},
};

TEST(ErrorModelFile, NamesFileLineAndTerm) {
  for (const Mistake& mistake : kMistakes) {
    const auto model = ReadErrorModel(With(mistake.from, mistake.to), "small.toml");
    if (mistake.line == 0) {
      EXPECT_TRUE(model) << mistake.to;
      continue;
    }
    ASSERT_FALSE(model) << mistake.to;
    EXPECT_THAT(model.fault().text, HasSubstr(mistake.says)) << mistake.to;
    EXPECT_EQ(model.fault().line, mistake.line) << mistake.to << ": " << model.fault().text;
    EXPECT_EQ(model.fault().source, "small.toml");
  }
}

TEST(ErrorModelFile, MissingParametersOfTerms) {
  const auto without = [](const std::string& file, const std::string& key) {
    std::string text = *ReadTextFile(kModels / file);
    const std::size_t at = text.find(key);
    EXPECT_NE(at, std::string::npos) << key;
    text.erase(at, text.find('\n', at) - at);
    const auto model = ReadErrorModel(text, file);
    return model ? std::string("accepted") : model.fault().text;
  };
  EXPECT_THAT(without("GYRO-NS.toml", "min_course_length_m"),
              AllOf(HasSubstr("term XYM3E"), HasSubstr("min_course_length_m")));
  EXPECT_THAT(without("GYRO-NS.toml", "tortuosity"),
              AllOf(HasSubstr("term XCLA"), HasSubstr("tortuosity")));
  EXPECT_THAT(without("GYRO-NS.toml", "noise_reduction ="),
              AllOf(HasSubstr("term GXY-RN"), HasSubstr("noise_reduction")));
  EXPECT_THAT(without("spe90408-1.toml", "cant_deg"),
              AllOf(HasSubstr("term AXY-B"), HasSubstr("cant_deg")));
  EXPECT_THAT(without("spe90408-4.toml", "min_distance_m"), HasSubstr("min_distance_m"));
}

/// A number to the last bits: degrees and hours are taken out and put in again.
void ExpectNear(double a, double b, const std::string& what) {
  EXPECT_NEAR(a, b, 1e-14 * std::abs(b)) << what;
}

void ExpectSameTerms(const ErrorModel& a, const ErrorModel& b) {
  ASSERT_EQ(a.terms.size(), b.terms.size());
  for (std::size_t i = 0; i < a.terms.size(); ++i) {
    EXPECT_EQ(a.terms[i].name, b.terms[i].name);
    EXPECT_EQ(a.terms[i].weight, b.terms[i].weight);
    EXPECT_EQ(a.terms[i].propagation, b.terms[i].propagation);
    EXPECT_EQ(a.terms[i].unit, b.terms[i].unit);
    ExpectNear(a.terms[i].magnitude, b.terms[i].magnitude, b.name + " " + b.terms[i].name);
  }
}

TEST(ErrorModelFile, WhatIsWrittenIsReadBack) {
  for (const ErrorModel& model : OwnModels()) {
    const auto text = WriteErrorModel(model);
    ASSERT_TRUE(text) << text.fault().text;
    const auto again = ReadErrorModel(*text, model.name);
    ASSERT_TRUE(again) << model.name << ": " << again.fault().text;
    EXPECT_EQ(again->source, model.source);
    EXPECT_EQ(again->doubled_tie_on, model.doubled_tie_on);
    ExpectNear(again->max_inclination, model.max_inclination, model.name);
    ExpectNear(again->cant.value_or(0), model.cant.value_or(0), model.name);
    ExpectNear(again->tortuosity.value_or(0), model.tortuosity.value_or(0), model.name);
    ExpectNear(again->min_course_length.value_or(0), model.min_course_length.value_or(0),
               model.name);
    ASSERT_EQ(again->stationary.has_value(), model.stationary.has_value());
    if (model.stationary) {
      EXPECT_EQ(again->stationary->axes, model.stationary->axes);
      EXPECT_EQ(again->stationary->noise_reduction_at_stations,
                model.stationary->noise_reduction_at_stations);
      ExpectNear(again->stationary->initialise.value_or(-9),
                 model.stationary->initialise.value_or(-9), model.name);
    }
    ASSERT_EQ(again->continuous.size(), model.continuous.size());
    for (std::size_t i = 0; i < model.continuous.size(); ++i) {
      ExpectNear(again->continuous[i].end, model.continuous[i].end, model.name);
      ExpectNear(again->continuous[i].speed, model.continuous[i].speed, model.name);
    }
    ExpectSameTerms(*again, model);
  }
}

TEST(ErrorModelFile, RemarksStandBesideTheirTerms) {
  const auto model = ReadErrorModel(kGood, "small.toml");
  const std::string remarks[] = {"", "assumed 0.3"};
  const auto text = WriteErrorModel(*model, remarks);
  ASSERT_TRUE(text);
  EXPECT_GT(text->find("# assumed 0.3"), text->find("GXY-B1S"));
  EXPECT_LT(text->find("# assumed 0.3"), text->find("GXY-GRW"));
  EXPECT_TRUE(ReadErrorModel(*text, "again.toml"));
}

TEST(ErrorModelFile, AFormulaOfItsOwnIsNotWritten) {
  ErrorModel model = *ReadErrorModel(kGood, "small.toml");
  FormulaTexts texts;
  texts.azimuth = "2";
  const auto formula = FormulaWeight::Compile(texts);
  ASSERT_TRUE(formula);
  model.terms[1].formula = *formula;
  const auto text = WriteErrorModel(model);
  ASSERT_FALSE(text);
  EXPECT_THAT(text.fault().text, HasSubstr("GXY-GRW"));
}

}  // namespace
}  // namespace wellgyro
