// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/judging/array_file.hpp"

#include <cstring>
#include <functional>
#include <map>
#include <memory>
#include <numeric>
#include <span>
#include <string_view>
#include <utility>

namespace montecarta::experiments {
namespace {

/// The first character of a question. The name of an object follows, and a row where one is asked.
enum class ArrayQuestion : char { members, has, is_group, shape, texts, row, all };

std::string asked(ArrayQuestion question, const std::string& name = "", std::size_t row = 0) {
  std::string text(1 + sizeof row, static_cast<char>(question));
  std::memcpy(text.data() + 1, &row, sizeof row);
  return text + name;
}

template <class T>
std::string packed(const std::vector<T>& numbers) {
  const auto bytes = std::as_bytes(std::span(numbers));
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

template <class T>
std::vector<T> unpacked(const std::string& bytes) {
  std::vector<T> numbers(bytes.size() / sizeof(T));
  std::memcpy(numbers.data(), bytes.data(), numbers.size() * sizeof(T));
  return numbers;
}

/// Each text with a zero behind it.
std::string packed(const std::vector<std::string>& texts) {
  std::string all;
  for (const std::string& text : texts) all += text.substr(0, text.find('\0')) + '\0';
  return all;
}

std::vector<std::string> unpacked_texts(std::string_view all) {
  std::vector<std::string> texts;
  while (!all.empty()) {
    texts.emplace_back(all.substr(0, all.find('\0')));
    all.remove_prefix(texts.back().size() + 1);
  }
  return texts;
}

/// The file as the other process has it.
class OpenArrays {
 public:
  explicit OpenArrays(const std::filesystem::path& path) : file_(h5::open_file(path)) {}

  std::string answer(std::string_view text) {
    std::size_t row = 0;
    std::memcpy(&row, text.data() + 1, sizeof row);
    const std::string name(text.substr(1 + sizeof row));
    switch (static_cast<ArrayQuestion>(text.front())) {
      case ArrayQuestion::members:
        return packed(h5::members(file_));
      case ArrayQuestion::has:
        return h5::has(file_, name) ? "yes" : "";
      case ArrayQuestion::is_group:
        return h5::is_group(file_, name) ? "yes" : "";
      case ArrayQuestion::shape:
        return packed(h5::shape(dataset(name)));
      case ArrayQuestion::texts:
        if (!h5::has_attribute(file_, name)) return "";
        return "yes" + packed(h5::find_texts(file_, name));
      case ArrayQuestion::row:
        return rows(name, row);
      case ArrayQuestion::all:
        return rows(name, std::nullopt);
    }
    return "";
  }

 private:
  const h5::Handle& dataset(const std::string& name) {
    auto opened = datasets_.find(name);
    if (opened == datasets_.end())
      opened = datasets_.emplace(name, h5::open_dataset(file_, name)).first;
    return opened->second;
  }

  std::string rows(const std::string& name, std::optional<std::size_t> row) {
    const h5::Handle& array = dataset(name);
    const h5::Shape shape = h5::shape(array);
    const auto first = shape.begin() + (row && !shape.empty() ? 1 : 0);
    std::string bytes(
        std::accumulate(first, shape.end(), sizeof(double), std::multiplies<std::size_t>()), '\0');
    const auto out = std::as_writable_bytes(std::span(bytes));
    if (row) h5::read_row(array, *row, Element::f64, out);
    if (!row) h5::read(array, Element::f64, out);
    return bytes;
  }

  h5::Handle file_;
  std::map<std::string, h5::Handle> datasets_;
};

/// Opens the file at the first question, in the other process.
ForkedReader::Answer reader_of(const std::filesystem::path& path) {
  return [path, arrays = std::shared_ptr<OpenArrays>()](std::string_view question) mutable {
    if (!arrays) arrays = std::make_shared<OpenArrays>(path);
    return arrays->answer(question);
  };
}

}  // namespace

ArrayFile::ArrayFile(const std::filesystem::path& path) : copy_(path, reader_of(path)) {}

std::vector<std::string> ArrayFile::members() const {
  return unpacked_texts(copy_.ask(asked(ArrayQuestion::members)));
}

bool ArrayFile::has(const std::string& name) const {
  return !copy_.ask(asked(ArrayQuestion::has, name)).empty();
}

bool ArrayFile::is_group(const std::string& name) const {
  return !copy_.ask(asked(ArrayQuestion::is_group, name)).empty();
}

h5::Shape ArrayFile::shape(const std::string& array) const {
  return unpacked<h5::Shape::value_type>(copy_.ask(asked(ArrayQuestion::shape, array)));
}

std::optional<std::vector<std::string>> ArrayFile::texts(const std::string& attribute) const {
  const std::string answer = copy_.ask(asked(ArrayQuestion::texts, attribute));
  if (answer.empty()) return std::nullopt;
  return unpacked_texts(std::string_view(answer).substr(3));
}

std::vector<double> ArrayFile::numbers(const std::string& array,
                                       std::optional<std::size_t> row) const {
  return unpacked<double>(
      copy_.ask(asked(row ? ArrayQuestion::row : ArrayQuestion::all, array, row.value_or(0))));
}

}  // namespace montecarta::experiments
