// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/records/columns.hpp"

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

/// The part of HDF5 that montecarta uses, with owned identifiers and exceptions. Every function
/// throws StudyError with the name of the object if the file is open for reading only, otherwise
/// RunError. Only h5.cpp includes hdf5.h.
namespace montecarta::engine::h5 {

/// Owns an HDF5 identifier of any kind.
class Handle {
 public:
  explicit Handle(std::int64_t id) : id_(id) {}
  ~Handle();
  Handle(Handle&& other) noexcept : id_(std::exchange(other.id_, -1)) {}
  Handle& operator=(Handle&& other) noexcept {
    std::swap(id_, other.id_);
    return *this;
  }
  std::int64_t id() const { return id_; }

 private:
  std::int64_t id_;
};

using Text = std::pair<std::string, std::string>;  ///< (name, value) of an attribute

/// Version of the HDF5 library, e.g. "1.10.8".
std::string library_version();

/// Creates or empties a file. Sets no HDF5 lock; the caller has a lock of its own.
Handle create_file(const std::filesystem::path& path);
/// Creates a file in memory that is never written to a disk. `name` is for errors only.
Handle create_image(const std::string& name);
/// The bytes of a file of create_image(). All other handles into it must be closed.
std::string image_of(const Handle& file);
/// Returns whether a file is in HDF5; false if it cannot be read.
bool is_hdf5(const std::filesystem::path& path);
/// Opens a file for reading, even if another process is writing runs to it.
Handle open_file(const std::filesystem::path& path);
/// Writes cached data and closes the file. Unlike the destructor, it throws if that fails.
void close_file(Handle file);

/// Creates a group that keeps the order of its members.
Handle create_group(const Handle& parent, const std::string& name);
Handle open_group(const Handle& parent, const std::string& name);
bool has(const Handle& parent, const std::string& name);
/// Returns whether a member is a group, not a dataset.
bool is_group(const Handle& parent, const std::string& name);
/// Names of the members of a group, in the order in which they were made.
std::vector<std::string> members(const Handle& group);

void put_text(const Handle& object, const std::string& name, const std::string& value);
void put_numbers(const Handle& object, const std::string& name,
                 std::span<const std::uint64_t> values);
std::optional<std::string> find_text(const Handle& object, const std::string& name);
std::string text(const Handle& object, const std::string& name);
bool has_attribute(const Handle& object, const std::string& name);
/// The texts of an attribute that is one text or a list of texts; empty if it is something else.
std::vector<std::string> find_texts(const Handle& object, const std::string& name);
/// All text attributes, in the order in which they were made.
std::vector<Text> texts(const Handle& object);
/// A text that tells apart all texts and numbers in attributes, and their order. Attributes of
/// other types are left out: HDF5 keeps its dimension scales in them.
std::string attributes_text(const Handle& object);
std::vector<std::uint64_t> numbers(const Handle& object, const std::string& name);
/// The first number of the attribute.
std::uint64_t number(const Handle& object, const std::string& name);

using Shape = std::vector<unsigned long long>;  ///< HDF5's hsize_t

/// Creates a contiguous dataset. Its place in the file is allocated at once, but not filled.
Handle create_dataset(const Handle& parent, const std::string& name, Element element,
                      const Shape& shape);
/// Creates a dataset of one text with at most `width` bytes. An axis of texts would crash netCDF-C
/// 4.9 or Octave 7.
Handle create_text(const Handle& parent, const std::string& name, std::size_t width);
Handle open_dataset(const Handle& parent, const std::string& name);
void write(const Handle& dataset, Element element, const void* values);
void write_text(const Handle& dataset, const std::string& text);
/// Offset of the elements in the file [byte]; nullopt if they are not contiguous.
std::optional<std::uint64_t> place(const Handle& dataset);
/// Size of the elements in the file [byte].
std::uint64_t stored_bytes(const Handle& dataset);
/// Lengths of the axes of a dataset. Throws StudyError also if the file is too small for that many
/// elements, so that memory can be allocated for them.
Shape shape(const Handle& dataset);
/// Stored type of the elements; nullopt if it is not one of Element.
std::optional<Element> element(const Handle& dataset);
/// Name of the stored type, such as "f64", or "text of 20".
std::string type_name(const Handle& dataset);
/// Reads all elements, converted to `element`. Throws StudyError unless they fill `bytes` exactly.
void read(const Handle& dataset, Element element, std::span<std::byte> bytes);
/// Reads index `i` of the first axis, converted to `element`. Throws like read().
void read_row(const Handle& dataset, std::uint64_t i, Element element, std::span<std::byte> bytes);
std::string read_text(const Handle& dataset);

/// Makes a dataset the scale of a dimension.
void make_scale(const Handle& dataset, const std::string& dimension);
void attach_scale(const Handle& dataset, const Handle& scale, unsigned axis);

}  // namespace montecarta::engine::h5
