#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "wellgyro/base/export.h"
#include "wellgyro/record/survey_head.h"

/// @file
/// A survey by columns, as files exchange it.
namespace wellgyro {

/// The numbers a station can have, in SI and radians. Every column but the first three may be
/// absent, as a whole or in single rows.
enum class Column : std::uint8_t {
  kMd,
  kInclination,
  kAzimuth,  ///< from the north of SurveyHead::azimuth
  kTvd,
  kNorth,
  kEast,  ///< offsets from the well head, by the north of SurveyHead::offsets
  kNorthing,
  kEasting,
  kDown,  ///< below the vertical reference, in the CRS
  kLatitude,
  kLongitude,
  kTvdSubSea,
  kDogleg,
  kBuild,
  kTurn,
  kToolface,          ///< from the high side
  kMagneticToolface,  ///< from north
  kVerticalSection,
  kClosure,
  kClosureAzimuth,
  kAzimuthTrue,
  kAzimuthGrid,
  kAzimuthMagnetic,  ///< beside kAzimuth, where a file has more than one
  kVarNN,
  kCovNE,
  kCovNV,
  kVarEE,
  kCovEV,
  kVarVV,
  kBiasN,
  kBiasE,
  kBiasV,
  kSigmaInclination,
  kSigmaAzimuth,
  kGravity,
  kGravityRef,
  kEarthRateMeasured,
  kEarthRateReference,
  kConvergence,
  kScale,
  kTemperature,  ///< [degC]
  kUtc,          ///< seconds since 1970, good to a microsecond
  kSurvey,       ///< number of the SurveyRun
  kObject,       ///< number of the PositionObject that the row is
};
inline constexpr std::size_t kColumns = static_cast<std::size_t>(Column::kObject) + 1;

/// The texts a station can have; each may be absent.
enum class TextColumn : std::uint8_t {
  kUid,
  kPoint,  ///< what stands there: ZDP, WRP, TP, D, BHL
  kTool,
  kErrorModel,
  kKind,     ///< of a station of ours
  kQuality,  ///< of a station of ours
  kComment,
};
inline constexpr std::size_t kTextColumns = static_cast<std::size_t>(TextColumn::kComment) + 1;

/// How a row came to be, in the words of IOGP P7/17.
enum class RowStatus : std::uint8_t {
  kUnused,  ///< surveyed, but not part of the path
  kSurveyed,
  kPlanned,
  kInclinationInterpolated,
  kAzimuthInterpolated,
  kInterpolated,
  kProjected,
  kTrended,
  kBackCalculated,
  kOther,
  kTieIn,
};

/// A survey as files exchange it: a head, and stations by columns. Every format of io/ reads into
/// it and writes from it. Takes 8 bytes for each number it holds.
class WELLGYRO_EXPORT SurveyTable {
 public:
  SurveyHead head;

  std::size_t rows() const { return status_.size(); }
  bool Has(Column column) const { return !Values(column).empty(); }
  bool Has(TextColumn column) const { return !texts_[static_cast<std::size_t>(column)].empty(); }

  /// Appends a station and gives its row.
  std::size_t Add(double md, double inclination, double azimuth,
                  RowStatus status = RowStatus::kSurveyed);

  void Set(Column column, std::size_t row, double value);
  void Set(TextColumn column, std::size_t row, std::string text);
  void SetStatus(std::size_t row, RowStatus status) { status_[row] = status; }
  /// Takes a column away.
  void Drop(Column column);
  /// Takes one value away.
  void Clear(Column column, std::size_t row);
  /// Turns the order of the rows round.
  void Reverse();

  std::optional<double> Get(Column column, std::size_t row) const;
  const std::string& Get(TextColumn column, std::size_t row) const;  ///< empty where absent
  RowStatus status(std::size_t row) const { return status_[row]; }
  double md(std::size_t row) const { return Values(Column::kMd)[row]; }
  double inclination(std::size_t row) const { return Values(Column::kInclination)[row]; }
  double azimuth(std::size_t row) const { return Values(Column::kAzimuth)[row]; }

  /// Numbers held, for those who mind memory.
  std::size_t cells() const;

 private:
  const std::vector<double>& Values(Column column) const {
    return values_[static_cast<std::size_t>(column)];
  }

  std::vector<RowStatus> status_;
  std::vector<double> values_[kColumns];
  std::vector<bool> known_[kColumns];  ///< beside values_; shorter where the rest is absent
  std::vector<std::string> texts_[kTextColumns];
};

}  // namespace wellgyro
