// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "analysis/output/chart.hpp"

#include <concepts>
#include <ranges>
#include <string>
#include <string_view>

namespace montecarta::analysis {

/// Writes compact JSON that may stand in a page's <script>. The caller nests: begin and end in
/// pairs, and within an object a key() before every value.
class JsonWriter {
 public:
  static constexpr int kDigits = 5;  ///< significant, of numbers; nobody sees more in a drawing

  JsonWriter& begin_object() { return begin('{'); }
  JsonWriter& end_object() { return end('}'); }
  JsonWriter& begin_array() { return begin('['); }
  JsonWriter& end_array() { return end(']'); }
  JsonWriter& key(std::string_view name);

  JsonWriter& value(std::string_view text);
  JsonWriter& value(const char* text) { return value(std::string_view(text)); }
  JsonWriter& value(bool truth) { return literal(truth ? "true" : "false"); }
  /// NaN becomes null; what is infinite becomes 1e999, which a page reads as infinite.
  JsonWriter& value(double number, int digits = kDigits);
  /// The shortest text that reads back as the same bits, as a number with a fraction: 3.0.
  JsonWriter& exact(double number);
  JsonWriter& value(std::integral auto number) { return literal(std::to_string(number)); }

  /// An array of numbers or texts.
  template <std::ranges::range Values>
  requires(!std::convertible_to<Values, std::string_view>) JsonWriter& value(const Values& values) {
    begin_array();
    for (const auto& each : values) value(each);
    return end_array();
  }

  /// A member of an object.
  template <class Value>
  JsonWriter& member(std::string_view name, const Value& content) {
    return key(name).value(content);
  }

  const std::string& text() const { return text_; }

 private:
  JsonWriter& begin(char bracket);
  JsonWriter& end(char bracket);
  JsonWriter& literal(std::string_view text);
  void separate();

  std::string text_;
  bool first_ = true;  ///< nothing stands before the next value that a comma must part it from
};

/// A chart as the page's script reads it (page/script/chart.js).
std::string chart_json(const Chart& chart);

}  // namespace montecarta::analysis
