#include "wellgyro/io/exchange/exchange.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <stdexcept>
#include <string>
#include <vector>

#include <gmock/gmock.h>

#include "wellgyro/io/exchange/survey_files.h"

#include "support/scratch.h"
#include "support/survey_samples.h"

namespace wellgyro {
namespace {

using support::ExpectSameStations;
using support::FullSurvey;
using testing::HasSubstr;

constexpr std::array kReadable{SurveyFormat::kCsv,      SurveyFormat::kLas,
                               SurveyFormat::kP717,     SurveyFormat::kWitsml1411,
                               SurveyFormat::kWitsml21, SurveyFormat::kPetrel,
                               SurveyFormat::kCompass};

SurveyTable Reread(const std::string& text, const ReadOptions& options = {}) {
  auto table = ParseSurvey(text, "text", options);
  EXPECT_TRUE(table) << (table ? "" : table.fault().text) << " line "
                     << (table ? 0 : table.fault().line);
  return table ? *table : SurveyTable();
}

// What each format can hold of a station, and more of its head than its stations.
std::vector<Column> Held(SurveyFormat format) {
  using C = Column;
  std::vector<C> held{C::kMd,    C::kInclination, C::kAzimuth, C::kTvd,
                      C::kNorth, C::kEast,        C::kDogleg};
  const auto add = [&](std::initializer_list<C> more) {
    held.insert(held.end(), more.begin(), more.end());
  };
  const auto covariance = {C::kVarNN, C::kCovNE, C::kCovNV, C::kVarEE, C::kCovEV, C::kVarVV};
  switch (format) {
    case SurveyFormat::kPetrel:
      add({C::kNorthing, C::kEasting, C::kDown});
      break;
    case SurveyFormat::kCompass:
      add({C::kNorthing, C::kEasting, C::kVerticalSection});
      break;
    case SurveyFormat::kWitsml21:
      add(covariance);
      add({C::kToolface, C::kVerticalSection, C::kGravity, C::kGravityRef, C::kLatitude,
           C::kLongitude, C::kUtc});
      break;
    default:
      add(covariance);
      add({C::kToolface, C::kVerticalSection, C::kGravity, C::kGravityRef, C::kLatitude,
           C::kLongitude, C::kUtc, C::kNorthing, C::kEasting, C::kDown, C::kSigmaInclination,
           C::kSigmaAzimuth, C::kEarthRateMeasured, C::kEarthRateReference});
  }
  return held;
}

TEST(Exchange, EveryFormatGivesBackWhatItHoldsToTheLastBit) {
  for (const LengthUnit unit : {LengthUnit::kMetre, LengthUnit::kFoot}) {
    const SurveyTable table = FullSurvey(unit);
    for (const SurveyFormat format : kReadable) {
      SCOPED_TRACE(std::string(WordOf(format)));
      const SurveyTable back = Reread(WriteSurvey(table, format));
      ExpectSameStations(table, back, Held(format));
      EXPECT_EQ(back.head.md_unit, unit);
      EXPECT_EQ(back.head.azimuth.north, North::kGrid);
      EXPECT_EQ(back.head.offsets, North::kGrid);
      if (format == SurveyFormat::kCsv) continue;
      EXPECT_EQ(back.head.names.well, table.head.names.well);
      EXPECT_EQ(back.head.datum, "RT");
      if (format == SurveyFormat::kPetrel) continue;
      EXPECT_EQ(back.head.tool, SurveyTool::kGyroContinuous);
      EXPECT_EQ(back.head.error_model, table.head.error_model);
      EXPECT_EQ(back.head.method, "minimum curvature");
      EXPECT_NEAR(back.head.azimuth.convergence.value_or(9), *table.head.azimuth.convergence,
                  1e-16);
      EXPECT_NEAR(back.head.azimuth.declination.value_or(9), *table.head.azimuth.declination,
                  1e-16);
      EXPECT_NEAR(back.head.datum_elevation.value_or(0), *table.head.datum_elevation, 1e-12);
    }
  }
}

// The table of the README: numbers to the last bit through any two formats, heads as it says.
TEST(Exchange, EveryFormatToEveryOtherAndBack) {
  const SurveyTable table = FullSurvey();
  const auto through = [](const SurveyTable& t, SurveyFormat format) {
    return Reread(WriteSurvey(t, format, {.preamble = true}));
  };
  int pairs = 0;
  for (const SurveyFormat first : kReadable) {
    const SurveyTable one = through(table, first);
    for (const SurveyFormat second : kReadable) {
      SCOPED_TRACE(std::string(WordOf(first)) + " to " + std::string(WordOf(second)));
      const SurveyTable back = through(one, second);
      std::vector<Column> columns = Held(first);
      const std::vector<Column> other = Held(second);
      std::erase_if(columns, [&](Column c) {
        return std::find(other.begin(), other.end(), c) == other.end();
      });
      ExpectSameStations(table, back, columns);
      EXPECT_EQ(back.head.names.well, table.head.names.well);
      EXPECT_EQ(back.head.datum, table.head.datum);
      EXPECT_EQ(back.head.azimuth.north, table.head.azimuth.north);
      EXPECT_EQ(back.head.offsets, table.head.offsets);
      EXPECT_NEAR(back.head.datum_elevation.value_or(0), *table.head.datum_elevation, 1e-12);
      ++pairs;
      if (first == SurveyFormat::kPetrel || second == SurveyFormat::kPetrel) continue;
      EXPECT_EQ(back.head.names.contractor, table.head.names.contractor);
      EXPECT_EQ(back.head.tool, table.head.tool);
      EXPECT_EQ(back.head.error_model, table.head.error_model);
      EXPECT_EQ(back.head.method, table.head.method);
      EXPECT_NEAR(*back.head.azimuth.convergence, *table.head.azimuth.convergence, 1e-15);
      EXPECT_NEAR(*back.head.azimuth.declination, *table.head.azimuth.declination, 1e-15);
    }
  }
  std::printf("%d pairs of formats\n", pairs);
}

TEST(Exchange, WrittenAgainTheBytesAreTheSame) {
  for (const SurveyFormat format : kReadable) {
    SCOPED_TRACE(std::string(WordOf(format)));
    const std::string once = WriteSurvey(FullSurvey(), format);
    EXPECT_EQ(WriteSurvey(Reread(once), format), once);
  }
}

TEST(Exchange, NorthIsNeverGuessed) {
  SurveyTable table = FullSurvey();
  table.head.azimuth.north = North::kUnknown;
  for (const SurveyFormat format : kReadable) {
    try {
      WriteSurvey(table, format);
      ADD_FAILURE() << WordOf(format);
    } catch (const std::invalid_argument& error) {
      EXPECT_THAT(error.what(), HasSubstr("north"));
    }
  }
  EXPECT_THROW(WriteSurvey(FullSurvey(), SurveyFormat::kWitsml20), std::invalid_argument);
}

TEST(Exchange, OptionsWinWithANote) {
  const std::string text = WriteSurvey(FullSurvey(), SurveyFormat::kLas);
  const SurveyTable turned = Reread(text, {.convergence = 0.3});
  EXPECT_EQ(turned.head.azimuth.convergence, 0.3);
  EXPECT_THAT(turned.head.notes, testing::Contains(HasSubstr("convergence is taken as told")));
  EXPECT_TRUE(ParseSurvey(text, "x", {.depth_unit = LengthUnit::kMetre, .north = North::kGrid}));
  // Depths in feet would contradict the positions, which are said to be in metres too; not those.
  const std::string bare = "MD[m],INC[deg],AZI_TRUE[deg]\n0,0,0\n100,1,2\n";
  const SurveyTable feet = Reread(bare, {.depth_unit = LengthUnit::kFoot, .north = North::kGrid});
  EXPECT_EQ(feet.md(1), 100 * units::kFoot);
  EXPECT_EQ(feet.head.azimuth.north, North::kGrid);
  EXPECT_THAT(feet.head.notes, testing::Contains(HasSubstr("though the file says m")));
  EXPECT_THAT(feet.head.notes, testing::Contains(HasSubstr("though the file says true")));
}

// A file of ours that is cut at any byte is refused, or, where the format has no place to say how
// long it is, taken with the word that its end could not be seen.
TEST(Exchange, ACutAtEvery97thByteIsTold) {
  const WriteOptions preamble{.preamble = true};
  int cuts = 0, told = 0;
  for (const SurveyFormat format : kReadable) {
    for (const bool with : {false, true}) {
      const std::string text = WriteSurvey(FullSurvey(), format, with ? preamble : WriteOptions{});
      for (std::size_t size = 0; size < text.size(); size += 97) {
        const auto table = ParseSurvey(std::string_view(text).substr(0, size), "cut");
        ++cuts;
        if (!table) continue;
        ++told;
        EXPECT_THAT(table->head.notes, testing::Contains(HasSubstr("where the table ends")))
            << WordOf(format) << " " << size;
      }
    }
  }
  std::printf("%d cuts: %d refused, %d told by a note\n", cuts, cuts - told, told);
}

TEST(Exchange, WhatWasChangedSinceIsTold) {
  for (const SurveyFormat format :
       {SurveyFormat::kLas, SurveyFormat::kP717, SurveyFormat::kPetrel, SurveyFormat::kCompass}) {
    std::string text = WriteSurvey(FullSurvey(), format);
    const auto whole = ParseSurvey(text, "whole");
    ASSERT_TRUE(whole);
    EXPECT_THAT(whole->head.notes, testing::Not(testing::Contains(HasSubstr("was changed"))));
    text.insert(text.find("358.5"), 1, ' ');
    const auto table = ParseSurvey(text, "changed");
    if (!table) continue;
    EXPECT_THAT(table->head.notes, testing::Contains(HasSubstr("was changed")));
  }
}

// Of every fifth byte, in ten parts.
class FlippedBytes : public testing::TestWithParam<std::size_t> {};

TEST_P(FlippedBytes, CrashNothing) {
  for (const SurveyFormat format : kReadable) {
    const std::string text = WriteSurvey(FullSurvey(), format);
    for (std::size_t at = 5 * GetParam(); at < text.size(); at += 50) {
      constexpr std::array kFlips{'\x01', '\x20', '\x80'};
      std::string damaged = text;
      damaged[at] = static_cast<char>(damaged[at] ^ kFlips[at % 3]);
      const auto table = ParseSurvey(damaged, "damaged");
      EXPECT_TRUE(table || !table.fault().text.empty());
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Exchange, FlippedBytes, testing::Range<std::size_t>(0, 10));

TEST(Exchange, EmptyFilesAndFoldersAreRefused) {
  const support::Scratch scratch;
  scratch.Write("empty.csv", "");
  const auto empty = ReadSurvey(scratch.path() / "empty.csv");
  ASSERT_FALSE(empty);
  EXPECT_THAT(empty.fault().text, HasSubstr("empty"));
  EXPECT_FALSE(ReadSurvey(scratch.path()));
  EXPECT_FALSE(ReadSurvey(scratch.path() / "missing.las"));
  for (const std::string text : {"\n\n", "\xEF\xBB\xBF", "<", "<a/>", "IOGP,", "~V\n", "#", "\"",
                                 "# WELL TRACE FROM PETREL\n"}) {
    EXPECT_FALSE(ParseSurvey(text, "x")) << text;
  }
}

TEST(Exchange, ExportsRoundedForPeople) {
  const std::array formats{SurveyFormat::kCsv, SurveyFormat::kLas, SurveyFormat::kWitsml1411};
  SurveyTable table = FullSurvey();
  table.Set(Column::kTvd, 1, 29.912345678);
  const auto files = ExportFormats(table, formats, "survey");
  ASSERT_EQ(files.size(), 3u);
  EXPECT_EQ(files[0].name, "survey.csv");
  EXPECT_EQ(files[2].name, "survey-1411.xml");
  EXPECT_THAT(files[0].bytes, HasSubstr("29.9123,"));
  EXPECT_THAT(files[0].bytes, testing::Not(HasSubstr("29.91234")));
}

TEST(Exchange, NumbersThatNoReaderTakesAreWrittenInNoFormat) {
  const SurveyTable good = support::FullSurvey();
  const double last = good.md(good.rows() - 1);
  std::vector<SurveyTable> odd(5, good);
  odd[0].Add(last + 1, std::nan(""), 1);
  odd[1].Add(last + 1, 1, std::nan(""));
  odd[2].Set(Column::kTvd, 1, HUGE_VAL);
  odd[3].Set(Column::kVarNN, 1, std::nan(""));
  odd[4].Add(good.md(1), 1, 1);
  for (const std::string& word : WrittenFormats()) {
    const SurveyFormat format = *SurveyFormatOf(word);
    for (std::size_t i = 0; i < odd.size(); ++i) {
      EXPECT_THROW(WriteSurvey(odd[i], format), std::invalid_argument) << word << " " << i;
      EXPECT_THROW(SurveyFiles(odd[i], format, "x"), std::invalid_argument) << word << " " << i;
    }
  }
}

TEST(Exchange, WhatIsNoFormatIsRefused) {
  const auto none = static_cast<SurveyFormat>(99);
  EXPECT_THROW(WordOf(none), std::invalid_argument);
  EXPECT_THROW(FileNameOf(none, "x"), std::invalid_argument);
  EXPECT_THROW(WriteSurvey(support::FullSurvey(), none), std::invalid_argument);
}

TEST(Exchange, FormatsHaveNames) {
  for (const SurveyFormat format : kReadable) EXPECT_EQ(SurveyFormatOf(WordOf(format)), format);
  EXPECT_FALSE(SurveyFormatOf("docx"));
}

}  // namespace
}  // namespace wellgyro
