#include "wellgyro/io/exchange/model_files.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <tuple>
#include <vector>

#include <gmock/gmock.h>

#include "wellgyro/base/units.h"
#include "wellgyro/io/toml/model_catalogue.h"
#include "wellgyro/uncertainty/propagate.h"

namespace wellgyro {
namespace {

using testing::HasSubstr;

std::vector<SurveyPoint> Hole() {
  std::vector<SurveyPoint> survey;
  for (int k = 0; k <= 60; ++k) {
    const double inclination = std::max(0.0, k - 10.0) * 1.2 * units::kDeg;
    survey.push_back({30.0 * k, inclination, (40 + 0.5 * k) * units::kDeg, 28.0 * k});
  }
  return survey;
}

Surroundings Place() {
  Surroundings place;
  place.latitude = 60 * units::kDeg;
  place.field = 50000 * units::kNanotesla;
  place.dip = 70 * units::kDeg;
  place.declination = -3 * units::kDeg;
  return place;
}

/// Largest difference of covariances over the largest trace.
double Gap(const ErrorModel& a, const ErrorModel& b) {
  const auto one = PropagateErrors(Hole(), Place(), a), two = PropagateErrors(Hole(), Place(), b);
  EXPECT_EQ(one.cov_p_W.size(), two.cov_p_W.size());
  double gap = 0;
  for (std::size_t k = 0; k < std::min(one.cov_p_W.size(), two.cov_p_W.size()); ++k) {
    gap = std::max(gap, (one.cov_p_W[k] - two.cov_p_W[k]).norm() / (1e-9 + two.cov_p_W[k].trace()));
  }
  // Nothing is compared that is nothing: each term alone moves the end by more than a centimetre.
  for (const ErrorTerm& term : b.terms) {
    ErrorModel alone = b;
    alone.terms = {term};
    EXPECT_GT(PropagateErrors(Hole(), Place(), alone).cov_p_W.back().trace(), 1e-4) << term.name;
  }
  return gap;
}

std::string Json(const std::string& terms, const std::string& parameters = R"("inc_max": 180)") {
  return R"({"metadata": {"short_name": "made", "long_name": "made here", "revision_number": 5,
    "source": "this test", "framework": "ISCWSA Rev5"}, "parameters": {)" +
         parameters + R"(}, "terms": [)" + terms + "]}";
}

std::string Term(const std::string& name, double value, const std::string& unit,
                 const std::string& mode, const std::string& md, const std::string& inclination,
                 const std::string& azimuth, const std::string& singular = "null, null",
                 const std::string& code = "") {
  const auto comma = singular.find(", ");
  return R"({"name": ")" + name + R"(", "value": )" + std::to_string(value) + R"(, "units": ")" +
         unit + R"(", "propagation_mode": ")" + mode + R"(", "depth_formula": ")" + md +
         R"(", "inclination_formula": ")" + inclination + R"(", "azimuth_formula": ")" + azimuth +
         R"(", "north_singularity": )" + singular.substr(0, comma) + R"(, "east_singularity": )" +
         singular.substr(comma + 2) + R"(, "x_owsg_weight_function": ")" + code + R"("})";
}

ErrorModel Published(const std::vector<std::tuple<const char*, double, Propagation>>& terms) {
  ErrorModel model;
  model.name = "published";
  model.max_inclination = kPi;
  model.vertical_limit = 1e-4 * units::kDeg;
  model.min_course_length = 10;
  model.tortuosity = units::kDegPer100ft;
  for (const auto& [code, magnitude, propagation] : terms) {
    model.terms.push_back({code, FindWeight(code), magnitude, propagation});
  }
  return model;
}

