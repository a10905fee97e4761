// SPDX-License-Identifier: BSD-3-Clause
#include "engine/records/h5.hpp"

#include "engine/errors.hpp"

#include <hdf5.h>

#include <algorithm>

namespace montecarta::engine::h5 {
namespace {

constexpr hsize_t kPage = 4096;          // large datasets begin on a page, for pwrite's sake
constexpr hsize_t kLarge = 1024 * 1024;  // [byte] what counts as large

static_assert(sizeof(hid_t) == sizeof(std::int64_t));

/// Errors become exceptions here; HDF5's own printed stacks would only frighten. Its tidying up at
/// exit goes, too: nothing is left open for it, and it crashes on a file it could not write out.
void disable_error_printing() {
  H5dont_atexit();
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
}

Handle file_access() {
  Handle access(H5Pcreate(H5P_FILE_ACCESS));
  H5Pset_fclose_degree(access.id(), H5F_CLOSE_STRONG);
  H5Pset_libver_bounds(access.id(), H5F_LIBVER_V18, H5F_LIBVER_V18);
  H5Pset_alignment(access.id(), kLarge, kPage);
  H5Pset_file_locking(access.id(), false, true);
  return access;
}

/// Members and attributes keep the order in which they are made.
Handle file_creation() {
  Handle creation(H5Pcreate(H5P_FILE_CREATE));
  H5Pset_link_creation_order(creation.id(), H5P_CRT_ORDER_TRACKED | H5P_CRT_ORDER_INDEXED);
  H5Pset_attr_creation_order(creation.id(), H5P_CRT_ORDER_TRACKED | H5P_CRT_ORDER_INDEXED);
  return creation;
}

std::string name_of_file(hid_t id) {
  std::string name(static_cast<std::size_t>(std::max<ssize_t>(H5Fget_name(id, nullptr, 0), 0)),
                   '\0');
  H5Fget_name(id, name.data(), name.size() + 1);
  return name;
}

std::string name_in_file(hid_t id) {
  std::string name(static_cast<std::size_t>(std::max<ssize_t>(H5Iget_name(id, nullptr, 0), 0)),
                   '\0');
  H5Iget_name(id, name.data(), name.size() + 1);
  return name == "/" ? "" : name;
}

herr_t collect_name(hid_t, const char* name, const H5L_info_t*, void* names) {
  static_cast<std::vector<std::string>*>(names)->emplace_back(name);
  return 0;
}

/// What cannot be read is the user's file; what cannot be written is the machine's fault.
bool is_only_read(const Handle& object) {
  const Handle file(H5Iget_file_id(object.id()));
  unsigned intent = 0;
  return file.id() >= 0 && H5Fget_intent(file.id(), &intent) >= 0 && intent == H5F_ACC_RDONLY;
}

}  // namespace

namespace detail {

std::int64_t check(std::int64_t status, const char* what, const Handle& object,
                   const std::string& name) {
  if (status >= 0) return status;
  const std::string within = name_in_file(object.id()) + (name.empty() ? "" : "/" + name);
  const std::string said =
      name_of_file(object.id()) + ": cannot " + what + " '" + within +
      "' (the file is damaged, not of montecarta, or the disk failed): check it with 'h5ls -r'";
  if (is_only_read(object)) throw StudyError(said);
  throw RunError(said);
}

void expect_in_file(std::span<const unsigned long long> elements, std::size_t width,
                    const Handle& object, const std::string& name) {
  constexpr unsigned long long kMostCompression = 1032;  // of deflate
  hsize_t most = 0;
  const Handle file(check(H5Iget_file_id(object.id()), "find the file of", object, name));
  check(H5Fget_filesize(file.id(), &most), "measure the file of", object, name);
  bool fits = !__builtin_mul_overflow(most, kMostCompression, &most);
  unsigned long long bytes = width;
  for (const auto length : elements) fits = fits && !__builtin_mul_overflow(bytes, length, &bytes);
  check(fits && bytes <= most ? 0 : -1, "believe the size of", object, name);
}

std::int64_t native_type(Element element) {
  switch (element) {
    case Element::f64:
      return H5T_NATIVE_DOUBLE;
    case Element::u8:
      return H5T_NATIVE_UINT8;
    case Element::u16:
      return H5T_NATIVE_UINT16;
    case Element::u32:
      return H5T_NATIVE_UINT32;
    case Element::u64:
      return H5T_NATIVE_UINT64;
  }
  return H5I_INVALID_HID;
}

}  // namespace detail

Handle::~Handle() {
  if (id_ >= 0) H5Idec_ref(id_);
}

std::string library_version() {
  disable_error_printing();
  unsigned major = 0;
  unsigned minor = 0;
  unsigned release = 0;
  H5get_libversion(&major, &minor, &release);
  return std::to_string(major) + "." + std::to_string(minor) + "." + std::to_string(release);
}

Handle create_file(const std::filesystem::path& path) {
  disable_error_printing();
  Handle file(H5Fcreate(path.c_str(), H5F_ACC_TRUNC, file_creation().id(), file_access().id()));
  if (file.id() < 0)
    throw RunError(path.string() +
                   ": cannot create it (HDF5 refused; the disk may be full): check the disk");
  return file;
}

Handle create_image(const std::string& name) {
  disable_error_printing();
  const Handle access = file_access();
  H5Pset_fapl_core(access.id(), kLarge, false);
  // H5Fget_file_image spoils the checksum that newer superblocks have.
  H5Pset_libver_bounds(access.id(), H5F_LIBVER_EARLIEST, H5F_LIBVER_V18);
  Handle file(H5Fcreate(name.c_str(), H5F_ACC_TRUNC, file_creation().id(), access.id()));
  if (file.id() < 0)
    throw RunError(name + ": cannot be made in memory (HDF5 refused): free memory");
  return file;
}

std::string image_of(const Handle& file) {
  detail::check(H5Fflush(file.id(), H5F_SCOPE_LOCAL), "flush", file, "");
  const auto size = detail::check(H5Fget_file_image(file.id(), nullptr, 0), "measure", file, "");
  std::string image(static_cast<std::size_t>(size), '\0');
  detail::check(H5Fget_file_image(file.id(), image.data(), image.size()), "copy", file, "");
  return image;
}

Handle open_file(const std::filesystem::path& path) {
  disable_error_printing();
  Handle file(H5Fopen(path.c_str(), H5F_ACC_RDONLY, file_access().id()));
  if (file.id() < 0)
    throw StudyError(path.string() +
                     ": not a readable HDF5 file (another kind, cut short, or damaged): "
                     "give a file that 'montecarta run' wrote");
  return file;
}

void close_file(Handle file) {
  const std::string name = name_of_file(file.id());
  const hid_t id = file.id();
  H5Iinc_ref(id);
  if (H5Fflush(id, H5F_SCOPE_LOCAL) < 0 || H5Fclose(id) < 0)
    throw RunError(
        name +
        ": cannot write it out (the disk is full, or a limit on file sizes reached): free "
        "space or raise the limit (ulimit -f), then try again");
}

Handle create_group(const Handle& parent, const std::string& name) {
  Handle creation(H5Pcreate(H5P_GROUP_CREATE));
  H5Pset_link_creation_order(creation.id(), H5P_CRT_ORDER_TRACKED | H5P_CRT_ORDER_INDEXED);
  H5Pset_attr_creation_order(creation.id(), H5P_CRT_ORDER_TRACKED | H5P_CRT_ORDER_INDEXED);
  const hid_t group =
      H5Gcreate2(parent.id(), name.c_str(), H5P_DEFAULT, creation.id(), H5P_DEFAULT);
  return Handle(detail::check(group, "create group", parent, name));
}

Handle open_group(const Handle& parent, const std::string& name) {
  const hid_t group = H5Gopen2(parent.id(), name.c_str(), H5P_DEFAULT);
  return Handle(detail::check(group, "open group", parent, name));
}

bool has(const Handle& parent, const std::string& name) {
  return detail::check(H5Lexists(parent.id(), name.c_str(), H5P_DEFAULT), "look up", parent, name) >
         0;
}

bool is_group(const Handle& parent, const std::string& name) {
  const hid_t opened = H5Oopen(parent.id(), name.c_str(), H5P_DEFAULT);
  const Handle object(detail::check(opened, "open", parent, name));
  return H5Iget_type(object.id()) == H5I_GROUP;
}

std::vector<std::string> members(const Handle& group) {
  std::vector<std::string> names;
  herr_t status =
      H5Literate(group.id(), H5_INDEX_CRT_ORDER, H5_ITER_INC, nullptr, collect_name, &names);
  if (status < 0) {  // a tool rewrote the file without keeping the order
    names.clear();
    status = H5Literate(group.id(), H5_INDEX_NAME, H5_ITER_INC, nullptr, collect_name, &names);
  }
  detail::check(status, "list", group, "");
  return names;
}

}  // namespace montecarta::engine::h5
