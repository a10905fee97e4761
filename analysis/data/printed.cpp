// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/data/printed.hpp"

#include "analysis/output/number_text.hpp"
#include "engine/errors.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <sstream>

namespace montecarta::analysis {
namespace {

constexpr const char* kValueForm =
    "write value = cell=LABEL metric=NAME printed=NUMBER [relative_to=LABEL] [runs=N] "
    "[note=\"...\"]";
constexpr const char* kBandForm = "write band = pose LOWER UPPER (or position, heading)";
constexpr const char* kClaimForm = "write claim = METRIC LABEL < LABEL [note=\"...\"] (or >, ~)";

/// A line's words, and the note behind them, which may have spaces.
struct Line {
  std::vector<std::string> words;
  std::string note;
};

Line split_line(const std::string& text) {
  Line line;
  const std::size_t at = (" " + text).find(" note=");
  if (at != std::string::npos) {
    line.note = text.substr(at + 5);
    const bool quoted =
        line.note.size() >= 2 && line.note.front() == '"' && line.note.back() == '"';
    if (!quoted) {
      throw StudyError("note=" + line.note +
                       " (a note stands last, in double quotes): write note=\"Table 1\"");
    }
    line.note = line.note.substr(1, line.note.size() - 2);
  }
  std::istringstream words(text.substr(0, at));
  for (std::string word; words >> word;) line.words.push_back(word);
  return line;
}

std::uint64_t count_in(const std::string& text) {
  std::uint64_t count = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), count);
  if (error == std::errc() && end == text.data() + text.size() && count > 0) return count;
  throw StudyError("runs = " + text + " (a whole number above 0 is needed): correct it");
}

double number_in(const std::string& text) {
  double number = 0.0;
  std::from_chars(text.data(), text.data() + text.size(), number);
  return number;
}

bool is_number(const std::string& text) {
  double number = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  return error == std::errc() && end == text.data() + text.size() && std::isfinite(number);
}

/// Where `key` of a value line is kept; nullptr where there is no such key.
std::string* place_of(const std::string& key, PrintedValue& value) {
  if (key == "cell") return &value.cell;
  if (key == "metric") return &value.metric;
  if (key == "printed") return &value.printed;
  if (key == "relative_to") return &value.relative_to;
  return nullptr;
}

void take_word(const std::string& word, PrintedValue& value) {
  const std::size_t equals = word.find('=');
  const std::string key = word.substr(0, equals);
  const std::string text = equals == std::string::npos ? "" : word.substr(equals + 1);
  if (key == "runs") {
    value.runs = count_in(text);
    return;
  }
  std::string* const place = place_of(key, value);
  if (place == nullptr || text.empty()) {
    throw StudyError("'" + word + "' is not understood: " + kValueForm);
  }
  if (!place->empty()) throw StudyError(key + " is given twice: remove one of the two");
  *place = text;
}

PrintedValue value_in(const std::string& text) {
  const Line line = split_line(text);
  PrintedValue value;
  value.note = line.note;
  for (const std::string& word : line.words) take_word(word, value);
  for (const auto& [key, given] : {std::pair("cell", value.cell), std::pair("metric", value.metric),
                                   std::pair("printed", value.printed)}) {
    if (given.empty()) throw StudyError(std::string(key) + "= is missing: " + kValueForm);
  }
  if (!is_number(value.printed)) {
    throw StudyError("printed=" + value.printed + " is no number: write it as the paper does");
  }
  return value;
}

PrintedClaim parse_claim(const std::string& text) {
  const Line line = split_line(text);
  const auto& words = line.words;
  const bool good = words.size() == 4 && (words[2] == "<" || words[2] == ">" || words[2] == "~");
  if (!good) throw StudyError("'" + text + "' is not understood: " + kClaimForm);
  return {words[0], words[1], words[2][0], words[3], line.note};
}

