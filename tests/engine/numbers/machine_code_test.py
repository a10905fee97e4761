# SPDX-License-Identifier: BSD-3-Clause
"""Whether the compiler kept two promises: python3 machine_code_test.py PROGRAM...

1. It fuses no products unasked, which would change bits. The sources never ask for
   (a b - c, a b + c) in one instruction, which g++ 12 makes of neighbouring sums and differences
   where its cost model says so, in spite of -ffp-contract=off.
2. A function that used wide registers (ymm0 to ymm15, zmm0 to zmm15) clears their upper halves
   before it returns or calls another library, which may compute with the older instructions of
   SSE: each change between the two costs 0.1 us and more on Intel processors.

Exit code 0: both hold; 1: one does not, with the functions at fault; 77: no objdump here.
"""
import re
import shutil
import subprocess
import sys

FUNCTION = re.compile(r"^[0-9a-f]+ <(.*)>:$")
INSTRUCTION = re.compile(r"^ *([0-9a-f]+):\t(\S+) *(.*)$")
FUSED = re.compile(r"\bvfm(addsub|subadd)\d*p[ds]\b")
WIDE = re.compile(r"%[yz]mm(?:[0-9]|1[0-5])(?:\{.*)?$")  # as the last operand, the result
COMPARES = ("vcomis", "vucomis", "vptest", "vtestp")  # instructions whose last operand is read
OTHER_LIBRARY = "@plt>"


class Instruction:
    """One line of a listing."""

    def __init__(self, line):
        self.place, self.name, operands = INSTRUCTION.match(line).groups()
        self.target = operands
        self.operands = operands.split("#")[0].split("<")[0].strip()

    def leaves_wide(self, was_wide):
        """Returns whether upper halves are in use behind the instruction."""
        if self.name == "vzeroupper":
            return False
        return was_wide or bool(WIDE.search(self.operands) and not self.name.startswith(COMPARES))

    def ends(self):
        """Returns whether the next instruction in memory does not follow."""
        return self.name.startswith(("ret", "jmp", "ud2", "hlt"))


def functions_of(program):
    """Yields each function's demangled name and the lines of its instructions."""
    words = ["objdump", "--disassemble", "--demangle", "--no-show-raw-insn", program]
    name, lines = "?", []
    with subprocess.Popen(words, stdout=subprocess.PIPE, text=True) as listing:
        for line in listing.stdout:
            if head := FUNCTION.match(line):
                yield name, lines
                name, lines = head[1], []
            elif INSTRUCTION.match(line):
                lines.append(line.rstrip("\n"))
    yield name, lines
    if listing.returncode != 0:
        sys.exit(f"objdump cannot read {program}")


def leaves_with_wide_registers(lines):
    """Returns whether a way through the function uses wide registers, does not clear them, and
    then returns or calls another library."""
    instructions = [Instruction(line) for line in lines]
    index = {instruction.place: i for i, instruction in enumerate(instructions)}
    reached = set()  # (index, whether upper halves are in use before the instruction)
    ways = [(0, False)]
    while ways:
        i, wide = ways.pop()
        if i == len(instructions) or (i, wide) in reached or (i, True) in reached:
            continue
        reached.add((i, wide))
        instruction = instructions[i]
        jumps = instruction.name.startswith("j")
        target = index.get(instruction.operands) if jumps else None
        leaves = instruction.name.startswith("ret") or (
            OTHER_LIBRARY in instruction.target and (jumps or instruction.name == "call"))
        if wide and leaves:
            return True
        wide = instruction.leaves_wide(wide)
        if target is not None:
            ways.append((target, wide))
        if not instruction.ends():
            ways.append((i + 1, wide))
    return False


def faults_of(program):
    """Yields a sentence for each function that breaks a promise."""
    for name, lines in functions_of(program):
        count = sum(bool(FUSED.search(line)) for line in lines)
        if count:
            yield f"{count} fused in {name[:200]}"
        if any(WIDE.search(line) for line in lines) and leaves_with_wide_registers(lines):
            yield f"wide registers left in use by {name[:200]}"


def main(programs):
    if not programs:
        sys.exit(__doc__)
    if shutil.which("objdump") is None:
        print("skipped: no objdump")
        return 77
    faults = [f"{program}: {fault}" for program in programs for fault in faults_of(program)]
    for fault in faults:
        print(fault)
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
