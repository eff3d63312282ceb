#include "wellgyro/io/result/uncertainty_files.h"

#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "wellgyro/base/units.h"
#include "wellgyro/math/random.h"

#include "support/scratch.h"

namespace wellgyro {
namespace {

using testing::HasSubstr;

const std::filesystem::path kModels = std::filesystem::path(WELLGYRO_DATA_DIR) / "models";
const std::filesystem::path kCases =
    std::filesystem::path(WELLGYRO_DATA_DIR) / "../tests/uncertainty/cases";

class UncertaintyFiles : public testing::Test {
 protected:
  std::filesystem::path Write(const std::string& name, const std::string& text) {
    folder_.Write(name, text);
    return folder_.path() / name;
  }

  support::Scratch folder_;
};

std::string Read(const std::filesystem::path& path) {
  std::ostringstream text;
  text << std::ifstream(path, std::ios::binary).rdbuf();
  return text.str();
}

std::string Bytes(const UncertaintyAnswer& answer, const std::string& name) {
  for (const OutputFile& file : answer.files)
    if (file.name == name) return file.bytes;
  ADD_FAILURE() << "no " << name;
  return {};
}

/// Rows of numbers by column name; cells that are no numbers are left.
std::vector<std::map<std::string, double>> Rows(const std::string& csv) {
  std::istringstream stream(csv);
  std::string line, cell;
  std::vector<std::string> names;
  std::vector<std::map<std::string, double>> rows;
  while (std::getline(stream, line)) {
    std::istringstream cells(line);
    std::map<std::string, double> row;
    for (std::size_t i = 0; std::getline(cells, cell, ','); ++i) {
      if (rows.empty() && names.size() == i) {
        names.push_back(cell);
      } else {
        char* end = nullptr;
        const double value = std::strtod(cell.c_str(), &end);
        if (end != cell.c_str()) row[names[i]] = value;
      }
    }
    if (!row.empty()) rows.push_back(row);
  }
  return rows;
}

UncertaintyRequest WellOne() {
  UncertaintyRequest request;
  request.sources.survey = kCases / "iscwsa-well-1.csv";
  request.sources.model = kModels / "GYRO-NS-CT.toml";
  request.surroundings.latitude = 60 * units::kDeg;
  return request;
}

// The columns to the letter; the ellipse, high side and confidence follow from the covariance.
TEST_F(UncertaintyFiles, CovarianceColumnsHoldTogether) {
  UncertaintyRequest request = WellOne();
  request.confidence = 0.9;
  const auto answer = AnswerUncertainty(request);
  ASSERT_TRUE(answer) << answer.fault().text;
  const std::string csv = Bytes(*answer, "covariance.csv");
  EXPECT_EQ(csv.substr(0, csv.find('\n')),
            "MD[m],VAR_NN[m2],COV_NE[m2],COV_NV[m2],VAR_EE[m2],COV_EV[m2],VAR_VV[m2],VAR_HH[m2],"
            "COV_HL[m2],COV_HA[m2],VAR_LL[m2],COV_LA[m2],VAR_AA[m2],SEMI_MAJOR[m],SEMI_MINOR[m],"
            "AZI_MAJOR[deg]");
  const auto rows = Rows(csv);
  ASSERT_EQ(rows.size(), 268u);
  for (auto row : rows) {
    const double trace = row["VAR_NN[m2]"] + row["VAR_EE[m2]"] + row["VAR_VV[m2]"];
    EXPECT_NEAR(row["VAR_HH[m2]"] + row["VAR_LL[m2]"] + row["VAR_AA[m2]"], trace, 1e-7 * trace);
    const double k2 = -2 * std::log(0.1);  // 90 % in two dimensions
    const double major = row["SEMI_MAJOR[m]"], minor = row["SEMI_MINOR[m]"];
    EXPECT_NEAR(major * major + minor * minor, k2 * (row["VAR_NN[m2]"] + row["VAR_EE[m2]"]),
                1e-3 * (1 + major));
  }
}

TEST_F(UncertaintyFiles, TermsSumToTheCovariance) {
  UncertaintyRequest request = WellOne();
  request.terms = true;
  request.plot = true;
  const auto answer = AnswerUncertainty(request);
  ASSERT_TRUE(answer) << answer.fault().text;
  std::map<double, double> sum;
  for (auto row : Rows(Bytes(*answer, "terms.csv"))) sum[row["MD[m]"]] += row["VAR_EE[m2]"];
  for (auto row : Rows(Bytes(*answer, "covariance.csv")))
    EXPECT_NEAR(sum[row["MD[m]"]], row["VAR_EE[m2]"], 1e-6 * (1 + row["VAR_EE[m2]"]));
  EXPECT_THAT(Bytes(*answer, "uncertainty.svg"), HasSubstr("</svg>"));
  EXPECT_THAT(Bytes(*answer, "uncertainty.toml"), HasSubstr("GYRO-NS-CT.toml"));
}

// One leg is the simple case of a program; two legs of one run are one.
TEST_F(UncertaintyFiles, AProgramOfOneRunIsItsSurvey) {
  Write("well.csv", Read(kCases / "iscwsa-well-1.csv"));
  Write("model.toml", Read(kModels / "GYRO-NS-CT.toml"));
  const std::string head = "format = \"wellgyro.program/1\"\n";
  const std::string leg = "[[leg]]\nsurvey = \"well.csv\"\nmodel = \"model.toml\"\nrun = 7\n";
  const std::string whole = Bytes(*AnswerUncertainty(WellOne()), "covariance.csv");
  UncertaintyRequest request = WellOne();
  request.sources = {};
  for (const std::string& text :
       {head + leg, head + leg + "to_md_m = 4000\n" + leg + "from_md_m = 4000\n"}) {
    request.sources.program = Write("program.toml", text);
    const auto answer = AnswerUncertainty(request);
    ASSERT_TRUE(answer) << answer.fault().text;
    EXPECT_EQ(Bytes(*answer, "covariance.csv"), whole);
  }
}

TEST_F(UncertaintyFiles, ProgramFaultsNameTheirPlace) {
  Write("well.csv", Read(kCases / "iscwsa-well-1.csv"));
  Write("model.toml", Read(kModels / "GYRO-NS-CT.toml"));
  const std::string head = "format = \"wellgyro.program/1\"\n";
  struct Bad {
    std::string text;
    int line;
    const char* says;
  };
  const Bad all[] = {
      {head, 1, "[[leg]]"},
      {head + "[[leg]]\nsurvey = \"well.csv\"\n", 2, "model"},
      {head + "[[leg]]\nsurvey = \"well.csv\"\nmodel = \"model.toml\"\nfrom_md_m = 9000\n", 2,
       "no station"},
      {head + "[[leg]]\nsurvey = \"well.csv\"\nmodel = \"model.toml\"\nrun = \"a\"\n", 5, "run"},
      {head + "[[leg]]\nsurvey = \"none.csv\"\nmodel = \"model.toml\"\n", 0, "open"},
      {head + "[tie_in]\nnorth_m = 3\n[[leg]]\nsurvey = \"well.csv\"\nmodel = \"model.toml\"\n", 2,
       "tvd_m"},
  };
  for (const Bad& bad : all) {
    UncertaintyRequest request = WellOne();
    request.sources = {};
    request.sources.program = Write("program.toml", bad.text);
    const auto answer = AnswerUncertainty(request);
    ASSERT_FALSE(answer) << bad.text;
    EXPECT_THAT(answer.fault().text, HasSubstr(bad.says));
    EXPECT_EQ(answer.fault().line, bad.line) << bad.text;
  }
}

TEST_F(UncertaintyFiles, AllanModesSayWhichWasUsed) {
  UncertaintyRequest request = WellOne();
  request.sources.model.reset();
  request.sources.noise = Write("noise.toml",
                                "format = \"wellgyro.noise/1\"\n[coefficients]\n"
                                "angle_random_walk_deg_per_sqrt_h = 0.1\n"
                                "rate_random_walk_deg_per_h_sqrt_h = 0.2\n"
                                "rate_ramp_deg_per_h2_upper95 = 0.7\n");
  EXPECT_THROW(static_cast<void>(AnswerUncertainty(request)), std::invalid_argument);  // no speed
  request.speed = 0.75;
  request.terms = true;
  const auto exact = AnswerUncertainty(request);
  ASSERT_TRUE(exact);
  EXPECT_THAT(Bytes(*exact, "uncertainty.toml"), HasSubstr("allan = \"exact\""));
  EXPECT_THAT(Bytes(*exact, "terms.csv"), HasSubstr("ALLAN-K"));
  EXPECT_THAT(Bytes(*exact, "uncertainty.toml"),
              HasSubstr("rate_ramp_deg_per_h2 was not observed"));
  request.form = AllanForm::kPrinted;
  const auto printed = AnswerUncertainty(request);
  ASSERT_TRUE(printed);
  EXPECT_THAT(Bytes(*printed, "uncertainty.toml"), HasSubstr("allan = \"printed\""));
  EXPECT_THAT(Bytes(*printed, "uncertainty.toml"), HasSubstr("begin anew at every station"));

  // Beside a model it takes the place of drift and random walk, and of nothing else.
  request.form = AllanForm::kExact;
  request.sources.model = kModels / "GYRO-NS-CT.toml";
  request.speed.reset();
  const auto both = AnswerUncertainty(request);
  ASSERT_TRUE(both);
  const std::string terms = Bytes(*both, "terms.csv");
  EXPECT_THAT(terms, HasSubstr("ALLAN-N"));
  EXPECT_THAT(terms, HasSubstr("GXY-B1S"));
  EXPECT_THAT(terms, testing::Not(HasSubstr("GXY-GRW")));
}

TEST_F(UncertaintyFiles, NorthIsNeverGuessedAgainstTheHeader) {
  UncertaintyRequest request = WellOne();
  request.sources.survey = Write("s.csv", "MD[m],INC[deg],AZI_GRID[deg]\n0,0,0\n30,5,7\n");
  EXPECT_THROW(static_cast<void>(AnswerUncertainty(request)), std::invalid_argument);
  request.convergence = 1 * units::kDeg;
  EXPECT_TRUE(AnswerUncertainty(request));
  request.sources.survey = Write("s.csv", "MD[m],INC[deg],AZI_TRUE[deg]\n0,0,0\n30,5,7\n");
  EXPECT_THROW(static_cast<void>(AnswerUncertainty(request)), std::invalid_argument);
}

TEST_F(UncertaintyFiles, RefusalEndsTheFileAndIsSaid) {
  UncertaintyRequest request = WellOne();
  request.sources.model = kModels / "GYRO-NS.toml";
  const auto answer = AnswerUncertainty(request);
  ASSERT_TRUE(answer);
  ASSERT_EQ(answer->refusals.size(), 1u);
  EXPECT_THAT(answer->refusals[0], HasSubstr("5400"));
  EXPECT_EQ(Rows(Bytes(*answer, "covariance.csv")).back()["MD[m]"], 5370);
  EXPECT_THAT(Bytes(*answer, "uncertainty.toml"), HasSubstr("[[refusal]]"));
}

/// One to three bytes changed, cut out, doubled or put elsewhere, or a digit made another: what
/// readers cannot see, so that numbers are computed from it.
std::string Mutated(std::string text, Random& random) {
  const auto below = [&](std::size_t n) {
    return static_cast<std::size_t>(random.Uniform() * static_cast<double>(n));
  };
  constexpr std::string_view kLikely = "0123456789.-+eE,\n\"[]= naif";
  for (std::size_t n = 1 + below(3); n > 0 && text.size() > 40; --n) {
    const std::size_t at = below(text.size()), size = 1 + below(20);
    switch (below(6)) {
      case 0:
        text[at] = static_cast<char>(random.Bits());
        break;
      case 1:
        text[at] = kLikely[below(kLikely.size())];
        break;
      case 2:
        text.erase(at, size);
        break;
      case 3:
        text.insert(at, text.substr(below(text.size()), size));
        break;
      case 4:
        if (const std::size_t digit = text.find_first_of("0123456789", at); digit < text.size()) {
          text[digit] = kLikely[below(10)];
        }
        break;
      default:
        text.insert(at, 1, kLikely[below(kLikely.size())]);
        break;
    }
  }
  return text;
}

void ExpectSoundText(const std::string& text) {
  EXPECT_EQ(text.find("nan"), std::string::npos);
  EXPECT_EQ(text.find("inf"), std::string::npos);
}

// Its first three columns: where TVD stands beside them, most damage contradicts it and is refused.
std::string AnglesAlone(const std::string& survey) {
  std::string text;
  int column = 0;
  for (const char c : survey) {
    column = c == '\n' ? 0 : column + (c == ',' ? 1 : 0);
    if (column < 3) text += c;
  }
  return text;
}

// Damaged models, surveys, programs and noise files: an answer without a NaN, or an error; no
// crash.
class MutatedFiles : public UncertaintyFiles, public testing::WithParamInterface<std::uint64_t> {};

TEST_P(MutatedFiles, NeverGiveNan) {
  Random random(GetParam());
  const std::string survey = AnglesAlone(Read(kCases / "iscwsa-well-3.csv"));
  const std::string noise =
      "format = \"wellgyro.noise/1\"\n[coefficients]\nangle_random_walk_deg_per_sqrt_h = 0.1\n"
      "bias_instability_deg_per_h = 0.3\nbias_instability_correlation_time_h = 0.2\n"
      "rate_random_walk_deg_per_h_sqrt_h = 0.2\nrate_ramp_deg_per_h2 = 0.1\n";
  const std::string models[] = {
      Read(kModels / "GYRO-NS-CT.toml"), Read(kModels / "spe90408-4.toml"),
      Read(kModels / "CB_Film_GSS.toml"), Read(kModels / "ISCWSA-MWD-Rev5.1.toml")};
  int answered = 0, refused = 0;
  for (int round = 0; round < 400; ++round) {
    UncertaintyRequest request = WellOne();
    request.surroundings.field = 50e-6;
    request.surroundings.dip = 1.2;
    request.surroundings.declination = 0.1;
    request.plot = request.terms = round % 4 == 0;
    const std::string& model = models[round % 4];
    const bool hit_model = round % 3 == 0, hit_noise = round % 7 == 0;
    request.sources.survey = Write("s.csv", hit_model ? survey : Mutated(survey, random));
    request.sources.model = Write("m.toml", hit_model ? Mutated(model, random) : model);
    if (hit_noise) {
      request.sources.noise = Write("n.toml", Mutated(noise, random));
      request.speed = 0.6;
    }
    if (round % 11 == 0) {
      request.sources = {};
      request.sources.program =
          Write("p.toml", Mutated("format = \"wellgyro.program/1\"\n[[leg]]\nsurvey = \"s.csv\"\n"
                                  "model = \"m.toml\"\nto_md_m = 2000.0\n[[leg]]\nsurvey = "
                                  "\"s.csv\"\nmodel = \"m.toml\"\n",
                                  random));
    }
    try {
      const auto answer = AnswerUncertainty(request);
      (answer ? answered : refused) += 1;
      if (!answer) {
        EXPECT_FALSE(answer.fault().text.empty());
        continue;
      }
      for (const OutputFile& file : answer->files)
        if (file.name.ends_with(".csv")) ExpectSoundText(file.bytes);
    } catch (const std::invalid_argument& error) {
      ++refused;
      EXPECT_NE(std::string(error.what()), "");
    }
  }
  EXPECT_GT(answered, 15);  // rows with more or fewer fields than the header are refused
  EXPECT_GT(refused, 30);
}

INSTANTIATE_TEST_SUITE_P(Seeds, MutatedFiles, testing::Range<std::uint64_t>(90408, 90414));

}  // namespace
}  // namespace wellgyro
