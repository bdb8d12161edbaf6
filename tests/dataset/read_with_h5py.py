"""Reads a data set with h5py and prints its content as JSON. Used by h5py_test.cpp."""

import glob
import hashlib
import json
import os
import sys

import h5py
import numpy as np


def attributes(node):
    return {key: int(value) if isinstance(value, np.integer) else value for key, value in node.attrs.items()}


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
            "unit": view[name].attrs["unit"],
            "description": view[name].attrs["description"],
            "view": digest(values),
            "concatenated": digest(np.concatenate(parts)),
            "hashes_match": all(digest(part) == shard[name].attrs["sha256"] for shard, part in zip(shards, parts)),
            "compressed": shards[0][name].compression == "gzip",
            "sum": float(np.sum(values, dtype=np.float64)),
        }
        if name == "meta/episode_ends":
            columns[name]["values"] = values.tolist()
    print(json.dumps({"attributes": attributes(view), "shards": [attributes(shard) for shard in shards], "columns": columns}))


main(sys.argv[1])
