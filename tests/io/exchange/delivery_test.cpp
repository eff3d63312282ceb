// What goes to others: maps, manifests, heads in awkward words; and layouts that others send.
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include <gmock/gmock.h>

#include "wellgyro/io/exchange/delivery_check.h"
#include "wellgyro/io/exchange/exchange.h"
#include "wellgyro/io/exchange/losses.h"
#include "wellgyro/io/exchange/survey_files.h"

#include "io/exchange/parsed.h"
#include "support/scratch.h"
#include "support/survey_samples.h"

namespace wellgyro {
namespace {

using support::FullSurvey;
using testing::Contains;
using testing::HasSubstr;

constexpr std::array kMaps{SurveyFormat::kGeoJson, SurveyFormat::kKml, SurveyFormat::kGeoPackage};

TEST(Delivery, CutsOfMapsAndManifestsAreSeen) {
  const support::Scratch scratch;
  std::vector<SurveyFormat> formats(kMaps.begin(), kMaps.end());
  formats.push_back(SurveyFormat::kOsdu);
  int cuts = 0;
  for (const SurveyFormat format : formats) {
    for (const OutputFile& file : SurveyFiles(FullSurvey(), format, FileNameOf(format, "s"))) {
      scratch.Write(file.name, file.bytes);
      const auto path = scratch.path() / file.name;
      EXPECT_TRUE(DeliveryKind(path)) << file.name;
      EXPECT_FALSE(CheckDelivery(path)) << file.name;
      for (std::size_t size = 97; size < file.bytes.size(); size += 97) {
        scratch.Write("cut", file.bytes.substr(0, size));
        EXPECT_TRUE(CheckDelivery(scratch.path() / "cut") || !DeliveryKind(scratch.path() / "cut"))
            << file.name << " " << size;
        ++cuts;
      }
    }
  }
  std::printf("%d cuts seen\n", cuts);
}

TEST(Delivery, AMapNeedsAPlace) {
  SurveyTable table = FullSurvey();
  table.Drop(Column::kLatitude);
  table.head.objects.clear();
  EXPECT_THROW(WriteSurvey(table, SurveyFormat::kGeoJson), std::invalid_argument);
  table.head.objects.push_back({.kind = "WRP", .latitude = 1.0, .longitude = 0.1});
  const std::string map = WriteSurvey(table, SurveyFormat::kGeoJson);
  // 180 m of hole stay within a few thousandths of a degree of its head.
  EXPECT_THAT(map, HasSubstr("[5.72"));
  EXPECT_THAT(map, HasSubstr(",57.29"));
}

TEST(Delivery, TheManifestNamesTheColumnsOfItsStations) {
  const auto files = SurveyFiles(FullSurvey(), SurveyFormat::kOsdu, "s.json");
  ASSERT_EQ(files.size(), 2u);
  EXPECT_EQ(files[0].name, "s.csv");
  EXPECT_THAT(files[0].bytes, testing::StartsWith("MD,Inclination,AzimuthGN,TVD,DX,DY,DLS,Cov"));
  EXPECT_THAT(files[1].bytes, HasSubstr("\"Name\": \"CovarianceEV\""));
  EXPECT_THAT(files[1].bytes, HasSubstr("SurveyToolType:GYRO-NS-CT_A021Gc:"));
  EXPECT_THAT(files[1].bytes, HasSubstr("7 stations in s.csv, SHA-256 "));
}

// Heads of awkward lengths, letters, blanks and dates, or none at all, come back from every format
// that holds them.
TEST(Delivery, AwkwardHeadsComeBack) {
  std::string longest;
  for (int i = 0; i < 50; ++i) longest += "\xC3\x98-1 ";
  for (const std::string& name :
       {std::string("\xC3\x98-1 H"), std::string("\xC3\x86-1 H"), longest + "x",
        std::string("6507/7-A-42: 10:15"), std::string("a \"b\" <c> & 'd'"), std::string()}) {
    for (const std::string date : {"", "2026-01-15", "2026-01-15T08:00:00.500Z", "January"}) {
      SurveyTable table = FullSurvey();
      table.head.names.well = table.head.names.wellbore = table.head.names.survey = name;
      table.head.names.contractor = table.head.datum = name;
      table.head.names.begin = table.head.names.end = table.head.names.created = date;
      table.head.names.uid_well = table.head.names.uid_wellbore = "";
      for (const SurveyFormat format :
           {SurveyFormat::kWitsml1411, SurveyFormat::kWitsml21, SurveyFormat::kLas}) {
        const SurveyTable back = Parsed(WriteSurvey(table, format));
        const std::string where(WordOf(format));
        EXPECT_EQ(back.head.names.well, name) << where;
        EXPECT_EQ(back.head.names.survey, name) << where;
        EXPECT_EQ(back.head.names.contractor, name) << where;
        EXPECT_EQ(back.head.datum, name) << where;
        EXPECT_EQ(back.head.names.begin, date) << where;
      }
      const SurveyTable p717 = Parsed(WriteSurvey(table, SurveyFormat::kP717));
      EXPECT_EQ(p717.head.names.created, date == "January" ? p717.head.names.created : date);
    }
  }
}

TEST(Delivery, LikeNamesHaveDifferentIdentifiers) {
  const auto uid = [](const std::string& well) {
    SurveyTable table = FullSurvey();
    table.head.names.well = well;
    table.head.names.uid_well.clear();
    const std::string text = WriteSurvey(table, SurveyFormat::kWitsml1411);
    const std::size_t at = text.find("uidWell=\"") + 9;
    return text.substr(at, text.find('"', at) - at);
  };
  EXPECT_NE(uid("\xC3\x98-1 H"), uid("\xC3\x86-1 H"));
  EXPECT_EQ(uid("\xC3\x98-1 H").find(' '), std::string::npos);
  EXPECT_LE(uid(std::string(200, 'x')).size(), 64u);
  EXPECT_NE(uid(std::string(200, 'x')), uid(std::string(201, 'x')));
}

TEST(Delivery, LossesAreNamed) {
  const SurveyTable table = FullSurvey();
  EXPECT_TRUE(LossesOf(table, SurveyFormat::kCsv, {.preamble = true}).empty());
  EXPECT_TRUE(LossesOf(table, SurveyFormat::kWitsml1411).empty());
  EXPECT_THAT(LossesOf(table, SurveyFormat::kPetrel), Contains(HasSubstr("VAR_NN")));
  EXPECT_THAT(LossesOf(table, SurveyFormat::kLas), Contains(HasSubstr("QUALITY")));
  EXPECT_THAT(LossesOf(table, SurveyFormat::kCsv), Contains(HasSubstr("datum")));
}

// What 2.1 has no element for comes back from its extension.
TEST(Delivery, Witsml21HoldsEverythingOfAStation) {
  SurveyTable table = FullSurvey();
  table.Set(TextColumn::kComment, 2, "50 % = a;b");
  table.SetStatus(3, RowStatus::kTrended);
  const SurveyTable back = Parsed(WriteSurvey(table, SurveyFormat::kWitsml21));
  support::ExpectSameStations(
      table, back,
      std::vector{Column::kNorthing, Column::kEasting, Column::kDown, Column::kSigmaInclination,
                  Column::kSigmaAzimuth, Column::kEarthRateMeasured});
  EXPECT_EQ(back.Get(TextColumn::kQuality, 3), "moved+gap");
  EXPECT_EQ(back.Get(TextColumn::kComment, 2), "50 % = a;b");
  EXPECT_EQ(back.status(3), RowStatus::kTrended);
}

TEST(Delivery, PositionsSummedBetweenTheStationsSaySo) {
  SurveyTable table = FullSurvey();
  EXPECT_LT(*DepartureFromListed(table), 1e-9);
  for (std::size_t row = 1; row < table.rows(); ++row) {
    table.Set(Column::kNorth, row, *table.Get(Column::kNorth, row) + 0.02);
  }
  EXPECT_NEAR(*DepartureFromListed(table), 0.02, 1e-9);
  SayDeparture(table);
  SayDeparture(table);
  ASSERT_EQ(table.head.remarks.size(), 1u);
  EXPECT_THAT(table.head.remarks[0], HasSubstr("0.020 m"));
  for (const SurveyFormat format :
       {SurveyFormat::kLas, SurveyFormat::kP717, SurveyFormat::kWitsml1411, SurveyFormat::kWitsml21,
        SurveyFormat::kPetrel, SurveyFormat::kCompass, SurveyFormat::kOsdu, SurveyFormat::kKml}) {
    EXPECT_THAT(WriteSurvey(table, format), HasSubstr("0.020 m")) << WordOf(format);
  }
  SumAsListed(table);
  EXPECT_LT(*DepartureFromListed(table), 1e-5);
  EXPECT_NEAR(*table.Get(Column::kNorth, 0), -4.4321, 1e-9);
}

TEST(Delivery, EveryDirectionTurns) {
  SurveyTable table = FullSurvey();
  for (std::size_t row = 0; row < table.rows(); ++row) {
    table.Set(Column::kClosureAzimuth, row, 0.3);
    table.Set(Column::kBiasN, row, 1);
    table.Set(Column::kBiasE, row, 0);
  }
  TurnTo(table, North::kTrue);
  const double turn = -1.2345 * units::kDeg;
  EXPECT_NEAR(*table.Get(Column::kClosureAzimuth, 2), 0.3 + turn, 1e-12);
  EXPECT_NEAR(*table.Get(Column::kBiasE, 2), std::sin(turn), 1e-12);
}

TEST(Layouts, PositionLogs) {
  const SurveyTable t = Parsed(
      "MD[m],X[m],Y[m],Z[m]\n0,400000,6500000,25\n100,400000,6500000,-75\n"
      "200,400050,6500000,-161.6\n\n");
  ASSERT_EQ(t.rows(), 3u);
  EXPECT_EQ(t.status(2), RowStatus::kBackCalculated);
  EXPECT_NEAR(t.inclination(2), 30 * units::kDeg, 1e-3);
  EXPECT_NEAR(t.azimuth(2), 90 * units::kDeg, 1e-9);
  EXPECT_EQ(t.head.azimuth.north, North::kGrid);
  EXPECT_THAT(t.head.notes, Contains(HasSubstr("position log")));
  const auto mixed =
      ParseSurvey("MD[ft],X[m],Y[m],Z[m]\n0,4,6,25\n100,4,6,-75\n200,54,6,-161.6\n", "text");
  ASSERT_FALSE(mixed);
  EXPECT_THAT(mixed.fault().text, HasSubstr("--depth-unit"));
}

TEST(Layouts, Edm) {
  const auto station = [](double md, double inc, double azi, double tvd, double north,
                          double east) {
    return "<CD_DEFINITIVE_SURVEY_STATION well_id=\"w\" wellbore_id=\"b\" "
           "def_survey_header_id=\"h\" md=\"" +
           std::to_string(md) + "\" inclination=\"" + std::to_string(inc) + "\" azimuth=\"" +
           std::to_string(azi) + "\" tvd=\"" + std::to_string(tvd) + "\" offset_north=\"" +
           std::to_string(north) + "\" offset_east=\"" + std::to_string(east) + "\"/>";
  };
  const std::string text =
      "<export><CD_WELL well_id=\"w\" well_common_name=\"A-1\"/>"
      "<CD_DEFINITIVE_SURVEY_HEADER well_id=\"w\" wellbore_id=\"b\" def_survey_header_id=\"h\" "
      "name=\"Gyro\" phase=\"ACTUAL\"/>" +
      station(200, 4, 90, 199.85, 0, 6.98) + station(0, 0, 0, 0, 0, 0) +
      station(100, 2, 90, 99.98, 0, 1.75) + "</export>";
  const SurveyTable t = Parsed(text, {.north = North::kGrid});
  ASSERT_EQ(t.rows(), 3u);
  EXPECT_EQ(t.md(1), 100 * units::kFoot);
  EXPECT_EQ(t.head.names.well, "A-1");
  EXPECT_EQ(t.head.names.survey, "Gyro");
  EXPECT_EQ(t.Get(Column::kEast, 2), 6.98 * units::kFoot);
}

TEST(Layouts, ATableOfSamplesIsToldWhatItCouldBe) {
  const auto table = ParseSurvey("time,gyro_x,gyro_y,acc_x\n0,1,2,3\n", "text");
  ASSERT_FALSE(table);
  EXPECT_THAT(table.fault().text, HasSubstr("GX[deg/h]"));
}

TEST(Layouts, PetrelWithoutUnitLinesAndLocal) {
  std::string text = WriteSurvey(FullSurvey(LengthUnit::kFoot), SurveyFormat::kPetrel);
  for (const std::string start : {"# DX DY", "# DEPTH", "# wellgyro"}) {
    const std::size_t at = text.find(start);
    text.erase(at, text.find('\n', at) + 1 - at);
  }
  const SurveyTable feet = Parsed(text);
  EXPECT_EQ(feet.head.md_unit, LengthUnit::kFoot);
  EXPECT_NEAR(feet.md(6), 180 * units::kFoot, 1e-9);
  EXPECT_THAT(feet.head.notes, Contains(HasSubstr("in feet")));
  const std::size_t system = text.find("EPSG:23031");
  text.replace(system, 10, "LOCAL");
  const SurveyTable local = Parsed(text);
  EXPECT_FALSE(local.Has(Column::kNorthing));
  EXPECT_THAT(local.head.notes, Contains(HasSubstr("local")));
}

}  // namespace
}  // namespace wellgyro
