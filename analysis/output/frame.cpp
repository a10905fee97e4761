// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/output/frame.hpp"

#include "engine/errors.hpp"

namespace montecarta::analysis {

void Frame::add(const Row& row, const Row& more) {
  Row all = row;
  all.insert(all.end(), more.begin(), more.end());
  if (columns.empty()) {
    for (const Entry& entry : all) columns.push_back({entry.name, entry.units});
  }
  expect(all.size() == columns.size(), "all rows of a frame have the same columns");
  for (std::size_t c = 0; c < columns.size(); ++c) {
    if (all[c].is_text) {
      columns[c].texts.push_back(std::move(all[c].text));
    } else {
      columns[c].numbers.push_back(all[c].number);
    }
  }
}

void Frame::push(std::initializer_list<double> row) {
  expect(row.size() == columns.size(), "a row has a number for each column");
  auto column = columns.begin();
  for (const double number : row) (column++)->numbers.push_back(number);
}

std::size_t Frame::rows() const {
  return columns.empty() ? 0 : columns[0].numbers.size() + columns[0].texts.size();
}

std::string heading(const std::string& name, const std::string& units) {
  return units == "1" ? name : name + " [" + units + "]";
}

}  // namespace montecarta::analysis
