#!/bin/bash
# SPDX-License-Identifier: BSD-3-Clause
# The Debian package of a build, unpacked into a folder and used from there: package_test.sh BUILD
set -euo pipefail
build=$1
source=$(cd "$(dirname "$0")" && pwd)
for tool in cpack dpkg-deb dpkg-shlibdeps h5diff; do
  command -v $tool >/dev/null || { echo "skipped: $tool is not installed"; exit 77; }
done
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
fail() { echo "package_test: $*" >&2; exit 1; }

cpack --config "$build/CPackConfig.cmake" -B "$folder" >cpack.log ||
  { cat cpack.log; fail "cpack"; }
package=$(ls "$folder"/montecarta_*_*.deb)
grep -q libhdf5 <<<"$(dpkg-deb -f "$package" Depends)" ||
  fail "dependencies: $(dpkg-deb -f "$package")"
grep -q python3-h5py <<<"$(dpkg-deb -f "$package" Recommends)" ||
  fail "recommendations: $(dpkg-deb -f "$package")"
dpkg-deb -x "$package" root

# What is shipped is found beside the program, not in the source tree.
mkdir elsewhere
cd elsewhere
export PATH=$folder/root/usr/bin:$PATH PYTHONPATH=$folder/root/usr/lib/python3/dist-packages
grep -q first_study <<<"$(montecarta list studies)" || fail "no studies"
verdict=$(montecarta run first_study --runs 0:2) || fail "run first_study"
grep -q 'ekf_slam' <<<"$verdict" || fail "no verdict: $verdict"
[ -s first_study_report/index.html ] || fail "no page"
for file in worlds/web_loop.csv studies/first_study.ini external/python/ekf_slam.py \
  convert/conversion.py; do
  [ -s "$folder/root/usr/share/montecarta/$file" ] || fail "$file is not in the package"
