// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/benchmark/archive_entry.hpp"

#include "analysis/statistics/spread.hpp"
#include "analysis/study/frame.hpp"
#include "analysis/study/stored_sums.hpp"
#include "analysis/study/study_analysis.hpp"
#include "engine/errors.hpp"
#include "engine/formatted.hpp"
#include "engine/records/fingerprint.hpp"
#include "engine/text/list_text.hpp"
#include "experiments/benchmark/benchmark_study.hpp"
#include "experiments/external/external_filter.hpp"
#include "experiments/files/files.hpp"
#include "experiments/text/words.hpp"

#include <openssl/evp.h>

#include <algorithm>
#include <bit>
#include <charconv>
#include <cmath>
#include <limits>
#include <map>

namespace montecarta::experiments {
namespace {

namespace fs = std::filesystem;

constexpr int kFormat = 1;

// A score is the upper 24 bits of its binary32 number, in base 64.
constexpr unsigned kDroppedBits = 8;
constexpr std::size_t kBytes = 3, kCharacters = 4;

std::uint32_t code_of(double score) {
  const auto number = static_cast<float>(score);
  if (std::isnan(number)) return std::bit_cast<std::uint32_t>(std::nanf("")) >> kDroppedBits;
  const auto bits = std::bit_cast<std::uint32_t>(number);
  const std::uint32_t is_odd = (bits >> kDroppedBits) & 1U;
  return (bits + 0x7FU + is_odd) >> kDroppedBits;  // to the nearest, halves to the even one
}

double score_of(std::uint32_t code) {
  return static_cast<double>(std::bit_cast<float>(code << kDroppedBits));
}

std::string encoded(const std::vector<double>& scores) {
  std::vector<unsigned char> bytes;
  for (const double score : scores) {
    const std::uint32_t code = code_of(score);
    for (const unsigned shift : {16U, 8U, 0U})
      bytes.push_back(static_cast<unsigned char>(code >> shift));
  }
  std::vector<unsigned char> text(kCharacters * scores.size() + 1);  // one for a zero at the end
  EVP_EncodeBlock(text.data(), bytes.data(), static_cast<int>(bytes.size()));
  return {text.begin(), text.end() - 1};
}

/// The scores in a text; empty if it is none.
std::vector<double> decoded(const std::string& text) {
  const bool is_whole =
      text.size() % kCharacters == 0 && text.find_first_of("= \t\r\n") == text.npos;
  if (!is_whole) return {};
  std::vector<unsigned char> bytes(text.size() / kCharacters * kBytes);
  const int read =
      EVP_DecodeBlock(bytes.data(), reinterpret_cast<const unsigned char*>(text.data()),
                      static_cast<int>(text.size()));
  if (read != static_cast<int>(bytes.size())) return {};
  std::vector<double> scores;
  for (std::size_t i = 0; i < bytes.size(); i += kBytes) {
    const std::uint32_t code = std::uint32_t{bytes[i]} << 16U | std::uint32_t{bytes[i + 1]} << 8U |
                               std::uint32_t{bytes[i + 2]};
    scores.push_back(score_of(code));
  }
  return scores;
}

constexpr int kDigits = 6;  ///< significant digits of numbers other than scores

Json json_of_pair(const Interval& interval) {
  return {rounded(interval.lower, kDigits), rounded(interval.upper, kDigits)};
}

/// The number that rounded() wrote.
double number_in(const Json& json) {
  if (json.is_null()) return kNaN;
  if (json.is_number()) return json.get<double>();
  const double infinity = std::numeric_limits<double>::infinity();
  return json.get<std::string>() == "-inf" ? -infinity : infinity;
}

Answer answer_called(const std::string& name) {
  for (const Answer answer : {Answer::untested, Answer::consistent, Answer::optimistic,
                              Answer::conservative, Answer::inconsistent, Answer::undecided}) {
    if (analysis::name_of(answer) == name) return answer;
  }
  throw StudyError("no verdict is called '{}'", excerpt(name));
}

Json families_of(const Verdict& verdict) {
  Json families = Json::array();
  for (const FamilyTest& test : verdict.families) {
    const Member& member = test.strongest();
    families.push_back({{"family", key_of(test.family)},
                        {"p", rounded(test.p, kDigits)},
                        {"rejected", test.is_rejected},
                        {"strongest", analysis::name_of(member)},
                        {"estimate", rounded(member.estimate, kDigits)},
                        {"interval", json_of_pair(member.interval)}});
  }
  return families;
}

std::vector<std::uint64_t> block_fingerprints(std::span<const std::uint64_t> of_runs) {
  std::vector<std::uint64_t> blocks;
  for (; !of_runs.empty();
       of_runs = of_runs.subspan(std::min<std::size_t>(kRunsOfArchivedBlock, of_runs.size()))) {
    blocks.push_back(block_fingerprint(
        of_runs.first(std::min<std::size_t>(kRunsOfArchivedBlock, of_runs.size()))));
  }
  return blocks;
}

/// What made a result, without date and host.
TextPairs made_by(const ResultFile& result) {
  TextPairs kept;
  for (const auto& [name, value] : result.provenance()) {
    if (name == "version" || name == "git" || name == "compiler" || name == "libm" ||
        name == "instruction_set" || name == "cpu")
      kept.emplace_back(name, value);
  }
  return kept;
}

constexpr std::string_view kSha256Of = "sha256 of ";

std::string text_of_blocks(const std::vector<std::uint64_t>& blocks) {
  std::vector<std::string> words;
  for (const std::uint64_t block : blocks) words.push_back(formatted("{:x}", block));
  return joined(words, " ");
}

std::vector<std::uint64_t> blocks_in(const std::string& text) {
  std::vector<std::uint64_t> blocks;
  for (const std::string& word : split(text, ' ')) {
    std::uint64_t block = 0;
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), block, 16);
    if (error != std::errc() || end != word.data() + word.size())
      throw StudyError("'{}' is no fingerprint", excerpt(word));
    blocks.push_back(block);
  }
  return blocks;
}

}  // namespace

