// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/records/result_writer.hpp"
#include "tests/doubles/complaint.hpp"
#include "tests/doubles/scratch_folder.hpp"
#include "tests/doubles/scripted_result.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <string>
#include <vector>

namespace montecarta::engine {

/// A folder of its own for each test, in which the result of a small study is written.
class ResultWriting : public ::testing::Test {
 protected:
  ResultWriter create(Existing existing = Existing::refuse) const {
    return ResultWriter::create(path_, plan_, {}, existing);
  }
  /// Leaves unfinished work with run 0 stored.
  void begin(Existing existing = Existing::refuse) const {
    ResultWriter writer = create(existing);
    store_run(writer, plan_, 0);
  }
  ResultWriter resume() const { return ResultWriter::resume(path_, plan_, {}); }
  StudyPlan other_study() const {
    StudyPlan other = plan_;
    other.resolved_text += "seed = 8\n";
    return other;
  }
  /// Names of the files in the folder, sorted.
  std::vector<std::string> names() const {
    std::vector<std::string> found;
    for (const auto& entry : std::filesystem::directory_iterator(folder_.path()))
      found.push_back(entry.path().filename().string());
    std::ranges::sort(found);
    return found;
  }

  ScratchFolder folder_;
  std::filesystem::path path_ = folder_ / "out.h5";
  std::filesystem::path part_ = folder_ / "out.h5.part";
  StudyPlan plan_ = small_result_plan();
};

}  // namespace montecarta::engine
