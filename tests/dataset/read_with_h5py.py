"""Reads a data set with h5py and prints its content as JSON. Used by h5py_test.cpp."""

import glob
import hashlib
import json
import os
import sys

import h5py
import numpy as np


def plain(value):
    """An attribute as plain Python: whole numbers and decoded texts."""
    if isinstance(value, np.ndarray):
        return [plain(item) for item in value]
    return int(value) if isinstance(value, np.integer) else value.decode() if isinstance(value, bytes) else value


def attributes(node):
    return {key: plain(value) for key, value in node.attrs.items()}


def variable_lengths(file):
    """Paths of texts of variable length among attributes and values."""
    found = []

    def visit(path, node):
        found.extend(f"{path}@{key}" for key in node.attrs if node.attrs.get_id(key).get_type().get_class() == h5py.h5t.STRING
                     and node.attrs.get_id(key).get_type().is_variable_str())
        if isinstance(node, h5py.Dataset) and h5py.check_string_dtype(node.dtype) and h5py.check_string_dtype(node.dtype).length is None:
            found.append(path)

    visit("/", file)
    file.visititems(visit)
    return found


def digest(array):
    return hashlib.sha256(np.ascontiguousarray(array).tobytes()).hexdigest()


def main(directory):
    shards = [h5py.File(name, "r") for name in sorted(glob.glob(os.path.join(directory, "shard-*.h5")))]
    view = h5py.File(os.path.join(directory, "dataset.h5"), "r")
    names = []
    view.visititems(lambda name, node: names.append(name) if isinstance(node, h5py.Dataset) else None)
    columns = {}
    for name in names:
        values = view[name][...]
        parts = [shard[name][...] for shard in shards]
        columns[name] = {
            "type": str(values.dtype),
            "shape": values.shape,
            "unit": plain(view[name].attrs["unit"]),
            "description": plain(view[name].attrs["description"]),
            "value_names": plain(view[name].attrs.get("value_names", np.array([]))),
            "bit_names": plain(view[name].attrs.get("bit_names", np.array([]))),
            "view": digest(values),
            "concatenated": digest(np.concatenate(parts)),
            "hashes_match": all(digest(part) == plain(shard[name].attrs["sha256"]) for shard, part in zip(shards, parts)),
            "compressed": shards[0][name].compression == "gzip",
        }
        if values.dtype.kind == "S":
            columns[name]["texts"] = [text.decode() for text in values]
        else:
            columns[name]["sum"] = float(np.sum(values, dtype=np.float64))
        if name == "meta/episode_ends":
            columns[name]["values"] = values.tolist()
    print(json.dumps({"attributes": attributes(view), "shards": [attributes(shard) for shard in shards], "columns": columns,
                      "variable_length": [path for file in [view, *shards] for path in variable_lengths(file)]}))


main(sys.argv[1])
