// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/namespaces.hpp"

#include <algorithm>
#include <cstddef>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace montecarta::filters {

/// One thing that a user may set: of a filter behind its name in a cell line, of a study in a
/// section of its file.
struct Option {
  enum class Kind {
    text,     ///< anything
    number,   ///< finite, from `least` to `most`
    count,    ///< whole, from `least` to `most`
    choice,   ///< one of `choices`
    choices,  ///< a list out of `choices`
  };
  std::string key = {};
  Kind kind = Kind::text;
  std::string unit = {};                     ///< "" where there is none
  std::optional<std::string> fallback = {};  ///< default value, as text; nullopt: must be given
  double least = 0.0;                        ///< inclusive, as `most`
  double most = 0.0;
  std::vector<std::string> choices = {};
  std::string meaning = {};  ///< one line, with unit and equation
  std::string example = {};  ///< offered as remedy where there is no fallback
  /// The default of a filter's option where its controls are noisy measurements of the true ones
  /// (scenario.noise = measured-control), if that differs.
  std::optional<std::string> fallback_if_measured = {};
};

inline Option number_option(const char* key, const char* fallback, double least, double most,
                            const char* meaning) {
  return {.key = key,
          .kind = Option::Kind::number,
          .fallback = fallback,
          .least = least,
          .most = most,
          .meaning = meaning};
}
inline Option count_option(const char* key, const std::string& fallback, double least, double most,
                           const char* meaning) {
  return {.key = key,
          .kind = Option::Kind::count,
          .fallback = fallback,
          .least = least,
          .most = most,
          .meaning = meaning};
}
inline Option choice_option(const char* key, const std::string& fallback,
                            std::vector<std::string> choices, const char* meaning) {
  return {.key = key,
          .kind = Option::Kind::choice,
          .fallback = fallback,
          .choices = std::move(choices),
          .meaning = meaning};
}

/// Values of a filter's options, checked against their Option beforehand.
class FilterOptions {
 public:
  explicit FilterOptions(std::map<std::string, std::string, std::less<>> values)
      : values_(std::move(values)) {}
  double number(std::string_view name) const;
  std::size_t integer(std::string_view name) const;
  const std::string& choice(std::string_view name) const;

 private:
  std::map<std::string, std::string, std::less<>> values_;
};

/// The enumerator at the place of `choice` among `choices`, which stand in the enumerators' order
/// and hold it: an option's value was checked before.
template <class Enumerator>
Enumerator chosen(const std::string& choice, const std::vector<std::string>& choices) {
  return static_cast<Enumerator>(std::find(choices.begin(), choices.end(), choice) -
                                 choices.begin());
}

}  // namespace montecarta::filters
