#pragma once

#include <string>
#include <string_view>

namespace wellgyro {

/// Whether bytes begin as a workbook of spreadsheets does (Office Open XML, a zip archive).
bool IsWorkbook(std::string_view head);

/// One sheet of a workbook as text, a line for each row under its own number, cells parted by tabs:
/// the one called `wanted`, else the only one with anything in it. Numbers as the file has them;
/// formulas by the values it keeps. At most 2^26 bytes a part unpacked and 1024 columns. Throws
/// TextError: kForeign where it is no such workbook, kConflict where several sheets are possible,
/// kSize, kSyntax. Source: ECMA-376 part 1, 18.2 to 18.4.
std::string SheetText(const std::string& bytes, const std::string& source,
                      const std::string& wanted);

}  // namespace wellgyro
