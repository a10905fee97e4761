// SPDX-License-Identifier: BSD-3-Clause
#include "engine/records/h5.hpp"

#include <hdf5.h>

#include <array>

namespace montecarta::engine::h5 {
namespace {

using detail::check;

/// Strings of any length in UTF-8: what h5py hands back as str.
Handle text_type() {
  Handle type(H5Tcopy(H5T_C_S1));
  H5Tset_size(type.id(), H5T_VARIABLE);
  H5Tset_cset(type.id(), H5T_CSET_UTF8);
  return type;
}

Handle create_attribute(const Handle& object, const std::string& name, hid_t type,
                        const Handle& space) {
  const hid_t made =
      H5Acreate2(object.id(), name.c_str(), type, space.id(), H5P_DEFAULT, H5P_DEFAULT);
  return Handle(check(made, "create attribute", object, name));
}

Handle open_attribute(const Handle& object, const std::string& name) {
  const hid_t opened = H5Aopen(object.id(), name.c_str(), H5P_DEFAULT);
  return Handle(check(opened, "open attribute", object, name));
}

/// The value of a text attribute, of fixed or any length; nullopt where it is no single text.
std::optional<std::string> value_of(const Handle& attribute) {
  const Handle type(H5Aget_type(attribute.id()));
  const Handle space(H5Aget_space(attribute.id()));
  if (H5Tget_class(type.id()) != H5T_STRING || H5Sget_simple_extent_npoints(space.id()) != 1)
    return std::nullopt;
  if (H5Tis_variable_str(type.id()) > 0) {
    char* value = nullptr;
    if (H5Aread(attribute.id(), text_type().id(), &value) < 0) return std::nullopt;
    std::string copy = value == nullptr ? "" : value;
    H5free_memory(value);
    return copy;
  }
  const std::size_t width = H5Tget_size(type.id());
  detail::expect_in_file({}, width, attribute, "");
  std::string value(width, '\0');
  if (H5Aread(attribute.id(), type.id(), value.data()) < 0) return std::nullopt;
  return value.substr(0, value.find('\0'));
}

herr_t collect_name(hid_t, const char* name, const H5A_info_t*, void* names) {
  static_cast<std::vector<std::string>*>(names)->emplace_back(name);
  return 0;
}

std::vector<std::string> attribute_names(const Handle& object) {
  std::vector<std::string> names;
  hsize_t start = 0;
  herr_t status =
      H5Aiterate2(object.id(), H5_INDEX_CRT_ORDER, H5_ITER_INC, &start, collect_name, &names);
  if (status < 0) {
    names.clear();
    start = 0;
    status = H5Aiterate2(object.id(), H5_INDEX_NAME, H5_ITER_INC, &start, collect_name, &names);
  }
  check(status, "list the attributes of", object, "");
  return names;
}

}  // namespace

void put_text(const Handle& object, const std::string& name, const std::string& value) {
  const Handle type = text_type();
  const Handle attribute = create_attribute(object, name, type.id(), Handle(H5Screate(H5S_SCALAR)));
  const char* characters = value.c_str();
  check(H5Awrite(attribute.id(), type.id(), &characters), "write attribute", object, name);
}

void put_numbers(const Handle& object, const std::string& name,
                 std::span<const std::uint64_t> values) {
  const hsize_t count = values.size();
  const Handle space(count == 1 ? H5Screate(H5S_SCALAR) : H5Screate_simple(1, &count, nullptr));
  const Handle attribute = create_attribute(object, name, H5T_NATIVE_UINT64, space);
  check(H5Awrite(attribute.id(), H5T_NATIVE_UINT64, values.data()), "write attribute", object,
        name);
}

std::optional<std::string> find_text(const Handle& object, const std::string& name) {
  if (H5Aexists(object.id(), name.c_str()) <= 0) return std::nullopt;
  return value_of(open_attribute(object, name));
}

std::string text(const Handle& object, const std::string& name) {
  auto value = find_text(object, name);
  if (!value) check(-1, "read text attribute", object, name);
  return *std::move(value);
}

std::vector<Text> texts(const Handle& object) {
  std::vector<Text> found;
  for (const std::string& name : attribute_names(object)) {
    if (auto value = find_text(object, name)) found.emplace_back(name, *std::move(value));
  }
  return found;
}

std::vector<std::uint64_t> numbers(const Handle& object, const std::string& name) {
  const Handle attribute = open_attribute(object, name);
  const Handle space(H5Aget_space(attribute.id()));
  const auto count =
      check(H5Sget_simple_extent_npoints(space.id()), "read attribute", object, name);
  detail::expect_in_file(std::array{static_cast<hsize_t>(count)}, sizeof(std::uint64_t), object,
                         name);
  std::vector<std::uint64_t> values(static_cast<std::size_t>(count));
  check(H5Aread(attribute.id(), H5T_NATIVE_UINT64, values.data()), "read attribute", object, name);
  return values;
}

std::uint64_t number(const Handle& object, const std::string& name) {
  const std::vector<std::uint64_t> values = numbers(object, name);
  check(values.empty() ? -1 : 0, "read attribute", object, name);
  return values.front();
}

}  // namespace montecarta::engine::h5
