# SPDX-License-Identifier: BSD-3-Clause
"""Whether the compiler fused products unasked: python3 fused_instructions_test.py PROGRAM...

The sources never ask for (a b - c, a b + c) in one instruction, which g++ 12 makes of neighbouring
sums and differences where its cost model says so, in spite of -ffp-contract=off. Exit code 0: no
such instruction; 1: some, with the functions that hold them; 77: no objdump here.
"""
import re
import shutil
import subprocess
import sys

FUNCTION = re.compile(r"^[0-9a-f]+ <(.*)>:$")
FUSED = re.compile(r"\bvfm(addsub|subadd)\d*p[ds]\b")


def functions_that_fuse(program):
    """{demangled name: number of such instructions}"""
    words = ["objdump", "--disassemble", "--demangle", "--no-show-raw-insn", program]
    found, function = {}, "?"
    with subprocess.Popen(words, stdout=subprocess.PIPE, text=True) as listing:
        for line in listing.stdout:
            if name := FUNCTION.match(line):
                function = name[1]
            elif FUSED.search(line):
                found[function] = found.get(function, 0) + 1
    if listing.returncode != 0:
        sys.exit(f"objdump cannot read {program}")
    return found


def main(programs):
    if not programs:
        sys.exit(__doc__)
    if shutil.which("objdump") is None:
        print("skipped: no objdump")
        return 77
    fused = False
    for program in programs:
        for function, count in functions_that_fuse(program).items():
            print(f"{program}: {count} fused in {function[:200]}")
            fused = True
    return 1 if fused else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
