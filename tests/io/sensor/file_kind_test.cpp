#include "wellgyro/io/sensor/file_kind.h"

#include <string>

#include <gtest/gtest.h>

#include "wellgyro/io/exchange/survey_csv.h"
#include "wellgyro/io/text_file.h"

#include "support/scratch.h"

namespace wellgyro {
namespace {

TEST(IdentifyBytes, KnowsOurOwnByTheirFormatLine) {
  EXPECT_EQ(IdentifyBytes("format = \"wellgyro.job/1\"\n").kind, FileKind::kJob);
  EXPECT_EQ(IdentifyBytes("# a job\r\n\r\nformat='wellgyro.job/1'\r\n").kind, FileKind::kJob);
  EXPECT_EQ(IdentifyBytes("\xEF\xBB\xBF"
                          "format = \"wellgyro.simulation/1\"")
                .kind,
            FileKind::kSimulation);
  EXPECT_EQ(IdentifyBytes("format = \"wellgyro.noise/1\"").kind, FileKind::kNoise);
  EXPECT_EQ(IdentifyBytes("format = \"wellgyro.calibration/1\"").kind, FileKind::kCalibration);
  EXPECT_EQ(IdentifyBytes("format = \"wellgyro.tool/1\"").kind, FileKind::kTool);
  EXPECT_EQ(IdentifyBytes("format = \"wellgyro.error-model/1\"").kind, FileKind::kErrorModel);
  EXPECT_EQ(IdentifyBytes("format = \"wellgyro.run/1\"").kind, FileKind::kRun);
  EXPECT_EQ(IdentifyBytes("format = \"wellgyro.source/1\"").kind, FileKind::kSource);
  const FileIdentity newer = IdentifyBytes("format = \"wellgyro.job/2\"");
  EXPECT_EQ(newer.kind, FileKind::kUnknownFormat);
  EXPECT_NE(newer.text.find("wellgyro.job/2"), std::string::npos);
}

TEST(IdentifyBytes, KnowsTablesByTheirHeader) {
  EXPECT_EQ(IdentifyBytes(SurveyCsv({}, nullptr)).kind, FileKind::kSurveyCsv);
  EXPECT_EQ(IdentifyBytes(PassesCsv({}, nullptr)).kind, FileKind::kPassesCsv);
  EXPECT_EQ(IdentifyBytes(ChecksCsv({})).kind, FileKind::kChecksCsv);
}

TEST(IdentifyBytes, KnowsLogsAlsoWhereTheirHeadIsDamaged) {
  const std::string event("\xED\xA1\xDA\x01\0\0\0\0\0\0\0\1", 12);
  EXPECT_EQ(IdentifyBytes(event).kind, FileKind::kLcmLog);
  EXPECT_EQ(IdentifyBytes(std::string(1000, '\0') + event).kind, FileKind::kLcmLog);
}

TEST(IdentifyBytes, SaysWhatAForeignFileIs) {
  EXPECT_EQ(IdentifyBytes("").kind, FileKind::kEmpty);
  EXPECT_EQ(IdentifyBytes("").text, "an empty file");
  for (const auto& [bytes, text] : std::initializer_list<std::pair<const char*, const char*>>{
           {"%PDF-1.4", "a PDF document"},
           {"\x1F\x8B\x08", "a gzip archive"},
           {"<?xml version='1.0'?>", "an XML or HTML document"},
           {"md,inc,azi\n1,2,3\n", "text of an unknown kind"},
           {"format = job", "text of an unknown kind"},
           {"\x01\x02\x03", "binary data of an unknown kind"}}) {
    EXPECT_EQ(IdentifyBytes(bytes).kind, FileKind::kForeign);
    EXPECT_EQ(IdentifyBytes(bytes).text, text);
  }
}

TEST(IdentifyBytes, KnowsTheTruthOfASimulation) {
  const FileIdentity truth =
      IdentifyBytes("T[s],MD[m],INC[deg],AZI_TRUE[deg],GTF[deg],TVD[m],N[m],E[m]\n0.000,1\n");
  EXPECT_EQ(truth.kind, FileKind::kTruthCsv);
  EXPECT_EQ(truth.text, "the truth of a wellgyro simulation");
}

TEST(IdentifyBytes, KnowsTablesOfSensorData) {
  const FileIdentity tally = IdentifyBytes("# rig A\nUTC[s],END_UTC[s],LENGTH[m]\n1,2,3\n");
  EXPECT_EQ(tally.kind, FileKind::kSensorCsv);
  EXPECT_EQ(tally.text, "a table of depths");
  EXPECT_EQ(IdentifyBytes("UTC[s],DURATION[s],GX[deg/h],GY[deg/h],AX[g],AY[g],AZ[g]\n").text,
            "a table of averages at rest");
}

TEST(IdentifyFile, ReadsNoMoreThanTheHead) {
  const support::Scratch scratch;
  scratch.Write("big", "format = \"wellgyro.job/1\"\n" + std::string(1 << 20, '#'));
  EXPECT_EQ(IdentifyFile(scratch.path() / "big")->kind, FileKind::kJob);
  EXPECT_EQ(IdentifyFile(scratch.path() / "absent").fault().code, FaultCode::kIo);
  EXPECT_EQ(IdentifyFile(scratch.path()).fault().code, FaultCode::kIo);
  EXPECT_EQ(ReadTextHead(scratch.path() / "big", 10)->size(), 10u);
  EXPECT_EQ(ReadTextFile(scratch.path() / "big")->size(), (1u << 20) + 26);
  EXPECT_EQ(ReadTextFile(scratch.path() / "big", 100).fault().code, FaultCode::kForeign);
}

}  // namespace
}  // namespace wellgyro