TextPairs provenance_of_files(const TextPairs& program_files) {
  TextPairs provenance;
  for (const auto& [name, sha] : program_files)
    provenance.emplace_back(std::string(kSha256Of) + name, sha);
  return provenance;
}

TextPairs program_files_in(const TextPairs& provenance) {
  TextPairs files;
  for (const auto& [name, value] : provenance) {
    if (name.starts_with(kSha256Of)) files.emplace_back(name.substr(kSha256Of.size()), value);
  }
  return files;
}

double cpu_seconds_of(const CellAnalysis& cell) {
  const bool is_program = starts_program(cell.filter);
  return is_program ? kNaN : cell.over_runs("cpu_seconds").mean;
}

ArchivedVerdict verdict_in_short(const Verdict& verdict) {
  return {.answer = verdict.answer,
          .is_slight = verdict.is_slight(),
          .within = verdict.within,
          .level = verdict.level,
          .ratio = verdict.ratio_estimate(),
          .interval = verdict.ratio(),
          .families = families_of(verdict)};
}

ArchivedScores scores_of_runs(const CellAnalysis& cell, std::uint64_t runs) {
  ArchivedScores all;
  for (std::size_t k = 0; k < all.size(); ++k) {
    all[k].assign(runs, kNaN);
    const std::vector<double>& column = cell.scores.column(kArchivedScores.at(k));
    for (std::size_t i = 0; i < column.size(); ++i) all[k][cell.runs[i]] = archived(column[i]);
  }
  return all;
}

double archived(double score) { return score_of(code_of(score)); }

double ArchiveEntry::position_rmse() const {
  double sum = 0.0, n = 0.0;
  for (const double rmse : scores[kArchivedPositionRmse]) {
    if (std::isnan(rmse)) continue;
    sum += rmse;
    n += 1.0;
  }
  return sum / n;
}

