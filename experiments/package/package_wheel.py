# SPDX-License-Identifier: BSD-3-Clause
"""Builds the wheel of the Python package, which has the program beside it (a backend of PEP 517).
It needs CMake, Ninja, a compiler and the libraries of .ci/packages.txt, and downloads nothing.

    pip install .                               # builds the program in build-wheel/
    pip install . --config-settings=build=build # takes the program of that folder

The program is built for every x86-64-v3 processor, or on ARM for armv8-a. The libraries that it
links are not in the wheel.
"""
import base64
import hashlib
import os
import platform
import re
import shutil
import subprocess
import sysconfig
import tarfile
import tempfile
import tomllib
import zipfile

SOURCE = os.path.normpath(os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", ".."))


def build_wheel(wheel_directory, config_settings=None, metadata_directory=None):
    """Writes the wheel, and returns its name."""
    stem, tag = _stem(), f"py3-none-{re.sub('[-.]', '_', sysconfig.get_platform())}"
    name = f"{stem}-{tag}.whl"
    with tempfile.TemporaryDirectory() as prefix:
        build = (config_settings or {}).get("build") or _built()
        subprocess.run(["cmake", "--install", os.path.join(SOURCE, build), "--component", "program",
                        "--strip", "--prefix", prefix], check=True)
        files = {f"{stem}.data/data/{path}": os.path.join(prefix, path) for path in _below(prefix)}
        files[f"{stem}.data/scripts/montecarta"] = files.pop(f"{stem}.data/data/bin/montecarta")
        readers = os.path.join(SOURCE, "analysis/readers")
        files |= {path: os.path.join(readers, path) for path in _below(readers)
                  if re.fullmatch(r"montecarta/(\w+\.py|py\.typed)", path)}
        external = os.path.join(SOURCE, "experiments/external/python/montecarta_filter.py")
        files["montecarta_filter.py"] = external
        files[f"{stem}.dist-info/LICENSE"] = os.path.join(SOURCE, "LICENSE")
        texts = {f"{stem}.dist-info/METADATA": _metadata(),
                 f"{stem}.dist-info/WHEEL": "Wheel-Version: 1.0\nGenerator: montecarta\n"
                                            f"Root-Is-Purelib: false\nTag: {tag}\n"}
        _write_zip(os.path.join(wheel_directory, name), files, texts, f"{stem}.dist-info/RECORD")
    return name


def prepare_metadata_for_build_wheel(metadata_directory, config_settings=None):
    """Writes what pip wants to know before it builds, and returns the name of its folder."""
    folder = f"{_stem()}.dist-info"
    os.makedirs(os.path.join(metadata_directory, folder))
    with open(os.path.join(metadata_directory, folder, "METADATA"), "w", encoding="utf-8") as file:
        file.write(_metadata())
    return folder


def build_sdist(sdist_directory, config_settings=None):
    """Writes an archive of the files that git knows, and returns its name."""
    listed = subprocess.run(["git", "ls-files", "-z"], cwd=SOURCE, check=True, capture_output=True,
                            text=True).stdout.split("\0")
    with (tempfile.TemporaryDirectory() as folder,
          tarfile.open(os.path.join(sdist_directory, f"{_stem()}.tar.gz"), "w:gz") as archive):
        for path in filter(None, listed):
            archive.add(os.path.join(SOURCE, path), f"{_stem()}/{path}")
        about = os.path.join(folder, "PKG-INFO")
        with open(about, "w", encoding="utf-8") as file:
            file.write(_metadata())
        archive.add(about, f"{_stem()}/PKG-INFO")
    return f"{_stem()}.tar.gz"


def _built():
    """Builds the program, and returns the folder."""
    missing = [name for name in ("cmake", "ninja", "pkg-config") if shutil.which(name) is None]
    if missing:
        raise RuntimeError(f"{', '.join(missing)} is not installed (the wheel has the program): "
                           "bash .ci/install-packages build")
    arch = {"x86_64": "x86-64-v3", "aarch64": "armv8-a"}.get(platform.machine(), "native")
    for arguments in [["--preset", "bits", "-B", "build-wheel", f"-DMONTECARTA_ARCH={arch}"],
                      ["--build", "build-wheel", "--target", "montecarta"]]:
        subprocess.run(["cmake", *arguments], cwd=SOURCE, check=True)
    return "build-wheel"


def _below(folder):
    """The files of a folder, relative to it, in their order."""
    return sorted(os.path.relpath(os.path.join(parent, name), folder)
                  for parent, _, names in os.walk(folder) for name in names)


def _version():
    with open(os.path.join(SOURCE, "CMakeLists.txt"), encoding="utf-8") as file:
        return re.search(r"project\(montecarta VERSION ([\d.]+)", file.read()).group(1)


def _stem():
    return f"montecarta-{_version()}"


def _metadata():
    with open(os.path.join(SOURCE, "pyproject.toml"), "rb") as file:
        project = tomllib.load(file)["project"]
    lines = ["Metadata-Version: 2.1", f"Name: {project['name']}", f"Version: {_version()}",
             f"Summary: {project['description']}", f"License: {project['license']['text']}",
             f"Requires-Python: {project['requires-python']}"]
    lines += [f"Requires-Dist: {name}" for name in project["dependencies"]]
    for extra, names in project["optional-dependencies"].items():
        lines.append(f"Provides-Extra: {extra}")
        lines += [f"Requires-Dist: {name}; extra == '{extra}'" for name in names]
    lines.append("Description-Content-Type: text/markdown")
    with open(os.path.join(SOURCE, project["readme"]), encoding="utf-8") as file:
        return "\n".join([*lines, "", file.read()])


def _write_zip(path, files, texts, record):
    """Writes files {name in the wheel: path} and texts {name: text}, and the record of both."""
    rows = []
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        def add(name, content, mode):
            entry = zipfile.ZipInfo(name)
            entry.external_attr = (0o100000 | mode) << 16
            entry.compress_type = zipfile.ZIP_DEFLATED
            archive.writestr(entry, content)
            digest = base64.urlsafe_b64encode(hashlib.sha256(content).digest()).rstrip(b"=")
            rows.append(f"{name},sha256={digest.decode()},{len(content)}")

        for name, source in sorted(files.items()):
            with open(source, "rb") as file:
                add(name, file.read(), 0o755 if os.access(source, os.X_OK) else 0o644)
        for name, text in texts.items():
            add(name, text.encode(), 0o644)
        rows.append(f"{record},,")
        archive.writestr(record, "\n".join(rows) + "\n")
