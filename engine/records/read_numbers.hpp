// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/records/h5.hpp"

#include <functional>
#include <numeric>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace montecarta::engine {

/// All numbers of a dataset of `parent`, one behind the other.
template <class T>
std::vector<T> read_all(const h5::Handle& parent, const std::string& name, Element element) {
  const h5::Handle dataset = h5::open_dataset(parent, name);
  const h5::Shape shape = h5::shape(dataset);
  const auto count = std::accumulate(shape.begin(), shape.end(), 1ULL, std::multiplies<>());
  std::vector<T> values(count);
  h5::read(dataset, element, std::as_writable_bytes(std::span(values)));
  return values;
}

/// Pairs of numbers; none where the dataset is not there.
inline std::vector<std::pair<double, double>> read_points(const h5::Handle& group,
                                                          const std::string& name) {
  std::vector<std::pair<double, double>> points;
  if (!h5::has(group, name)) return points;
  const auto flat = read_all<double>(group, name, Element::f64);
  for (std::size_t i = 0; i + 1 < flat.size(); i += 2) points.emplace_back(flat[i], flat[i + 1]);
  return points;
}

}  // namespace montecarta::engine