PrintedBand parse_band(const std::string& text) {
  const std::vector<std::string> words = split_line(text).words;
  const bool good = words.size() == 3 &&
                    (words[0] == "pose" || words[0] == "position" || words[0] == "heading") &&
                    is_number(words[1]) && is_number(words[2]);
  if (!good) throw StudyError("'" + text + "' is not understood: " + kBandForm);
  PrintedBand band{words[0], number_in(words[1]), number_in(words[2])};
  if (band.lower < band.upper) return band;
  throw StudyError("'" + text + "' has no width (the lower end comes first): " + kBandForm);
}

std::string note_text(const std::string& note) {
  return note.empty() ? "" : " note=\"" + note + "\"";
}

}  // namespace

double PrintedValue::number() const { return number_in(printed); }

const PrintedBand* Printed::find_band(std::string_view error) const {
  const auto found = std::ranges::find(bands, error, &PrintedBand::error);
  return found == bands.end() ? nullptr : &*found;
}

double PrintedValue::rounding() const {
  const std::size_t point = printed.find('.');
  const std::size_t end = std::min(printed.find_first_of("eE"), printed.size());
  const std::size_t decimals = point == std::string::npos ? 0 : end - point - 1;
  return 0.5 * std::pow(10.0, -static_cast<double>(decimals));
}

void take_printed_line(const std::string& key, const std::string& text, Printed& printed) {
  if (text.empty()) throw StudyError(key + " says nothing: complete the line or remove it");
  if (key == "value") {
    printed.values.push_back(value_in(text));
  } else if (key == "claim") {
    printed.claims.push_back(parse_claim(text));
  } else if (key == "assume") {
    printed.assumptions.push_back(text);
  } else if (key == "band") {
    const PrintedBand band = parse_band(text);
    if (printed.find_band(band.error) != nullptr) {
      throw StudyError("band of the " + band.error + " is given twice: remove one of the two");
    }
    printed.bands.push_back(band);
  } else if (key == "baseline") {
    if (!printed.baseline.empty()) throw StudyError("baseline is given twice: remove one of them");
    printed.baseline = text;
  } else if (key == "source") {
    if (!printed.source.empty()) throw StudyError("source is given twice: remove one of the two");
    printed.source = text;
  } else if (key == "runs") {
    if (printed.runs != 0) throw StudyError("runs is given twice: remove one of the two");
    printed.runs = count_in(text);
  } else {
    throw StudyError(
        "unknown key printed." + key +
        " (nothing would come of it): use source, runs, baseline, band, value, claim or "
        "assume");
  }
}

std::string printed_text(const Printed& printed) {
  std::string text;
  if (!printed.source.empty()) text += "source = " + printed.source + "\n";
  if (printed.runs != 0) text += "runs = " + std::to_string(printed.runs) + "\n";
  if (!printed.baseline.empty()) text += "baseline = " + printed.baseline + "\n";
  for (const PrintedBand& band : printed.bands) {
    text +=
        "band = " + band.error + " " + exact_text(band.lower) + " " + exact_text(band.upper) + "\n";
  }
  for (const PrintedValue& value : printed.values) {
    text += "value = cell=" + value.cell + " metric=" + value.metric + " printed=" + value.printed;
    if (!value.relative_to.empty()) text += " relative_to=" + value.relative_to;
    if (value.runs != 0) text += " runs=" + std::to_string(value.runs);
    text += note_text(value.note) + "\n";
  }
  for (const PrintedClaim& claim : printed.claims) {
    text += "claim = " + claim.metric + " " + claim.left + " " + claim.relation + " " +
            claim.right + note_text(claim.note) + "\n";
  }
  for (const std::string& assumption : printed.assumptions) text += "assume = " + assumption + "\n";
  return text;
}

Printed printed_in(const std::string& study_text) {
  Printed printed;
  std::istringstream lines(study_text);
  bool inside = false;
  for (std::string line; std::getline(lines, line);) {
    if (line.starts_with('[')) inside = line == "[printed]";
    const std::size_t equals = line.find(" = ");
    if (!inside || equals == std::string::npos) continue;
    take_printed_line(line.substr(0, equals), line.substr(equals + 3), printed);
  }
  return printed;
}

}  // namespace montecarta::analysis
