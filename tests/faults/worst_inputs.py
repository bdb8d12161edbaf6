"""Makes the largest input of each kind that taxelsim accepts, and prints the CPU time and the peak memory of a command that reads it.

    python3 worst_inputs.py TAXELSIM SCENES FOLDER [KIND ...]

SCENES: the folder scenes/ of the clone; FOLDER: for the inputs, 2 GB. Prints rows of Markdown for docs/notes/reliability.md.
"""

import collections.abc
import os
import pathlib
import re
import struct
import subprocess
import sys

program = pathlib.Path(sys.argv[1]).resolve()
scenes = pathlib.Path(sys.argv[2]).resolve()
folder = pathlib.Path(sys.argv[3]).resolve()

SENSOR = f"sensor: {scenes}/sensors/weiss_dsa_distal.yaml\n"
SCENE = (
    f"format_version: 1\nname: big\nkind: contacts\n{SENSOR}randomization: {{load: 1}}\n"
    "record: [tactile_image]\ndata_set: {episodes: 1, seed: 1}\n"
)
SKIN = "skin: {thickness_mm: 2, law: winkler, normal_contact_stiffness: 1e8}\nreadout: {curve: {counts_per_newton: 1000}}\n"


def write(name: str, text: str) -> pathlib.Path:
    """A file of this text in the folder."""
    file = folder / name
    file.write_text(text)
    return file


def frame(*arguments: object) -> list[str]:
    """A frame of a sphere, or of what the arguments say."""
    chosen = [str(argument) for argument in arguments]
    if "--sensor" not in chosen:
        chosen += ["--sensor", str(scenes / "sensors/weiss_dsa_distal.yaml")]
    return ["frame", *chosen]


def scene() -> list[str]:
    """199,000 spheres, a million values."""
    return ["devices", "--plan", str(write("scene.yaml", SCENE + "objects:\n" + "  - sphere: {radius_mm: 5}\n" * 199_000))]


def patches() -> list[str]:
    """16 grids of 128 x 128 taxels."""
    items = "".join(
        f"  - {{name: p{n}, num_rows: 128, num_cols: 128, pitch_mm: 1, pose: {{position_mm: [{130 * n}, 0, 0]}}}}\n" for n in range(16)
    )
    file = write("patches.yaml", f"format_version: 1\nname: patches\npatches:\n{items}samples_per_taxel: 1\n{SKIN}")
    return frame("--sensor", file, "--object", "sphere:5", "--pose", "0 0 0.004 1 0 0 0")


def waypoints() -> list[str]:
    """A million poses."""
    rows = "".join(f"{n * 1e-3:.3f},0,0,{n % 7}e-6,1,0,0,0\n" for n in range(1_000_000))
    write("waypoints.csv", "time_s,x_m,y_m,z_m,qw,qx,qy,qz\n" + rows)
    motion = "objects:\n  - sphere: {radius_mm: 5}\n    motion: {waypoints: {file: waypoints.csv, interpolation: linear}}\n"
    text = (scenes / "edge_servo.yaml").read_text()
    text = re.sub(r"^objects:.*\n(?:[ #].*\n)+", motion, text, flags=re.MULTILINE).replace("sensors/", f"{scenes}/sensors/")
    return ["devices", "--plan", str(write("waypoints.yaml", text))]


def measurement() -> list[str]:
    """2^24 - 1 rows of two numbers, then one that is refused, so that no fit follows."""
    with (folder / "table.csv").open("w") as table:
        table.write("depth_mm,force_N\n")
        for n in range((1 << 24) - 1):
            table.write(f"{n * 1e-8:.8f},1\n")
        table.write("x,1\n")
    text = f"format_version: 1\nmeasurement: force_depth\n{SENSOR}table: table.csv\nindenter: {{flat_pin: {{radius_mm: 0.5}}}}\n"
    return ["characterize", str(write("measurement.yaml", text)), "-o", str(folder / "fitted.yaml")]


def manifest() -> list[str]:
    """A million shards, all of them missing."""
    head = pathlib.Path(folder / "made/dataset.yaml").read_text()
    lines = ["num_episodes: 1000000" if line.startswith("num_episodes:") else line for line in head.splitlines()]
    lines = ["episodes_per_shard: 1" if line.startswith("episodes_per_shard:") else line for line in lines]
    (folder / "manifest").mkdir(exist_ok=True)
    write("manifest/dataset.yaml", "\n".join(lines) + "\n")
    return ["inspect", str(folder / "manifest")]


def contacts() -> list[str]:
    """4096 contacts."""
    return frame(
        "--contacts", write("contacts.csv", "".join(f"{(n % 32 - 16) * 0.5e-3},{(n // 32 % 32 - 16) * 1e-3},0,0.1\n" for n in range(4096)))
    )


def stl() -> list[str]:
    """Triangles of a wavy sheet in 2^30 bytes."""
    count = ((1 << 30) - 84) // 50
    with (folder / "sheet.stl").open("wb") as file:
        file.write(bytes(80) + struct.pack("<I", count))
        side = int((count / 2) ** 0.5) + 1
        for cell in range(count // 2 + 1):
            x, y = cell // side, cell % side
            z = [((a * 7 + b * 13) % 5) * 0.01 for a, b in ((x, y), (x + 1, y), (x + 1, y + 1), (x, y + 1))]
            corners = [(x, y, z[0]), (x + 1, y, z[1]), (x + 1, y + 1, z[2]), (x, y + 1, z[3])]
            for a, b, c in ((0, 1, 2), (0, 2, 3)):
                file.write(struct.pack("<12fH", 0, 0, 1, *corners[a], *corners[b], *corners[c], 0))
        file.truncate(84 + 50 * count)
    return frame("--object", folder / "sheet.stl", "--scale", "1e-5", "--load", 1)


KINDS: dict[str, collections.abc.Callable[[], list[str]]] = {
    "scene": scene,
    "patches": patches,
    "waypoints": waypoints,
    "measurement": measurement,
    "manifest": manifest,
    "contacts": contacts,
    "stl": stl,
}


def measure(kind: str) -> None:
    """Prints the row of one kind."""
    arguments = KINDS[kind]()
    process = subprocess.Popen([program, "--log-level", "error", *arguments], stdout=subprocess.DEVNULL, stderr=subprocess.PIPE)
    message = process.stderr.read().decode() if process.stderr else ""
    _, status, usage = os.wait4(process.pid, 0)
    process.returncode = os.waitstatus_to_exitcode(status)
    time = usage.ru_utime + usage.ru_stime
    print(
        f"| {kind}: {KINDS[kind].__doc__} | {arguments[0]} | {process.returncode} | {time:.1f} | {usage.ru_maxrss / 1e3:.0f} |",
        message.strip()[:200],
    )


def main() -> None:
    """Measures all kinds, or those of the command line."""
    folder.mkdir(exist_ok=True)
    small = write("small.yaml", SCENE + "objects: [{sphere: {radius_mm: 5}}]\n")
    subprocess.run([program, "generate", small, "-o", folder / "made"], check=True, capture_output=True)
    for kind in sys.argv[4:] or KINDS:
        measure(kind)


if __name__ == "__main__":
    main()
