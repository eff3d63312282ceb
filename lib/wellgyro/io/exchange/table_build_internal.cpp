#include "wellgyro/io/exchange/table_build_internal.h"

#include <array>
#include <cstddef>
#include <stdexcept>
#include <utility>

#include <fmt/core.h>

#include "wellgyro/base/angle.h"
#include "wellgyro/io/exchange/survey_words_internal.h"
#include "wellgyro/io/text_internal.h"
#include "wellgyro/io/words.h"

namespace wellgyro {
namespace {

// Plain texts of a head and the keys they go by.
struct TextKey {
  std::string_view key;
  std::string SurveyIdentity::*member;
};
constexpr std::array kTextKeys{
    TextKey{"well", &SurveyIdentity::well},
    TextKey{"uwi", &SurveyIdentity::uwi},
    TextKey{"wellbore", &SurveyIdentity::wellbore},
    TextKey{"uwi_wellbore", &SurveyIdentity::uwi_wellbore},
    TextKey{"field", &SurveyIdentity::field},
    TextKey{"region", &SurveyIdentity::region},
    TextKey{"country", &SurveyIdentity::country},
    TextKey{"structure", &SurveyIdentity::structure},
    TextKey{"rig", &SurveyIdentity::rig},
    TextKey{"survey", &SurveyIdentity::survey},
    TextKey{"operator", &SurveyIdentity::operator_name},
    TextKey{"contractor", &SurveyIdentity::contractor},
    TextKey{"job", &SurveyIdentity::job},
    TextKey{"begin", &SurveyIdentity::begin},
    TextKey{"end", &SurveyIdentity::end},
    TextKey{"created", &SurveyIdentity::created},
};

struct HeadTextKey {
  std::string_view key;
  std::string SurveyHead::*member;
};
constexpr std::array kHeadTextKeys{
    HeadTextKey{"datum", &SurveyHead::datum},
    HeadTextKey{"vertical_reference", &SurveyHead::vertical_reference},
    HeadTextKey{"crs", &SurveyHead::crs},
    HeadTextKey{"method", &SurveyHead::method},
    HeadTextKey{"error_model", &SurveyHead::error_model},
};

struct NumberKey {
  std::string_view key;
  std::optional<double> SurveyHead::*member;
  Quantity quantity;
};
constexpr std::array kNumberKeys{
    NumberKey{"datum_elevation_m", &SurveyHead::datum_elevation, Quantity::kRatio},
    NumberKey{"grid_scale", &SurveyHead::scale, Quantity::kRatio},
    NumberKey{"section_azimuth_deg", &SurveyHead::section_azimuth, Quantity::kAngle},
};

struct ReferenceKey {
  std::string_view key;
  std::optional<double> AzimuthReference::*member;
};
constexpr std::array kReferenceKeys{
    ReferenceKey{"grid_convergence_deg", &AzimuthReference::convergence},
    ReferenceKey{"declination_deg", &AzimuthReference::declination},
};

double FactorOfKey(Quantity quantity) { return quantity == Quantity::kAngle ? FromDegrees(1) : 1; }

}  // namespace

Pairs PairsOf(const SurveyHead& head) {
  Pairs pairs;
  const auto add = [&](std::string_view key, std::string_view value) {
    if (!value.empty()) pairs.emplace_back(key, value);
  };
  for (const TextKey& k : kTextKeys) add(k.key, head.names.*k.member);
  if (head.azimuth.north != North::kUnknown) add("north_reference", WordOf(head.azimuth.north));
  for (const ReferenceKey& k : kReferenceKeys) {
    if (const auto& value = head.azimuth.*k.member) add(k.key, Exact(*value, FromDegrees(1)));
  }
  add("declination_source", head.azimuth.declination_source);
  add("declination_date", head.azimuth.declination_date);
  for (const HeadTextKey& k : kHeadTextKeys) add(k.key, head.*k.member);
  for (const NumberKey& k : kNumberKeys) {
    if (const auto& value = head.*k.member) add(k.key, Exact(*value, FactorOfKey(k.quantity)));
  }
  if (head.md_kind != DepthKind::kIndicated) add("depth_kind", WordOf(head.md_kind));
  add("tool", WordOf(head.tool));
  for (const std::string& remark : head.remarks) add("remark", remark);
  return pairs;
}

std::string OneLine(std::string remark) {
  for (char& c : remark) {
    if (c == '\n' || c == '\r') c = ' ';
  }
  return remark;
}

void AddRemark(SurveyHead& head, std::string remark) {
  constexpr std::size_t kMostRemarks = 1000;
  if (head.remarks.size() < kMostRemarks) head.remarks.push_back(std::move(remark));
}

std::string JoinedRemarks(const SurveyHead& head) {
  std::string text;
  for (const std::string& remark : head.remarks) {
    text += (text.empty() ? "" : "; ") + OneLine(remark);
  }
  return text;
}

bool TakePair(SurveyHead& head, std::string_view key, std::string_view value) {
  key = Trim(key);
  value = Trim(value);
  for (const TextKey& k : kTextKeys) {
    if (k.key == key) return head.names.*k.member = value, true;
  }
  for (const HeadTextKey& k : kHeadTextKeys) {
    if (k.key == key) return head.*k.member = value, true;
  }
  if (key == "declination_source") return head.azimuth.declination_source = value, true;
  if (key == "declination_date") return head.azimuth.declination_date = value, true;
  if (key == "remark") return head.remarks.emplace_back(value), true;
  if (key == "north_reference") {
    const auto north = NorthOf(value);
    if (north) head.azimuth.north = *north;
    return north.has_value();
  }
  if (key == "depth_kind") {
    const auto kind = DepthKindOf(value);
    if (kind) head.md_kind = *kind;
    return kind.has_value();
  }
  if (key == "tool") {
    const auto tool = SurveyToolOf(value);
    if (tool) head.tool = *tool;
    return tool.has_value();
  }
  const std::optional<double> number = NumberOf(value);
  if (!number) return false;
  for (const ReferenceKey& k : kReferenceKeys) {
    if (k.key == key) return head.azimuth.*k.member = *number * FromDegrees(1), true;
  }
  for (const NumberKey& k : kNumberKeys) {
    if (k.key == key) return head.*k.member = *number * FactorOfKey(k.quantity), true;
  }
  return false;
}

void Lacks(std::string_view format, std::string_view what) {
  throw std::invalid_argument(fmt::format("{} needs {}", format, what));
}

void NeedNorth(const SurveyTable& table, std::string_view format) {
  if (table.head.azimuth.north == North::kUnknown) {
    Lacks(format,
          "to be told which north the azimuths count from: true, grid or magnetic, by "
          "--azimuth-reference");
  }
}

void CheckRows(const SurveyTable& table, std::string_view format) {
  for (const ColumnInfo& info : AllColumns()) {
    for (std::size_t row = 0; table.Has(info.column) && row < table.rows(); ++row) {
      const std::optional<double> value = table.Get(info.column, row);
      if (!value || std::isfinite(*value)) continue;
      throw std::invalid_argument(
          fmt::format("{} cannot be written: row {} has {} = {}", format, row, info.csv, *value));
    }
  }
  std::optional<double> last;
  for (std::size_t row = 0; row < table.rows(); ++row) {
    if (!OnPath(table.status(row))) continue;
    const double md = table.Get(Column::kMd, row).value_or(last.value_or(0));
    if (last && md < *last) {
      throw std::invalid_argument(
          fmt::format("{} cannot be written: row {} has depth {} m after {} m: depth must increase",
                      format, row, md, *last));
    }
    last = md;
  }
}

}  // namespace wellgyro
