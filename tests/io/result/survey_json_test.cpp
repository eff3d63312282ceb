#include "wellgyro/io/result/survey_json.h"

#include <string>

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

namespace wellgyro {
namespace {

using nlohmann::json;
using testing::HasSubstr;

constexpr const char* kColumns =
    "MD[m],INC[deg],AZI_TRUE[deg],GTF[deg],TVD[m],N[m],E[m],DLS[deg/30m],VAR_NN[m2],COV_NE[m2],"
    "COV_NV[m2],VAR_EE[m2],COV_EV[m2],VAR_VV[m2],SIG_INC[deg],SIG_AZI[deg],KIND,QUALITY";

ResultTexts Whole() {
  const std::string columns(kColumns);
  ResultTexts texts;
  texts["run.toml"] =
      "format = \"wellgyro.run/1\"\n[well]\nname = \"W\"\n[verdict]\nverdict = \"pass\"\n"
      "[[input]]\nrole = \"job\"\nname = \"j\"\ntext = \"\"\"\n[grid]\nutm_zone = "
      "\"31N\"\n\"\"\"\n";
  texts["survey.csv"] =
      columns + ",AZI_GRID[deg],NORTHING[m],EASTING[m]\n" +
      "0.0000,0.1,0.500000,0,0,0,0,0,0,0,0,0,0,0,0,0,tie_in,good,359.000000,0,0\n"
      "100.1000,1.000001,90,0,100.0001,0,1,0.3,9,0,0,1,0,4,0.01,0.2,continuous,good,88.5,0,0\n";
  texts["passes.csv"] =
      "RUN,PASS,STATUS,REVISION," + columns + "\n" +
      "1,in,field,1,100,20,359.9,0,0,0,0,0,0,0,0,0,0,0,0.03,0.3,continuous,good\n"
      "1,in,field,1,110,20,10,0,0,0,0,0,0,0,0,0,0,0,0.03,0.3,continuous,good\n"
      "1,out,field,1,100,20.4,0.1,0,0,0,0,0,0,0,0,0,0,0,0.04,0.4,continuous,good\n"
      "2,out,field,1,110,21,0,0,0,0,0,0,0,0,0,0,0,0,,,continuous,unfit\n";
  texts["checks.csv"] =
      "CODE,RUN,PASS,MD[m],VALUE,SIGMA,LIMIT,UNIT,LIMIT_SOURCE,VERDICT\n"
      "fit,1,,,1.5,,2,1,\"a, \"\"b\"\"\nc\",pass\n";
  return texts;
}

json Parsed(const ResultTexts& texts) {
  const Result<std::string> document = SurveyJson(texts);
  return document ? json::parse(*document) : json(document.fault().text);
}

TEST(SurveyJson, HoldsTheNumbersOfTheFiles) {
  const json document = Parsed(Whole());
  EXPECT_EQ(document["format"], "wellgyro.survey/1");
  const json& row = document["stations"]["rows"][1];
  EXPECT_EQ(row[0], 100.1);
  EXPECT_EQ(row[1], 1.000001);
  EXPECT_EQ(row[16], "continuous");
  EXPECT_EQ(document["run"]["well"]["name"], "W");
  EXPECT_FALSE(document["run"]["input"][0].contains("text"));
  EXPECT_TRUE(document["diagnosis"].is_null());
  // A unit that looks like a number is a word; a quoted cell may go over lines.
  EXPECT_EQ(document["checks"]["rows"][0],
            json::parse(R"(["fit", 1, null, null, 1.5, null, 2, "1", "a, \"b\"\nc", "pass"])"));
}

TEST(SurveyJson, ConvergenceAndEndAreComputed) {
  const json document = Parsed(Whole());
  EXPECT_EQ(document["north"]["grid"], "UTM 31N");
  EXPECT_DOUBLE_EQ(document["north"]["convergence_deg"].get<double>(), 1.5);
  EXPECT_EQ(document["north"]["convergence_source"], "projection");
  const json& ellipse = document["end"]["ellipse"];
  // Sigmas 3 and 1 m in the plane, 2 m down; factors of the chi-square distribution's tables.
  EXPECT_NEAR(ellipse["semi_major_m"].get<double>(), 3 * 2.4477, 1e-3);
  EXPECT_NEAR(ellipse["semi_minor_m"].get<double>(), 2.4477, 1e-3);
  EXPECT_NEAR(ellipse["azimuth_major_deg"].get<double>(), 0, 1e-9);
  EXPECT_NEAR(ellipse["vertical_half_m"].get<double>(), 2 * 1.95996, 1e-4);
}

TEST(SurveyJson, AnEndWithoutACovarianceHasNoEllipse) {
  ResultTexts texts = Whole();
  texts["survey.csv"] = std::string(kColumns) +
                        "\n0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,tie_in,good\n"
                        "10,1,0,0,10,0,0,0,,,,,,,,,continuous,unfit\n";
  const json document = Parsed(texts);
  EXPECT_TRUE(document["end"]["ellipse"].is_null());
  EXPECT_EQ(document["end"]["MD[m]"], 10);
  EXPECT_TRUE(document["north"]["convergence_deg"].is_null());
}

TEST(SurveyJson, PassesOfARunAreComparedWhereBothHaveADepth) {
  const json document = Parsed(Whole());
  ASSERT_EQ(document["pass_differences"].size(), 1u);
  const json& pair = document["pass_differences"][0];
  EXPECT_EQ(pair["run"], 1);
  EXPECT_EQ(pair["other"], "out");
  EXPECT_EQ(pair["rows"], json::parse("[[100, 20, 0.4, 0.2, 0.05, 0.5]]"));
}

TEST(SurveyJson, IsTheSameTwice) { EXPECT_EQ(*SurveyJson(Whole()), *SurveyJson(Whole())); }

TEST(SurveyJson, SaysWhichFileIsWrongAndWhere) {
  ResultTexts texts = Whole();
  texts["checks.csv"] += "fit,1\n";
  const auto short_row = SurveyJson(texts);
  ASSERT_FALSE(short_row);
  EXPECT_EQ(short_row.fault().source, "checks.csv");
  EXPECT_EQ(short_row.fault().line, 4);  // a cell above it goes over two
  texts = Whole();
  texts["checks.csv"] += "\"fit,1\n";
  ASSERT_FALSE(SurveyJson(texts));
  texts = Whole();
  texts["run.toml"] = "format = \n";
  const auto broken = SurveyJson(texts);
  ASSERT_FALSE(broken);
  EXPECT_EQ(broken.fault().line, 1);
  texts["run.toml"] = "format = \"wellgyro.job/1\"\n";
  EXPECT_THAT(SurveyJson(texts).fault().text, HasSubstr("wellgyro.run/1"));
  texts.erase("survey.csv");
  EXPECT_EQ(SurveyJson(texts).fault().source, "survey.csv");
}

TEST(SurveyJson, WhatIsNoUtf8IsShownAsSuch) {
  ResultTexts texts = Whole();
  texts["checks.csv"] += "fit,1,,,,,,,\xff\xfe,pass\n";
  EXPECT_EQ(Parsed(texts)["checks"]["rows"][1][8], "\uFFFD\uFFFD");
}

TEST(SurveyJson, AnotherWellIsSummed) {
  const OtherWell other{"beside", "MD[m],INC[deg],AZI_TRUE[deg]\n0,90,0\n100,90,0\n"};
  const auto document = SurveyJson(Whole(), {&other, 1});
  ASSERT_TRUE(document) << document.fault().text;
  const json well = json::parse(*document)["others"][0];
  EXPECT_EQ(well["name"], "beside");
  EXPECT_NEAR(well["rows"][1][1].get<double>(), 100, 1e-9);
}

}  // namespace
}  // namespace wellgyro
