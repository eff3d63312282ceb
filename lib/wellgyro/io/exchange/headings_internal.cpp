#include "wellgyro/io/exchange/headings_internal.h"

#include <array>

#include "wellgyro/io/exchange/columns_internal.h"
#include "wellgyro/io/text_internal.h"

namespace wellgyro {
namespace {

using C = Column;

struct Alias {
  std::string_view name;  // letters and digits alone, in lower case
  Column column;
  North north = North::kUnknown;
};

constexpr std::array kAliases{
    Alias{"measureddepth", C::kMd},
    Alias{"measdepth", C::kMd},
    Alias{"mdepth", C::kMd},
    Alias{"depth", C::kMd},
    Alias{"dept", C::kMd},
    Alias{"incl", C::kInclination},
    Alias{"inclination", C::kInclination},
    Alias{"devi", C::kInclination},
    Alias{"sdev", C::kInclination},
    Alias{"deviation", C::kInclination},
    Alias{"deviationangle", C::kInclination},
    Alias{"azi", C::kAzimuth},
    Alias{"azim", C::kAzimuth},
    Alias{"azimuth", C::kAzimuth},
    Alias{"haz", C::kAzimuth},
    Alias{"hazi", C::kAzimuth},
    Alias{"holeazimuth", C::kAzimuth},
    Alias{"azitrue", C::kAzimuth, North::kTrue},
    Alias{"aztrue", C::kAzimuth, North::kTrue},
    Alias{"azimtrue", C::kAzimuth, North::kTrue},
    Alias{"azimuthtrue", C::kAzimuth, North::kTrue},
    Alias{"azimuthtruenorth", C::kAzimuth, North::kTrue},
    Alias{"azimtn", C::kAzimuth, North::kTrue},
    Alias{"azt", C::kAzimuth, North::kTrue},
    Alias{"azigrid", C::kAzimuth, North::kGrid},
    Alias{"azgrid", C::kAzimuth, North::kGrid},
    Alias{"azimgrid", C::kAzimuth, North::kGrid},
    Alias{"azimuthgrid", C::kAzimuth, North::kGrid},
    Alias{"azimuthgridnorth", C::kAzimuth, North::kGrid},
    Alias{"azimgn", C::kAzimuth, North::kGrid},
    Alias{"azg", C::kAzimuth, North::kGrid},
    Alias{"azimag", C::kAzimuth, North::kMagnetic},
    Alias{"azimagn", C::kAzimuth, North::kMagnetic},
    Alias{"azmag", C::kAzimuth, North::kMagnetic},
    Alias{"azmagn", C::kAzimuth, North::kMagnetic},
    Alias{"azimuthmagnetic", C::kAzimuth, North::kMagnetic},
    Alias{"azm", C::kAzimuth},
    Alias{"azmth", C::kAzimuth},
    Alias{"drift", C::kInclination},
    Alias{"driftangle", C::kInclination},
    Alias{"inclin", C::kInclination},
    Alias{"holedevi", C::kInclination},
    Alias{"holeazi", C::kAzimuth},
    Alias{"azimuthtn", C::kAzimuth, North::kTrue},
    Alias{"azimuthgn", C::kAzimuth, North::kGrid},
    Alias{"trueverticaldepth", C::kTvd},
    Alias{"verticaldepth", C::kTvd},
    Alias{"tvdsubsea", C::kTvdSubSea},
    Alias{"sstvd", C::kTvdSubSea},
    Alias{"tvdmsl", C::kTvdSubSea},
    Alias{"tvdzdp", C::kTvd},
    Alias{"north", C::kNorth},
    Alias{"ns", C::kNorth},
    Alias{"nsdr", C::kNorth},
    Alias{"dispns", C::kNorth},
    Alias{"nsoffset", C::kNorth},
    Alias{"northoffset", C::kNorth},
    Alias{"dy", C::kNorth},
    Alias{"yoffset", C::kNorth},
    Alias{"yoff", C::kNorth},
    Alias{"dx", C::kEast},
    Alias{"xoffset", C::kEast},
    Alias{"xoff", C::kEast},
    Alias{"deltanorth", C::kNorth},
    Alias{"deltaeast", C::kEast},
    Alias{"localnorth", C::kNorth},
    Alias{"localeast", C::kEast},
    Alias{"mapn", C::kNorthing},
    Alias{"mape", C::kEasting},
    Alias{"ycoord", C::kNorthing},
    Alias{"xcoord", C::kEasting},
    Alias{"z", C::kDown},
    Alias{"y", C::kNorthing},
    Alias{"x", C::kEasting},
    Alias{"ntrue", C::kNorth, North::kTrue},
    Alias{"ngrid", C::kNorth, North::kGrid},
    Alias{"east", C::kEast},
    Alias{"ew", C::kEast},
    Alias{"ewdr", C::kEast},
    Alias{"dispew", C::kEast},
    Alias{"ewoffset", C::kEast},
    Alias{"eastoffset", C::kEast},
    Alias{"etrue", C::kEast, North::kTrue},
    Alias{"egrid", C::kEast, North::kGrid},
    Alias{"latitude", C::kLatitude},
    Alias{"lati", C::kLatitude},
    Alias{"longitude", C::kLongitude},
    Alias{"long", C::kLongitude},
    Alias{"dogleg", C::kDogleg},
    Alias{"dleg", C::kDogleg},
    Alias{"doglegseverity", C::kDogleg},
    Alias{"buildrate", C::kBuild},
    Alias{"turnrate", C::kTurn},
    Alias{"toolface", C::kToolface},
    Alias{"vsec", C::kVerticalSection},
    Alias{"vertsect", C::kVerticalSection},
    Alias{"verticalsection", C::kVerticalSection},
    Alias{"clsr", C::kClosure},
    Alias{"closuredistance", C::kClosure},
    Alias{"closureazimuth", C::kClosureAzimuth},
    Alias{"temperature", C::kTemperature},
};

// Finds what `name` is a heading of, if of anything.
void NameHeading(Heading& found, std::string_view name) {
  const std::string plain = LettersAndDigits(name);
  found.status = plain == "status";
  for (const std::string_view well :
       {"well", "wellname", "wellid", "uwi", "api", "borehole", "wellbore", "boreholename",
        "wellborename", "wellidentifier", "commonname"}) {
    found.well = found.well || plain == well;
  }
  found.either_axis = plain == "x" || plain == "y" || plain == "dx" || plain == "dy" ||
                      plain == "xoffset" || plain == "yoffset";
  for (const TextColumnInfo& info : AllTextColumns()) {
    if (plain == LettersAndDigits(info.csv)) found.text = info.column;
  }
  for (const Alias& alias : kAliases) {
    if (plain != alias.name) continue;
    found.column = alias.column;
    found.north = alias.north;
    return;
  }
  for (const ColumnInfo& info : AllColumns()) {
    if (plain == LettersAndDigits(info.csv)) found.column = info.column;
  }
}

}  // namespace

Heading HeadingOf(std::string_view heading) {
  Heading found;
  heading = Trim(heading);
  const std::size_t bracket = heading.find_first_of("[(");
  const std::string_view name = heading.substr(0, bracket);
  if (bracket != std::string_view::npos) {
    const std::size_t close = heading.find_last_of("])");
    const std::size_t end = close == std::string_view::npos ? heading.size() : close;
    if (end > bracket) found.unit = Trim(heading.substr(bracket + 1, end - bracket - 1));
    NameHeading(found, name);
    Heading within;  // "Azi (azimuth)" says twice what it is, and not in which unit
    NameHeading(within, found.unit);
    if (within.column && within.column == found.column) found.unit.clear();
    return found;
  }
  NameHeading(found, name);
  for (const std::string_view unit : {"m", "ft", "deg"}) {  // as md_ft
    const std::size_t line = name.find_last_of('_');
    if (found.column || line == std::string_view::npos) break;
    if (!EqualNoCase(name.substr(line + 1), unit)) continue;
    found.unit = unit;
    NameHeading(found, name.substr(0, line));
  }
  return found;
}

std::optional<Column> SecondAzimuth(North north) {
  switch (north) {
    case North::kTrue:
      return Column::kAzimuthTrue;
    case North::kGrid:
      return Column::kAzimuthGrid;
    case North::kMagnetic:
      return Column::kAzimuthMagnetic;
    default:
      return std::nullopt;
  }
}

}  // namespace wellgyro
