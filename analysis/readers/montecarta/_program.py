# SPDX-License-Identifier: BSD-3-Clause
"""The program montecarta."""
from __future__ import annotations

import os
import shutil
import subprocess

_GATE_ANSWERS = (0, 4, 5)  # consistent, not consistent, undecided
_WRONG_INPUT = 2


def program() -> str:
    """Finds the program montecarta.

    Returns
    -------
    str
        The path of the program: the environment variable MONTECARTA, else that of the source tree,
        the wheel or the package to which this module belongs, else the one in PATH.

    Raises
    ------
    FileNotFoundError
        If there is none, or MONTECARTA names none.
    """
    said = os.environ.get("MONTECARTA")
    if said:
        if not _is_program(said):
            raise FileNotFoundError(f"MONTECARTA is {said}, which is no program: correct it")
        return said
    here = os.path.dirname(os.path.abspath(__file__))
    source_tree = os.path.join(here, "..", "..", "..", "build")
    environment = os.path.join(here, "..", "..", "..", "..", "bin")  # or /usr
    target = os.path.join(here, "..", "bin")  # of pip install --target
    for folder in (source_tree, environment, target):
        path = os.path.normpath(os.path.join(folder, "montecarta"))
        if _is_program(path):
            return path
    found = shutil.which("montecarta")
    if found is None:
        raise FileNotFoundError("no program montecarta is in build, beside this module or in PATH: "
                                "build it (bash experiments/first_study), install the Debian "
                                "package, or set MONTECARTA to its path")
    return found


def _is_program(path: str) -> bool:
    return os.path.isfile(path) and os.access(path, os.X_OK)


def call(*words: str) -> subprocess.CompletedProcess[str]:
    """Calls the program. Raises ValueError with its message if it refuses its input, RuntimeError
    if it fails."""
    done = subprocess.run([program(), *words], capture_output=True, text=True, check=False)
    if done.returncode in _GATE_ANSWERS:
        return done
    said = "\n".join(line.removeprefix("montecarta: ") for line in done.stderr.splitlines()
                     if not line.startswith("montecarta: note: "))
    if done.returncode == _WRONG_INPUT and said:
        raise ValueError(said)
    raise RuntimeError(f"montecarta ended with code {done.returncode}: {said or 'no message'}")
