#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

/// Cutting up lines of text, and the numbers in them.
namespace wellgyro {

/// Without blanks at its ends. What is empty still points to its place in the line.
std::string_view Trim(std::string_view text);
/// The same without quotes at its ends either.
std::string_view TrimCell(std::string_view text);
std::string Lower(std::string_view text);
/// With a capital for its first letter.
std::string Capital(std::string_view word);
bool EqualNoCase(std::string_view a, std::string_view b);
/// Its letters and digits alone, in lower case.
std::string LettersAndDigits(std::string_view text);

/// `text` if it is UTF-8, else as Latin-1.
std::string ToUtf8(std::string_view text);

/// Fields between `delimiter`, quotes as in RFC 4180; with ' ' for any run of blanks. The last
/// quote is missing: nothing.
std::optional<std::vector<std::string>> SplitQuoted(std::string_view line, char delimiter);
/// The same without quotes, and without copies.
void Split(std::string_view line, char delimiter, std::vector<std::string_view>& fields);
/// The same for tables of numbers, where quotes may stand around a cell but hold no delimiter.
void SplitCells(std::string_view line, char delimiter, std::vector<std::string_view>& cells);
/// The first of comma, semicolon and tab that stands in the line.
char DelimiterOf(std::string_view line, char otherwise);

/// One more name behind a comma, unless there are 1000 characters of names already: what a
/// complaint tells of a file's contents.
void AddName(std::string_view name, std::string& names);

/// As a CSV field, quoted where it must be (RFC 4180).
std::string CsvQuoted(std::string_view text);

/// A finite number, whole, with blanks around it; any number of digits is rounded right, what does
/// not fit a double is none.
std::optional<double> NumberOf(std::string_view text);
/// The same with "nan" and "inf"; what does not fit a double is infinite.
std::optional<double> AnyNumberOf(std::string_view text);
std::optional<int> IntegerOf(std::string_view text);

}  // namespace wellgyro
