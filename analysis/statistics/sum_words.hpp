// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "analysis/statistics/merging.hpp"

#include <Eigen/Core>

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <tuple>
#include <type_traits>
#include <utility>
#include <vector>

/// Sums as a stream of 64-bit words, by the parts() of their classes (merging.hpp) or by members(),
/// a tuple of pointers to all members of an aggregate:
///
///     static constexpr auto members() { return std::tuple(&Mean::sum, &Mean::n); }
namespace montecarta::analysis {

using Words = std::vector<std::uint64_t>;

/// Calls visit(member, of_first_runs) for every member of T that is stored.
template <class T, class Visit>
void for_each_member(const Visit& visit) {
  if constexpr (requires { T::parts(); }) {
    const auto visit_part = [&](const auto& part) {
      std::apply([&](auto... member) { (visit(member, part.of_first_runs), ...); }, part.members);
    };
    std::apply([&](const auto&... part) { (visit_part(part), ...); }, T::parts());
  } else {
    std::apply([&](auto... member) { (visit(member, false), ...); }, T::members());
  }
}

template <class T>
concept Number = std::is_arithmetic_v<T> || std::is_enum_v<T>;

/// Writes sums.
class SumWriter {
 public:
  /// Which of the members are written that are kept of the first runs of a study alone.
  enum class FirstRuns : std::uint8_t { keep, leave_out };
  explicit SumWriter(FirstRuns first_runs) : first_runs_(first_runs) {}

  template <class T>
  void put(const T& value) {
    if constexpr (std::is_same_v<T, double>) {
      words_.push_back(std::bit_cast<std::uint64_t>(value));
    } else if constexpr (Number<T>) {
      words_.push_back(static_cast<std::uint64_t>(value));
    } else {
      for_each_member<T>([&](auto member, bool of_first_runs) {
        const bool is_left_out = of_first_runs && first_runs_ == FirstRuns::leave_out;
        is_left_out ? words_.push_back(0) : put(value.*member);  // an empty vector
      });
    }
  }
  template <class T>
  void put(const std::vector<T>& values) {
    words_.push_back(values.size());
    for (const T& value : values) put(value);
  }
  template <class T, std::size_t N>
  void put(const std::array<T, N>& values) {
    for (const T& value : values) put(value);
  }
  template <class T>
  void put(const std::optional<T>& value) {
    put(value.has_value());
    if (value) put(*value);
  }
  template <int R, int C>
  void put(const Eigen::Matrix<double, R, C>& matrix) {
    static_assert(R > 0 && C > 0);
    for (const double value : matrix.reshaped()) put(value);
  }

  Words take() { return std::move(words_); }

 private:
  FirstRuns first_runs_;
  Words words_;
};

/// Reads sums that a SumWriter wrote. Throws StudyError if the words end too early, or if a number
/// is none of its type.
class SumReader {
 public:
  explicit SumReader(std::span<const std::uint64_t> words) : words_(words) {}

  template <class T>
  void get(T& value) {
    if constexpr (std::is_same_v<T, double>) {
      value = std::bit_cast<double>(next());
    } else if constexpr (Number<T>) {
      const std::uint64_t word = next();
      value = static_cast<T>(word);
      expect(static_cast<std::uint64_t>(value) == word);
    } else {
      for_each_member<T>([&](auto member, bool /*of_first_runs*/) { get(value.*member); });
    }
  }
  template <class T>
  void get(std::vector<T>& values) {
    const std::uint64_t length = next();
    expect(length <= words_.size());  // every value takes at least a word
    values.clear();
    for (std::uint64_t k = 0; k < length; ++k) {  // grows as long as there are words
      T value{};
      get(value);
      values.push_back(std::move(value));
    }
  }
  template <class T, std::size_t N>
  void get(std::array<T, N>& values) {
    for (T& value : values) get(value);
  }
  template <class T>
  void get(std::optional<T>& value) {
    bool has_value = false;
    get(has_value);
    value.reset();
    if (has_value) get(value.emplace());
  }
  template <int R, int C>
  void get(Eigen::Matrix<double, R, C>& matrix) {
    for (double& value : matrix.reshaped()) get(value);
  }

  /// Throws StudyError, which says that the sums are damaged, unless the condition holds.
  static void expect(bool condition);
  /// Throws StudyError unless all words are read.
  void expect_end() const { expect(words_.empty()); }

 private:
  std::uint64_t next() {
    expect(!words_.empty());
    const std::uint64_t word = words_.front();
    words_ = words_.subspan(1);
    return word;
  }

  std::span<const std::uint64_t> words_;
};

/// Appends the layout of a type to `text`: the kinds of its numbers, in order.
template <class T>
struct SumLayout {
  static void add(std::string& text) {
    if constexpr (std::is_same_v<T, double>) {
      text += 'd';
    } else if constexpr (Number<T>) {
      text += 'n';
    } else {
      text += '{';
      for_each_member<T>([&](auto member, bool of_first_runs) {
        text += of_first_runs ? "1" : "";
        SumLayout<std::remove_cvref_t<decltype(std::declval<T&>().*member)>>::add(text);
      });
      text += '}';
    }
  }
};
template <class T>
struct SumLayout<std::vector<T>> {
  static void add(std::string& text) { SumLayout<T>::add(text += '*'); }
};
template <class T, std::size_t N>
struct SumLayout<std::array<T, N>> {
  static void add(std::string& text) { SumLayout<T>::add(text += std::to_string(N) + 'x'); }
};
template <class T>
struct SumLayout<std::optional<T>> {
  static void add(std::string& text) { SumLayout<T>::add(text += '?'); }
};
template <int R, int C>
struct SumLayout<Eigen::Matrix<double, R, C>> {
  static void add(std::string& text) { text += std::to_string(R * C) + "xd"; }
};

/// The same words with repetitions written once: numbers that do not apply are NaN in every run.
Words packed(std::span<const std::uint64_t> words);
/// Undoes packed(). Throws StudyError if the words are none that packed() wrote.
Words unpacked(std::span<const std::uint64_t> words);

}  // namespace montecarta::analysis
