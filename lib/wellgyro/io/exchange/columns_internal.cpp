#include "wellgyro/io/exchange/columns_internal.h"

#include <array>

namespace wellgyro {
namespace {

using C = Column;
using Q = Quantity;

constexpr std::array<ColumnInfo, kColumns> kInfo{{
    {C::kMd, Q::kLength, "MD", "DEPT", "measured depth"},
    {C::kInclination, Q::kAngle, "INC", "DEVI", "inclination from vertical"},
    {C::kAzimuth, Q::kDirection, "AZI", "AZIM", "azimuth of the hole"},
    {C::kTvd, Q::kLength, "TVD", "TVD", "true vertical depth"},
    {C::kNorth, Q::kLength, "N", "NSDR", "north offset from the well head"},
    {C::kEast, Q::kLength, "E", "EWDR", "east offset from the well head"},
    {C::kNorthing, Q::kGridLength, "NORTHING", "NORTHING", "northing"},
    {C::kEasting, Q::kGridLength, "EASTING", "EASTING", "easting"},
    {C::kDown, Q::kGridLength, "DOWN", "DOWN", "depth below the vertical reference"},
    {C::kLatitude, Q::kAngle, "LAT", "LATI", "latitude"},
    {C::kLongitude, Q::kAngle, "LON", "LONG", "longitude"},
    {C::kTvdSubSea, Q::kLength, "TVDSS", "TVDSS", "true vertical depth below mean sea level"},
    {C::kDogleg, Q::kCurvature, "DLS", "DLS", "dogleg severity"},
    {C::kBuild, Q::kCurvature, "BUILD", "BUILD", "build rate"},
    {C::kTurn, Q::kCurvature, "TURN", "TURN", "turn rate"},
    {C::kToolface, Q::kDirection, "GTF", "GTF", "gravity toolface"},
    {C::kMagneticToolface, Q::kDirection, "MTF", "MTF", "magnetic toolface"},
    {C::kVerticalSection, Q::kLength, "VS", "VSEC", "vertical section"},
    {C::kClosure, Q::kLength, "CLOSURE", "CLSR", "closure distance"},
    {C::kClosureAzimuth, Q::kDirection, "CLOSURE_AZI", "CLSRA", "closure azimuth"},
    {C::kAzimuthTrue, Q::kDirection, "AZI_TRUE", "AZT", "azimuth from true north"},
    {C::kAzimuthGrid, Q::kDirection, "AZI_GRID", "AZG", "azimuth from grid north"},
    {C::kAzimuthMagnetic, Q::kDirection, "AZI_MAG", "AZMAG", "azimuth from magnetic north"},
    {C::kVarNN, Q::kArea, "VAR_NN", "VARNN", "variance of north"},
    {C::kCovNE, Q::kArea, "COV_NE", "COVNE", "covariance of north and east"},
    {C::kCovNV, Q::kArea, "COV_NV", "COVNV", "covariance of north and vertical"},
    {C::kVarEE, Q::kArea, "VAR_EE", "VAREE", "variance of east"},
    {C::kCovEV, Q::kArea, "COV_EV", "COVEV", "covariance of east and vertical"},
    {C::kVarVV, Q::kArea, "VAR_VV", "VARVV", "variance of vertical"},
    {C::kBiasN, Q::kLength, "BIAS_N", "BIASN", "bias of north"},
    {C::kBiasE, Q::kLength, "BIAS_E", "BIASE", "bias of east"},
    {C::kBiasV, Q::kLength, "BIAS_V", "BIASV", "bias of vertical"},
    {C::kSigmaInclination, Q::kAngle, "SIG_INC", "SIGINC", "sigma of inclination"},
    {C::kSigmaAzimuth, Q::kAngle, "SIG_AZI", "SIGAZI", "sigma of azimuth"},
    {C::kGravity, Q::kAcceleration, "GRAVITY", "GTOT", "measured gravity"},
    {C::kGravityRef, Q::kAcceleration, "GRAVITY_REF", "GREF", "reference gravity"},
    {C::kEarthRateMeasured, Q::kRate, "EARTH_RATE", "ERATE", "measured Earth rate"},
    {C::kEarthRateReference, Q::kRate, "EARTH_RATE_REF", "ERREF", "reference Earth rate"},
    {C::kConvergence, Q::kAngle, "CONV", "CONV", "grid convergence"},
    {C::kScale, Q::kRatio, "SCALE", "SCALE", "grid scale factor"},
    {C::kTemperature, Q::kTemperature, "TEMP", "TEMP", "temperature"},
    {C::kUtc, Q::kTime, "UTC", "UTC", "UTC since 1970"},
    {C::kSurvey, Q::kNumber, "SURVEY", "SURVEY", "number of the survey"},
    {C::kObject, Q::kNumber, "OBJECT", "OBJECT", "number of the position object"},
}};

constexpr std::array kTextInfo{
    TextColumnInfo{TextColumn::kUid, "UID"},
    TextColumnInfo{TextColumn::kPoint, "POINT"},
    TextColumnInfo{TextColumn::kTool, "TOOL"},
    TextColumnInfo{TextColumn::kErrorModel, "ERROR_MODEL"},
    TextColumnInfo{TextColumn::kKind, "KIND"},
    TextColumnInfo{TextColumn::kQuality, "QUALITY"},
    TextColumnInfo{TextColumn::kComment, "COMMENT"},
};

}  // namespace

std::span<const ColumnInfo> AllColumns() { return kInfo; }
const ColumnInfo& InfoOf(Column column) { return kInfo[static_cast<std::size_t>(column)]; }
std::span<const TextColumnInfo> AllTextColumns() { return kTextInfo; }

}  // namespace wellgyro