std::uint64_t block_fingerprint(std::span<const std::uint64_t> of_runs) {
  Fingerprint fingerprint;
  fingerprint.add(std::as_bytes(of_runs));
  return fingerprint.value();
}

ArchiveEntry entry_of(const ResultFile& result, const std::string& world, const std::string& cell,
                      const Parallel& parallel) {
  expect(result.has_sums() && result.cells().size() == 1, "an entry is made of sums of one cell");
  const StudyAnalysis study = analyze(result, kStoredLevel, parallel);
  const CellAnalysis& analysed = study.cells.front();
  ArchiveEntry entry{
      .world = world,
      .label = analysed.label,
      .filter = analysed.filter,
      .cell = cell,
      .program_files = program_files_in(result.provenance()),
      .study_sha256 = result.study_sha256(),
      .drives_sha256 = drives_sha256(result.study_text()),
      .seed = result.seed(),
      .runs = study.runs_here,
      .failed = analysed.failures.size(),
      .first_failure = {},
      .verdict = verdict_in_short(analysed.verdict),
      .cpu_seconds = cpu_seconds_of(analysed),
      .made_by = made_by(result),
      .blocks = block_fingerprints(fingerprints_in_sums(result, result.cells().front())),
      .scores = scores_of_runs(analysed, study.runs_here)};
  if (entry.failed > 0) entry.first_failure = analysed.failures.front().reason;
  return entry;
}

std::string text_of(const ArchiveEntry& entry) {
  const ArchivedVerdict& verdict = entry.verdict;
  Json scores = Json::object();
  for (std::size_t k = 0; k < kArchivedScores.size(); ++k)
    scores[kArchivedScores.at(k)] = encoded(entry.scores.at(k));
  Json made_by = Json::object();
  for (const auto& [name, value] : entry.made_by) made_by[name] = value;
  Json json = {{"montecarta_archive", kFormat},
               {"world", entry.world},
               {"label", entry.label},
               {"filter", entry.filter},
               {"cell", entry.cell},
               {"study_sha256", entry.study_sha256},
               {"drives_sha256", entry.drives_sha256},
               {"seed", entry.seed},
               {"runs", entry.runs},
               {"failed", entry.failed},
               {"first_failure", entry.first_failure},
               {"made_by", std::move(made_by)},
               {"cpu_seconds", rounded(entry.cpu_seconds, 3)},
               {"verdict",
                {{"answer", analysis::name_of(verdict.answer)},
                 {"slight", verdict.is_slight},
                 {"within", verdict.within},
                 {"level", verdict.level},
                 {"nees_ratio", rounded(verdict.ratio, kDigits)},
                 {"interval", json_of_pair(verdict.interval)},
                 {"families", verdict.families}}},
               {"runs_of_block", kRunsOfArchivedBlock},
               {"blocks", text_of_blocks(entry.blocks)},
               {"scores", std::move(scores)}};
  for (const auto& [name, sha] : entry.program_files) json["program_files"][name] = sha;
  return json.dump(1, ' ', true, Json::error_handler_t::replace) + "\n";
}

fs::path path_of_entry(const fs::path& folder, const std::string& world, const std::string& label) {
  return folder / world / (label + ".json");
}

void write_entry(const ArchiveEntry& entry, const fs::path& folder) {
  const fs::path path = path_of_entry(folder, entry.world, entry.label);
  make_directory(path.parent_path());
  write_text(path, text_of(entry));
}

