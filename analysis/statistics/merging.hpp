// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <iterator>
#include <tuple>
#include <utility>
#include <vector>

/// How the sums over two blocks of runs become one. A class of sums names its members once, by what
/// they are:
///
///     static constexpr auto parts() {
///       return std::tuple(added(&Sums::squares_, &Sums::runs_), appended(&Sums::values_));
///     }
///
/// A member that is named nowhere is neither merged nor stored: memory for one run, or what the
/// constructor knows. A plain aggregate of numbers names its members by members() instead.
namespace montecarta::analysis {

/// Merges `next`, the sums over the runs that come behind those of `sums`: by the parts or the
/// merge() of a class, arrays element by element, numbers by addition. What only one of them has
/// stays as it is. `next` is used up: values of runs are moved, since threads wait for a merge.
template <class T>
void merge_into(T& sums, T& next);

/// Members of a class of sums with one rule, `merge`, by which those of two blocks become one.
template <class Merge, class... Members>
struct Part {
  Merge merge;
  std::tuple<Members...> members;  ///< pointers to members
  bool of_first_runs = false;      ///< kept of the first runs of a study alone
};
template <class Merge, class... Members>
Part(Merge, std::tuple<Members...>, bool = false) -> Part<Merge, Members...>;  // for clang 14

/// Sums, which are merged themselves.
template <class... Members>
constexpr auto added(Members... members) {
  return Part{[=](auto& sums, auto& next) { (merge_into(sums.*members, next.*members), ...); },
              std::tuple(members...)};
}

/// Settings, which are the same in all blocks, and stored where sums are stored (sum_words.hpp).
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

/// Values of each run, or several lists of them.
template <class... Members>
constexpr auto appended(Members... members) {
  return Part{[=](auto& sums, auto& next) { (append(sums.*members, next.*members), ...); },
              std::tuple(members...)};
}

/// A value or a list for each of the first runs, of as many as the member function `most` says.
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

/// What the first run says that has it: an optional.
template <class... Members>
constexpr auto of_first_run(Members... members) {
  return Part{[=](auto& sums, auto& next) {
                ((sums.*members ? void() : void(sums.*members = std::move(next.*members))), ...);
              },
              std::tuple(members...)};
}

/// Vectors and arrays.
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

}  // namespace montecarta::analysis
