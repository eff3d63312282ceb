// Files made from wells with one error planted in each: of unit, north, datum, offset or null. None
// may be converted into other numbers than the truth's, and the clean ones must get in.
#include "planted_errors.h"

#include <array>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include <gmock/gmock.h>

#include "wellgyro/base/angle.h"
#include "wellgyro/io/exchange/exchange.h"

#include "foreign_files.h"

namespace wellgyro {
namespace {

using foreign::Look;
using foreign::Planted;
using foreign::Sheet;
using foreign::SheetOf;
using foreign::Well;

constexpr std::array kLooks{Look::kBrackets, Look::kUnitLine, Look::kTabs,
                            Look::kLas,      Look::kReport,   Look::kPreamble};

std::filesystem::path Reference(const std::string& name) {
  return std::filesystem::path(WELLGYRO_REFERENCE_DIR) / name;
}

void Add(std::vector<Well>& wells, const std::filesystem::path& path, const ReadOptions& options) {
  const auto table = ReadSurvey(path, options);
  ASSERT_TRUE(table) << path << " " << table.fault().text;
  Well well{.name = path.stem().string()};
  for (std::size_t row = 0; row < table->rows(); ++row) {
    const auto rounded = [](double value) { return std::round(value * 100) / 100; };
    well.md.push_back(rounded(table->md(row)));
    well.inclination.push_back(rounded(ToDegrees(table->inclination(row))));
    well.azimuth.push_back(std::fmod(rounded(ToDegrees(table->azimuth(row))), 360));
  }
  const auto k = static_cast<double>(wells.size());
  well.convergence = (wells.size() % 2 == 0 ? -1 : 1) * (0.6 + 0.23 * k);
  well.declination = 3.1 + 0.37 * k;
  well.elevation = 25.3 + 3 * k;
  well.northing = 6625015.54 + 1000 * k;
  well.easting = 427710.69 - 1000 * k;
  Sum(well);
  wells.push_back(well);
}

std::vector<Well> Wells() {
  std::vector<Well> wells;
  const std::filesystem::path own = std::filesystem::path(WELLGYRO_DATA_DIR) / "wells";
  for (const char* name : {"s-shape.csv", "horizontal-turn.csv", "near-vertical.csv"}) {
    Add(wells, own / name, {});
  }
  if (!std::filesystem::exists(Reference("wells"))) {
    std::printf("the reference wells are not here: our own alone\n");
    return wells;
  }
  const ReadOptions metres{.depth_unit = LengthUnit::kMetre, .north = North::kGrid};
  const ReadOptions columns{.columns = {{"MD[m]", "1"}, {"INC", "2"}, {"AZI_GRID", "3"}}};
  for (const char* name : {"iscwsa-1.txt", "iscwsa-2.txt", "iscwsa-3.txt"}) {
    Add(wells, Reference("wells") / name, columns);
  }
  Add(wells, Reference("wells/volve/15_9-F-12_Survey_Data.csv"), metres);
  Add(wells, Reference("wells/nlog/P11-A-02_SURV.csv"), metres);
  Add(wells, Reference("wells/wellpathpy/well9.csv"), {});
  Add(wells, Reference("wells/wellpathpy/well10.csv"), {});
  Add(wells, Reference("wells/p717/exampleA.p717"), {});
  return wells;
}

// What is wrong with a table that was read, against the truth; empty where nothing is.
std::string WrongIn(const SurveyTable& table, const Well& well) {
  const double grid_to_true = FromDegrees(well.convergence);
  const double grid_to_magnetic = FromDegrees(well.convergence - well.declination);
  const auto turn = [&](North north) {
    return north == North::kTrue ? grid_to_true : north == North::kMagnetic ? grid_to_magnetic : 0;
  };
  if (table.head.azimuth.north == North::kUnknown) return "";  // it cannot be written
  std::size_t at = 0;
  for (std::size_t row = 0; row < table.rows(); ++row) {
    while (at + 1 < well.md.size() && well.md[at] < table.md(row) - 0.02) ++at;
    if (std::abs(table.md(row) - well.md[at]) > 0.02) return "MD";
    if (table.status(row) != RowStatus::kSurveyed) continue;
    const double inclination = FromDegrees(well.inclination[at]);
    if (std::abs(table.inclination(row) - inclination) > FromDegrees(0.011)) return "inclination";
    const double azimuth = FromDegrees(well.azimuth[at]) + turn(table.head.azimuth.north);
    if (std::abs(WrapPi(table.azimuth(row) - azimuth)) * std::sin(inclination) >
        FromDegrees(0.011)) {
      return "azimuth";
    }
    const double angle = turn(table.head.offsets);
    const double north = well.north[at] * std::cos(angle) - well.east[at] * std::sin(angle);
    const double east = well.north[at] * std::sin(angle) + well.east[at] * std::cos(angle);
    const auto off = [&](Column column, double wanted) {
      const auto value = table.Get(column, row);
      return value && std::abs(*value - wanted) > 0.02;
    };
    if (off(Column::kTvd, well.tvd[at])) return "TVD";
    if (off(Column::kNorth, north) || off(Column::kEast, east)) return "offsets";
    if (off(Column::kNorthing, well.northing + well.north[at])) return "northing";
    if (off(Column::kEasting, well.easting + well.east[at])) return "easting";
    if (off(Column::kTvdSubSea, well.tvd[at] - well.elevation)) return "TVDSS";
  }
  const auto& elevation = table.head.datum_elevation;
  if (elevation && std::abs(*elevation - well.elevation) > 0.02) return "elevation";
  return "";
}

bool Named(const SurveyTable& table) {
  for (const std::string& note : table.head.notes) {
    if (!note.starts_with("MD, inclination and azimuth agree") &&
        !note.starts_with("nothing in the file checks") &&
        !note.starts_with("nothing in it says")) {
      return true;
    }
  }
  return false;
}

// An error that changes nothing is none: a turn within what the file's digits show, say.
bool Matters(const std::string& planted, const Well& well) {
  double reach = 0;
  for (std::size_t k = 0; k < well.md.size(); ++k) {
    reach = std::max(reach, std::hypot(well.north[k], well.east[k]));
  }
  return reach > 20 || planted.find("azimuth") == std::string::npos;
}

struct Count {
  int planted = 0, refused = 0, named = 0, silent = 0, wrong = 0;
};

class CleanFiles : public testing::Test {
 protected:
  static const std::vector<Well>& AllWells() {
    static const std::vector<Well> wells = Wells();
    return wells;
  }
};

// By every fourth file, in four parts.
class PlantedErrors : public CleanFiles, public testing::WithParamInterface<int> {
 protected:
  // Every error of a kind in every well, looks and units by turns, until `many` files are made.
  static Count Plant(const std::string& kind, const std::vector<Planted>& errors, int many) {
    Count count;
    const std::size_t each = errors.size() * AllWells().size();
    for (std::size_t k = 0; count.planted < many && k < 20 * each; ++k) {
      const Planted& error = errors[k % errors.size()];
      const Well& well = AllWells()[k / errors.size() % AllWells().size()];
      const Look look = kLooks[(k + k / each) % kLooks.size()];
      const std::string unit = (k / 3 + k / each) % 2 == 0 ? "m" : "ft";
      if (!Matters(error.name, well)) continue;
      // LAS says itself what stands for nothing.
      if (look == Look::kLas && error.name.starts_with("-999.25")) continue;
      if (count.planted++ % 4 != GetParam()) continue;
      Sheet sheet = SheetOf(well, unit, error.map);
      error.plant(sheet, well);
      Judge(TextOf(sheet, look, well.name),
            kind + ", " + error.name + ", " + well.name + ", " + unit + ", look " +
                std::to_string(static_cast<int>(look)),
            well, count);
    }
    std::printf("%-8s %4d refused, %4d named, %d silent, %d converted wrong\n", kind.c_str(),
                count.refused, count.named, count.silent, count.wrong);
    return count;
  }

