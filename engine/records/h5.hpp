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

/// The little of HDF5 that montecarta uses, with owned identifiers and exceptions. Every function
/// throws StudyError naming the object if the file is only read, RunError if it is written. hdf5.h
/// itself stays in h5.cpp.
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

/// Of the HDF5 library, e.g. "1.10.8".
std::string library_version();

/// Creates or empties a file. Takes no HDF5 lock: the caller holds its own.
Handle create_file(const std::filesystem::path& path);
/// Begins a file in memory, which never touches a disk; `name` is for messages only.
Handle create_image(const std::string& name);
/// The bytes of a file made by create_image(), all other handles into which are closed.
std::string image_of(const Handle& file);
/// Opens for reading, also while another process writes runs into it.
Handle open_file(const std::filesystem::path& path);
/// Writes out what is cached and closes; unlike the destructor it tells when that fails.
void close_file(Handle file);

/// A group that remembers the order of its members.
Handle create_group(const Handle& parent, const std::string& name);
Handle open_group(const Handle& parent, const std::string& name);
bool has(const Handle& parent, const std::string& name);
/// Whether a member is a group and not a dataset.
bool is_group(const Handle& parent, const std::string& name);
/// Names of the members of a group in the order they were made.
std::vector<std::string> members(const Handle& group);

void put_text(const Handle& object, const std::string& name, const std::string& value);
void put_numbers(const Handle& object, const std::string& name,
                 std::span<const std::uint64_t> values);
std::optional<std::string> find_text(const Handle& object, const std::string& name);
std::string text(const Handle& object, const std::string& name);
/// All text attributes in the order they were made.
std::vector<Text> texts(const Handle& object);
std::vector<std::uint64_t> numbers(const Handle& object, const std::string& name);
/// The first of them.
std::uint64_t number(const Handle& object, const std::string& name);

using Shape = std::vector<unsigned long long>;  ///< HDF5's hsize_t

/// A contiguous dataset, given its place in the file at once and filled with nothing.
Handle create_dataset(const Handle& parent, const std::string& name, Element element,
                      const Shape& shape);
/// One text of at most `width` bytes. Texts along an axis would crash netCDF-C 4.9 or Octave 7.
Handle create_text(const Handle& parent, const std::string& name, std::size_t width);
Handle open_dataset(const Handle& parent, const std::string& name);
void write(const Handle& dataset, Element element, const void* values);
void write_text(const Handle& dataset, const std::string& text);
/// Where the elements begin in the file [byte]; nullopt where they do not lie in one piece.
std::optional<std::uint64_t> place(const Handle& dataset);
/// What the elements take in the file [byte].
std::uint64_t stored_bytes(const Handle& dataset);
/// Throws StudyError also where so many elements cannot be in the file: memory may be taken by it.
Shape shape(const Handle& dataset);
/// Type of the elements as stored; nullopt where it is none of ours.
std::optional<Element> element(const Handle& dataset);
/// Reads everything, converted to `element`; throws StudyError unless `bytes` fit exactly.
void read(const Handle& dataset, Element element, std::span<std::byte> bytes);
/// Reads index `i` of the first axis, converted to `element`; throws StudyError as read() does.
void read_row(const Handle& dataset, std::uint64_t i, Element element, std::span<std::byte> bytes);
std::string read_text(const Handle& dataset);

/// Makes a dataset the scale of a dimension.
void make_scale(const Handle& dataset, const std::string& dimension);
bool is_scale(const Handle& dataset);
void attach_scale(const Handle& dataset, const Handle& scale, unsigned axis);

namespace detail {
/// Throws StudyError (of a file that is only read, else RunError) "file: cannot <what>
/// '/object/name'" where `status` < 0; returns it otherwise.
std::int64_t check(std::int64_t status, const char* what, const Handle& object,
                   const std::string& name);
/// Throws StudyError where `elements` of `width` bytes are more than the file of `object` can hold,
/// even if another program compressed it.
void expect_in_file(std::span<const unsigned long long> elements, std::size_t width,
                    const Handle& object, const std::string& name);
/// HDF5's type of an element, in this machine's byte order; not to be closed.
std::int64_t native_type(Element element);
}  // namespace detail

}  // namespace montecarta::engine::h5
