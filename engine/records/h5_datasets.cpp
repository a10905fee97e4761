// SPDX-License-Identifier: BSD-3-Clause
#include "engine/records/h5.hpp"

#include <hdf5.h>
#include <hdf5_hl.h>

#include <algorithm>
#include <numeric>
#include <type_traits>

namespace montecarta::engine::h5 {
namespace {

using detail::check;
using detail::native_type;

Handle space_of(const Shape& shape) {
  if (shape.empty()) return Handle(H5Screate(H5S_SCALAR));
  return Handle(H5Screate_simple(static_cast<int>(shape.size()), shape.data(), nullptr));
}

/// Marked ASCII, though the text may be UTF-8: Octave 7 reads no text that is marked UTF-8.
Handle text_type(std::size_t width) {
  Handle type(H5Tcopy(H5T_C_S1));
  H5Tset_size(type.id(), std::max<std::size_t>(width, 1));
  H5Tset_strpad(type.id(), H5T_STR_NULLPAD);
  return type;
}

Handle create(const Handle& parent, const std::string& name, hid_t type, const Shape& shape) {
  Handle creation(H5Pcreate(H5P_DATASET_CREATE));
  H5Pset_layout(creation.id(), H5D_CONTIGUOUS);
  H5Pset_alloc_time(creation.id(), H5D_ALLOC_TIME_EARLY);
  H5Pset_fill_time(creation.id(), H5D_FILL_TIME_NEVER);
  H5Pset_attr_creation_order(creation.id(), H5P_CRT_ORDER_TRACKED | H5P_CRT_ORDER_INDEXED);
  const hid_t made = H5Dcreate2(parent.id(), name.c_str(), type, space_of(shape).id(), H5P_DEFAULT,
                                creation.id(), H5P_DEFAULT);
  return Handle(check(made, "create dataset", parent, name));
}

std::uint64_t count(const Shape& shape) {
  return std::accumulate(shape.begin(), shape.end(), std::uint64_t{1}, std::multiplies<>());
}

void expect_fit(std::uint64_t elements, Element element, std::span<std::byte> bytes,
                const Handle& dataset) {
  check(elements * size_of(element) == bytes.size() ? 0 : -1, "fit to its axes", dataset, "");
}

/// Of a dataset that may be anything.
std::size_t width_of(const Handle& dataset) {
  return H5Tget_size(Handle(H5Dget_type(dataset.id())).id());
}

}  // namespace

Handle create_dataset(const Handle& parent, const std::string& name, Element element,
                      const Shape& shape) {
  return create(parent, name, native_type(element), shape);
}

Handle create_text(const Handle& parent, const std::string& name, std::size_t width) {
  return create(parent, name, text_type(width).id(), {});
}

Handle open_dataset(const Handle& parent, const std::string& name) {
  return Handle(
      check(H5Dopen2(parent.id(), name.c_str(), H5P_DEFAULT), "open dataset", parent, name));
}

void write(const Handle& dataset, Element element, const void* values) {
  const auto status =
      H5Dwrite(dataset.id(), native_type(element), H5S_ALL, H5S_ALL, H5P_DEFAULT, values);
  check(status, "write", dataset, "");
}

void write_text(const Handle& dataset, const std::string& text) {
  const Handle type(H5Dget_type(dataset.id()));
  std::string padded = text;
  padded.resize(H5Tget_size(type.id()), '\0');
  check(H5Dwrite(dataset.id(), type.id(), H5S_ALL, H5S_ALL, H5P_DEFAULT, padded.data()), "write",
        dataset, "");
}

std::optional<std::uint64_t> place(const Handle& dataset) {
  static_assert(std::is_same_v<Shape::value_type, hsize_t>);
  const haddr_t address = H5Dget_offset(dataset.id());
  if (address != HADDR_UNDEF) return address;
  return count(shape(dataset)) == 0 ? std::optional<std::uint64_t>(0) : std::nullopt;
}

std::uint64_t stored_bytes(const Handle& dataset) { return H5Dget_storage_size(dataset.id()); }

Shape shape(const Handle& dataset) {
  const Handle space(H5Dget_space(dataset.id()));
  const auto rank = check(H5Sget_simple_extent_ndims(space.id()), "read the shape of", dataset, "");
  std::vector<hsize_t> dimensions(static_cast<std::size_t>(rank));
  H5Sget_simple_extent_dims(space.id(), dimensions.data(), nullptr);
  detail::expect_in_file(dimensions, width_of(dataset), dataset, "");
  return {dimensions.begin(), dimensions.end()};
}

std::optional<Element> element(const Handle& dataset) {
  const Handle type(H5Dget_type(dataset.id()));
  for (Element candidate : {Element::f64, Element::u8, Element::u16, Element::u32, Element::u64}) {
    if (H5Tequal(type.id(), native_type(candidate)) > 0) return candidate;
  }
  return std::nullopt;
}

void read(const Handle& dataset, Element element, std::span<std::byte> bytes) {
  expect_fit(count(shape(dataset)), element, bytes, dataset);
  const auto status =
      H5Dread(dataset.id(), native_type(element), H5S_ALL, H5S_ALL, H5P_DEFAULT, bytes.data());
  check(status, "read", dataset, "");
}

void read_row(const Handle& dataset, std::uint64_t i, Element element, std::span<std::byte> bytes) {
  Shape extent = shape(dataset);
  check(!extent.empty() && i < extent[0] ? 0 : -1, "find a row of", dataset, "");
  Shape start(extent.size(), 0);
  start[0] = i;
  extent[0] = 1;
  expect_fit(count(extent), element, bytes, dataset);
  const Handle file_space(H5Dget_space(dataset.id()));
  H5Sselect_hyperslab(file_space.id(), H5S_SELECT_SET, start.data(), nullptr, extent.data(),
                      nullptr);
  const Handle memory_space = space_of({count(extent)});
  const auto status = H5Dread(dataset.id(), native_type(element), memory_space.id(),
                              file_space.id(), H5P_DEFAULT, bytes.data());
  check(status, "read", dataset, "");
}

std::string read_text(const Handle& dataset) {
  const Handle type(H5Dget_type(dataset.id()));
  const bool fixed = H5Tget_class(type.id()) == H5T_STRING && H5Tis_variable_str(type.id()) == 0;
  check(fixed && shape(dataset).empty() ? 0 : -1, "read as text", dataset, "");
  std::string text(H5Tget_size(type.id()), '\0');
  check(H5Dread(dataset.id(), type.id(), H5S_ALL, H5S_ALL, H5P_DEFAULT, text.data()), "read",
        dataset, "");
  text.resize(std::min(text.find('\0'), text.size()));
  return text;
}

void make_scale(const Handle& dataset, const std::string& dimension) {
  check(H5DSset_scale(dataset.id(), dimension.c_str()), "make a dimension scale of", dataset, "");
}

bool is_scale(const Handle& dataset) { return H5DSis_scale(dataset.id()) > 0; }

void attach_scale(const Handle& dataset, const Handle& scale, unsigned axis) {
  check(H5DSattach_scale(dataset.id(), scale.id(), axis), "attach a dimension scale to", dataset,
        "");
}

}  // namespace montecarta::engine::h5
