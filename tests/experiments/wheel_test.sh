#!/bin/bash
# SPDX-License-Identifier: BSD-3-Clause
# The wheel with the program of a build, installed and used without a network: wheel_test.sh BUILD
set -euo pipefail
build=$1
source=$(cd "$(dirname "$0")/../.." && pwd)
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
fail() { echo "wheel_test: $*" >&2; exit 1; }
/usr/bin/python3 -m venv --system-site-packages "$folder/env" >/dev/null 2>&1 ||
  { echo "skipped: python3-venv is not installed"; exit 77; }
/usr/bin/python3 -c 'import h5py' 2>/dev/null || { echo "skipped: no python3-h5py"; exit 77; }

pip() { "$folder/env/bin/python" -m pip --disable-pip-version-check -q "$@"; }
pip wheel --no-index --no-deps --config-settings="build=$build" -w "$folder" "$source" ||
  fail "pip wheel"
wheel=$(ls "$folder"/montecarta-*-py3-none-linux_*.whl)
pip install --no-index "$wheel" || fail "pip install"
pip install --no-index --no-deps --target "$folder/target" "$wheel" || fail "pip install --target"

# The module finds the program that came with it, and not the one in PATH.
cd "$folder"
mkdir other
printf '#!/bin/sh\necho the one in PATH >&2; exit 1\n' >other/montecarta
chmod +x other/montecarta
unset MONTECARTA PYTHONPATH
export PATH="$folder/other:$PATH" HDF5_USE_FILE_LOCKING=FALSE
cat >judge.py <<'PYTHON'
import os, sys
import montecarta, montecarta_filter
import numpy as np

assert montecarta.program() == sys.argv[1], montecarta.program()
assert os.path.exists(os.path.join(os.path.dirname(montecarta.__file__), "py.typed"))
errors = np.random.default_rng(1).standard_normal((300, 100, 2))
assert montecarta.judge(errors, np.broadcast_to(np.eye(2), (100, 2, 2))).answer == "consistent"
results = montecarta.run("first_study", "first.h5", {"study.runs": 2})  # a shipped study
assert "ekf_slam" in results.labels
PYTHON
"$folder/env/bin/python" judge.py "$folder/env/bin/montecarta" || fail "in an environment"
rm first.h5
PYTHONPATH=$folder/target /usr/bin/python3 -B judge.py "$folder/target/bin/montecarta" ||
  fail "in a folder"
"$folder/env/bin/montecarta" check first_study >/dev/null || fail "the command montecarta"
pip uninstall -y montecarta
[ ! -e "$folder/env/bin/montecarta" ] || fail "pip uninstall leaves the program"

# A wheel with its libraries needs none of the machine but the C library.
if command -v patchelf >/dev/null; then
  pip wheel --no-index --no-deps --config-settings="build=$build" \
    --config-settings=libraries=bundled -w "$folder" "$source" || fail "pip wheel, bundled"
  bundled=$(ls "$folder"/montecarta-*-py3-none-manylinux_*.whl)
  pip install --no-index "$bundled" || fail "pip install, bundled"
  foreign=$(ldd "$folder/env/bin/montecarta" | grep '=>' | grep -v "=> $folder/env/" |
    grep -vE '^\s*lib(c|m|resolv|dl|rt|pthread)\.so' || true)
  [ -z "$foreign" ] || fail "libraries that are not in the wheel: $foreign"
  grep -q HDF5 "$folder"/env/lib/python3*/site-packages/montecarta-*.dist-info/licenses/libhdf5* ||
    fail "no licences"
  rm -f first.h5
  "$folder/env/bin/python" judge.py "$folder/env/bin/montecarta" || fail "bundled"
  if "$folder/env/bin/python" -m pip wheel --no-index --no-deps -q -w "$folder" "$source" \
    --config-settings="build=$build" --config-settings=libraries=some 2>refused; then
    fail "a setting that is none"
  fi
  grep -q 'say linked' refused || fail "$(cat refused)"
else
  echo "not tried: a wheel with its libraries, since patchelf is not installed"
fi

# The source archive has what git knows.
if git -C "$source" rev-parse 2>/dev/null; then
  PYTHONPATH=$source/experiments/package /usr/bin/python3 -B -c \
    'import package_wheel; package_wheel.build_sdist(".")' || fail "sdist"
  tar -tf montecarta-*.tar.gz >names
  grep -q '/pyproject.toml$' names || fail "the source archive: $(head names)"
fi
