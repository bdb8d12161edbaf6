#!/usr/bin/env python3
"""Runs clang-tidy on sources of src/ and remembers which passed.

    scripts/tidy.py BUILD CACHE JOBS SOURCE...

BUILD is a build folder by Ninja with compile_commands.json, already built. A source that passed with the same text, headers of the project,
compile command and .clang-tidy is skipped: CACHE holds one empty file for each of these. Exits with 1 if a source fails.
"""

import concurrent.futures
import hashlib
import json
import pathlib
import re
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent


def dependencies(build):
    """Object file -> headers and sources it was compiled from, as Ninja recorded them."""
    listing = subprocess.run(["ninja", "-C", build, "-t", "deps"], check=True, capture_output=True, text=True).stdout
    found = {}
    for block in listing.split("\n\n"):
        lines = block.splitlines()
        if lines:
            found[lines[0].split(":")[0]] = [line.strip() for line in lines[1:]]
    return found


def key(command, depends, build):
    """Hash of everything of the project that clang-tidy reads for one source."""
    digest = hashlib.sha256((ROOT / ".clang-tidy").read_bytes())
    digest.update(re.sub(re.escape(str(ROOT)), "", command).encode())
    for name in sorted(depends):
        path = pathlib.Path(build, name).resolve() if not name.startswith("/") else pathlib.Path(name)
        if path.is_relative_to(ROOT) and path.exists():
            digest.update(path.read_bytes())
    return digest.hexdigest()


def commands(build):
    """Compile command of each source, also of those that are compiled in batches."""
    for entry in json.loads(pathlib.Path(build, "compile_commands.json").read_text()):
        batch = re.findall(r'#include "(.*\.cpp)"', pathlib.Path(entry["file"]).read_text()) if "/Unity/" in entry["file"] else []
        for source in batch or [entry["file"]]:
            yield {**entry, "file": source, "command": entry["command"].replace(entry["file"], source)}


def main():
    build, cache, jobs = sys.argv[1], pathlib.Path(sys.argv[2]), int(sys.argv[3])
    wanted = {str((ROOT / source).resolve()) for source in sys.argv[4:]}
    cache.mkdir(parents=True, exist_ok=True)
    depends = dependencies(build)
    entries = [entry for entry in commands(build) if entry["file"] in wanted]
    open_sources = []
    for entry in entries:
        object_file = entry.get("output") or re.search(r" -o (\S+)", entry["command"]).group(1)
        passed = cache / key(entry["command"], depends.get(object_file, [entry["file"]]), build)
        if not passed.exists():
            open_sources.append((entry["file"], passed))
    database = pathlib.Path(build, "tidy")
    database.mkdir(exist_ok=True)
    (database / "compile_commands.json").write_text(json.dumps(entries))

    def check(source):
        file, passed = source
        result = subprocess.run(["clang-tidy", "--quiet", "-p", str(database), "--extra-arg=-Wno-unknown-warning-option", file], capture_output=True, text=True)
        if result.returncode == 0:
            passed.touch()
            return True
        print(result.stdout, result.stderr, file=sys.stderr)
        return False

    with concurrent.futures.ThreadPoolExecutor(jobs) as pool:
        passed = list(pool.map(check, open_sources))
    print(f"clang-tidy: {len(wanted)} sources, {len(open_sources)} of them checked now")
    return 0 if all(passed) else 1


if __name__ == "__main__":
    sys.exit(main())
