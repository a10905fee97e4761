// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/commands/array_index.hpp"

#include "engine/errors.hpp"
#include "engine/formatted.hpp"
#include "engine/namespaces.hpp"
#include "engine/text/list_text.hpp"
#include "experiments/text/words.hpp"

#include <array>
#include <cstdlib>
#include <optional>
#include <string_view>
#include <vector>

namespace montecarta::experiments {
namespace {

constexpr std::string_view kAutomatic = "auto/";

/// How a scheduler numbers the tasks of an array.
struct TaskVariable {
  const char* name;
  std::uint64_t first;      ///< number of the first task of an array from which shard 0 is made
  const char* last_number;  ///< variable with the number of the array's last task; "" if none
  const char* remedy;       ///< option that makes an array of N tasks, with N and L = N - 1 in it
  const char* no_array;     ///< value in a job that is no array; "" if the variable is not set then
};

constexpr std::array<TaskVariable, 6> kTaskVariables = {{
    {"SLURM_ARRAY_TASK_ID", 0, "SLURM_ARRAY_TASK_MAX", "sbatch --array=0-{L}", ""},
    {"PBS_ARRAY_INDEX", 0, "", "qsub -J 0-{L}", ""},
    {"SGE_TASK_ID", 1, "SGE_TASK_LAST", "qsub -t 1-{N}", "undefined"},
    {"LSB_JOBINDEX", 1, "", "bsub -J \"name[1-{N}]\"", "0"},
    {"JOB_COMPLETION_INDEX", 0, "", "completions: {N}, completionMode: Indexed", ""},
    {"AWS_BATCH_JOB_ARRAY_INDEX", 0, "", "--array-properties size={N}", ""},
}};

/// The value of a variable of the environment; empty if it is not set.
std::string value_of(const char* name) {
  const char* value = name[0] == '\0' ? nullptr : std::getenv(name);
  return value == nullptr ? "" : value;
}

std::string remedy_of(const TaskVariable& variable, std::uint64_t shards) {
  std::string text = variable.remedy;
  const std::array<std::pair<const char*, std::uint64_t>, 2> numbers = {
      {{"{N}", shards}, {"{L}", shards - 1}}};
  for (const auto& [word, number] : numbers) {
    const std::size_t at = text.find(word);
    if (at != std::string::npos) text.replace(at, 3, std::to_string(number));
  }
  return text;
}

/// The number of a task does not fit the shards, which the array must have.
[[noreturn]] void refuse_number(const TaskVariable& variable, const char* name,
                                std::uint64_t shards) {
  throw StudyError(
      "{}={}: does not fit --shard auto/{} (tasks are numbered from {} to {}): start the array "
      "with {}, or give --shard I/{}",
      name, value_of(name), shards, variable.first, variable.first + shards - 1,
      remedy_of(variable, shards), shards);
}

/// The index of a task by the number that a variable holds. Throws StudyError if an array of
/// `shards` tasks has no such number.
std::uint64_t index_of(const TaskVariable& variable, const char* name, std::uint64_t shards) {
  const std::string value = value_of(name);
  const auto number = to_count(value);
  if (number && *number >= variable.first && *number - variable.first < shards)
    return *number - variable.first;
  refuse_number(variable, name, shards);
}

/// The index by a variable; nullopt if this is no task of an array of its scheduler.
std::optional<std::uint64_t> index_by(const TaskVariable& variable, std::uint64_t shards) {
  const std::string value = value_of(variable.name);
  if (value.empty() || value == variable.no_array) return std::nullopt;
  const std::uint64_t index = index_of(variable, variable.name, shards);
  // An array from 1 to N lacks shard 0, and a short one the last shards, which each of its tasks
  // must notice.
  const auto last = to_count(value_of(variable.last_number));
  if (last && *last != variable.first + shards - 1)
    refuse_number(variable, variable.last_number, shards);
  return index;
}

std::string names_of_variables() {
  std::vector<std::string> names;
  for (const TaskVariable& variable : kTaskVariables) names.emplace_back(variable.name);
  return joined(names);
}

}  // namespace

std::string with_array_index(const std::string& shard) {
  if (!shard.starts_with(kAutomatic)) return shard;
  const auto shards = to_count(shard.substr(kAutomatic.size()));
  if (!shards || *shards == 0) return shard;  // parse_shard() says what is wrong
  const TaskVariable* source = nullptr;
  std::uint64_t index = 0;
  for (const TaskVariable& variable : kTaskVariables) {
    const auto found = index_by(variable, *shards);
    if (!found) continue;
    if (source != nullptr && *found != index) {
      throw StudyError(
          "{}={} and {}={}: --shard {} is shard {} by one and {} by the other: unset the one that "
          "is not of this array",
          source->name, value_of(source->name), variable.name, value_of(variable.name), shard,
          index, *found);
    }
    source = &variable;
    index = *found;
  }
  if (source == nullptr) {
    throw StudyError(
        "--shard {}: this process is no task of an array (none of {} is set): start it by a "
        "scheduler's array, or give --shard I/{}",
        shard, names_of_variables(), *shards);
  }
  return formatted("{}/{}", index, *shards);
}

}  // namespace montecarta::experiments
