// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/page/json.hpp"

#include <array>
#include <charconv>
#include <cmath>

namespace montecarta::analysis {
namespace {

/// A character within quotes. "<" may not stand in a script: it could end it.
std::string json_escaped(char c) {
  constexpr std::string_view kHex = "0123456789abcdef";
  if (c == '"' || c == '\\') return {'\\', c};
  const auto code = static_cast<unsigned char>(c);
  if (code >= 0x20 && c != '<') return {c};
  return std::string("\\u00") + kHex[code >> 4U] + kHex[code & 15U];
}

}  // namespace

void JsonWriter::separate() {
  if (!first_) text_ += ',';
  first_ = false;
}

JsonWriter& JsonWriter::begin(char bracket) {
  separate();
  text_ += bracket;
  first_ = true;
  return *this;
}

JsonWriter& JsonWriter::end(char bracket) {
  text_ += bracket;
  first_ = false;
  return *this;
}

JsonWriter& JsonWriter::literal(std::string_view text) {
  separate();
  text_ += text;
  return *this;
}

JsonWriter& JsonWriter::key(std::string_view name) {
  value(name);
  text_ += ':';
  first_ = true;
  return *this;
}

JsonWriter& JsonWriter::value(std::string_view text) {
  separate();
  text_ += '"';
  for (const char c : text) text_ += json_escaped(c);
  text_ += '"';
  return *this;
}

JsonWriter& JsonWriter::value(double number, int digits) {
  if (std::isnan(number)) return literal("null");
  if (std::isinf(number)) return literal(number > 0.0 ? "1e999" : "-1e999");
  std::array<char, 32> buffer{};
  const auto written = std::to_chars(buffer.data(), buffer.data() + buffer.size(), number,
                                     std::chars_format::general, digits);
  return literal({buffer.data(), written.ptr});
}

JsonWriter& JsonWriter::exact(double number) {
  if (!std::isfinite(number)) return value(number);
  std::array<char, 32> buffer{};
  const auto written = std::to_chars(buffer.data(), buffer.data() + buffer.size(), number);
  const std::string_view text(buffer.data(), written.ptr);
  literal(text);
  if (text.find_first_of(".e") == std::string_view::npos) text_ += ".0";
  return *this;
}

}  // namespace montecarta::analysis
