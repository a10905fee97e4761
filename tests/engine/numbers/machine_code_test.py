# SPDX-License-Identifier: BSD-3-Clause
"""Whether the compiler kept two promises:

    python3 machine_code_test.py [--fused-only] PROGRAM...

1. It fuses no products unasked, which would change bits. The sources never ask for
   (a b - c, a b + c) in one instruction, which g++ 12 makes of neighbouring sums and differences
   where its cost model says so, in spite of -ffp-contract=off.
2. A function that used wide registers (ymm0 to ymm15, zmm0 to zmm15) clears their upper halves
   before it returns or calls another library. Such a library may compute with the older
   instructions of SSE, before which the processor then waits. Where a way through a function goes
   by a table of a switch, or to the handler of an exception, it is not followed. A program built
   without optimisation, or without names of functions, cannot be tested: --fused-only.

Exit code 0: both hold; 1: one does not, with the functions at fault; 77: no objdump here.
"""
import doctest
import re
import shutil
import subprocess
import sys

FUNCTION = re.compile(r"^[0-9a-f]+ <(.*)>:$")
INSTRUCTION = re.compile(r"^ *([0-9a-f]+):\t(\S+) *(.*)$")
FUSED = re.compile(r"\bvfm(addsub|subadd)\d*p[ds]\b")
WIDE = re.compile(r"%[yz]mm(?:[0-9]|1[0-5])(?:\{.*)?$")  # as the last operand, the result
PREFIX = re.compile(r"^(?:notrack|bnd|repz|repnz|rep)$")
COMPARES = ("vcomis", "vucomis", "vptest", "vtestp")  # instructions whose last operand is read
OTHER_LIBRARY = "@plt>"


class Instruction:
    """One line of a listing."""

    def __init__(self, line):
        self.place, self.name, operands = INSTRUCTION.match(line).groups()
        while PREFIX.match(self.name):
            self.name, _, operands = operands.partition(" ")
        self.target = operands
        self.operands = operands.split("#")[0].split("<")[0].strip()

    def leaves_wide(self, was_wide):
        """Returns whether upper halves are in use behind the instruction."""
        if self.name.startswith("vzero"):
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


def leaves(instruction, is_inside):
    """Returns whether a function returns by the instruction, or goes on in another one, or calls
    another library. `is_inside`: whether it jumps to another instruction of the function."""
    if instruction.name.startswith("call"):
        return OTHER_LIBRARY in instruction.target
    is_cold = ".cold]" in instruction.target or ".cold>" in instruction.target
    is_jump = instruction.name.startswith("j") and not instruction.operands.startswith("*")
    return instruction.name.startswith("ret") or (is_jump and not is_inside and not is_cold)


def leaves_with_wide_registers(lines):
    """Returns whether a way through the function uses wide registers, does not clear them, and
    then returns or calls another library.

    >>> def listing(*code):
    ...     return [f" {k}:{chr(9)}{text}" for k, text in enumerate(code)]
    >>> load = "vmovapd (%rdi),%ymm0"
    >>> leaves_with_wide_registers(listing(load, "vzeroupper", "ret"))
    False
    >>> leaves_with_wide_registers(listing(load, "ret"))
    True
    >>> leaves_with_wide_registers(listing("vmovapd (%rdi),%ymm16", "ret"))
    False
    >>> leaves_with_wide_registers(listing("vbroadcastsd 0x1(%rip),%zmm3  # 6f <c>", "repz ret"))
    True
    >>> leaves_with_wide_registers(listing(load, "call 8 <log@plt>", "vzeroupper", "ret"))
    True
    >>> leaves_with_wide_registers(listing(load, "call 8 <ours>", "vzeroupper", "ret"))
    False
    >>> leaves_with_wide_registers(listing("je 3 <f+3>", load, "vzeroupper", "ret"))
    False
    >>> leaves_with_wide_registers(listing(load, "jne 3 <f+3>", "vzeroupper", "ret"))
    True
    >>> leaves_with_wide_registers(listing(load, "jmp 99 <ours>"))
    True
    >>> leaves_with_wide_registers(listing(load, "jmp 1 <f+1>"))  # for ever
    False
    """
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
        if wide and leaves(instruction, target is not None):
            return True
        wide = instruction.leaves_wide(wide)
        if target is not None:
            ways.append((target, wide))
        if not instruction.ends():
            ways.append((i + 1, wide))
    return False


def faults_of(program, fused_only):
    """Yields a sentence for each function that breaks a promise."""
    for name, lines in functions_of(program):
        count = sum(bool(FUSED.search(line)) for line in lines)
        if count:
            yield f"{count} fused in {name[:200]}"
        is_wide = not fused_only and any("%ymm" in line or "%zmm" in line for line in lines)
        if is_wide and leaves_with_wide_registers(lines):
            yield f"wide registers left in use by {name[:200]}"


def main(arguments):
    programs = [argument for argument in arguments if argument != "--fused-only"]
    if not programs:
        sys.exit(__doc__)
    if doctest.testmod().failed:
        return 1
    if shutil.which("objdump") is None:
        print("skipped: no objdump")
        return 77
    faults = [f"{program}: {fault}" for program in programs
              for fault in faults_of(program, "--fused-only" in arguments)]
    for fault in faults:
        print(fault)
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
