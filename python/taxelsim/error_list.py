"""The errors that users meet: messages, causes and remedies. The page of errors in the documentation follows from it."""

from __future__ import annotations

import re
from dataclasses import dataclass

from .errors import ArgumentError, DeviceError, InputError, IoError, OutOfRangeError


@dataclass(frozen=True)
class KnownError:
    """A kind of error."""

    area: str  #: Where it belongs: files, arguments, devices, data sets.
    title: str  #: What is wrong, in a few words.
    raised: type[Exception]  #: Class of the exception in Python.
    pattern: str  #: Regular expression that the message matches.
    example: str  #: A message of this kind.
    cause: str  #: Why it happens.
    remedy: str  #: What helps.


FILES, ARGUMENTS, DEVICES, DATA_SETS = "Scene, sensor and mesh files", "Arguments and arrays", "Devices", "Data sets"

ERRORS = (
    KnownError(
        FILES,
        "A value is not allowed",
        InputError,
        r": .+ is not allowed: ",
        "scene.yaml:30:9: randomization.load: -1 is not allowed: a number from 0 to 1e+06 N",
        "A key has a value outside of its range, or of another type.",
        "The line names file, line, column and key, then the value found and what is allowed; `taxelsim schema scene` lists all keys.",
    ),
    KnownError(
        FILES,
        "A key is unknown",
        InputError,
        r": unknown key(, did you mean '\w+'\?)?; allowed: ",
        "scene.yaml:5:1: nam: unknown key, did you mean 'name'?; allowed: format_version, name, kind, sensor, robot, objects",
        "A key is misspelt or stands in the wrong block.",
        "Take one of the keys that the message lists. An editor with the JSON Schema of `taxelsim schema` marks such keys.",
    ),
    KnownError(
        FILES,
        "A key is missing",
        InputError,
        r" is missing: ",
        "scene.yaml:1:1: sensor is missing: a sensor file, or a sensor's own settings",
        "A required key has no value.",
        "Add the key; the message says what it takes.",
    ),
    KnownError(
        FILES,
        "A file is not YAML",
        InputError,
        r": not YAML: ",
        "scene.yaml:2:1: not YAML: end of sequence flow not found",
        "A bracket, a quote or the indentation is wrong.",
        "Correct the text at this line, or at the line before it.",
    ),
    KnownError(
        FILES,
        "A file belongs to a newer version",
        InputError,
        r": version \d+ is newer than this program: it reads up to \d+",
        "scene.yaml:1:17: format_version: version 9 is newer than this program: it reads up to 1",
        "A newer version of taxelsim wrote the file.",
        "Update taxelsim.",
    ),
    KnownError(
        FILES,
        "A file does not exist",
        InputError,
        r": no such file",
        "scene.yaml: no such file",
        "The path is wrong, or relative to another folder. Files that a scene names are relative to the scene.",
        "Check the path.",
    ),
    KnownError(
        FILES,
        "A mesh cannot be read",
        InputError,
        r": is not a mesh: ",
        "part.obj: is not a mesh: line 2: a face uses vertex 2 of 1",
        "The file is damaged, or it has another format than its name says.",
        "Export it again from the program that made it: OBJ, STL, PLY, GLB and glTF are read.",
    ),
    KnownError(
        ARGUMENTS,
        "An object is neither a shape nor a file",
        InputError,
        r"^object '.*': neither a known shape nor a file that exists",
        "object 'blob:1': neither a known shape nor a file that exists; allowed: sphere:R, cylinder:R,L, ...",
        "The name of the shape is misspelt, or the mesh file is not there.",
        "Lengths in these words are metres: `sphere:0.01` has a radius of 10 mm.",
    ),
    KnownError(
        ARGUMENTS,
        "A load is out of reach",
        InputError,
        r"N is out of reach: pressed through the skin, the objects carry ",
        "--load 100000 N is out of reach: pressed through the skin, the objects carry 309 N: sphere:0.01 is 20 x 20 x 20 mm",
        "Even at full depth the skin under this object does not carry the load. Often a mesh in millimetres was read as metres.",
        "Reduce the load, or check `--scale`. A batch does not stop: `ground_truth.load_reached` marks such instances.",
    ),
    KnownError(
        ARGUMENTS,
        "A quaternion is not a rotation",
        InputError,
        r"^rotation of instance \d+: a quaternion of length .+ is not allowed: 1",
        "rotation of instance 0: a quaternion of length 0.000000 is not allowed: 1",
        "The array of poses has zeros in columns 3 to 6.",
        "The identity is (1, 0, 0, 0): quaternions are (w, x, y, z); those of ROS and SciPy are (x, y, z, w).",
    ),
    KnownError(
        ARGUMENTS,
        "An array has another shape",
        InputError,
        r": shape \(.*\) is not allowed: ",
        "poses: shape (3, 7) is not allowed: (N, 7) = (4, 7) or (N, 4, 4) = (4, 4, 4)",
        "The first axis of every array is the batch.",
        "Give one row per instance.",
    ),
    KnownError(
        ARGUMENTS,
        "A number is not finite",
        InputError,
        r" of instance \d+ is not finite",
        "poses: nan of instance 0 is not finite",
        "A computation before this call gave NaN or an infinity.",
        "`error.instance` is the index of the instance.",
    ),
    KnownError(
        ARGUMENTS,
        "An argument is unknown",
        ArgumentError,
        r"^\w+\(\): unknown argument \w+",
        "Sphere(): unknown argument radiu: did you mean radius?",
        "The keyword is misspelt, or belongs to another function.",
        "`help()` of the function lists its arguments.",
    ),
    KnownError(
        ARGUMENTS,
        "An output was not requested",
        InputError,
        r" needs a simulator with outputs\.\w+: true",
        "vjp() needs a simulator with outputs.vjp: true",
        "Optional outputs cost time, so a simulator computes those that were asked for.",
        "`Simulator(model, N, outputs=taxelsim.OutputOptions(vjp=True))`.",
    ),
    KnownError(
        DEVICES,
        "There is no Vulkan device",
        DeviceError,
        r"^no Vulkan 1\.2 device with a compute queue",
        "no Vulkan 1.2 device with a compute queue; install a driver (apt-get install mesa-vulkan-drivers has one for CPUs)",
        "No Vulkan driver is installed, or VK_ICD_FILENAMES names a file that is not there.",
        "Install the vendor's driver, or `mesa-vulkan-drivers` for processors. Containers need the GPU and its driver passed in.",
    ),
    KnownError(
        DEVICES,
        "No device has this name",
        DeviceError,
        r'no device matches ".*"; allowed are ',
        'device: no device matches "nosuch"; allowed are gpu, discrete, integrated, cpu, an index, or part of a name of Vulkan\'s devices',
        "`--device` or TAXELSIM_DEVICE names a device that Vulkan does not list.",
        "`taxelsim devices` lists them. A GPU that is missing there needs its vendor's Vulkan driver.",
    ),
    KnownError(
        DEVICES,
        "A batch does not fit",
        InputError,
        r"^a batch of \d+ instances of \d+ bytes does not fit into device ",
        'a batch of 1000000000 instances of 2416 bytes does not fit into device "llvmpipe": at most 199728 do',
        "The arrays of the batch need more memory than the device gives to one buffer or in all.",
        "Use at most the number that the message names; `taxelsim devices --plan SCENE` says what a scene needs.",
    ),
    KnownError(
        DEVICES,
        "The device has no memory left",
        DeviceError,
        r"^out of memory: |^the device has no memory for buffer ",
        'the device has no memory for buffer "tactile_image"',
        "Other programs hold memory of the device, or the batch is too large.",
        "Reduce the batch, or end the other programs.",
    ),
    KnownError(
        DEVICES,
        "The device was lost",
        DeviceError,
        r"^the device was lost during ",
        "the device was lost during a step",
        "The driver reset the GPU, for example because a dispatch took longer than its time limit.",
        "Run the command again: `generate` resumes. If it happens again, reduce the batch, and look at the log of the driver.",
    ),
    KnownError(
        DEVICES,
        "A device does not survive fork()",
        DeviceError,
        r"^this device belongs to the parent process",
        "this device belongs to the parent process: a device does not survive fork(); open it in the child process",
        "A process that was forked uses a device of its parent.",
        'Start processes with `multiprocessing.get_context("spawn")`, and open the device in each.',
    ),
    KnownError(
        DATA_SETS,
        "A shard was changed",
        InputError,
        r": its SHA-256 is [0-9a-f]{64}, not [0-9a-f]{64}",
        "out/shard-000000.h5: its SHA-256 is 6f06dc13..., not 9a188a51... as in shard-000000.h5.sha256: the file was changed",
        "A disk, a copy or a program changed bytes of the file.",
        "Copy it again, or make it again: `taxelsim generate SCENE -o out --repair`.",
    ),
    KnownError(
        DATA_SETS,
        "A folder holds another data set",
        InputError,
        r": holds a data set (with another|of) ",
        "out: holds a data set with another number of episodes per shard (4096 there, 256 requested): choose another directory",
        "The scene, its seed or the device's values differ from those with which the data set was begun.",
        "Take another folder, or generate with the scene that is in `dataset.yaml`.",
    ),
    KnownError(
        DATA_SETS,
        "A folder is no data set",
        InputError,
        r": no data set: it has no dataset\.yaml",
        "out: no data set: it has no dataset.yaml",
        "The path is wrong, or the folder holds another kind of file.",
        "Name the folder that `generate` was given.",
    ),
    KnownError(
        DATA_SETS,
        "A column is not there",
        InputError,
        r": no column '.*'",
        "out: no column 'data/nosuch'; did you mean 'data/pose'?",
        "The scene did not record it.",
        "`taxelsim inspect` lists the columns; the key `record` of a scene chooses them.",
    ),
    KnownError(
        DATA_SETS,
        "An index is outside",
        OutOfRangeError,
        r": \w+: -?\d+ is not allowed: -\d+ to \d+",
        "out: episode: 99 is not allowed: -8 to 7",
        "The data set has fewer episodes or frames.",
        "`data.num_episodes` and `data.num_frames` say how many.",
    ),
    KnownError(
        DATA_SETS,
        "The file system refused",
        IoError,
        r"^cannot (write|create|read|open) |: (No such file or directory|Permission denied|No space left on device|Not a directory)$",
        "cannot write out.png: its folder does not exist",
        "A folder is missing, the disk is full, or the user may not write there.",
        "The message has the reason of the operating system. Nothing is half-written: a file is whole, or absent.",
    ),
)


def known_error(message: str) -> KnownError | None:
    """The kind of an error by its message; None if it is not listed. The list goes from general to special."""
    return next((error for error in reversed(ERRORS) if re.search(error.pattern, message)), None)
