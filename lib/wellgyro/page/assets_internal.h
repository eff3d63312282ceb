#pragma once

#include <string_view>

namespace wellgyro {

// What goes into every page. Written into a source by CMake when the library is built: the styles
// and scripts of this room, and D3 with its licence from the Debian package node-d3.
std::string_view ReportStyle();
std::string_view ReportScript();
std::string_view ChartsScript();  ///< of both pages
std::string_view LiveStyle();     ///< beside the report's
std::string_view LiveScript();
std::string_view D3Script();
std::string_view D3Licence();

}  // namespace wellgyro
