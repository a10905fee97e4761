// SPDX-License-Identifier: BSD-3-Clause
// Law: the readers that people have open a result file. Run with the real programs from Debian.
#include "engine/records/result_file.hpp"
#include "tests/doubles/matchers.hpp"
#include "tests/doubles/reader_program.hpp"
#include "tests/doubles/result_writing.hpp"

#include <fstream>
#include <sstream>

namespace montecarta::engine {
namespace {

class ResultReaders : public ResultWriting {
 protected:
  void SetUp() override {
    ResultWriter writer =
        ResultWriter::create(path_, plan_, {{"host", "nowhere"}}, Existing::refuse);
    store_run(writer, plan_, 0);
    const RecordLayout layout = layout_of(plan_);
    RunRecord record(layout);
    record.mark_failed(17, "weights vanished", 0.5);
    writer.write(0, 1, record);
  }
  std::string mean_x() const {
    const ResultFile result(part_);
    std::vector<double> mean(24 * 3);
    result.read(result.cells()[0], "pose_mean", 0, mean);
    std::ostringstream text;
    text.precision(17);
    text << mean[3 * 23];
    return text.str();
  }
  ProgramOutcome python(const std::string& script) const {
    std::ofstream(folder_ / "script.py") << script;
    return run_program("HDF5_USE_FILE_LOCKING= /usr/bin/python3 " +
                       (folder_ / "script.py").string());
  }

  /// One run is missing: the file is work in progress, which must open as well.
  const std::string file_ = part_.string();
};

TEST_F(ResultReaders, H5py) {
  if (!python_has("h5py")) GTEST_SKIP() << "h5py (python3-h5py) is not installed";
  const auto outcome = python("import h5py\nf = h5py.File('" + file_ + R"(', 'r')
c = f['cells/scripted_m4']
assert f.attrs['filetype'] == 'montecarta-results'
assert f.attrs['format_version'][0] == 1
assert list(c['status'][:]) == [1, 2, 0]
assert c['failure_reason'][1].tobytes().rstrip(b'\0').decode() == 'weights vanished'
assert c['pose_mean'].dims[1].keys() == ['time'] and c['pose_mean'].attrs['units'] == 'm, m, rad'
assert c['ancestor'].dtype == 'uint16'
assert f['provenance/study'][()].decode().startswith('[study]')
assert abs(c['pose_mean'][0, -1, 0] - )" +
                              mean_x() + R"() < 1e-15
)");
  EXPECT_EQ(outcome.status, 0) << outcome.output;
}

TEST_F(ResultReaders, Ncdump) {
  if (!installed("ncdump")) GTEST_SKIP() << "ncdump (netcdf-bin) is not installed";
  const auto outcome = run_program("ncdump " + file_);  // data too, not only the header
  EXPECT_EQ(outcome.status, 0);
  EXPECT_THAT(outcome.output, AllOf(HasSubstr("double pose_mean(run, time, component)"),
                                    HasSubstr("status = 1, 2, 0")));
}

}  // namespace
}  // namespace montecarta::engine
