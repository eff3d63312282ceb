// Block 8: the survey listing.
#include <array>
#include <cstddef>
#include <optional>
#include <string>

#include <fmt/core.h>

#include "wellgyro/base/angle.h"
#include "wellgyro/page/html_internal.h"
#include "wellgyro/page/page_internal.h"
#include "wellgyro/uncertainty/ellipse.h"

namespace wellgyro {
namespace {

std::string KindLetter(const std::string& kind) {
  if (kind == "tie_in") return "T";
  if (kind == "gyrocompass") return "G";
  if (kind == "continuous") return "C";
  if (kind == "still") return "S";
  return kind;
}

void WriteStation(const PageText& page, HtmlTable& table, const Columns& stations, std::size_t i,
                  bool grid) {
  const auto number = [&](const char* name) { return stations.Number(i, name); };
  const auto length = [&](const char* name) { return page.Length(number(name)); };
  const std::string quality = stations.Text(i, "QUALITY");
  const auto dls = number("DLS[deg/30m]");
  const auto cov = stations.Covariance(i);
  std::optional<double> major, minor;
  if (cov) {
    const ErrorEllipse ellipse = HorizontalEllipse(*cov, kConfidence);
    major = page.Length(ellipse.semi_major);
    minor = page.Length(ellipse.semi_minor);
  }
  table.Row(quality.find("unfit") != std::string::npos ? "fail" : "")
      .Number(length("MD[m]"), 2)
      .Number(number("INC[deg]"), 3)
      .Number(number("AZI_TRUE[deg]"), 3);
  if (grid) table.Number(number("AZI_GRID[deg]"), 3);
  table.Number(length("TVD[m]"), 2).Number(length("N[m]"), 2).Number(length("E[m]"), 2);
  if (grid) table.Number(number("NORTHING[m]"), 2).Number(number("EASTING[m]"), 2);
  table.Number(dls ? std::optional(*dls * page.units.dogleg) : dls, 2)
      .Number(number("SIG_INC[deg]"), 3)
      .Number(number("SIG_AZI[deg]"), 3)
      .Number(major, 2)
      .Number(minor, 2)
      .Text(KindLetter(stations.Text(i, "KIND")))
      .Text(quality == "good" ? "" : quality);
}

void WriteHeads(PageText& page, bool grid, const Columns& stations) {
  const std::string dls = fmt::format(">DLS [{}]", page.units.dogleg_name), md = page.Named(">MD"),
                    tvd = page.Named(">TVD"), north = page.Named(">N"), east = page.Named(">E"),
                    major = page.Named(">95 % long"), minor = page.Named(">95 % short");
  const auto write = [&](HtmlTable& table) {
    for (std::size_t i = 0; i < stations.rows(); ++i) WriteStation(page, table, stations, i, grid);
  };
  if (grid) {
    HtmlTable table(page.html, "listing", "",
                    {md, ">Inc [\u00b0]", ">Azi true [\u00b0]", ">Azi grid [\u00b0]", tvd, north,
                     east, ">Northing [m]", ">Easting [m]", dls, ">\u03c3 inc [\u00b0]",
                     ">\u03c3 azi [\u00b0]", major, minor, "Kind", "Quality"});
    write(table);
  } else {
    HtmlTable table(
        page.html, "listing", "",
        {md, ">Inc [\u00b0]", ">Azi true [\u00b0]", tvd, north, east, dls, ">\u03c3 inc [\u00b0]",
         ">\u03c3 azi [\u00b0]", major, minor, "Kind", "Quality"});
    write(table);
  }
}

}  // namespace

void WriteListing(PageText& page) {
  BeginBlock(page, 8, "Survey listing");
  const Columns stations(At(page.survey, {"stations"}));
  if (stations.rows() == 0) {
    SayNotMeasured(page, "Stations");
    return EndBlock(page);
  }
  page.html += fmt::format(
      "<p>{} stations. Kind: T tie-in, G gyrocompassed at rest, C continuous, S still. Sigmas are "
      "one "
      "sigma of the hole's direction at the tool; 95 % are half axes of the horizontal ellipse. No "
      "quality: good. Positions are summed over {}.</p>\n",
      stations.rows(), Isolated(TextAt(page.survey, {"run", "positions_summed_over"})));
  WriteHeads(page, stations.Has("AZI_GRID[deg]"), stations);
  EndBlock(page);
}

}  // namespace wellgyro
