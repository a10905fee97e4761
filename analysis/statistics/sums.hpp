// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <span>
#include <string>
#include <tuple>
#include <type_traits>
#include <utility>
#include <vector>

/// Sums over runs, which are merged from blocks of runs and stored as 64-bit words. A class of sums
/// lists its members once, each with its rule:
///
///     static constexpr auto parts() {
///       return std::tuple(added(&Sums::squares_, &Sums::runs_), appended(&Sums::values_));
///     }
///
/// A member that is not listed is neither merged nor stored: working memory of one run, or a value
/// that the constructor sets. A plain aggregate of numbers lists all of its members instead:
///
///     static constexpr auto members() { return std::tuple(&Mean::sum, &Mean::n); }
namespace montecarta::analysis {

/// Merges `next`, the sums over the runs that follow those of `sums`: a class by its parts or its
/// merge(), arrays element by element, numbers by addition. A value that only one of the two has is
/// kept. `next` is used up: values of runs are moved, since threads wait for a merge.
template <class T>
void merge_into(T& sums, T& next);

/// Members of a class of sums with one rule, `merge`, that combines those of two blocks.
template <class Merge, class... Members>
struct Part {
  Merge merge;
  std::tuple<Members...> members;  ///< pointers to members
  bool of_first_runs = false;      ///< whether they are kept for the first runs of a study only
};
template <class Merge, class... Members>
Part(Merge, std::tuple<Members...>, bool = false) -> Part<Merge, Members...>;  // needed by clang 14

/// Members that are sums: merge_into() combines them.
template <class... Members>
constexpr auto added(Members... members) {
  return Part{[=](auto& sums, auto& next) { (merge_into(sums.*members, next.*members), ...); },
              std::tuple(members...)};
}

/// Members that are settings: they are equal in all blocks, and stored with the sums.
template <class... Members>
constexpr auto settings(Members... members) {
  return Part{[](auto&, auto&) {}, std::tuple(members...)};
}

/// Puts the values of `next` behind those of `values`.
template <class T>
void append(std::vector<T>& values, std::vector<T>& next) {
  if (values.empty()) return values.swap(next);
  values.insert(values.end(), next.begin(), next.end());
}
template <class T>
void append(std::vector<std::vector<T>>& lists, std::vector<std::vector<T>>& next) {
  for (std::size_t k = 0; k < lists.size(); ++k) append(lists[k], next[k]);
}

/// Members that hold values of each run, or several lists of them: those of `next` are appended.
template <class... Members>
constexpr auto appended(Members... members) {
  return Part{[=](auto& sums, auto& next) { (append(sums.*members, next.*members), ...); },
              std::tuple(members...)};
}

/// Members that hold values or lists of the first runs, at most as many as the member function
/// `most` returns.
template <class Most, class... Members>
constexpr auto appended_up_to(Most most, Members... members) {
  return Part{[=](auto& sums, auto& next) {
                const auto append_some = [&](auto& values, auto& more) {
                  const std::size_t room = (sums.*most)() - values.size();
                  if (more.size() > room) more.resize(room);
                  std::move(more.begin(), more.end(), std::back_inserter(values));
                };
                (append_some(sums.*members, next.*members), ...);
              },
              std::tuple(members...), true};
}

/// Optional members that keep the value of the first run that has one.
template <class... Members>
constexpr auto of_first_run(Members... members) {
  return Part{[=](auto& sums, auto& next) {
                ((sums.*members ? void() : void(sums.*members = std::move(next.*members))), ...);
              },
              std::tuple(members...)};
}

/// True for vectors and arrays.
template <class T>
inline constexpr bool kIsList = false;
template <class T>
inline constexpr bool kIsList<std::vector<T>> = true;
template <class T, std::size_t N>
inline constexpr bool kIsList<std::array<T, N>> = true;

template <class T>
void merge_into(T& sums, T& next) {
  if constexpr (requires { T::parts(); }) {
    std::apply([&](const auto&... part) { (part.merge(sums, next), ...); }, T::parts());
  } else if constexpr (requires { sums.merge(next); }) {
    sums.merge(next);
  } else if constexpr (kIsList<T>) {
    const std::size_t common = std::min(sums.size(), next.size());
    for (std::size_t k = 0; k < common; ++k) merge_into(sums[k], next[k]);
    if constexpr (requires { sums.push_back(next[0]); }) {
      std::move(next.begin() + static_cast<std::ptrdiff_t>(common), next.end(),
                std::back_inserter(sums));
    }
  } else if constexpr (requires { sums.has_value(); }) {
    if (sums && next) merge_into(*sums, *next);
    if (!sums) sums = std::move(next);
  } else {
    sums += next;
  }
}

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
template <class T>
concept FixedMatrix = (T::SizeAtCompileTime > 0);
template <class T>
concept Growing = requires(T list) {
  list.emplace_back();
};

/// Writes sums.
class SumWriter {
 public:
  /// Whether members that are kept for the first runs of a study only are written.
  enum class FirstRuns : std::uint8_t { keep, leave_out };
  explicit SumWriter(FirstRuns first_runs) : first_runs_(first_runs) {}

