// SPDX-License-Identifier: BSD-3-Clause
// The worlds of the benchmark are frozen: a number that changes would make archived results those
// of another world.
#include "engine/records/fingerprint.hpp"
#include "experiments/files/files.hpp"
#include "experiments/study/known_filters.hpp"
#include "experiments/study/study.hpp"

#include <gmock/gmock.h>

#include <map>
#include <string>

namespace montecarta::experiments {
namespace {

constexpr const char* kFrozenFolder = "studies/benchmark/1";

/// {name} SHA-256 of the resolved text of each study, which contains its world.
const std::map<std::string, std::string>& frozen_studies() {
  static const std::map<std::string, std::string> frozen = {
      {"circle_easy", "4aecd154c5b9245768c5e60d86f8ef571510af1bd25d39e5127b3ff89ad8cd1f"},
      {"circle_hard", "f8563e03e9d69aaebd97f3beb2cd7248d6e0cfdf99f8902cfcbccc03ec8bb072"},
      {"corridor_easy", "911b7e448c89279815d99ee3988cbaff4370ed31e970d6a9e17faccb4a20c1b5"},
      {"corridor_hard", "cdfcaab8e88418dff4052398b96eaf218e8c024d6f8d64dc17ec9d60ce8d6ff4"},
      {"dense_loop_easy", "d5837c964ef1f13693bc8c46e92561e171d8ab0264e4bb3eb8b1ca8e1bb35c00"},
      {"dense_loop_hard", "70dc00b1fbc1723b11bd18291ab666f2e2235c906f184ec58444bd67a7aa43fa"},
      {"field_easy", "bcf03971b13c598029f168c1f8d40f15e500c7b19b90a174032d07ea55759d37"},
      {"field_hard", "5424c1ad44524733acc4b1ac050b06761a3a837c368da249410e1102925fc6d9"},
      {"figure_eight_easy", "c33a5dd39115c3516eca46b4c4b41ed55c4fdd31cbca00cca15d8bd747a1b351"},
      {"figure_eight_hard", "57697b6b7d5b85b1f621498bd5eca4dd53a4ff7ff24463b3915beec13716dbfd"},
      {"known_map", "5ca2accf3e146d2a5d9495377f395e64d2c71ec971fe730ef11b28048116e946"},
      {"small_loop_easy", "61772b22c0ecd7990806a55ce00236785bf8f007eaea24394d3d9a3d490c0296"},
      {"small_loop_hard", "f42c23b283f9b2fd3c682a8f92e4c338feed27b01b3f44e819dfda00d5325b12"},
      {"sparse_loop_easy", "905f5e5868ef0fbcf4ce318919fce594b3cc1164504f5bcd88324568648132c4"},
      {"sparse_loop_hard", "1a77b9e7f76aa7cfb4d85cbf1ba7b5fe58fbf82b583849e2f92347d9cc1e00ae"},
  };
  return frozen;
}

TEST(BenchmarkWorlds, AreFrozen) {
  std::map<std::string, std::string> shipped;
  for (const std::string& name : shipped_names(kFrozenFolder, ".ini")) {
    const auto path = shipped_file(kFrozenFolder, name + ".ini");
    shipped[name] = sha256(resolved_text(read_study(path.value(), known_filters())));
  }
  EXPECT_EQ(shipped, frozen_studies());
}

}  // namespace
}  // namespace montecarta::experiments
