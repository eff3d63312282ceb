#include "wellgyro/record/survey_table.h"

#include <algorithm>
#include <cassert>
#include <utility>

namespace wellgyro {

std::size_t SurveyTable::Add(double md, double inclination, double azimuth, RowStatus status) {
  const std::size_t row = rows();
  status_.push_back(status);
  Set(Column::kMd, row, md);
  Set(Column::kInclination, row, inclination);
  Set(Column::kAzimuth, row, azimuth);
  return row;
}

void SurveyTable::Set(Column column, std::size_t row, double value) {
  assert(row < rows());
  const auto c = static_cast<std::size_t>(column);
  if (values_[c].size() <= row) {
    values_[c].resize(row + 1);
    known_[c].resize(row + 1);
  }
  values_[c][row] = value;
  known_[c][row] = true;
}

void SurveyTable::Set(TextColumn column, std::size_t row, std::string text) {
  assert(row < rows());
  std::vector<std::string>& texts = texts_[static_cast<std::size_t>(column)];
  if (text.empty() && texts.size() <= row) return;
  if (texts.size() <= row) texts.resize(row + 1);
  texts[row] = std::move(text);
}

void SurveyTable::Drop(Column column) {
  const auto c = static_cast<std::size_t>(column);
  values_[c].clear();
  known_[c].clear();
}

void SurveyTable::Clear(Column column, std::size_t row) {
  const auto c = static_cast<std::size_t>(column);
  if (row < known_[c].size()) known_[c][row] = false;
}

void SurveyTable::Reverse() {
  std::reverse(status_.begin(), status_.end());
  for (std::size_t c = 0; c < kColumns; ++c) {
    if (values_[c].empty()) continue;
    values_[c].resize(rows());
    known_[c].resize(rows());
    std::reverse(values_[c].begin(), values_[c].end());
    std::reverse(known_[c].begin(), known_[c].end());
  }
  for (std::vector<std::string>& texts : texts_) {
    if (texts.empty()) continue;
    texts.resize(rows());
    std::reverse(texts.begin(), texts.end());
  }
}

std::optional<double> SurveyTable::Get(Column column, std::size_t row) const {
  const auto c = static_cast<std::size_t>(column);
  if (row >= known_[c].size() || !known_[c][row]) return std::nullopt;
  return values_[c][row];
}

const std::string& SurveyTable::Get(TextColumn column, std::size_t row) const {
  static const std::string kNone;
  const std::vector<std::string>& texts = texts_[static_cast<std::size_t>(column)];
  return row < texts.size() ? texts[row] : kNone;
}

std::size_t SurveyTable::cells() const {
  std::size_t sum = 0;
  for (const auto& values : values_) sum += values.size();
  for (const auto& texts : texts_) sum += 4 * texts.size();
  return sum;
}

}  // namespace wellgyro
