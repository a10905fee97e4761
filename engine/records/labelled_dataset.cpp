// SPDX-License-Identifier: BSD-3-Clause
#include "engine/records/labelled_dataset.hpp"

#include <numeric>

namespace montecarta::engine {
namespace {

void put_label(const h5::Handle& dataset, const Label& label) {
  h5::put_text(dataset, "units", label.units);
  h5::put_text(dataset, "long_name", label.long_name);
}

/// Attaches scales and names the axes, slowest first, for readers that turn them round.
void put_dimensions(const h5::Handle& dataset, const std::vector<std::string>& dimensions,
                    const Scales& scales) {
  std::string order;
  for (unsigned axis = 0; axis < dimensions.size(); ++axis) {
    h5::attach_scale(dataset, scales.at(dimensions[axis]), axis);
    order += (axis == 0 ? "" : ", ") + dimensions[axis];
  }
  h5::put_text(dataset, "dimension_order", order);
}

void become_scale(h5::Handle dataset, const std::string& name, const Label& label, Scales& scales) {
  h5::make_scale(dataset, name);
  put_label(dataset, label);
  scales.insert_or_assign(name, std::move(dataset));
}

void add_numeric_scale(const h5::Handle& parent, const std::string& name, Element element,
                       std::size_t length, const void* values, const Label& label, Scales& scales) {
  h5::Handle dataset = h5::create_dataset(parent, name, element, {length});
  h5::write(dataset, element, values);
  become_scale(std::move(dataset), name, label, scales);
}

}  // namespace

h5::Handle add_dataset(const h5::Handle& parent, const std::string& name, Element element,
                       const h5::Shape& shape, const std::vector<std::string>& dimensions,
                       const Label& label, const Scales& scales) {
  h5::Handle dataset = h5::create_dataset(parent, name, element, shape);
  put_label(dataset, label);
  put_dimensions(dataset, dimensions, scales);
  return dataset;
}

h5::Handle add_text(const h5::Handle& parent, const std::string& name, const std::string& text,
                    std::size_t width, const Label& label) {
  h5::Handle dataset = h5::create_text(parent, name, width);
  h5::write_text(dataset, text);
  put_label(dataset, label);
  return dataset;
}

void add_scale(const h5::Handle& parent, const std::string& name, const std::vector<double>& values,
               const Label& label, Scales& scales) {
  add_numeric_scale(parent, name, Element::f64, values.size(), values.data(), label, scales);
}

void add_scale(const h5::Handle& parent, const std::string& name,
               const std::vector<std::uint64_t>& values, const Label& label, Scales& scales) {
  add_numeric_scale(parent, name, Element::u64, values.size(), values.data(), label, scales);
}

void add_index_scale(const h5::Handle& parent, const std::string& name, std::size_t length,
                     const Label& label, Scales& scales) {
  std::vector<std::uint32_t> values(length);
  std::iota(values.begin(), values.end(), 0U);
  add_numeric_scale(parent, name, Element::u32, length, values.data(), label, scales);
}

}  // namespace montecarta::engine