// The formulas of a file and the functions of this library say the same.
TEST(ModelFiles, JsonFormulasAreThePublishedWeights) {
  const std::string q = "(1 - Sin(Inc) * Sin(Inc) * Sin(AzM) * Sin(AzM))";
  const auto read = ParseModelJson(
      Json(Term("DREF", 0.35, "m", "Random", "1", "0", "0") + "," +
           Term("DSF", 0.0006, "-", "Systematic", "MD", "0", "0") + "," +
           Term("ABXY-TI2", 0.004, "m/s2", "Systematic", "0", "0",
                "((Tan((pi / 2) - Inc)) - Tan(Dip) * Cos(AzM)) / Gfield",
                R"("-Sin(Az) / Gfield", "Cos(Az) / Gfield")") +
           "," +
           Term("MFI", 130, "nT", "Global", "0", "0",
                "-Sin(Inc) * Sin(AzM) * (Tan(Dip) * Cos(Inc) + Sin(Inc) * Cos(AzM)) / " + q +
                    " / Bfield") +
           "," + Term("DBH", 5000, "deg.nT", "Global", "0", "0", "1 / (BField * Cos(Dip))") + "," +
           Term("XYM1", 0.1, "deg", "Systematic", "0", "Abs(Sin(Inc))", "0") + "," +
           Term("XCLA", 0.167, "-", "Random", "0", "0", "0", "null, null", "XCLA")),
      "made.json");
  ASSERT_TRUE(read) << read.fault().text;
  EXPECT_EQ(read->name, "made");
  EXPECT_EQ(read->description, "made here");
  const ErrorModel ours = Published({{"DREF", 0.35, Propagation::kRandom},
                                     {"DSF", 0.0006, Propagation::kSystematic},
                                     {"ABXY-TI2", 0.004, Propagation::kSystematic},
                                     {"MFI", 130e-9, Propagation::kGlobal},
                                     {"DBH", 5000 * units::kDeg * 1e-9, Propagation::kGlobal},
                                     {"XYM1", 0.1 * units::kDeg, Propagation::kSystematic},
                                     {"XCLA", 0.167, Propagation::kRandom}});
  EXPECT_LT(Gap(*read, ours), 1e-12);
}

TEST(ModelFiles, HostileJsonIsRefused) {
  const std::string bad[] = {"",
                             "{",
                             "[]",
                             "{\"terms\": 3}",
                             Json("3"),
                             Json(Term("A", 1, "furlong", "Random", "1", "0", "0")),
                             Json(Term("A", 1, "m", "sometimes", "1", "0", "0")),
                             Json(Term("A", 1, "m", "Random", "system(1)", "0", "0")),
                             Json(Term("A", 1, "m", "Random", "__import__('os')", "0", "0")),
                             Json(Term("A", 1, "m", "Random", "Unknown", "0", "0")),
                             Json(Term("A", 1, "m", "Random", std::string(5000, '('), "0", "0")),
                             Json(Term("", 1, "m", "Random", "1", "0", "0")),
                             Json(Term("A", 1, "m", "Random", "1", "0", "")),
                             Json(Term("A", 1, "", "Random", "1", "0", "0")),
                             Json(Term("A", 1, "m", "Random", "1", "0", "0") + "," +
                                  Term("A", 1, "m", "Random", "1", "0", "0")),
                             Json(""),
                             std::string(200000, '['),
                             std::string(1 << 23, ' ')};
  for (const std::string& text : bad) {
    EXPECT_FALSE(ParseModelJson(text, "bad.json")) << text.substr(0, 60);
  }
  const auto named =
      ParseModelJson(Json(Term("GOOD", 1, "m", "Random", "1", "0", "system(1)")), "bad.json");
  ASSERT_FALSE(named);
  EXPECT_THAT(named.fault().text, HasSubstr("GOOD"));
  EXPECT_THAT(named.fault().text, HasSubstr("system"));
}

// A formula without a value ends the result with the term's name; it never counts as 0.
TEST(ModelFiles, AFormulaWithoutAValueEndsTheResult) {
  const auto read = ParseModelJson(
      Json(Term("LOG", 1, "deg", "Systematic", "0", "log(Inc - 0.3)", "0")), "made.json");
  ASSERT_TRUE(read);
  const auto errors = PropagateErrors(Hole(), Place(), *read);
  ASSERT_TRUE(errors.refusal);
  EXPECT_THAT(errors.refusal->text, HasSubstr("LOG"));
}

