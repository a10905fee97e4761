// SPDX-License-Identifier: BSD-3-Clause
// Law: arrays are judged as the same numbers in CSV files would be, or are refused by name.
#include "experiments/judging/estimate_arrays.hpp"

#include "engine/records/h5.hpp"
#include "engine/records/posix_file.hpp"
#include "tests/doubles/complaint.hpp"
#include "tests/doubles/matchers.hpp"
#include "tests/doubles/scratch_folder.hpp"

#include <cmath>
#include <limits>
#include <span>

namespace montecarta::experiments {
namespace {

constexpr double kNo = std::numeric_limits<double>::quiet_NaN();

/// An HDF5 file of arrays.
class Arrays {
 public:
  explicit Arrays(const std::filesystem::path& path) : file_(h5::create_file(path)) {}
  Arrays& with(const std::string& name, const h5::Shape& shape, std::vector<double> values) {
    std::size_t count = 1;
    for (const auto length : shape) count *= length;
    values.resize(count, values.empty() ? 0.0 : values.back());
    h5::write(h5::create_dataset(file_, name, Element::f64, shape), Element::f64, values.data());
    return *this;
  }
  /// As Octave saves a matrix.
  Arrays& with_group(const std::string& name, const h5::Shape& shape, std::vector<double> values) {
    const h5::Handle group = h5::create_group(file_, name);
    return with(name + "/value", shape, std::move(values));
  }
  Arrays& called(const std::string& names) {
    h5::put_text(file_, "names", names);
    return *this;
  }

 private:
  h5::Handle file_;
};

class EstimateArraysTest : public testing::Test {
 protected:
  ScratchFolder folder_;
  std::filesystem::path path_ = folder_ / "study.h5";

