#include "wellgyro/io/exchange/geo_path_internal.h"

#include <cmath>
#include <stdexcept>
#include <utility>

#include <fmt/core.h>

#include "wellgyro/base/angle.h"
#include "wellgyro/earth/grid.h"
#include "wellgyro/io/exchange/table_build_internal.h"
#include "wellgyro/uncertainty/ellipse.h"

namespace wellgyro {
namespace {

// Corners of an ellipse: between them it is short by 1 - cos 5.6 deg = 0.5 %.
constexpr int kRing = 32;

std::optional<GeodeticPoint> HeadPlace(const SurveyHead& head) {
  for (const PositionObject& object : head.objects) {
    if (object.kind != "WRP" && object.kind != "ZDP") continue;
    if (object.latitude_wgs84 && object.longitude_wgs84) {
      return GeodeticPoint{*object.latitude_wgs84, *object.longitude_wgs84};
    }
    if (object.latitude && object.longitude) {
      return GeodeticPoint{*object.latitude, *object.longitude};
    }
  }
  return std::nullopt;
}

double TurnToTrue(const SurveyHead& head) {
  if (head.offsets == North::kTrue) return 0;
  return AzimuthFrom(head.azimuth, 0, head.offsets, North::kTrue);
}

class PathMaker {
 public:
  explicit PathMaker(const SurveyTable& table) : table_(table), place_(HeadPlace(table.head)) {
    whole_ = table.rows() > 0;
    for (std::size_t row = 0; row < table.rows(); ++row) {
      whole_ = whole_ && table.Get(Column::kLatitude, row) && table.Get(Column::kLongitude, row);
    }
    if (whole_) return;
    if (!place_) {
      Lacks("a map",
            "latitudes and longitudes, or those of the well head (--latitude-deg, "
            "--longitude-deg)");
    }
    turn_ = TurnToTrue(table.head);
  }

  std::optional<GeoStation> At(std::size_t row) const {
    const auto place = PlaceOf(row);
    if (!place) return std::nullopt;
    GeoStation station{.row = row,
                       .latitude_deg = ToDegrees(place->latitude),
                       .longitude_deg = ToDegrees(place->longitude)};
    const auto down = table_.Get(Column::kDown, row), tvd = table_.Get(Column::kTvd, row);
    if (down) {
      station.elevation = -*down;
    } else if (tvd && table_.head.datum_elevation) {
      station.elevation = *table_.head.datum_elevation - *tvd;
    }
    AddEllipse(*place, station);
    return station;
  }

 private:
  std::optional<GeodeticPoint> PlaceOf(std::size_t row) const {
    if (whole_) {
      return GeodeticPoint{*table_.Get(Column::kLatitude, row),
                           *table_.Get(Column::kLongitude, row)};
    }
    const auto n = table_.Get(Column::kNorth, row), e = table_.Get(Column::kEast, row);
    if (!n || !e) return std::nullopt;
    return OffsetGeodetic(*place_, *n * std::cos(turn_) - *e * std::sin(turn_),
                          *n * std::sin(turn_) + *e * std::cos(turn_));
  }

  void AddEllipse(const GeodeticPoint& place, GeoStation& station) const {
    const auto nn = table_.Get(Column::kVarNN, station.row);
    const auto ne = table_.Get(Column::kCovNE, station.row);
    const auto ee = table_.Get(Column::kVarEE, station.row);
    if (!nn || !ne || !ee || !(*nn > 0) || !(*ee > 0)) return;
    Eigen::Matrix3d cov = Eigen::Matrix3d::Zero();
    cov(0, 0) = *nn;
    cov(0, 1) = cov(1, 0) = *ne;
    cov(1, 1) = *ee;
    const ErrorEllipse ellipse = HorizontalEllipse(cov, kConfidence);
    const double azimuth = ellipse.azimuth_major + turn_;
    for (int k = 0; k <= kRing; ++k) {
      const double t = kTwoPi * (k % kRing) / kRing;
      const double along = ellipse.semi_major * std::cos(t),
                   across = ellipse.semi_minor * std::sin(t);
      const GeodeticPoint p =
          OffsetGeodetic(place, along * std::cos(azimuth) - across * std::sin(azimuth),
                         along * std::sin(azimuth) + across * std::cos(azimuth));
      station.ellipse.push_back({ToDegrees(p.longitude), ToDegrees(p.latitude)});
    }
  }

  const SurveyTable& table_;
  std::optional<GeodeticPoint> place_;
  double turn_ = 0;
  bool whole_ = false;
};

}  // namespace

std::vector<GeoStation> GeoPathOf(const SurveyTable& table) {
  const PathMaker maker(table);
  std::vector<GeoStation> path;
  for (std::size_t row = 0; row < table.rows(); ++row) {
    if (!OnPath(table.status(row))) continue;
    if (auto station = maker.At(row)) path.push_back(*std::move(station));
  }
  if (path.size() < 2) Lacks("a map", "two stations with positions");
  return path;
}

std::vector<std::pair<std::string, std::string>> GeoFactsOf(const SurveyTable& table) {
  std::vector<std::pair<std::string, std::string>> facts;
  std::string remarks;
  for (const auto& [key, value] : PairsOf(table.head)) {
    if (key == "remark") {
      remarks += (remarks.empty() ? "" : "; ") + value;
    } else {
      facts.emplace_back(key, value);
    }
  }
  if (!remarks.empty()) facts.emplace_back("remarks", remarks);
  facts.emplace_back("stations", std::to_string(table.rows()));
  facts.emplace_back("ellipse_confidence", fmt::format("{}", kConfidence));
  return facts;
}

std::string JsonQuoted(std::string_view text) {
  std::string quoted = "\"";
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if (c == '"' || c == '\\') {
      quoted += '\\';
      quoted += c;
    } else if (byte < 0x20) {
      quoted += fmt::format("\\u{:04x}", byte);
    } else {
      quoted += c;
    }
  }
  return quoted + '"';
}

}  // namespace wellgyro
