#!/usr/bin/env python3
"""Licences of the libraries that auditwheel bundles into the wheel.

wheel_licences.py add WHEEL     puts the copyright file of each library's Debian package into the wheel
wheel_licences.py check WHEEL   refuses a library without a licence file, a missing part, wrong requirements, and more than 60 MB
"""

from __future__ import annotations

import base64
import csv
import fnmatch
import hashlib
import io
import re
import subprocess
import sys
import zipfile
from pathlib import Path

MOST_BYTES = 60_000_000
PARTS = (
    "taxelsim/_core.*.so",
    "taxelsim/_core.pyi",
    "taxelsim/py.typed",
    "taxelsim/bin/taxelsim",
    "taxelsim/lib/libtaxelsim.so*",
    "taxelsim/scenes/edge_servo.yaml",
)
BUNDLED = re.compile(r"^taxelsim\.libs/(?P<stem>.+?)-[0-9a-f]{8}(?P<rest>\..*)$")


def bundled_libraries(names: list[str]) -> dict[str, str]:
    """File names as in Debian, "libhdf5_serial.so.103", by path in the wheel."""
    libraries = {}
    for name in names:
        if name.startswith("taxelsim.libs/") and not name.endswith("/"):
            found = BUNDLED.match(name)
            libraries[name] = found["stem"] + found["rest"] if found else Path(name).name
    return libraries


def licence_folder(names: list[str]) -> str:
    info = next(name for name in names if name.endswith(".dist-info/METADATA"))
    return info.removesuffix("METADATA") + "licenses/bundled/"


def debian_package(library: str) -> str:
    """The package that a library of this machine comes from."""
    paths = [path for folder in ("/usr/lib", "/lib") for path in Path(folder).glob(f"*-linux-gnu/{library}*")]
    for path in paths:
        for candidate in (path, path.resolve()):
            found = subprocess.run(["dpkg", "-S", str(candidate)], capture_output=True, text=True)
            if found.returncode == 0:
                return found.stdout.split(":")[0]
    raise SystemExit(f"wheel_licences: no Debian package has {library}")


def add(wheel: Path) -> None:
    with zipfile.ZipFile(wheel) as archive:
        files = {name: archive.read(name) for name in archive.namelist()}
        modes = {info.filename: info for info in archive.infolist()}
    names = list(files)
    folder = licence_folder(names)
    packages: dict[str, list[str]] = {}
    for library in bundled_libraries(names).values():
        packages.setdefault(debian_package(library), []).append(library)
    record = next(name for name in names if name.endswith(".dist-info/RECORD"))
    for package, libraries in packages.items():
        text = Path(f"/usr/share/doc/{package}/copyright").read_bytes()
        files[f"{folder}{package}.txt"] = f"{package}: {', '.join(sorted(libraries))}\n\n".encode() + text
    rows = io.StringIO()
    writer = csv.writer(rows, lineterminator="\n")
    for name, content in files.items():
        digest = base64.urlsafe_b64encode(hashlib.sha256(content).digest()).rstrip(b"=").decode()
        writer.writerow([name, "", ""] if name == record else [name, f"sha256={digest}", len(content)])
    files[record] = rows.getvalue().encode()
    with zipfile.ZipFile(wheel, "w", zipfile.ZIP_DEFLATED, compresslevel=9) as archive:
        for name, content in files.items():
            archive.writestr(modes.get(name, zipfile.ZipInfo(name, (1980, 1, 1, 0, 0, 0))), content, zipfile.ZIP_DEFLATED)


def check(wheel: Path) -> None:
    faults = []
    with zipfile.ZipFile(wheel) as archive:
        names = archive.namelist()
        folder = licence_folder(names)
        licences = {name: archive.read(name).decode(errors="replace") for name in names if name.startswith(folder)}
        metadata = archive.read(next(name for name in names if name.endswith(".dist-info/METADATA"))).decode()
        needs_backend = "\nRequires-Dist: nanobind-backend" in metadata
        sizes = {info.filename: info.file_size for info in archive.infolist()}
    libraries = bundled_libraries(names)
    for path, library in libraries.items():
        if not any(library in text.split("\n", 1)[0] for text in licences.values()):
            faults.append(f"{path} has no licence file in {folder}")
    faults += [f"{part} is missing" for part in PARTS if not any(fnmatch.fnmatch(name, part) for name in names)]
    is_split = any(name == "taxelsim/_core.abi3.so" for name in names)
    if is_split != needs_backend:
        faults.append(f"requires nanobind-backend: {needs_backend}, while the module {'needs' if is_split else 'does not need'} it")
    if wheel.stat().st_size > MOST_BYTES:
        faults.append(f"{wheel.stat().st_size:,} bytes, at most {MOST_BYTES:,} are allowed")
    for path in libraries:
        print(f"{sizes[path]:>12,}  {path}")
    print(f"{wheel.name}: {wheel.stat().st_size:,} bytes, {len(libraries)} bundled libraries, {len(licences)} licence files")
    if faults:
        raise SystemExit("\n".join(f"wheel_licences: {fault}" for fault in faults))


def main() -> None:
    if len(sys.argv) != 3 or sys.argv[1] not in ("add", "check"):
        raise SystemExit(__doc__)
    {"add": add, "check": check}[sys.argv[1]](Path(sys.argv[2]))


if __name__ == "__main__":
    main()