TEST(ModelFiles, Yaml) {
  const std::string text =
      "header:\n  Short Name: MADE\n  Revision No: 5.1\n  Inclination Range Max: 180 deg\n"
      "  Misalignment Min Course Length: 10 m\ncodes:\n"
      "  DREFR:\n    function: DREF\n    magnitude: 0.35\n    propagation: random\n    unit: m\n"
      "  ABIZ:\n    function: ABIZ\n    magnitude: 0.004\n    propagation: systematic\n"
      "    unit: m/s2\n"
      "  MDI-U:\n    function: MDI\n    magnitude: 0.002\n    propagation: within_pad\n"
      "    unit: rad\n";
  const auto read = ParseModelYaml(text, "made.yaml");
  ASSERT_TRUE(read) << read.fault().text;
  EXPECT_EQ(read->terms[2].propagation, Propagation::kWell);
  const ErrorModel ours = Published({{"DREF", 0.35, Propagation::kRandom},
                                     {"ABIZ", 0.004, Propagation::kSystematic},
                                     {"MDI", 0.002, Propagation::kWell}});
  EXPECT_LT(Gap(*read, ours), 1e-12);
  for (const char* bad : {"", "codes: 3", "codes:\n  A: 3", "codes:\n  A:\n    function: NOPE",
                          "a: &a [*a]", "\x01\x02",
                          "codes: {A: {function: DREF, magnitude: x, "
                          "propagation: random, unit: m}}"}) {
    EXPECT_FALSE(ParseModelYaml(bad, "bad.yaml")) << bad;
  }
}

constexpr char kIpm[] =
    "#Tool Name  :TEST TOOL\n#ShortName  :TEST\n#Description:made here\n"
    "#Name\tVector\tTie-On\tUnit\tValue\tFormula\n"
    "half\tn\tn\t-\t0.5\t1\n"
    "abz\ti\ts\t-\t0.004\t(-sin(inc))/gtot\n"
    "abz\ta\ts\t-\t0.004\tsin(inc)*sin(azm)*tan(dip)/gtot\n"
    "dref\te\tr\tm\t0.7\thalf\n"
    "mis\tl\ts\td\t0.1\t1.0\n"
    "mis-i\ti\ts\td\t0.1\t1.0\n";

// Rows of one name are one error; a named value is put in; a lateral row acts across the hole.
TEST(ModelFiles, Ipm) {
  const auto read = ParseModelIpm(kIpm, "test.ipm");
  ASSERT_TRUE(read) << read.fault().text;
  EXPECT_EQ(read->name, "TEST");
  ASSERT_EQ(read->terms.size(), 4U);
  const ErrorModel ours = Published({{"ABZ", 0.004, Propagation::kSystematic},
                                     {"DREF", 0.35, Propagation::kRandom},
                                     {"CNA", 0.1 * units::kDeg, Propagation::kSystematic},
                                     {"CNI", 0.1 * units::kDeg, Propagation::kSystematic}});
  auto survey = Hole();  // off vertical, where Compass takes the lateral east and CNA across
  for (SurveyPoint& p : survey) p.inclination += 0.01;
  const auto one = PropagateErrors(survey, Place(), *read);
  const auto two = PropagateErrors(survey, Place(), ours);
  ASSERT_EQ(one.cov_p_W.size(), survey.size());
  EXPECT_LT((one.cov_p_W.back() - two.cov_p_W.back()).norm(), 1e-9 * two.cov_p_W.back().trace());

  for (const char* bad :
       {"", "a b c", "abz\ti\ts\t-\tx\t1\n", "abz\tq\ts\t-\t1\t1\n", "abz\ti\tq\t-\t1\t1\n",
        "abz\ti\ts\tell\t1\t1\n", "abz\ti\ts\t-\t1\tsystem(1)\n", "abz\ti\ts\t-\t1\tsin(tfo)\n"}) {
    EXPECT_FALSE(ParseModelIpm(bad, "bad.ipm")) << bad;
  }
  // Some exports say behind the formula between which inclinations a term holds.
  const std::string ranged =
      "#Name\tVector\tTie-On\tUnit\tValue\tFormula\tRange Min\tRange Max\n"
      "dref\te\tr\tm\t0.35\t1\t0\t0\nxym1\ti\ts\td\t0.1\tabs(sin(inc))\t0\t20\n";
  const auto upper = ParseModelIpm(ranged, "ranged.ipm");
  ASSERT_TRUE(upper) << upper.fault().text;
  EXPECT_EQ(upper->terms.size(), 2U);
  std::string whole = ranged;
  whole.replace(whole.rfind("20"), 2, "0");
  const auto all = ParseModelIpm(whole, "whole.ipm");
  ASSERT_TRUE(all) << all.fault().text;
  EXPECT_LT(PropagateErrors(survey, Place(), *upper).cov_p_W.back().trace(),
            PropagateErrors(survey, Place(), *all).cov_p_W.back().trace());
  const auto unnamed = ParseModelIpm(ranged.substr(ranged.find('\n') + 1), "unnamed.ipm");
  ASSERT_FALSE(unnamed);
  EXPECT_THAT(unnamed.fault().text, HasSubstr("cells follow the formula"));
  // Values that name each other cannot grow without bound.
  std::string bomb = "x0\tn\tn\t-\t1\t1\n";
  for (int i = 1; i < 40; ++i) {
    const std::string before = "x" + std::to_string(i - 1);
    bomb += "x" + std::to_string(i) + "\tn\tn\t-\t1\t" + before + "+" + before + "\n";
  }
  EXPECT_FALSE(ParseModelIpm(bomb + "abz\ti\ts\t-\t1\tx39\n", "bomb.ipm"));
}