done
/usr/bin/python3 -B -c 'import montecarta_filter' || fail "montecarta_filter.py"
if /usr/bin/python3 -B -c 'import h5py' 2>/dev/null; then
  /usr/bin/python3 -B -c 'import montecarta; print(montecarta.open("first_study.h5").labels)' |
    grep -q ekf_slam || fail "montecarta"
  (unset MONTECARTA
   /usr/bin/python3 -B -c 'import montecarta, numpy as np, sys
assert montecarta.program() == sys.argv[1], montecarta.program()
errors = np.random.default_rng(1).standard_normal((300, 100, 2))
small = np.broadcast_to(0.8 * np.eye(2), (100, 2, 2))
assert montecarta.judge(errors, small).answer == "optimistic"
' "$folder/root/usr/bin/montecarta") || fail "montecarta.judge"
fi
[ -e "$PYTHONPATH/montecarta/py.typed" ] || fail "no py.typed"

# A program with a filter of its own, built of what the package holds.
cmake -S "$source/outside_filter" -B mine -DCMAKE_PREFIX_PATH="$folder/root/usr" >cmake.log 2>&1 ||
  { cat cmake.log; fail "find_package"; }
cmake --build mine >build.log 2>&1 ||
  { cat build.log; fail "the program with a filter of its own"; }
grep -q my_filter <<<"$(mine/my_montecarta list filters)" || fail "its filter is not there"
mine/my_montecarta run first_study -o mine.h5 --set cells.cell=my_filter --runs 0:2 --quiet ||
  fail "its filter does not run"
mine/my_laws >laws.log || { cat laws.log; fail "its filter breaks a law"; }
grep -q 'OK.*ForgetsADifferentRunBefore/my_filter' laws.log || fail "no laws: $(tail laws.log)"
grep -q 'OK.*MyFilter' laws.log || fail "no test of its own: $(tail laws.log)"
! mine/broken_laws >laws.log || fail "a filter that forgets nothing breaks no law"
grep -q 'FAILED.*ForgetsADifferentRunBefore/remembering' laws.log || fail "$(tail laws.log)"
for program in montecarta mine/my_montecarta; do  # the shipped filters have the same bits in both
  $program run first_study -o "same_$(basename $program).h5" --runs 0:2 --quiet || fail "$program"
done
h5diff same_montecarta.h5 same_my_montecarta.h5 /cells /cells ||
  fail "other bits in the program of one's own"

# The package of the preset `package` has a second program for wider registers. The one that fits
# runs, both compute the same bits, and the environment keeps the narrower one.
registers_of() { sed -n 's/.*(\(.*\))/\1/p' <<<"$("$@" --version)"; }
if [ -e "$folder/root/usr/lib/montecarta/x86-64-v4/montecarta" ]; then
  fitting=AVX2
  ! grep -qw avx512vl /proc/cpuinfo || fitting=AVX-512
  [ "$(registers_of montecarta)" = $fitting ] || fail "not $fitting: $(montecarta --version)"
  narrow=(env MONTECARTA_ARCH=x86-64-v3 montecarta)
  [ "$(registers_of "${narrow[@]}")" = AVX2 ] || fail "not kept: $("${narrow[@]}" --version)"
  code=0
  MONTECARTA_ARCH=avx2 montecarta --version 2>refused || code=$?
  if [ $code -ne 2 ] || ! grep -q "say x86-64-v3" refused; then
    fail "MONTECARTA_ARCH=avx2: $(cat refused)"
  fi
  studied=(run "$source/fingerprints/every_filter.ini" --runs 0:1 --quiet)
  montecarta "${studied[@]}" -o fitting.h5 || fail "every filter, $fitting"
  "${narrow[@]}" "${studied[@]}" -o narrow.h5 || fail "every filter, AVX2"
  h5diff fitting.h5 narrow.h5 /cells /cells || fail "other bits with other registers"
  code=0
  python3 -B "$source/../engine/numbers/machine_code_test.py" --fused-only \
    "$folder/root/usr/lib/montecarta/x86-64-v4/montecarta" || code=$?
  [ $code -eq 0 ] || [ $code -eq 77 ] || fail "the program for x86-64-v4 fuses products"
  grep -q $fitting <<<"$(montecarta info fitting.h5)" || fail "info: $(montecarta info fitting.h5)"
elif grep -q '^MONTECARTA_PACKAGE:.*=ON' "$build/CMakeCache.txt" && [ "$(uname -m)" = x86_64 ]; then
  fail "no program for x86-64-v4"
fi

# Completion of commands, options and shipped studies.
complete_words() {
  COMP_WORDS=(montecarta "$@") COMP_CWORD=$# COMPREPLY=()
  _montecarta
  printf '%s ' "${COMPREPLY[@]}"
}
# shellcheck disable=SC1091
source "$folder/root/usr/share/bash-completion/completions/montecarta"
[ "$(complete_words ana)" = "analyze " ] || fail "completion of commands: $(complete_words ana)"
grep -q -- '--within' <<<"$(complete_words analyze --w)" || fail "completion of options"
grep -q first_study <<<"$(complete_words run first)" || fail "completion of studies"

if command -v help2man >/dev/null; then
  zcat -f "$folder"/root/usr/share/man/man1/montecarta.1* | grep -q 'analyze' ||
    fail "no manual page"
fi

# On a processor that is too old the program says so.
if command -v qemu-x86_64 >/dev/null && [ "$(uname -m)" = x86_64 ]; then
  code=0
  qemu-x86_64 -cpu Nehalem "$folder/root/usr/bin/montecarta" --version 2>old || code=$?
  [ $code -eq 2 ] || fail "exit code on an old processor: $code"
  grep -q 'this processor lacks' old || fail "on an old processor: $(cat old)"
  if [ -e "$folder/root/usr/lib/montecarta/x86-64-v4/montecarta" ]; then
    registers=$(registers_of qemu-x86_64 -cpu Haswell "$folder/root/usr/bin/montecarta")
    [ "$registers" = AVX2 ] || fail "on a processor without AVX-512: $registers"
  fi
fi
