// SPDX-License-Identifier: BSD-3-Clause
#include "engine/records/posix_file.hpp"

#include "engine/errors.hpp"
#include "engine/formatted.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <fcntl.h>
#include <sys/stat.h>
#include <system_error>
#include <unistd.h>
#include <utility>
#include <vector>

namespace montecarta::engine {
namespace {

std::string reason(int error) { return formatted(" ({})", std::strerror(error)); }

[[noreturn]] void fail_to_open(const std::filesystem::path& path, int error) {
  std::string remedy = "choose another path";
  if (error == ENOENT) remedy = "make the folder first, or check the spelling";
  if (error == EACCES || error == EPERM || error == EROFS)
    remedy = "choose a path where you may write, or change the permissions";
  throw StudyError("{}: cannot open it{}: {}", path, reason(error), remedy);
}

std::string remedy(int error) {
  if (error == ENOSPC || error == EDQUOT) return "free space";
  if (error == EFBIG) return "raise the limit on file sizes (ulimit -f)";
  return "check the disk";
}

[[noreturn]] void fail_to_write(const std::filesystem::path& path, int error) {
  throw RunError(
      "{}: cannot write{}: {}, then continue with --resume; the runs stored so far are safe", path,
      reason(error), remedy(error));
}

[[noreturn]] void fail_to_read(const std::filesystem::path& path, const std::string& why) {
  throw RunError("{}: cannot read{}: check the disk, or make the file anew", path, why);
}

off_t signed_offset(std::uint64_t offset) { return static_cast<off_t>(offset); }

/// The flags of open(), which does not wait for the other end of a pipe.
int flags_of(PosixFile::Mode mode) {
  constexpr int always = O_CLOEXEC | O_NONBLOCK;
  switch (mode) {
    case PosixFile::Mode::read:
      return O_RDONLY | always;
    case PosixFile::Mode::write:
      return O_RDWR | always;
    case PosixFile::Mode::create:
      return O_RDWR | O_CREAT | always;
  }
  return always;
}

bool is_regular(int descriptor) {
  struct stat status {};
  return ::fstat(descriptor, &status) == 0 && S_ISREG(status.st_mode);
}

/// Writes the folder to the disk, since a new name is not durable before that.
void sync_folder_of(const std::filesystem::path& path) {
  const auto folder = path.has_parent_path() ? path.parent_path() : std::filesystem::path(".");
  const int descriptor = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (descriptor < 0) return;  // nothing can be done if the folder is not readable
  ::fsync(descriptor);
  ::close(descriptor);
}

}  // namespace

PosixFile::PosixFile(std::filesystem::path path, Mode mode) : path_(std::move(path)) {
  do {
    descriptor_ = ::open(path_.c_str(), flags_of(mode), 0666);
  } while (descriptor_ < 0 && errno == EINTR);
  if (descriptor_ < 0) fail_to_open(path_, errno);
  if (is_regular(descriptor_)) return;
  ::close(descriptor_);
  throw StudyError(path_.string() +
                   ": is no regular file (a folder, a pipe or a device): name one");
}

PosixFile::~PosixFile() {
  if (descriptor_ >= 0) ::close(descriptor_);
}

PosixFile::PosixFile(PosixFile&& other) noexcept
    : path_(std::move(other.path_)), descriptor_(std::exchange(other.descriptor_, -1)) {}

std::uint64_t PosixFile::size() const {
  struct stat status {};
  if (::fstat(descriptor_, &status) != 0) fail_to_read(path_, reason(errno));
  return static_cast<std::uint64_t>(status.st_size);
}

void PosixFile::write_at(std::uint64_t offset, std::span<const std::byte> bytes) const {
  while (!bytes.empty()) {
    const ssize_t done = ::pwrite(descriptor_, bytes.data(), bytes.size(), signed_offset(offset));
    if (done < 0 && errno == EINTR) continue;
    if (done <= 0) fail_to_write(path_, done == 0 ? ENOSPC : errno);
    bytes = bytes.subspan(static_cast<std::size_t>(done));
    offset += static_cast<std::uint64_t>(done);
  }
}

void PosixFile::read_at(std::uint64_t offset, std::span<std::byte> bytes) const {
  while (!bytes.empty()) {
    const ssize_t done = ::pread(descriptor_, bytes.data(), bytes.size(), signed_offset(offset));
    if (done < 0 && errno == EINTR) continue;
    if (done < 0) fail_to_read(path_, reason(errno));
    if (done == 0) fail_to_read(path_, " (the file was cut short)");
    bytes = bytes.subspan(static_cast<std::size_t>(done));
    offset += static_cast<std::uint64_t>(done);
  }
}

void PosixFile::copy_at(std::uint64_t offset, const PosixFile& from, std::uint64_t from_offset,
                        std::uint64_t count) const {
  while (count > 0) {
    off_t source = signed_offset(from_offset);
    off_t sink = signed_offset(offset);
    const ssize_t done = ::copy_file_range(from.descriptor_, &source, descriptor_, &sink, count, 0);
    if (done < 0 && errno == EINTR) continue;
    if (done < 0 && (errno == ENOSPC || errno == EDQUOT || errno == EFBIG))
      fail_to_write(path_, errno);
    if (done <= 0) return copy_through_memory(offset, from, from_offset, count);
    offset += static_cast<std::uint64_t>(done);
    from_offset += static_cast<std::uint64_t>(done);
    count -= static_cast<std::uint64_t>(done);
  }
}

void PosixFile::copy_through_memory(std::uint64_t offset, const PosixFile& from,
                                    std::uint64_t from_offset, std::uint64_t count) const {
  std::vector<std::byte> buffer(std::min<std::uint64_t>(count, 1U << 20U));
  while (count > 0) {
    const std::span<std::byte> piece(buffer.data(), std::min<std::uint64_t>(count, buffer.size()));
    from.read_at(from_offset, piece);
    write_at(offset, piece);
    offset += piece.size();
    from_offset += piece.size();
    count -= piece.size();
  }
}

void PosixFile::reserve() const {
  const std::uint64_t bytes = size();
  int error = 0;
  do {
    error = ::fallocate(descriptor_, 0, 0, signed_offset(bytes)) == 0 ? 0 : errno;
  } while (error == EINTR);
  if (error != ENOSPC && error != EDQUOT && error != EFBIG) return;
  throw RunError("{}: cannot reserve {} bytes{}: {}, or store fewer runs or columns", path_, bytes,
                 reason(error), remedy(error));
}

void PosixFile::sync() const {
  int status = 0;
  do {
    status = ::fsync(descriptor_);
  } while (status != 0 && errno == EINTR);
  if (status != 0) fail_to_write(path_, errno);
}

void PosixFile::lock() const {
  // A lock of the open file description, not flock, because flock would exclude HDF5 readers.
  struct flock whole {};
  whole.l_type = F_WRLCK;
  whole.l_whence = SEEK_SET;
  const bool refused =
      ::fcntl(descriptor_, F_OFD_SETLK, &whole) != 0 && (errno == EAGAIN || errno == EACCES);
  if (refused || !still_has_its_name()) {
    throw StudyError(path_.string() +
                     ": another montecarta process is writing it: wait for it, or choose another "
                     "output path");
  }
}

/// Returns false if another process renamed or replaced the file between opening and locking.
bool PosixFile::still_has_its_name() const {
  struct stat opened {};
  struct stat named {};
  return ::fstat(descriptor_, &opened) == 0 && ::stat(path_.c_str(), &named) == 0 &&
         opened.st_ino == named.st_ino && opened.st_dev == named.st_dev;
}

void PosixFile::rename(const std::filesystem::path& name, Existing existing) {
  int status = -1;
  if (existing == Existing::refuse) {
    status = ::renameat2(AT_FDCWD, path_.c_str(), AT_FDCWD, name.c_str(), RENAME_NOREPLACE);
    if (status != 0 && errno == EEXIST)
      throw StudyError(
          "{}: exists (made meanwhile by someone else): the result stays in {}; move one of them",
          name, path_);
  }
  if (status != 0) status = ::rename(path_.c_str(), name.c_str());
  if (status != 0) fail_to_write(name, errno);
  path_ = name;
  sync_folder_of(path_);
}

std::filesystem::path part_of(std::filesystem::path path) { return path += ".part"; }

bool is_there(const std::filesystem::path& path) {
  std::error_code ignored;
  return std::filesystem::exists(path, ignored);
}

void require_free(const std::filesystem::path& path) {
  if (!is_there(path)) return;
  throw StudyError(path.string() +
                   ": exists (nothing is overwritten unasked): add --force to replace it, or "
                   "choose another path");
}

std::string bytes_text(double bytes) {
  constexpr std::array kUnits = {" B", " kB", " MB", " GB", " TB"};
  std::size_t unit = 0;
  for (; bytes >= 999.5 && unit + 1 < kUnits.size(); ++unit) bytes /= 1000.0;
  std::array<char, 64> text{};
  std::snprintf(text.data(), text.size(), unit > 0 && bytes < 9.95 ? "%.1f" : "%.0f", bytes);
  return text.data() + std::string(kUnits[unit]);
}

}  // namespace montecarta::engine
