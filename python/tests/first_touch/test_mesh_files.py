"""Mesh files that are damaged or large."""

import itertools
import json
import os
import struct
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import taxelsim
import taxelsim.envs
import taxelsim.mujoco

from .tools import press, write_cube

CUBE = np.array(list(itertools.product((0, 0.01), repeat=3)), np.float32)
FACES = np.array(
    [[0, 1, 3], [0, 3, 2], [4, 6, 7], [4, 7, 5], [0, 4, 5], [0, 5, 1], [2, 3, 7], [2, 7, 6], [0, 2, 6], [0, 6, 4], [1, 5, 7], [1, 7, 3]]
)


def cube_json() -> dict[str, Any]:
    """glTF of a cube with sides of 10 mm."""
    return {
        "asset": {"version": "2.0"},
        "scene": 0,
        "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
        "accessors": [
            {"bufferView": 0, "componentType": 5126, "count": 8, "type": "VEC3"},
            {"bufferView": 1, "componentType": 5123, "count": 36, "type": "SCALAR"},
        ],
        "bufferViews": [{"buffer": 0, "byteLength": 96}, {"buffer": 0, "byteOffset": 96, "byteLength": 72}],
        "buffers": [{"byteLength": 168}],
    }


def write_glb(file: Path, text: str, buffer: bytes = CUBE.tobytes() + FACES.astype(np.uint16).tobytes()) -> Path:
    content = text.encode()
    content += b" " * (-len(content) % 4)
    chunks = [struct.pack("<I4s", len(chunk), kind) + chunk for kind, chunk in ((b"JSON", content), (b"BIN\0", buffer))]
    file.write_bytes(struct.pack("<4sII", b"glTF", 2, 12 + sum(map(len, chunks))) + b"".join(chunks))
    return file


def test_a_whole_cube_is_read(tmp_path):
    mesh = taxelsim.load_mesh(write_glb(tmp_path / "cube.glb", json.dumps(cube_json())))
    assert sorted(map(tuple, mesh.vertices)) == sorted(map(tuple, CUBE))
    assert len(mesh.triangles) == 12


FAR = {"bufferView": 0, "byteOffset": 1 << 31}
REFUSED_GLTF = {
    "sparse": ({"accessors.0.sparse": {"count": 2, "indices": {**FAR, "componentType": 5123}, "values": FAR}}, "accessors[0].sparse: "),
    "short joints": (
        {"accessors.2": {"count": 2, "componentType": 5121, "type": "VEC4"}, "meshes.0.primitives.0.attributes.JOINTS_0": 2},
        "accessors[2].count: 2 is not allowed: 8, the count of meshes[0].primitives[0].attributes.POSITION",
    ),
    "VEC2": ({"accessors.0.type": "VEC2"}, 'accessors[0].type: "VEC2" is not allowed: VEC3 for POSITION'),
    "BYTE": ({"accessors.1.componentType": 5120}, "accessors[1].componentType: 5120 is not allowed: 5121, 5123 or 5125 for indices"),
    "extension": ({"extensionsRequired": ["EXT_other"]}, "it requires the extension EXT_other, which is not read"),
    "offset": ({"bufferViews.1.byteOffset": 97}, "bufferViews[1].byteLength: 72 is not allowed: a whole number up to 71"),
    "wrap": ({"accessors.0.byteOffset": (1 << 64) - 8}, "accessors[0].byteOffset: "),
    "index": ({"bufferViews.1.byteOffset": 0}, "meshes[0].primitives[0]: index "),
    "two parents": ({"scenes.0.nodes": [0, 0]}, "its nodes are not a tree"),
    "cycle": ({"nodes.0.children": [0]}, "its nodes are not a tree"),
    "other file": ({"buffers.0.uri": "/dev/zero"}, "which its SHA-256 does not cover"),
}


@pytest.mark.parametrize("name", REFUSED_GLTF)
def test_damaged_gltf_is_one_line(tmp_path, name):
    changes, message = REFUSED_GLTF[name]
    document = cube_json()
    for path, value in changes.items():
        *parents, key = path.split(".")
        item: Any = document
        for parent in parents:
            item = item[int(parent) if isinstance(item, list) else parent]
        if isinstance(item, list):
            item.insert(int(key), value)
        else:
            item[key] = value
    with pytest.raises(taxelsim.InputError) as refusal:
        taxelsim.load_mesh(write_glb(tmp_path / "cube.glb", json.dumps(document)))
    assert message in str(refusal.value)


def test_a_key_twice_is_refused_whichever_counts(tmp_path):
    chain = [{"children": [i, i]} for i in range(1, 31)] + [{"mesh": 0}]  # 2^30 nodes
    text = json.dumps(cube_json())
    for nodes in (json.dumps(chain), "[" + '{"children":[1]},' * 100_000 + "{}]"):
        for doubled in (f'{{"nodes":{nodes},{text[1:]}', f'{text[:-1]},"nodes":{nodes}}}'):
            with pytest.raises(taxelsim.InputError, match='its JSON has the key "nodes" twice in one object'):
                taxelsim.load_mesh(write_glb(tmp_path / "cube.glb", doubled))


def test_quantized_positions_are_read(tmp_path):
    document = cube_json()
    document["extensionsRequired"] = ["KHR_mesh_quantization"]
    document["accessors"][0] |= {"componentType": 5122, "normalized": True}
    document["nodes"][0]["scale"] = [0.02, 0.02, 0.02]
    document["bufferViews"] = [{"buffer": 0, "byteLength": 62, "byteStride": 8}, {"buffer": 0, "byteOffset": 64, "byteLength": 72}]
    document["buffers"][0]["byteLength"] = 136
    shorts = np.zeros((8, 4), np.int16)
    shorts[:, :3] = np.where(CUBE > 0, 16000, 0)
    file = write_glb(tmp_path / "cube.glb", json.dumps(document), shorts.tobytes() + FACES.astype(np.uint16).tobytes())
    np.testing.assert_allclose(np.ptp(taxelsim.load_mesh(file).vertices, axis=0), 0.02 * 16000 / 32767, rtol=1e-6)


def test_a_pipe_as_buffer_does_not_block(tmp_path):
    os.mkfifo(tmp_path / "pipe")
    document = cube_json()
    document["buffers"][0]["uri"] = "pipe"
    file = tmp_path / "cube.gltf"
    file.write_text(json.dumps(document))
    assert 'buffers[0].uri: "pipe": not a regular file' in press(file).stderr


def test_a_byte_order_mark_is_no_part_of_a_mesh(tmp_path):
    file = write_cube(tmp_path / "cube.obj", 0.01)
    plain = taxelsim.load_mesh(file)
    file.write_bytes(b"\xef\xbb\xbf" + file.read_bytes())
    assert taxelsim.load_mesh(file) == plain


def test_a_hundred_thousand_parts_are_pressed_or_refused(tmp_path):
    document = cube_json()
    document["scenes"][0]["nodes"] = list(range(100_000))
    document["nodes"] = [{"mesh": 0, "translation": [0.02 * (i % 300), 0.02 * (i // 300), 0]} for i in range(100_000)]
    found = press(write_glb(tmp_path / "parts.glb", json.dumps(document)))
    assert found.returncode in (0, 2), found.stderr
