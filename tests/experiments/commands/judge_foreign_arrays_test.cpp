// SPDX-License-Identifier: BSD-3-Clause
// Arrays of NumPy and MATLAB, which `judge` has converted by a script of experiments/convert.
#include "tests/doubles/reader_program.hpp"
#include "tests/experiments/commands/program.hpp"

#include <filesystem>
#include <string>

namespace montecarta::experiments {
namespace {

using testing::AllOf, testing::HasSubstr, testing::Not;

/// Writes the same 20 runs of two components as HDF5, .npz, and MATLAB 5 and 7.3.
constexpr const char* kWriteArrays = R"(
import h5py, numpy as np, scipy.io, shutil, struct
P = np.broadcast_to(np.array([[.04, .01], [.01, .09]]), (20, 30, 2, 2))
noise = np.random.default_rng(1).standard_normal((20, 30, 2, 1))
arrays = {"error": (np.linalg.cholesky(P) @ noise)[..., 0], "covariance": P,
          "time": np.arange(30) / 2, "nis": noise[..., 0, 0]**2, "nis_dof": np.ones((20, 30))}
with h5py.File("arrays.h5", "w") as file:
    for name, values in arrays.items():
        file[name] = values
    file.attrs["names"] = "x_m,y_m"
np.savez("study.npz", names=np.array(["x_m", "y_m"]), **arrays)
scipy.io.savemat("old.mat", {"names": "x_m,y_m", **arrays})
with h5py.File("new.mat", "w", userblock_size=512) as file:
    for name, values in arrays.items():
        file[name] = np.atleast_2d(values).T
        file[name].attrs["MATLAB_class"] = np.bytes_("double")
    file["names"] = np.array([[ord(letter)] for letter in "x_m,y_m"], dtype=np.uint16)
    file["names"].attrs["MATLAB_class"] = np.bytes_("char")
with open("new.mat", "r+b") as file:
    file.write(b"MATLAB 7.3 MAT-file".ljust(124) + b"\0\2IM")
for name in "study.npz", "old.mat", "new.mat":
    open("damaged_" + name, "wb").write(open(name, "rb").read()[:900])
np.savez("nothing.npz", other=np.zeros(3))
np.savez("plural.npz", errors=arrays["error"], covariances=arrays["covariance"])
np.savez("both.npz", mean=arrays["error"], **arrays)

# `names` as an object of MATLAB's class string: what SciPy and h5py see of it.
def element(kind, content):
    return struct.pack("<II", kind, len(content)) + content + bytes(-len(content) % 8)
record = element(6, struct.pack("<II", 17, 0))
record += b"".join(element(1, word) for word in (b"names", b"MCOS", b"string"))
scipy.io.savemat("numbers.mat", {"ids": np.zeros((1, 6), np.uint32)})
numbers = open("numbers.mat", "rb").read()[128:]
scipy.io.savemat("old_string.mat", arrays)
with open("old_string.mat", "ab") as file:
    file.write(element(14, record + numbers))
shutil.copy("new.mat", "new_string.mat")
with h5py.File("new_string.mat", "r+") as file:
    del file["names"]
    file["names"] = np.zeros((6, 1), dtype=np.uint32)
    file["names"].attrs["MATLAB_class"] = np.bytes_("string")
for name, capitals in ("study.npz", "STUDY.NPZ"), ("new.mat", "NEW.MAT"):
    shutil.copy(name, capitals)
)";

class JudgeForeignArrays : public Program {
 protected:
  void SetUp() override {
    if (!python_has("numpy, scipy, h5py"))
      GTEST_SKIP() << "python3-scipy, python3-h5py are missing";
    write("write.py", kWriteArrays);
    ASSERT_EQ(std::system(("cd " + shell_quoted(folder_.string()) +
                           " && HDF5_USE_FILE_LOCKING=FALSE /usr/bin/python3 -B write.py")
                              .c_str()),
              0);
    std::filesystem::create_directory(folder_ / "temporary");
  }
  Called judged(const std::string& arrays, const std::string& before = "") const {
    return call({"judge", arrays, "-o", "mine.h5", "--cell", "mine", "--force"},
                "export TMPDIR=temporary && " + before);
  }
  bool is_nothing_left() const { return std::filesystem::is_empty(folder_ / "temporary"); }
};

TEST_F(JudgeForeignArrays, GiveTheVerdictOfTheSameNumbersInHdf5) {
  const Called wanted = judged("arrays.h5");
  ASSERT_EQ(wanted.code, 0) << wanted.err;
  EXPECT_THAT(wanted.out, HasSubstr("mine is "));
  for (const std::string name : {"study.npz", "old.mat", "new.mat", "STUDY.NPZ", "NEW.MAT"}) {
    const Called called = judged(name);
    EXPECT_EQ(called.code, 0) << called.err;
    EXPECT_EQ(called.out, wanted.out) << name;
    EXPECT_THAT(called.err, HasSubstr(name + " was converted by "));
    EXPECT_TRUE(is_nothing_left()) << name;
  }
}

TEST_F(JudgeForeignArrays, ThatAreDamagedAreRefused) {
  for (const std::string name : {"study.npz", "old.mat", "new.mat"}) {
    const Called called = judged("damaged_" + name);
    EXPECT_EQ(called.code, 2) << called.err;
    EXPECT_THAT(called.err,
                AllOf(HasSubstr("damaged_" + name + ": is damaged"), Not(HasSubstr("Traceback"))));
    EXPECT_TRUE(is_nothing_left()) << name;
  }
  EXPECT_THAT(judged("nothing.npz").err, HasSubstr("nothing.npz: neither 'error' nor 'mean'"));
  EXPECT_THAT(judged("both.npz").err, HasSubstr("both.npz: both 'error' and 'mean'"));
  for (const char* name : {"old_string.mat", "new_string.mat"})
    EXPECT_THAT(judged(name).err, HasSubstr("write 'x_m,y_m' in single quotes")) << name;
  EXPECT_THAT(judged("plural.npz").err, HasSubstr("plural.npz: has errors (an array is called"));
  EXPECT_THAT(judged("none.npz").err, HasSubstr("none.npz: cannot be opened"));
  EXPECT_TRUE(is_nothing_left());
}

TEST_F(JudgeForeignArrays, NeedPythonAndItsModules) {
  EXPECT_EQ(judged("study.npz", "export PATH=temporary && ").code, 0) << "that of the system";
  write("numpy.py", "raise ImportError(name='numpy')\n");
  const Called called = judged("study.npz", "export PYTHONPATH=. && ");
  EXPECT_EQ(called.code, 2) << called.err;
  EXPECT_THAT(called.err, HasSubstr("study.npz: numpy is missing in this Python"));
  EXPECT_TRUE(is_nothing_left());
}

}  // namespace
}  // namespace montecarta::experiments
