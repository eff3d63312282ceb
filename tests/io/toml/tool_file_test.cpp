#include "wellgyro/io/toml/tool_file.h"

#include <stdexcept>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "calibration/random_tool.h"

namespace wellgyro {
namespace {

using testing::HasSubstr;

void ExpectSame(const SensorGroup& a, const SensorGroup& b) {
  const double rounding = 1e-15;
  EXPECT_EQ(a.n_channels, b.n_channels);
  EXPECT_EQ(a.channel, b.channel);
  EXPECT_EQ(a.unit_per_count, b.unit_per_count);
  EXPECT_EQ(a.unit, b.unit);
  EXPECT_EQ(a.per_second, b.per_second);
  EXPECT_EQ(a.R_TS, b.R_TS);
  EXPECT_EQ(a.heating, b.heating);
  EXPECT_EQ(a.thermometer, b.thermometer);
  EXPECT_TRUE(a.second_order.isApprox(b.second_order, rounding));
  EXPECT_TRUE(a.g_squared.isApprox(b.g_squared, rounding));
  for (std::size_t n = 0; n < SensorGroup::kPowers; ++n) {
    EXPECT_EQ(a.bias[n], b.bias[n]);
    EXPECT_TRUE(a.sensitivity[n].isApprox(b.sensitivity[n], rounding));
    EXPECT_TRUE(a.g_dependence[n].isApprox(b.g_dependence[n], rounding));
  }
  if (a.thermometer < 0) return;
  EXPECT_EQ(a.reference, b.reference);
  EXPECT_EQ(a.half_range, b.half_range);
  EXPECT_EQ(a.min, b.min);
  EXPECT_EQ(a.max, b.max);
}

TEST(ToolFile, ComesBackAsItWasWritten) {
  ToolCalibration tool = test::RandomTool(3, {.gyro_channels = 4,
                                              .temperature = true,
                                              .second_order = true,
                                              .g_terms = true,
                                              .rotated = true});
  tool.asset_serial = "T-7 \"b\"";
  tool.sensor_serials = "G12;A3";
  tool.note = "by hand";
  tool.calibrated = UtcTime{1'767'225'600'000'000'000};  // 2026-01-01
  tool.rests_on_prior = true;
  tool.rests_on = {std::string(64, 'a'), std::string(64, 'b')};
  tool.expires = UtcTime{1'782'864'000'000'000'000};  // 2026-07-01
  tool.gyro.heating[1] = 0.25;
  tool.gyro.per_second = true;
  tool.mag.R_TS << 0, 1, 0, -1, 0, 0, 0, 0, 1;
  tool.accel.covariance = ParameterCovariance{{"bias[0]", "bias[1]"}, Eigen::Matrix2d::Identity()};
  tool.errors = ErrorPriors{.gyro_bias_sigma = 1e-7, .accel_noise = 2e-3};
  const std::string text = ToolToml(tool);
  EXPECT_THAT(text, HasSubstr("calibrated = \"2026-01-01\"\nexpires = \"2026-07-01\"\n"));
  EXPECT_THAT(text, HasSubstr("axes = [\"+y\", \"-x\", \"+z\"]"));
  const auto back = ParseTool(text, "t.toml");
  ASSERT_TRUE(back.has_value()) << back.fault().text << " " << back.fault().line;
  ExpectSame(tool.gyro, back->gyro);
  ExpectSame(tool.accel, back->accel);
  ExpectSame(tool.mag, back->mag);
  EXPECT_EQ(back->asset_serial, tool.asset_serial);
  EXPECT_EQ(back->sensor_serials, tool.sensor_serials);
  EXPECT_EQ(back->note, tool.note);
  EXPECT_EQ(back->calibrated, tool.calibrated);
  EXPECT_EQ(back->expires, tool.expires);
  EXPECT_TRUE(back->rests_on_prior);
  EXPECT_EQ(back->rests_on, tool.rests_on);
  EXPECT_EQ(back->accel.covariance->names, tool.accel.covariance->names);
  EXPECT_EQ(back->accel.covariance->cov, tool.accel.covariance->cov);
  EXPECT_DOUBLE_EQ(back->errors->gyro_bias_sigma, 1e-7);
  EXPECT_EQ(back->errors->accel_noise, 2e-3);
  ASSERT_EQ(back->thermometers.size(), 1u);
  EXPECT_EQ(back->thermometers[0].knee, 120);
  EXPECT_EQ(back->thermometers[0].c2, -0.004);
}

constexpr std::string_view kSmall = R"(format = "wellgyro.tool/1"
calibrated = "2026-02-28"
[accel]
channels = [3, 4, 5]
bias = [0.1, 0.2, 0.3]
sensitivity_per_mps2 = [[2, 0, 0], [0, 2, 0], [0, 0, 2]]
axes = ["+y", "-x", "+z"]
)";

TEST(ToolFile, IsReadInTheUnitsOfItsKeys) {
  const auto tool = ParseTool(
      std::string(kSmall) +
          "[gyro]\nchannels = [0, 1]\nsensitivity_per_deg_per_h = [[1.0, 0, 0], [0, 1.0, 0]]\n"
          "g_dependence_per_g = [[9.80665, 0, 0], [0, 0, 0]]\n",
      "t.toml");
  ASSERT_TRUE(tool.has_value()) << tool.fault().text;
  EXPECT_EQ(tool->accel.sensitivity[0](1, 1), 2);
  EXPECT_EQ(tool->accel.bias[0][2], 0.3);
  EXPECT_EQ(tool->accel.R_TS(1, 0), -1);
  EXPECT_NEAR(tool->gyro.sensitivity[0](0, 0), 206264.80624709636, 1e-9);
  EXPECT_EQ(tool->gyro.g_dependence[0](0, 0), 1);
  EXPECT_EQ(tool->calibrated->ns, 1'772'236'800'000'000'000);
}

TEST(ToolFile, NamesLineAndKeyOfWhatIsWrong) {
  const auto fault = [](std::string from, std::string to) {
    std::string text(kSmall);
    text.replace(text.find(from), from.size(), to);
    const auto tool = ParseTool(text, "t.toml");
    EXPECT_FALSE(tool.has_value()) << to;
    return tool.has_value() ? Fault{} : tool.fault();
  };
  EXPECT_EQ(fault("2026-02-28", "2026-02-30").line, 2);
  EXPECT_THAT(fault("2026-02-28", "2026-02-30").text, HasSubstr("is no date"));
  EXPECT_THAT(fault("[3, 4, 5]", "[3, 4.5, 5]").text, HasSubstr("whole numbers"));
  EXPECT_THAT(fault("[3, 4, 5]", "[3, 4, 16]").text, HasSubstr("channels"));
  EXPECT_THAT(fault("[3, 4, 5]", "[3, 4]").text, HasSubstr("one for each of 2 channels"));
  EXPECT_THAT(fault("[3, 4, 5]", "[3, 4, 4]").text, HasSubstr("named twice"));
  EXPECT_EQ(fault("bias = [0.1, 0.2, 0.3]", "bias = [0.1, 0.2]").line, 5);
  EXPECT_THAT(fault("-x", "-u").text, HasSubstr("names no axes"));
  EXPECT_THAT(fault("\"-x\"", "\"-y\"").text, HasSubstr("right angles"));
  EXPECT_THAT(fault("sensitivity_per_mps2", "sensitivity_per_mp2").text,
              HasSubstr("sensitivity_per_mp2"));
  EXPECT_THAT(fault("[0, 2, 0]", "[2, 0, 0]").text, HasSubstr("do not separate"));
  EXPECT_EQ(ParseTool("x", "t").fault().code, FaultCode::kSyntax);
  EXPECT_EQ(ParseTool("format = \"wellgyro.tool/1\"", "t").fault().code, FaultCode::kRange);
}

}  // namespace
}  // namespace wellgyro