  static void Judge(const std::string& text, const std::string& what, const Well& well,
                    Count& count) {
    const auto table = ParseSurvey(text, "file");
    if (!table) {
      ++count.refused;
      return;
    }
    const std::string wrong = WrongIn(*table, well);
    if (!wrong.empty()) {
      ++count.wrong;
      ADD_FAILURE() << what << ": converted into a wrong " << wrong << "\n"
                    << testing::PrintToString(table->head.notes) << "\n"
                    << text.substr(0, 600);
    } else if (Named(*table)) {
      ++count.named;
    } else {
      ++count.silent;
      std::printf("  silent: %s\n", what.c_str());
    }
  }
};

TEST_P(PlantedErrors, AreNamedOrRefused) {
  Count all;
  int told = 0;
  const auto add = [&](const Count& c) {
    all.planted += c.planted;
    all.silent += c.silent;
    all.wrong += c.wrong;
    told += c.named + c.refused;
  };
  add(Plant("unit", foreign::UnitErrors(), 200));
  add(Plant("north", foreign::NorthErrors(), 200));
  add(Plant("datum", foreign::DatumErrors(), 200));
  add(Plant("offset", foreign::OffsetErrors(), 200));
  add(Plant("null", foreign::NullErrors(), 200));
  EXPECT_EQ(all.planted, 1000);
  EXPECT_EQ(told + all.silent + all.wrong, 250);
  EXPECT_LE(all.silent, 2);
  EXPECT_EQ(all.wrong, 0);
}

INSTANTIATE_TEST_SUITE_P(Parts, PlantedErrors, testing::Range(0, 4));

TEST_F(CleanFiles, GetIn) {
  int clean = 0;
  for (const Well& well : AllWells()) {
    for (const Look look : kLooks) {
      for (const std::string unit : {"m", "ft"}) {
        for (const bool map : {false, true}) {
          const std::string text = TextOf(SheetOf(well, unit, map), look, well.name);
          const auto table = ParseSurvey(text, "file");
          ASSERT_TRUE(table) << well.name << " look " << static_cast<int>(look) << unit << "\n"
                             << table.fault().text << "\n"
                             << text.substr(0, 600);
          EXPECT_EQ(WrongIn(*table, well), "") << well.name;
          EXPECT_EQ(table->rows(), well.md.size());
          EXPECT_FALSE(Named(*table)) << testing::PrintToString(table->head.notes);
          ++clean;
        }
      }
    }
  }
  std::printf("%d clean files, none refused\n", clean);
}

}  // namespace
}  // namespace wellgyro