  std::string complaint() const {
    return complaint_of([&] {
      const EstimateArrays arrays(path_, "ekf");
      arrays.estimates(0, 0);
    });
  }
};

TEST_F(EstimateArraysTest, HaveErrorsOfWhichNaNIsMissing) {
  Arrays(path_)
      .with("error", {2, 3, 2}, {1, 2, kNo, kNo, 5, 6, 7, 8, 9, 10, kNo, kNo})
      .with("covariance", {2, 3, 2, 2}, {1, 0.5, 0.25, 2, 3})
      .with("time", {3}, {0.5, 1.0, 1.5});
  const EstimateArrays arrays(path_, "ekf");
  EXPECT_TRUE(h5::is_hdf5(path_));
  EXPECT_TRUE(arrays.has_errors());
  EXPECT_THAT(arrays.runs(), ElementsAre(0, 1));
  const StateRows rows = arrays.estimates(0, 0);
  EXPECT_THAT(rows.time, ElementsAre(0.5, 1.5));
  EXPECT_EQ(rows.state[1], Eigen::Vector2d(5, 6));
  EXPECT_EQ(rows.covariance[0], (Eigen::Matrix2d{{1, 0.5}, {0.25, 2}}));
  EXPECT_THAT(rows.shape.components, ElementsAre("e0", "e1"));
  EXPECT_THAT(arrays.times(0, 1), ElementsAre(0.5, 1.0));
  EXPECT_FALSE(arrays.has_common_truths());
}

TEST_F(EstimateArraysTest, AreErrorsOrMeansButNotBoth) {
  Arrays(path_)
      .with("error", {1, 1, 1}, {1})
      .with("mean", {1, 1, 1}, {1})
      .with("covariance", {1, 1, 1, 1}, {1});
  EXPECT_THAT(complaint(), HasSubstr("mean is beside error"));
}

// Octave writes no attributes.
TEST_F(EstimateArraysTest, MayBeNamedByTheCaller) {
  Arrays(path_).with("error", {1, 1, 2}, {1, 2}).with("covariance", {1, 1, 2, 2}, {1, 0, 0, 1});
  const EstimateArrays arrays(path_, "ekf", "x_m,rz_rad");
  EXPECT_EQ(arrays.estimates(0, 0).shape.components, (std::vector<std::string>{"x", "rz"}));
  EXPECT_THAT(complaint_of([&] { EstimateArrays(path_, "ekf", "x_m"); }),
              HasSubstr("has 1 columns"));
}

TEST_F(EstimateArraysTest, MayBeSavedByOctaveWhoseVectorsHaveTwoAxes) {
  Arrays(path_)
      .with_group("error", {2, 3, 1}, {1, 2, 3, 4, 5, 6})
      .with_group("covariance", {2, 3, 1, 1}, {0.5})
      .with_group("time", {1, 3}, {0.5, 1.0, 1.5});
  const StateRows rows = EstimateArrays(path_, "ekf").estimates(0, 1);
  EXPECT_THAT(rows.time, ElementsAre(0.5, 1.0, 1.5));
  EXPECT_EQ(rows.state[2](0), 6);
  Arrays(path_).with_group("error", {2, 3}, {1}).with("covariance", {2, 3, 1, 1}, {1});
  EXPECT_THAT(complaint(), HasSubstr("error has the axes {2, 3}"));
}

TEST_F(EstimateArraysTest, HaveMeansWithATruthOfAllRuns) {
  Arrays(path_)
      .called("x_m,y_m,heading_rad")
      .with("mean", {2, 1, 3}, {1, 2, 3, 4, 5, 6})
      .with("truth", {1, 3}, {1, 1, 1})
      .with("covariance", {2, 1, 3, 3}, {1})
      .with("nis", {2, 1}, {4.5, kNo})
      .with("nis_dof", {2, 1}, {2, 0});
  const EstimateArrays arrays(path_, "ekf");
  EXPECT_FALSE(arrays.has_errors());
  const StateRows rows = arrays.estimates(0, 1);
  EXPECT_EQ(rows.shape.kind, StateKind::pose);
  EXPECT_EQ(rows.state[0], Eigen::Vector3d(4, 5, 6));
  EXPECT_THAT(rows.nis_dof, ElementsAre(0U));
  EXPECT_THAT(arrays.estimates(0, 0).nis, ElementsAre(4.5));
  EXPECT_EQ(arrays.truth(0, 1, rows.shape).state[0], Eigen::Vector3d(1, 1, 1));
}

TEST_F(EstimateArraysTest, ThatDoNotFitAreNamed) {
  Arrays(path_).with("error", {2, 3, 2}, {1});
  EXPECT_THAT(complaint(), HasSubstr("study.h5: covariance is missing"));
  Arrays(path_).with("mean", {2, 3, 2}, {1}).with("covariance", {2, 3, 2, 2}, {1});
  EXPECT_THAT(complaint(), HasSubstr("truth is missing"));
  Arrays(path_).with("error", {3, 2}, {1}).with("covariance", {3, 2, 2}, {1});
  EXPECT_THAT(complaint(),
              HasSubstr("error has the axes {3, 2} (3 are needed, the first of runs)"));
  Arrays(path_).with("error", {2, 3, 2}, {1}).with("covariance", {2, 4, 2, 2}, {1});
  EXPECT_THAT(complaint(), HasSubstr("covariance has the axes {2, 4, 2, 2}"));
  Arrays(path_).with("error", {2, 30, 7}, {1}).with("covariance", {2, 2, 30, 7}, {1});
  EXPECT_THAT(complaint(), HasSubstr("permute(covariance, [4 3 2 1])"));
  Arrays(path_).with("error", {1, 2, 2}, {1, kNo, 1, 1}).with("covariance", {1, 2, 2, 2}, {1});
  EXPECT_THAT(complaint(), HasSubstr(":0: some numbers of error are not finite"));
  Arrays(path_)
      .with("error", {1, 2, 1}, {1})
      .with("covariance", {1, 2, 1, 1}, {1})
      .with("time", {2}, {1, 1});
  EXPECT_THAT(complaint(), HasSubstr(":1: time 1 s is not later"));
  Arrays(path_).with("error", {1, 2, 1}, {1}).with("covariance", {1, 2, 1, 1}, {1}).called("a,b");
  EXPECT_THAT(complaint(), HasSubstr("names has 2 columns (error has 1)"));
  Arrays(path_).with("errors", {2, 3, 2}, {1}).with("covariances", {2, 3, 2, 2}, {1});
  EXPECT_THAT(complaint(), HasSubstr("study.h5: has errors (an array is called error): rename it"));
  Arrays(path_).with("error", {0, 2, 1}, {}).with("covariance", {0, 2, 1, 1}, {});
  EXPECT_THAT(complaint(), HasSubstr("error is empty"));
}

/// HDF5 1.10 copies as many bytes of a text as the file says, or searches for its place for ever.
TEST_F(EstimateArraysTest, OfWhichATextIsDamagedEndNoProgram) {
  Arrays(path_).with("error", {1, 2, 1}, {1}).with("covariance", {1, 2, 1, 1}, {1}).called("a");
  const PosixFile file(path_, PosixFile::Mode::write);
  std::string bytes(file.size(), '\0');
  file.read_at(0, std::as_writable_bytes(std::span(bytes)));
  const std::size_t heap = bytes.find("GCOL");
  ASSERT_NE(heap, std::string::npos);
  const std::uint64_t long_text = 1U << 30U;
  constexpr std::size_t kSizeOfFirstText = 24;
  file.write_at(heap + kSizeOfFirstText, std::as_bytes(std::span(&long_text, 1)));
  EXPECT_THAT(complaint(), HasSubstr("study.h5"));
}

}  // namespace
}  // namespace montecarta::experiments
