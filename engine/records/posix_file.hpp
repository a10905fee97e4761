// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/namespaces.hpp"

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>

namespace montecarta::engine {

/// A file read and written at offsets, from any thread, with errors that say what to do.
/// Interrupted and partial transfers are carried on. Throws RunError where the disk fails.
class PosixFile {
 public:
  enum class Mode { read, write, create };

  /// Throws StudyError where the path cannot be opened so or is no regular file. `create` keeps
  /// what is there.
  PosixFile(std::filesystem::path path, Mode mode);
  ~PosixFile();
  PosixFile(PosixFile&& other) noexcept;

  const std::filesystem::path& path() const { return path_; }
  std::uint64_t size() const;
  void write_at(std::uint64_t offset, std::span<const std::byte> bytes) const;
  void read_at(std::uint64_t offset, std::span<std::byte> bytes) const;
  /// Copies `count` bytes from another file without a detour through this program where the system
  /// can.
  void copy_at(std::uint64_t offset, const PosixFile& from, std::uint64_t from_offset,
               std::uint64_t count) const;
  /// Takes the disk space of the whole file now, so that it cannot run out later; writing then also
  /// costs the system about half. Does nothing on file systems that cannot.
  void reserve() const;
  /// Waits until everything is on the disk.
  void sync() const;
  /// Keeps other montecarta processes out until this file is closed; readers are not kept out.
  /// Throws StudyError where another process holds it.
  void lock() const;
  /// Gives the file its final name, on the disk too. What had the name is replaced, or StudyError
  /// where `keep`.
  enum class Target { replace, keep };
  void rename(const std::filesystem::path& name, Target target);

 private:
  bool still_has_its_name() const;
  void copy_through_memory(std::uint64_t offset, const PosixFile& from, std::uint64_t from_offset,
                           std::uint64_t count) const;

  std::filesystem::path path_;
  int descriptor_ = -1;
};

/// "3.8 MB", "12 kB", "17 B": powers of 1000, two digits or more.
std::string bytes_text(double bytes);

/// Name of the work in progress of the result `path`.
std::filesystem::path part_of(std::filesystem::path path);

/// Whether something has that name. False where its folder may not be searched: opening the file
/// says so better than this could.
bool is_there(const std::filesystem::path& path);

/// Throws StudyError where something has that name already.
void expect_free(const std::filesystem::path& path);

}  // namespace montecarta::engine
