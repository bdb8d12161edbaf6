"""Rewrites all compressed data sets of a shard with HDF5's own filters, as earlier versions wrote them. Prints the number of chunks of the
original that skipped a filter. Used by h5py_test.cpp."""

import os
import sys

import h5py


def main(name):
    num_skipped = 0
    with h5py.File(name, "r") as old, h5py.File(name + ".new", "w", libver=("v108", "v108")) as new:
        for key, value in old.attrs.items():
            new.attrs.create(key, value, dtype=old.attrs.get_id(key).dtype)

        def copy(path, node):
            nonlocal num_skipped
            if not isinstance(node, h5py.Dataset):
                return
            if node.chunks:
                num_skipped += sum(node.id.get_chunk_info(k).filter_mask != 0 for k in range(node.id.get_num_chunks()))
            created = new.create_dataset(
                path,
                data=node[...],
                dtype=node.dtype,
                chunks=node.chunks,
                shuffle=node.shuffle,
                compression=node.compression,
                compression_opts=node.compression_opts,
            )
            for key, value in node.attrs.items():
                created.attrs.create(key, value, dtype=node.attrs.get_id(key).dtype)

        old.visititems(copy)
    os.rename(name + ".new", name)
    print(num_skipped)


main(sys.argv[1])
