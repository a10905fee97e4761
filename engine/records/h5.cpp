// SPDX-License-Identifier: BSD-3-Clause
#include "engine/records/h5.hpp"

#include "engine/errors.hpp"
#include "engine/formatted.hpp"

#include <hdf5.h>
#include <hdf5_hl.h>

#include <algorithm>
#include <array>
#include <bit>
#include <numeric>
#include <type_traits>

namespace montecarta::engine::h5 {
namespace {

constexpr hsize_t kPage = 4096;  // large datasets begin on a page, which makes pwrite faster
constexpr hsize_t kLarge = 1024 * 1024;  // [byte] least size of a large dataset
/// For chunks of one dataset: most bytes, least slots (HDF5's own number), most slots.
constexpr hsize_t kMostCache = hsize_t{1} << 30U, kFewSlots = 521, kMostSlots = hsize_t{1} << 20U;

static_assert(sizeof(hid_t) == sizeof(std::int64_t));

/// Errors become exceptions here, so HDF5 must not print its own stacks. Its clean-up at exit is
/// disabled too: nothing is left open, and it crashes if a file cannot be written.
void disable_error_printing() {
  H5dont_atexit();
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
}

Handle file_access() {
  Handle access(H5Pcreate(H5P_FILE_ACCESS));
  H5Pset_fclose_degree(access.id(), H5F_CLOSE_STRONG);
  H5Pset_alignment(access.id(), kLarge, kPage);
  H5Pset_file_locking(access.id(), false, true);
  return access;
}

/// Properties of a new file: members and attributes keep the order in which they are made.
Handle file_creation() {
  Handle creation(H5Pcreate(H5P_FILE_CREATE));
  H5Pset_link_creation_order(creation.id(), H5P_CRT_ORDER_TRACKED | H5P_CRT_ORDER_INDEXED);
  H5Pset_attr_creation_order(creation.id(), H5P_CRT_ORDER_TRACKED | H5P_CRT_ORDER_INDEXED);
  return creation;
}

/// The name that a function of HDF5 gives to an object.
std::string name_by(ssize_t (*name_of)(hid_t, char*, std::size_t), hid_t id) {
  std::string name(static_cast<std::size_t>(std::max<ssize_t>(name_of(id, nullptr, 0), 0)), '\0');
  name_of(id, name.data(), name.size() + 1);
  return name;
}

/// Returns whether the file is open for reading only. Then an error is due to the user's file,
/// otherwise to the machine.
bool is_only_read(const Handle& object) {
  const Handle file(H5Iget_file_id(object.id()));
  unsigned intent = 0;
  return file.id() >= 0 && H5Fget_intent(file.id(), &intent) >= 0 && intent == H5F_ACC_RDONLY;
}

/// Returns `status`, or throws "file: cannot <what> '/object/name'" if it is negative: StudyError
/// if the file is open for reading only, otherwise RunError.
std::int64_t check(std::int64_t status, const char* what, const Handle& object,
                   const std::string& name) {
  if (status >= 0) return status;
  const std::string own = name_by(H5Iget_name, object.id());
  const std::string within = (own == "/" ? "" : own) + (name.empty() ? "" : "/" + name);
  const std::string said = formatted(
      "{}: cannot {} '{}' (the file is damaged, not of montecarta, or the disk failed): check it "
      "with 'h5ls -r'",
      name_by(H5Fget_name, object.id()), what, within);
  if (is_only_read(object)) throw StudyError(said);
  throw RunError(said);
}

/// Throws StudyError if `elements` of `width` bytes are more than the file of `object` can hold,
/// even if they are compressed.
void require_in_file(std::span<const unsigned long long> elements, std::size_t width,
                     const Handle& object, const std::string& name) {
  constexpr unsigned long long kMostCompression = 1032;  // largest factor of deflate
  hsize_t most = 0;
  const Handle file(check(H5Iget_file_id(object.id()), "find the file of", object, name));
  check(H5Fget_filesize(file.id(), &most), "measure the file of", object, name);
  bool fits = !__builtin_mul_overflow(most, kMostCompression, &most);
  unsigned long long bytes = width;
  for (const auto length : elements) fits = fits && !__builtin_mul_overflow(bytes, length, &bytes);
  check(fits && bytes <= most ? 0 : -1, "believe the size of", object, name);
}

/// The HDF5 type of an element in the byte order of this machine. It must not be closed.
hid_t native_type(Element element) {
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

/// Access to a dataset in chunks, which other programs write, that caches all chunks with one index
/// of the first axis: then read_row() decompresses each chunk once, and not once for each row. HDF5
/// finds a chunk by a number with as many bits for an axis as its chunks need, so with this many
/// slots no chunk displaces another. Nullopt if there are no chunks.
std::optional<Handle> access_by_rows(const Handle& dataset) {
  const Handle creation(H5Dget_create_plist(dataset.id()));
  if (creation.id() < 0 || H5Pget_layout(creation.id()) != H5D_CHUNKED) return std::nullopt;
  std::array<hsize_t, H5S_MAX_RANK> extent{}, chunk{};
  const int rank = H5Pget_chunk(creation.id(), H5S_MAX_RANK, chunk.data());
  const Handle space(H5Dget_space(dataset.id())), type(H5Dget_type(dataset.id()));
  if (H5Sget_simple_extent_dims(space.id(), extent.data(), nullptr) != rank) return std::nullopt;
  const auto capped = [](hsize_t bytes) { return std::min(bytes, kMostCache); };
  hsize_t bytes = capped(capped(chunk[0]) * capped(H5Tget_size(type.id()))), slots = 1;
  for (std::size_t k = 1; k < static_cast<std::size_t>(rank); ++k) {
    const hsize_t length = std::max<hsize_t>(chunk[k], 1);
    const hsize_t chunks = extent[k] / length + (extent[k] % length == 0 ? 0 : 1);
    bytes = capped(bytes * capped(chunks * length));
    slots = std::min(slots * std::bit_ceil(capped(chunks)), kMostSlots);
  }
  Handle access(H5Pcreate(H5P_DATASET_ACCESS));
  H5Pset_chunk_cache(access.id(), std::max(slots, kFewSlots), std::max(bytes, kLarge), 1.0);
  return access;
}

template <class Info>
herr_t collect_name(hid_t, const char* name, const Info*, void* names) {
  static_cast<std::vector<std::string>*>(names)->emplace_back(name);
  return 0;
}

/// The names that `iterate` collects in the order in which they were made, or in alphabetical order
/// if a tool rewrote the file without keeping that order.
template <class Iterate>
std::vector<std::string> names_found(const Iterate& iterate, const char* what,
                                     const Handle& object) {
  std::vector<std::string> names;
  herr_t status = iterate(H5_INDEX_CRT_ORDER, &names);
  if (status < 0) {
    names.clear();
    status = iterate(H5_INDEX_NAME, &names);
  }
  check(status, what, object, "");
  return names;
}

}  // namespace

Handle::~Handle() {
  if (id_ >= 0) H5Idec_ref(id_);
}

std::string library_version() {
  disable_error_printing();
  unsigned major = 0;
  unsigned minor = 0;
  unsigned release = 0;
  H5get_libversion(&major, &minor, &release);
  return formatted("{}.{}.{}", major, minor, release);
}

Handle create_file(const std::filesystem::path& path) {
  disable_error_printing();
  const Handle access = file_access();
  H5Pset_libver_bounds(access.id(), H5F_LIBVER_V18, H5F_LIBVER_V18);
  Handle file(H5Fcreate(path.c_str(), H5F_ACC_TRUNC, file_creation().id(), access.id()));
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
  check(H5Fflush(file.id(), H5F_SCOPE_LOCAL), "flush", file, "");
  const auto size = check(H5Fget_file_image(file.id(), nullptr, 0), "measure", file, "");
  std::string image(static_cast<std::size_t>(size), '\0');
  check(H5Fget_file_image(file.id(), image.data(), image.size()), "copy", file, "");
  return image;
}

bool is_hdf5(const std::filesystem::path& path) { return H5Fis_hdf5(path.c_str()) > 0; }

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
  const std::string name = name_by(H5Fget_name, file.id());
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
  return Handle(check(group, "create group", parent, name));
}

Handle open_group(const Handle& parent, const std::string& name) {
  const hid_t group = H5Gopen2(parent.id(), name.c_str(), H5P_DEFAULT);
  return Handle(check(group, "open group", parent, name));
}

bool has(const Handle& parent, const std::string& name) {
  return check(H5Lexists(parent.id(), name.c_str(), H5P_DEFAULT), "look up", parent, name) > 0;
}

bool is_group(const Handle& parent, const std::string& name) {
  const hid_t opened = H5Oopen(parent.id(), name.c_str(), H5P_DEFAULT);
  const Handle object(check(opened, "open", parent, name));
  return H5Iget_type(object.id()) == H5I_GROUP;
}

std::vector<std::string> members(const Handle& group) {
  return names_found(
      [&](H5_index_t order, std::vector<std::string>* names) {
        return H5Literate(group.id(), order, H5_ITER_INC, nullptr, collect_name<H5L_info_t>, names);
      },
      "list", group);
}

namespace {

/// Type of UTF-8 strings of any length, which h5py reads as str.
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

/// The value of a text attribute of fixed or variable length; nullopt if it is not a single text.
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
  require_in_file({}, width, attribute, "");
  std::string value(width, '\0');
  if (H5Aread(attribute.id(), type.id(), value.data()) < 0) return std::nullopt;
  return value.substr(0, value.find('\0'));
}

std::vector<std::string> attribute_names(const Handle& object) {
  return names_found(
      [&](H5_index_t order, std::vector<std::string>* names) {
        return H5Aiterate2(object.id(), order, H5_ITER_INC, nullptr, collect_name<H5A_info_t>,
                           names);
      },
      "list the attributes of", object);
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

bool has_attribute(const Handle& object, const std::string& name) {
  return H5Aexists(object.id(), name.c_str()) > 0;
}

std::vector<std::string> find_texts(const Handle& object, const std::string& name) {
  if (!has_attribute(object, name)) return {};
  const Handle attribute = open_attribute(object, name);
  const Handle type(H5Aget_type(attribute.id()));
  const Handle space(H5Aget_space(attribute.id()));
  const hssize_t count = H5Sget_simple_extent_npoints(space.id());
  if (H5Tget_class(type.id()) != H5T_STRING || count < 1) return {};
  if (count == 1) return {value_of(attribute).value_or("")};
  std::vector<std::string> found;
  if (H5Tis_variable_str(type.id()) > 0) {
    require_in_file(std::array{static_cast<hsize_t>(count)}, sizeof(char*), object, name);
    std::vector<char*> values(static_cast<std::size_t>(count));
    if (H5Aread(attribute.id(), text_type().id(), values.data()) < 0) return {};
    for (const char* value : values) found.emplace_back(value == nullptr ? "" : value);
    H5Dvlen_reclaim(text_type().id(), space.id(), H5P_DEFAULT, values.data());
    return found;
  }
  const std::size_t width = H5Tget_size(type.id());
  require_in_file(std::array{static_cast<hsize_t>(count)}, width, object, name);
  std::string values(width * static_cast<std::size_t>(count), '\0');
  if (H5Aread(attribute.id(), type.id(), values.data()) < 0) return {};
  for (std::size_t k = 0; k < values.size(); k += width) {
    const std::string value = values.substr(k, width);
    found.push_back(value.substr(0, value.find('\0')));
  }
  return found;
}

std::vector<Text> texts(const Handle& object) {
  std::vector<Text> found;
  for (const std::string& name : attribute_names(object)) {
    if (auto value = find_text(object, name)) found.emplace_back(name, *std::move(value));
  }
  return found;
}

namespace {

/// Numbers of an attribute as they are stored.
std::string stored_bytes_of(const Handle& attribute, const Handle& type, std::size_t count) {
  const std::size_t width = H5Tget_size(type.id());
  require_in_file(std::array{static_cast<hsize_t>(count)}, width, attribute, "");
  std::string bytes(count * width, '\0');
  check(H5Aread(attribute.id(), type.id(), bytes.data()), "read attribute", attribute, "");
  return bytes;
}

}  // namespace

std::string attributes_text(const Handle& object) {
  std::string all;
  const auto add = [&](const std::string& part) { all += formatted("{}:{}", part.size(), part); };
  for (const std::string& name : attribute_names(object)) {
    const Handle attribute = open_attribute(object, name);
    const Handle type(H5Aget_type(attribute.id()));
    const H5T_class_t kind = H5Tget_class(type.id());
    if (kind != H5T_STRING && kind != H5T_INTEGER && kind != H5T_FLOAT) continue;
    const Handle space(H5Aget_space(attribute.id()));
    const auto count = static_cast<std::size_t>(
        check(H5Sget_simple_extent_npoints(space.id()), "read attribute", object, name));
    add(name);
    add(formatted("{} {}", kind, count));
    if (kind != H5T_STRING) add(stored_bytes_of(attribute, type, count));
    if (kind == H5T_STRING) {
      for (const std::string& value : find_texts(object, name)) add(value);
    }
  }
  return all;
}

std::vector<std::uint64_t> numbers(const Handle& object, const std::string& name) {
  const Handle attribute = open_attribute(object, name);
  const Handle space(H5Aget_space(attribute.id()));
  const auto count =
      check(H5Sget_simple_extent_npoints(space.id()), "read attribute", object, name);
  require_in_file(std::array{static_cast<hsize_t>(count)}, sizeof(std::uint64_t), object, name);
  std::vector<std::uint64_t> values(static_cast<std::size_t>(count));
  check(H5Aread(attribute.id(), H5T_NATIVE_UINT64, values.data()), "read attribute", object, name);
  return values;
}

std::uint64_t number(const Handle& object, const std::string& name) {
  const std::vector<std::uint64_t> values = numbers(object, name);
  check(values.empty() ? -1 : 0, "read attribute", object, name);
  return values.front();
}

namespace {

Handle space_of(const Shape& shape) {
  if (shape.empty()) return Handle(H5Screate(H5S_SCALAR));
  return Handle(H5Screate_simple(static_cast<int>(shape.size()), shape.data(), nullptr));
}

/// Type of texts of fixed width. It is marked as ASCII even for UTF-8, because Octave 7 does not
/// read texts that are marked as UTF-8.
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

void require_fit(std::uint64_t elements, Element element, std::span<std::byte> bytes,
                 const Handle& dataset) {
  check(elements * size_of(element) == bytes.size() ? 0 : -1, "fit to its axes", dataset, "");
}

/// Size of an element of any dataset [byte].
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
  const auto opened = [&](hid_t access) {
    return Handle(check(H5Dopen2(parent.id(), name.c_str(), access), "open dataset", parent, name));
  };
  const auto access = access_by_rows(opened(H5P_DEFAULT));
  return opened(access ? access->id() : H5P_DEFAULT);
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
  require_in_file(dimensions, width_of(dataset), dataset, "");
  return {dimensions.begin(), dimensions.end()};
}

std::optional<Element> element(const Handle& dataset) {
  const Handle type(H5Dget_type(dataset.id()));
  for (Element candidate : {Element::f64, Element::u8, Element::u16, Element::u32, Element::u64}) {
    if (H5Tequal(type.id(), native_type(candidate)) > 0) return candidate;
  }
  return std::nullopt;
}

std::string type_name(const Handle& dataset) {
  constexpr std::array<const char*, 5> names = {"f64", "u8", "u16", "u32", "u64"};
  if (const auto known = element(dataset)) return names[static_cast<std::size_t>(*known)];
  const Handle type(H5Dget_type(dataset.id()));
  const bool is_text = H5Tget_class(type.id()) == H5T_STRING;
  return (is_text ? "text of " : "other type of ") + std::to_string(H5Tget_size(type.id()));
}

void read(const Handle& dataset, Element element, std::span<std::byte> bytes) {
  require_fit(count(shape(dataset)), element, bytes, dataset);
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
  require_fit(count(extent), element, bytes, dataset);
  const Handle file_space(H5Dget_space(dataset.id()));
  H5Sselect_hyperslab(file_space.id(), H5S_SELECT_SET, start.data(), nullptr, extent.data(),
                      nullptr);
  const Handle memory_space = space_of(extent);  // of the same shape, which chunks are copied by
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

void attach_scale(const Handle& dataset, const Handle& scale, unsigned axis) {
  check(H5DSattach_scale(dataset.id(), scale.id(), axis), "attach a dimension scale to", dataset,
        "");
}

}  // namespace montecarta::engine::h5
