// SPDX-License-Identifier: BSD-3-Clause
// A file that another program changed is refused, or it is read as it was.
#include "engine/records/result_file.hpp"
#include "engine/records/seal.hpp"
#include "tests/doubles/matchers.hpp"
#include "tests/doubles/reader_program.hpp"
#include "tests/doubles/result_writing.hpp"

#include <fstream>

namespace montecarta::engine {
namespace {

struct Edit {
  std::string statement;  ///< Python, with the open file f and the group c of a cell
  std::string complaint;  ///< part of the message; empty if the file is read
};

const std::vector<Edit> kEdits = {
    {"del c['ess']", "'/cells/scripted_m4/ess' is gone"},
    {"f.move('cells/scripted_m4/ess', 'cells/scripted_m4/e')", "'/cells/scripted_m4/ess' is gone"},
    {"del f['cells/scripted_m3']", "'/cells/scripted_m3' is gone"},
    {"del f['truth']", "'/truth' is gone"},
    {"del f['provenance/structure']", "'/provenance/structure' is gone"},
    {"f['provenance/structure'][()] = b'x'", "'/' was added"},
    {"c['extra'] = c['ess'][:]", "'/cells/scripted_m4/extra' was added"},
    {"c['round'] = f['/']", "'/cells/scripted_m4/round' was added"},
    {"e = c['ess'][:]; del c['ess']; c['ess'] = e.astype('f4')", "it was f64 {4, 6}"},
    {"e = c['ess'][:]; del c['ess']; c['ess'] = e.reshape(-1)", "it was f64 {4, 6}"},
    {"c['ess'].attrs['units'] = 'm'", "'/cells/scripted_m4/ess' has other attributes"},
    {"c['settings'].attrs['particles'] = 5", "'/cells/scripted_m4/settings' has other attributes"},
    {"f.attrs['format_version'] = [1, 4]", "'/' has other attributes"},
    {"f.attrs['note'] = 'mine'", "'/' has other attributes"},
    {"f['time'][3] += 0.5", "'/time' has other attributes or contents"},
    {"f['scenario/landmarks'][0] = 1", "'/scenario' has other attributes or contents"},
    {"s = f['provenance/study']; s[()] = b'x' + s[()][1:]",
     "'/provenance/study' has other attributes or contents"},
    {"c['ess'][1, 2] = 3", "in '/cells/scripted_m4/' run 1 does not fit its fingerprint"},
    {"c['status'][2] = 2", "in '/cells/scripted_m4/' run 2 does not fit its fingerprint"},
    {"c['status'][2] = 0", "in '/cells/scripted_m4/' run 2 does not fit its fingerprint"},
    {"c['fingerprint'][0] = 7", "in '/cells/scripted_m4/' run 0 does not fit its fingerprint"},
    {"c['full/log_weight'][1, 2] = 3", "in '/cells/scripted_m4/full/' run 1 does not fit"},
    {"f['truth/pose'][3, 2] = 0", "in '/truth/' run 3 does not fit its fingerprint"},
    {"f['timing/wall_seconds'][()] = 3", ""},
    {"f.move('cells/scripted_m4/ess', 'e'); f.move('e', 'cells/scripted_m4/ess')",
     "its objects have another order"},
};

class Structure : public ResultWriting {
 protected:
  Structure() {
    plan_ = small_result_plan(4);
    plan_.columns = {.ancestry = false, .full_runs = 2};
    write_result(path_, plan_);
  }
  std::filesystem::path edited(std::size_t k) const {
    return folder_ / ("edited" + std::to_string(k) + ".h5");
  }
  /// Changes a copy of the file by each statement.
  ProgramOutcome edit_copies() const {
    std::ofstream script(folder_ / "edit.py");
    script << "import h5py, shutil\n";
    for (std::size_t k = 0; k < kEdits.size(); ++k) {
      const std::string copy = "'" + edited(k).string() + "'";
      script << "shutil.copy('" << path_.string() << "', " << copy << ")\n"
             << "with h5py.File(" << copy << ", 'r+') as f:\n"
             << "    c = f['cells/scripted_m4']\n    " << kEdits[k].statement << "\n";
    }
    script.close();
    return run_program("HDF5_USE_FILE_LOCKING= /usr/bin/python3 " + (folder_ / "edit.py").string());
  }
};

TEST_F(Structure, NamesWhatAnotherProgramChanged) {
  if (!python_has("h5py")) GTEST_SKIP() << "h5py (python3-h5py) is not installed";
  const auto outcome = edit_copies();
  ASSERT_EQ(outcome.status, 0) << outcome.output;
  for (std::size_t k = 0; k < kEdits.size(); ++k) {
    SCOPED_TRACE(kEdits[k].statement);
    ASSERT_EQ(check_seal(edited(k)), Seal::absent);
    const std::string complaint = complaint_of([&] { ResultFile file(edited(k)); });
    if (kEdits[k].complaint.empty()) {
      EXPECT_EQ(complaint, "nothing");
    } else {
      EXPECT_THAT(complaint, StartsWith(edited(k).string() + ": changed by another program"));
      EXPECT_THAT(complaint, HasSubstr(kEdits[k].complaint));
    }
  }
}

}  // namespace
}  // namespace montecarta::engine
