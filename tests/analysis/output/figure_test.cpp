// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/output/figure.hpp"

#include "analysis/figures/stored_map.hpp"
#include "analysis/output/csv_file.hpp"
#include "analysis/output/gnuplot.hpp"
#include "engine/errors.hpp"
#include "tests/doubles/scratch_folder.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace montecarta::analysis {
namespace {

using testing::AllOf;
using testing::HasSubstr;

std::string message_of(const std::function<void()>& action) {
  try {
    action();
  } catch (const std::runtime_error& error) {
    return error.what();
  }
  return "nothing was thrown";
}

TEST(Gnuplot, NamesThePackageWhereItIsMissing) {
  const ScratchFolder folder;
  const auto run = [&] { run_gnuplot(folder.path(), "a.gp", "gnuplot-that-is-nowhere"); };
  EXPECT_THROW(run(), StudyError);
  EXPECT_THAT(message_of(run), HasSubstr("apt-get install gnuplot-nox"));
}

TEST(Gnuplot, TellsWhatGnuplotSays) {
  const ScratchFolder folder;
  write_text(folder / "bad.gp", "plot 'nothing_here.csv'\n");
  const auto run = [&] { run_gnuplot(folder.path(), "bad.gp"); };
  EXPECT_THROW(run(), RunError);
  EXPECT_THAT(message_of(run), AllOf(HasSubstr("bad.gp"), HasSubstr("No data in plot")));
}

TEST(Gnuplot, QuotesText) { EXPECT_EQ(gnuplot_quoted("it's\n_m30"), R"('it''s\n_m30')"); }

TEST(TwoSigmaEllipse, LiesAlongTheAxesOfTheCovariance) {
  const Ellipse flat = two_sigma_ellipse(1.0, 2.0, 4.0, 0.0, 1.0);
  EXPECT_DOUBLE_EQ(flat.major, 8.0);
  EXPECT_DOUBLE_EQ(flat.minor, 4.0);
  EXPECT_DOUBLE_EQ(flat.angle, 0.0);
  const Ellipse tilted = two_sigma_ellipse(0.0, 0.0, 2.0, 1.0, 2.0);
  EXPECT_DOUBLE_EQ(tilted.angle, 45.0);
  EXPECT_NEAR(tilted.major, 4.0 * std::sqrt(3.0), 1e-12);
  EXPECT_NEAR(tilted.minor, 4.0, 1e-12);
}

}  // namespace
}  // namespace montecarta::analysis
