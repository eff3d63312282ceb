#pragma once

#include <string_view>

namespace wellgyro {

// What goes into every page. Written into a source by CMake when the library is built: the styles
// and scripts of this room, and D3 with its licence from the Debian package node-d3.
std::string_view ReportStyle();   ///< CSS, for screen and paper
std::string_view ReportScript();  ///< draws the report's charts again, with the depth cursor
std::string_view ChartsScript();  ///< of both pages
std::string_view LiveStyle();     ///< beside the report's
std::string_view LiveScript();    ///< follows a running survey
std::string_view D3Script();
std::string_view D3Licence();  ///< goes wherever D3 does

}  // namespace wellgyro