  template <class T>
  void put(const T& value) {
    if constexpr (std::is_same_v<T, double>) {
      words_.push_back(std::bit_cast<std::uint64_t>(value));
    } else if constexpr (Number<T>) {
      words_.push_back(static_cast<std::uint64_t>(value));
    } else if constexpr (FixedMatrix<T>) {
      for (const double element : value.reshaped()) put(element);
    } else if constexpr (requires { value.has_value(); }) {
      put(value.has_value());
      if (value) put(*value);
    } else if constexpr (kIsList<T>) {
      if constexpr (Growing<T>) words_.push_back(value.size());
      for (const auto& element : value) put(element);
    } else {
      for_each_member<T>([&](auto member, bool of_first_runs) {
        const bool is_left_out = of_first_runs && first_runs_ == FirstRuns::leave_out;
        // Writes the length of an empty vector.
        is_left_out ? words_.push_back(0) : put(value.*member);
      });
    }
  }

  Words take() { return std::move(words_); }

 private:
  FirstRuns first_runs_;
  Words words_;
};

/// Reads sums that a SumWriter wrote. Throws StudyError if the words end too early, or if a number
/// does not fit its type.
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
    } else if constexpr (FixedMatrix<T>) {
      for (double& element : value.reshaped()) get(element);
    } else if constexpr (requires { value.has_value(); }) {
      bool has_value = false;
      get(has_value);
      value.reset();
      if (has_value) get(value.emplace());
    } else if constexpr (Growing<T>) {
      const std::uint64_t length = next();
      expect(length <= words_.size());  // every value takes at least a word
      value.clear();
      for (std::uint64_t k = 0; k < length; ++k) get(value.emplace_back());
    } else if constexpr (kIsList<T>) {
      for (auto& element : value) get(element);
    } else {
      for_each_member<T>([&](auto member, bool /*of_first_runs*/) { get(value.*member); });
    }
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
    } else if constexpr (FixedMatrix<T>) {
      text += std::to_string(T::SizeAtCompileTime) + "xd";
    } else if constexpr (requires(T value) { value.has_value(); }) {
      SumLayout<typename T::value_type>::add(text += '?');
    } else if constexpr (Growing<T>) {
      SumLayout<typename T::value_type>::add(text += '*');
    } else if constexpr (kIsList<T>) {
      SumLayout<typename T::value_type>::add(text += std::to_string(std::tuple_size_v<T>) + 'x');
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

/// Compresses words by writing repetitions once, since numbers that do not apply are NaN in every
/// run.
Words packed(std::span<const std::uint64_t> words);
/// Undoes packed(). Throws StudyError if packed() did not write the words.
Words unpacked(std::span<const std::uint64_t> words);

}  // namespace montecarta::analysis
