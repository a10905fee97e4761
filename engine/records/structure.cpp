// SPDX-License-Identifier: BSD-3-Clause
#include "engine/records/structure.hpp"

#include "engine/errors.hpp"
#include "engine/formatted.hpp"
#include "engine/records/fingerprint.hpp"
#include "engine/records/result_format.hpp"
#include "engine/text/list_text.hpp"
#include "engine/text/visible_text.hpp"

#include <algorithm>
#include <cstdio>
#include <functional>
#include <numeric>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace montecarta::engine {
namespace {

constexpr std::size_t kDeepest = 8;  // a group that is linked into itself has no end
const std::string kName = std::string("/provenance/") + format::kStructure;

/// A group or a dataset.
struct Object {
  std::string name;
  std::string kind;  ///< "group", or type and axes of a dataset
  std::string fingerprint;
};

std::string fingerprint_of(const std::string& text) {
  Fingerprint fingerprint;
  fingerprint.add(std::as_bytes(std::span(text)));
  char digits[17];
  std::snprintf(digits, sizeof digits, "%016llx",
                static_cast<unsigned long long>(fingerprint.value()));
  return digits;
}

std::string line_of(const Object& object) {
  return formatted("{}\t{}\t{}\n", object.name, object.kind, object.fingerprint);
}

/// Returns whether the elements of a dataset are part of the structure. Runs have fingerprints of
/// their own, sums are read from sealed files only, and the times of computing change.
bool has_fixed_contents(const std::string& name) {
  const auto is_in = [&](std::string_view group) { return name.starts_with(group); };
  return !is_in("/cells/") && !is_in("/truth/") && !is_in("/timing/") && !is_in("/sums/") &&
         name != "/provenance/sittings";
}

std::string kind_of(const h5::Handle& dataset) {
  std::string axes;
  for (const auto length : h5::shape(dataset)) {
    append_part(axes, std::to_string(length));
  }
  return formatted("{} {{{}}}", h5::type_name(dataset), axes);
}

std::string contents_of(const h5::Handle& dataset) {
  const auto element = h5::element(dataset);
  if (!element) return h5::read_text(dataset);
  const h5::Shape shape = h5::shape(dataset);
  std::string bytes(
      std::accumulate(shape.begin(), shape.end(), size_of(*element), std::multiplies<>()), '\0');
  h5::read(dataset, *element, std::as_writable_bytes(std::span(bytes)));
  return bytes;
}

Object object_of(const h5::Handle& dataset, const std::string& name) {
  const std::string contents = has_fixed_contents(name) ? contents_of(dataset) : "";
  return {name, kind_of(dataset), fingerprint_of(h5::attributes_text(dataset) + contents)};
}

/// Appends a group and all that is in it, in the order of the file.
void add_objects(const h5::Handle& group, const std::string& name, std::size_t depth,
                 std::vector<Object>& objects) {
  objects.push_back(
      {name.empty() ? "/" : name, "group", fingerprint_of(h5::attributes_text(group))});
  if (depth == kDeepest) return;
  for (const std::string& member : h5::members(group)) {
    const std::string inside = formatted("{}/{}", name, member);
    if (inside == kName) continue;
    if (h5::is_group(group, member)) {
      add_objects(h5::open_group(group, member), inside, depth + 1, objects);
    } else {
      objects.push_back(object_of(h5::open_dataset(group, member), inside));
    }
  }
}

/// The objects of a file. Those of the scenario are one, since a study may have thousands of
/// drives.
std::vector<Object> objects_in(const h5::Handle& file) {
  std::vector<Object> all, objects;
  add_objects(file, "", 0, all);
  std::string scenario;
  for (const Object& object : all) {
    if (object.name.starts_with("/scenario/")) {
      scenario += line_of(object);
    } else {
      objects.push_back(object);
    }
  }
  const auto found = std::ranges::find(objects, "/scenario", &Object::name);
  if (found != objects.end()) found->fingerprint = fingerprint_of(found->fingerprint + scenario);
  return objects;
}

std::vector<Object> objects_from(std::string_view text) {
  std::vector<Object> objects;
  while (!text.empty()) {
    const std::string_view line = text.substr(0, text.find('\n'));
    text.remove_prefix(std::min(line.size() + 1, text.size()));
    const std::size_t first = line.find('\t'), last = line.rfind('\t');
    if (first == last) continue;
    objects.push_back({std::string(line.substr(0, first)),
                       std::string(line.substr(first + 1, last - first - 1)),
                       std::string(line.substr(last + 1))});
  }
  return objects;
}

/// The first difference, such as "'/cells/a/nis' is gone"; empty if there is none.
std::string difference(const std::vector<Object>& stored, const std::vector<Object>& found) {
  const auto quoted = [](const Object& object) { return formatted("'{}' ", visible(object.name)); };
  for (const Object& object : stored) {
    const auto same = std::ranges::find(found, object.name, &Object::name);
    if (same == found.end()) return quoted(object) + "is gone";
    if (same->kind != object.kind)
      return formatted("{}is {}, it was {}", quoted(object), same->kind, visible(object.kind));
    if (same->fingerprint != object.fingerprint)
      return quoted(object) + "has other attributes or contents";
  }
  for (const Object& object : found) {
    if (std::ranges::count(stored, object.name, &Object::name) == 0)
      return quoted(object) + "was added";
  }
  return std::ranges::equal(stored, found, {}, &Object::name, &Object::name)
             ? ""
             : "its objects have another order";
}

}  // namespace

void put_structure(const h5::Handle& file) {
  std::string text;
  for (const Object& object : objects_in(file)) text += line_of(object);
  const h5::Handle dataset = h5::create_text(file, kName, text.size());
  h5::write_text(dataset, text);
  h5::put_text(dataset, "units", "1");
  h5::put_text(dataset, "long_name",
               "type, axes and XXH3 of attributes and contents of all other objects");
}

void check_structure(const h5::Handle& file, std::uint64_t minor_version,
                     const std::filesystem::path& path) {
  const auto refuse = [&](const std::string& why) {
    throw StudyError(
        "{}: changed by another program ({}): take the file as montecarta wrote it, or run the "
        "study again",
        path, why);
  };
  const bool is_there = h5::has(file, "provenance") &&
                        h5::has(h5::open_group(file, "provenance"), format::kStructure);
  if (is_there) {
    const auto stored = objects_from(h5::read_text(h5::open_dataset(file, kName)));
    const std::string why = difference(stored, objects_in(file));
    if (!why.empty()) refuse(why);
  } else if (minor_version >= format::kMinorOfStructure) {
    refuse(formatted("'{}' is gone", kName));
  }
}

}  // namespace montecarta::engine
