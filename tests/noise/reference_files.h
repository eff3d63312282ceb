#pragma once

#include <cstdint>
#include <fstream>
#include <iterator>
#include <sstream>
#include <string>
#include <vector>

/// Readers for the published records that tests compare with.
namespace wellgyro::test {

inline std::string ReferencePath(const std::string& name) {
  return std::string(WELLGYRO_REFERENCE_DIR) + "/allan/" + name;
}

inline std::vector<double> Numbers(std::istream& in) {
  std::vector<double> values;
  for (std::string line; std::getline(in, line);) {
    if (line.empty() || line[0] == '#') continue;
    std::istringstream fields(line);
    for (double value = 0; fields >> value;) values.push_back(value);
  }
  return values;
}

inline std::vector<double> NumbersOf(const std::string& path) {
  std::ifstream in(path);
  return Numbers(in);
}

inline std::vector<double> CountsOf(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  const std::vector<char> bytes{std::istreambuf_iterator<char>(in), {}};
  std::vector<double> counts(bytes.size() / 2);
  for (std::size_t i = 0; i < counts.size(); ++i) {
    const auto low = static_cast<unsigned char>(bytes[2 * i]);
    const auto high = static_cast<unsigned char>(bytes[2 * i + 1]);
    counts[i] = static_cast<std::int16_t>(low | high << 8);
  }
  return counts;
}

/// One line of a Stable32 table.
struct Stable32Row {
  std::int64_t factor = 0;
  std::int64_t terms = 0;
  double sigma = 0;
};

inline std::vector<Stable32Row> Stable32Table(const std::string& path) {
  std::ifstream in(path);
  std::vector<Stable32Row> rows;
  for (std::string line; std::getline(in, line);) {
    if (line.empty() || line[0] == '#') continue;
    std::istringstream fields(line);
    Stable32Row row;
    double tau = 0;
    double alpha = 0;
    double low = 0;
    if (fields >> row.factor >> tau >> row.terms >> alpha >> low >> row.sigma) rows.push_back(row);
  }
  return rows;
}

}  // namespace wellgyro::test
