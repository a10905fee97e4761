// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/records/result_writer.hpp"
#include "tests/doubles/scratch_folder.hpp"
#include "tests/doubles/scripted_result.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

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
  std::string bytes_of(const std::filesystem::path& path) const {
    std::ifstream stream(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(stream), {}};
  }

  ScratchFolder folder_;
  std::filesystem::path path_ = folder_ / "out.h5";
  std::filesystem::path part_ = folder_ / "out.h5.part";
  StudyPlan plan_ = small_result_plan();
};

/// What an error of the given kind says; a failure of the test where there is none.
template <class Error, class Action>
std::string message(const Action& action) {
  try {
    action();
  } catch (const Error& error) {
    return error.what();
  }
  ADD_FAILURE() << "nothing of that kind was thrown";
  return {};
}

}  // namespace montecarta::engine
