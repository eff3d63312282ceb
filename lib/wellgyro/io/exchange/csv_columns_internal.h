#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "wellgyro/io/exchange/claims_internal.h"
#include "wellgyro/io/exchange/columns_internal.h"
#include "wellgyro/io/exchange/exchange.h"
#include "wellgyro/io/exchange/headings_internal.h"
#include "wellgyro/io/exchange/line_reader_internal.h"

namespace wellgyro {

struct CsvColumn {
  std::optional<Column> column;
  std::optional<TextColumn> text;
  bool status = false, well = false;
  Quantity quantity = Quantity::kNumber;
  double factor = 1;
};

/// The columns of a table, and where those that every survey has stand.
struct CsvColumns {
  std::vector<CsvColumn> all;
  std::optional<std::size_t> md, inclination, azimuth;
};

/// A sentence on the first of --columns that names none of these columns; empty where all do.
std::string UnusedColumn(const std::vector<Heading>& headings, const ReadOptions& options);

/// Headings of a line's fields, those that the options name by name or number among them.
std::vector<Heading> CsvHeadingsOf(const std::vector<std::string>& fields,
                                   const ReadOptions& options);
/// Whether they name measured depth, and with it a position in space but no angles.
bool NamePositions(const std::vector<Heading>& headings);
/// Whether they name depth, inclination and azimuth.
bool NameStations(const std::vector<Heading>& headings);
/// Whether a cell of a second heading line is a unit, in brackets or not.
bool IsCsvUnit(const std::string& cell);

/// Units and norths of headings: what they leave open goes to `claims`, what they say to `head`.
/// An option for the unit of depth wins over theirs.
CsvColumns CsvColumnsOf(const std::vector<Heading>& headings, const ReadOptions& options,
                        SurveyHead& head, Claims& claims, const LineReader& lines);

/// Headings from several lines over the first row of numbers, field by field, or for fields between
/// blanks by where they stand.
std::vector<Heading> MergedHeadings(const std::vector<std::string>& lines,
                                    const std::string& numbers, char delimiter,
                                    const ReadOptions& options);

}  // namespace wellgyro
