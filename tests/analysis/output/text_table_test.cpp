// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/output/text_table.hpp"

#include "analysis/output/number_text.hpp"
#include "engine/records/posix_file.hpp"

#include <gtest/gtest.h>

namespace montecarta::analysis {
namespace {

TEST(Table, AlignsColumnsAndLeavesNoTrailingSpace) {
  EXPECT_EQ(aligned({{"a", "bb", "c"}, {"ddd", "e"}}), "  a    bb  c\n  ddd  e\n");
  EXPECT_EQ(aligned({{"a", ""}}, 0), "a\n");
}

TEST(Table, WritesSizesAndTimesAsPeopleDo) {
  EXPECT_EQ(bytes_text(17), "17 B");
  EXPECT_EQ(bytes_text(999.7), "1.0 kB");
  EXPECT_EQ(bytes_text(3'760'000), "3.8 MB");
  EXPECT_EQ(bytes_text(64e9), "64 GB");
  EXPECT_EQ(duration_text(4.21), "4.2 s");
  EXPECT_EQ(duration_text(59.97), "1 min 00 s");
  EXPECT_EQ(duration_text(200), "3 min 20 s");
  EXPECT_EQ(duration_text(3900), "1 h 05 min");
}

}  // namespace
}  // namespace montecarta::analysis
