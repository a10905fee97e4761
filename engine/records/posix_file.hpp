// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/namespaces.hpp"

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>

namespace montecarta::engine {

/// The treatment of an existing file of the same name.
enum class Existing { refuse, replace };

/// A file that is read and written at offsets by any thread. Interrupted and partial transfers are
/// continued. Throws RunError with a remedy if the disk fails.
class PosixFile {
 public:
  enum class Mode { read, write, create };

  /// Opens a file. Throws StudyError if it cannot be opened in this mode or is no regular file.
  /// `create` keeps existing contents.
  PosixFile(std::filesystem::path path, Mode mode);
  ~PosixFile();
  PosixFile(PosixFile&& other) noexcept;

  const std::filesystem::path& path() const { return path_; }
  std::uint64_t size() const;
  void write_at(std::uint64_t offset, std::span<const std::byte> bytes) const;
  void read_at(std::uint64_t offset, std::span<std::byte> bytes) const;
  /// Copies `count` bytes from another file, within the operating system if it can.
  void copy_at(std::uint64_t offset, const PosixFile& from, std::uint64_t from_offset,
               std::uint64_t count) const;
  /// Allocates the disk space of the whole file, so that it cannot run out later and writing takes
  /// about half the system time. Does nothing on file systems that do not support it.
  void reserve() const;
  /// Waits until all data are on the disk.
  void sync() const;
  /// Locks the file against other montecarta processes that write, until it is closed. Readers are
  /// not excluded. Throws StudyError if another process has locked it.
  void lock() const;
  /// Gives the file its final name and writes that to the disk. Throws StudyError if another file
  /// has that name and may not be replaced.
  void rename(const std::filesystem::path& name, Existing existing);

 private:
  bool still_has_its_name() const;
  void copy_through_memory(std::uint64_t offset, const PosixFile& from, std::uint64_t from_offset,
                           std::uint64_t count) const;

  std::filesystem::path path_;
  int descriptor_ = -1;
};

/// A size in powers of 1000 with at least two digits: "3.8 MB", "12 kB", "17 B".
std::string bytes_text(double bytes);

/// Name of the unfinished work of the result `path`.
std::filesystem::path part_of(std::filesystem::path path);

/// Returns whether a file of that name exists. False if its folder cannot be searched; opening the
/// file reports that.
bool is_there(const std::filesystem::path& path);

/// Throws StudyError if a file of that name exists.
void require_free(const std::filesystem::path& path);

}  // namespace montecarta::engine
