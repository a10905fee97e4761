// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/study/text_table.hpp"

#include <gtest/gtest.h>

#include <sstream>
#include <stdexcept>

namespace montecarta::analysis {
namespace {

TextTable errors_of_a_cell() {
  TextTable table;
  table.headings = {{"cell", Align::left}, {"position RMSE"}, {"verdict", Align::left}};
  table.rows = {{"ekf", "4.5", "optimistic from the beginning to the end"}};
  return table;
}

std::string printed(const TextTable& table, std::size_t width) {
  std::ostringstream out;
  print_table(out, table, width);
  return out.str();
}

TEST(PrintTable, BreaksHeadingsFirstThenTextsWhereARowDoesNotFit) {
  EXPECT_EQ(printed(errors_of_a_cell(), 80),
            "cell  position RMSE  verdict\n"
            "----  -------------  ----------------------------------------\n"
            "ekf             4.5  optimistic from the beginning to the end\n");
  EXPECT_EQ(printed(errors_of_a_cell(), 60),
            "      position\n"
            "cell      RMSE  verdict\n"
            "----  --------  ----------------------------------------\n"
            "ekf        4.5  optimistic from the beginning to the end\n");
  EXPECT_EQ(printed(errors_of_a_cell(), 40),
            "     position\n"
            "cell     RMSE verdict\n"
            "---- -------- --------------------------\n"
            "ekf       4.5 optimistic from the\n"
            "              beginning to the end\n");
}

TEST(PrintTable, ContinuesBelowBesideTheKeys) {
  TextTable table{.keys = 2};
  table.headings = {{"cell", Align::left}, {"of", Align::left}, {"aaaaaaaa"}, {"bbbbbbbb"}};
  table.rows = {{"ekf", "pose", "1", "2"}};
  EXPECT_EQ(printed(table, 20),
            "cell of   aaaaaaaa\n"
            "---- ---- --------\n"
            "ekf  pose        1\n"
            "\n"
            "cell of   bbbbbbbb\n"
            "---- ---- --------\n"
            "ekf  pose        2\n");
  EXPECT_EQ(printed({}, 80), "");
}

TEST(TextTable, HasTheHeadingsOfItsFirstRow) {
  TextTable table;
  table.add({{"cell", "ekf", Align::left}, {"NEES", "3"}});
  table.add({{"cell", "ukf", Align::left}, {"NEES", "4"}});
  EXPECT_EQ(printed(table, 80),
            "cell  NEES\n"
            "----  ----\n"
            "ekf      3\n"
            "ukf      4\n");
  EXPECT_THROW(table.add({{"cell", "srcd", Align::left}}), std::logic_error);
}

}  // namespace
}  // namespace montecarta::analysis
