# SPDX-License-Identifier: BSD-3-Clause
"""Builds the wheel of the Python package, which has the program beside it (a backend of PEP 517).
It needs CMake, Ninja, a compiler and the libraries of .ci/packages.txt, and downloads nothing.

    pip install .                               # builds the program in build-wheel/
    pip install . --config-settings=build=build # takes the program of that folder
    pip wheel . --config-settings=libraries=bundled  # for machines without these libraries

The program is built for every x86-64-v3 processor, or on ARM for armv8-a. The wheel of a build by
the preset `package` has a second one for x86-64-v4, which the first starts where it can run. A
wheel with bundled libraries has all that its programs link but the C library, with their licences;
it is made on Debian, by patchelf. Without that setting the libraries are not in the wheel.
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

# The C library, which belongs to the system.
GLIBC = re.compile(r"(lib(c|m|dl|rt|pthread|resolv|util|mvec)|ld-linux.*)\.so\.\d+")
# Of the lines of ldd, the name and the path of a library.
LINKED = re.compile(r"^\s*(\S+) => (.+?)(?: \(0x\w+\))?$", re.MULTILINE)
LIBRARIES = "lib/montecarta"  # where bundled libraries are, beside the folder bin
# The second, for wider registers, is in the builds of the preset `package` only.
PROGRAMS = ("bin/montecarta", "lib/montecarta/x86-64-v4/montecarta")

SOURCE = os.path.normpath(os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", ".."))


def build_wheel(wheel_directory, config_settings=None, metadata_directory=None):
    """Writes the wheel, and returns its name."""
    settings = config_settings or {}
    is_bundled = _is_bundled(settings)
    system = sysconfig.get_platform()
    if is_bundled:
        glibc = os.confstr("CS_GNU_LIBC_VERSION").split()[1]
        system = system.replace("linux", f"manylinux_{glibc}")
    stem, tag = _stem(), f"py3-none-{re.sub('[-.]', '_', system)}"
    name = f"{stem}-{tag}.whl"
    with tempfile.TemporaryDirectory() as prefix:
        build = settings.get("build") or _built()
        subprocess.run(["cmake", "--install", os.path.join(SOURCE, build), "--component", "program",
                        "--strip", "--prefix", prefix], check=True)
        licences = _bundle(prefix) if is_bundled else {}
        files = {f"{stem}.data/data/{path}": os.path.join(prefix, path) for path in _below(prefix)}
        files[f"{stem}.data/scripts/montecarta"] = files.pop(f"{stem}.data/data/bin/montecarta")
        readers = os.path.join(SOURCE, "analysis/readers")
        files |= {path: os.path.join(readers, path) for path in _below(readers)
                  if re.fullmatch(r"montecarta/(\w+\.py|py\.typed)", path)}
        external = os.path.join(SOURCE, "experiments/external/python/montecarta_filter.py")
        files["montecarta_filter.py"] = external
        files |= {f"{stem}.dist-info/licenses/{package}.txt": path
                  for package, path in licences.items()}
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


def _is_bundled(settings):
    said = settings.get("libraries", "linked")
    if said not in ("linked", "bundled"):
        raise RuntimeError(f"libraries={said}: say linked (the default) or bundled")
    missing = [name for name in ("patchelf", "dpkg-query") if shutil.which(name) is None]
    if said == "bundled" and missing:
        raise RuntimeError(f"{' and '.join(missing)} not installed (libraries=bundled needs "
                           "Debian's): bash .ci/install-packages test")
    return said == "bundled"


def _bundle(prefix):
    """Copies the libraries that the programs link, and lets these find them where they are
    installed. Returns {package: file} of their licences."""
    programs = [os.path.join(prefix, name) for name in PROGRAMS
                if os.path.exists(os.path.join(prefix, name))]
    folder = os.path.join(prefix, LIBRARIES)
    os.makedirs(folder, exist_ok=True)
    licences = {}
    linked = subprocess.run(["ldd", *programs], check=True, capture_output=True, text=True).stdout
    for name, path in sorted(set(LINKED.findall(linked))):
        if GLIBC.fullmatch(name):
            continue
        if not os.path.exists(path):
            raise RuntimeError(f"{name}, which the program links, is {path}: install it")
        copy = os.path.join(folder, name)
        shutil.copyfile(path, copy)
        subprocess.run(["patchelf", "--set-rpath", "$ORIGIN", copy], check=True)
        package = _package_of(os.path.realpath(path))
        licences[package] = f"/usr/share/doc/{package}/copyright"
    for program in programs:
        to_libraries = os.path.relpath(folder, os.path.dirname(program))
        subprocess.run(["patchelf", "--force-rpath", "--set-rpath", f"$ORIGIN/{to_libraries}",
                        program], check=True)
    return licences


def _package_of(path):
    """The Debian package that has a library."""
    found = subprocess.run(["dpkg-query", "-S", f"*/{os.path.basename(path)}"], check=True,
                           capture_output=True, text=True).stdout
    return re.split("[:,]", found, maxsplit=1)[0]


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
