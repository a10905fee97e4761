// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/namespaces.hpp"
#include "experiments/study/study.hpp"

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace montecarta::experiments {

/// The plan of a folder of shards, stored as plan.json, which cluster/shards.py reads and writes as
/// well.
struct ShardPlan {
  std::string study_sha256 = {};
  std::uint64_t runs = 0;
  std::uint64_t cells = 0;
  std::uint64_t shards = 0;
  std::string program = {};                ///< path of the program that made the plan
  std::vector<std::string> settings = {};  ///< values of --set that study.ini does not contain
};

/// A folder that holds a study (study.ini, plan.json), its shards and its result.
class ShardFolder {
 public:
  /// Opens a folder that has a plan. Throws StudyError if it has none.
  explicit ShardFolder(std::filesystem::path folder);

  /// Makes the folder and its plan, unless another process has done that. Throws StudyError if the
  /// folder holds another study, or another number of shards.
  static ShardFolder make(const std::filesystem::path& folder, const Study& study, ShardPlan plan);

  const ShardPlan& plan() const { return plan_; }
  Study study() const;
  std::filesystem::path result() const { return folder_ / "result.h5"; }
  /// Paths of all shards, finished or not.
  std::vector<std::filesystem::path> shards() const;
  /// Index of a shard by its path.
  std::uint64_t index_of(const std::filesystem::path& shard) const;
  /// The files that remain to be made: the missing shards; if none is missing, the result; nothing
  /// if that is there.
  std::vector<std::filesystem::path> missing() const;

 private:
  std::filesystem::path folder_;
  ShardPlan plan_;
};

}  // namespace montecarta::experiments