TEST(ModelFiles, Edm) {
  const std::string text =
      "<export><CD_SURVEY_TOOL survey_tool_id=\"t1\" tool_name=\"MWD\"/>"
      "<CD_SURVEY_TOOL survey_tool_id=\"t2\" tool_name=\"Other\"/>"
      "<DP_TOOL_TERM survey_tool_id=\"t1\" term_name=\"dref\" vector_type=\"e\" tie_type=\"r\" "
      "c_units=\"m\" c_value=\"0.35\" c_formula=\"1\" sequence_no=\"1\"/>"
      "<DP_TOOL_TERM survey_tool_id=\"t1\" term_name=\"xym1\" vector_type=\"i\" tie_type=\"s\" "
      "c_units=\"d\" c_value=\"0.1\" c_formula=\"abs(sin(inc))\" sequence_no=\"2\"/></export>";
  const auto read = ParseModelEdm(text, "wells.xml", "mwd");
  ASSERT_TRUE(read) << read.fault().text;
  const ErrorModel ours = Published({{"DREF", 0.35, Propagation::kRandom},
                                     {"XYM1", 0.1 * units::kDeg, Propagation::kSystematic}});
  EXPECT_LT(Gap(*read, ours), 1e-12);
  EXPECT_FALSE(ParseModelEdm(text, "wells.xml", ""));  // which of two
  EXPECT_FALSE(ParseModelEdm(text, "wells.xml", "none"));
  EXPECT_FALSE(ParseModelEdm(text, "wells.xml", "t2"));  // it has no terms
  EXPECT_FALSE(ParseModelEdm("<a", "wells.xml", ""));
}

TEST(ModelCatalogue, EveryModelByName) {
  EXPECT_GE(OwnModels().size(), 13U);
  for (const ErrorModel& model : OwnModels()) {
    EXPECT_TRUE(FindModel(model.name)) << model.name;
    const auto floating = FindModel(model.name + "_Fl");
    ASSERT_TRUE(floating) << model.name;
    EXPECT_FALSE(FindComplaint(*floating)) << model.name;
  }
  const auto none = FindModel("GYRO-NS-CP");
  ASSERT_FALSE(none);
  EXPECT_THAT(none.fault().text, HasSubstr("GYRO-NS-CT"));
  EXPECT_FALSE(FindModel("/no/such/file.json"));
}

}  // namespace
}  // namespace wellgyro