namespace {

ArchivedVerdict verdict_in(const Json& json) {
  return {.answer = answer_called(json.at("answer")),
          .is_slight = json.at("slight"),
          .within = json.at("within"),
          .level = json.at("level"),
          .ratio = number_in(json.at("nees_ratio")),
          .interval = {number_in(json.at("interval").at(0)), number_in(json.at("interval").at(1))},
          .families = json.at("families")};
}

/// Throws StudyError unless lists have as many elements as the entry has runs.
void expect_whole_entry(const ArchiveEntry& entry) {
  const std::uint64_t blocks = (entry.runs + kRunsOfArchivedBlock - 1) / kRunsOfArchivedBlock;
  if (entry.blocks.size() != blocks) throw StudyError("has not one fingerprint for each block");
  for (const std::vector<double>& scores : entry.scores) {
    const auto failed = static_cast<std::uint64_t>(
        std::ranges::count_if(scores, [](double score) { return std::isnan(score); }));
    if (scores.size() != entry.runs || failed < entry.failed)
      throw StudyError("has not one score for each run");
  }
}

ArchiveEntry entry_in(const Json& json) {
  if (json.at("montecarta_archive") != kFormat || json.at("runs_of_block") != kRunsOfArchivedBlock)
    throw StudyError("is of another format than this program reads");
  ArchiveEntry entry{.world = json.at("world"),
                     .label = json.at("label"),
                     .filter = json.at("filter"),
                     .cell = json.at("cell"),
                     .program_files = {},
                     .study_sha256 = json.at("study_sha256"),
                     .drives_sha256 = json.at("drives_sha256"),
                     .seed = json.at("seed"),
                     .runs = json.at("runs"),
                     .failed = json.at("failed"),
                     .first_failure = json.at("first_failure"),
                     .verdict = verdict_in(json.at("verdict")),
                     .cpu_seconds = number_in(json.at("cpu_seconds")),
                     .made_by = {},
                     .blocks = blocks_in(json.at("blocks")),
                     .scores = {}};
  for (const auto& [name, value] : json.at("made_by").items())
    entry.made_by.emplace_back(name, value);
  const Json program_files = json.value("program_files", Json::object());
  for (const auto& [name, sha] : program_files.items()) entry.program_files.emplace_back(name, sha);
  for (std::size_t k = 0; k < kArchivedScores.size(); ++k)
    entry.scores.at(k) = decoded(json.at("scores").at(kArchivedScores.at(k)).get<std::string>());
  expect_whole_entry(entry);
  return entry;
}

}  // namespace

ArchiveEntry read_entry(const fs::path& path) {
  constexpr const char* kRemedy =
      ": take the file as 'montecarta benchmark' wrote it, or make it again";
  const std::string text = text_file(path);
  ArchiveEntry entry;
  try {
    entry = entry_in(Json::parse(text));
  } catch (const Json::exception& error) {
    throw StudyError("{}: is no entry of an archive ({}){}", path, error.what(), kRemedy);
  } catch (const StudyError& error) {
    throw StudyError("{}: {} (damaged, or changed by hand){}", path, error.what(), kRemedy);
  }
  if (path.stem() == entry.label && fs::absolute(path).parent_path().filename() == entry.world)
    return entry;
  throw StudyError(
      "{}: holds {} in the world {} (an entry lies in WORLD/LABEL.json): move it to {}/{}.json",
      path, entry.label, entry.world, entry.world, entry.label);
}

std::vector<ArchiveEntry> read_entries_of_world(const fs::path& folder) {
  std::vector<fs::path> paths;
  std::error_code none;
  for (const auto& file : fs::directory_iterator(folder, none)) {
    if (file.path().extension() == ".json") paths.push_back(file.path());
  }
  std::ranges::sort(paths);
  std::vector<ArchiveEntry> entries;
  for (const fs::path& path : paths) entries.push_back(read_entry(path));
  return entries;
}

std::vector<ArchiveEntry> read_entries(const fs::path& folder) {
  if (!fs::is_directory(folder)) {
    throw StudyError(
        "{}: no such folder (an archive is a folder with WORLD/LABEL.json): correct the path",
        folder);
  }
  std::vector<ArchiveEntry> entries;
  for (const std::string& world : benchmark_worlds()) {
    for (ArchiveEntry& entry : read_entries_of_world(folder / world))
      entries.push_back(std::move(entry));
  }
  return entries;
}

fs::path shipped_archive() { return shipped_folder(std::string("archive/") + kBenchmarkEdition); }

}  // namespace montecarta::experiments
