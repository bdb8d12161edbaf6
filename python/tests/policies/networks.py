"""ONNX files of small networks."""

from pathlib import Path

import numpy as np
import onnx
from onnx import TensorProto, helper, numpy_helper


def _constant(name: str, values: np.ndarray) -> onnx.TensorProto:
    return numpy_helper.from_array(values.astype(np.float32), name)


def write_mlp(
    file: Path,
    num_inputs: int = 6,
    num_actions: int = 6,
    *,
    batch: str | int = "batch",
    mix_rows: bool = False,
    settings: dict[str, str] | None = None,
) -> Path:
    """A network of two layers, with fixed random weights. mix_rows: subtracts the mean of the batch, so rows depend on each other."""
    random = np.random.default_rng(3)
    nodes = [
        helper.make_node("Gemm", ["obs", "w1", "b1"], ["h1"]),
        helper.make_node("Tanh", ["h1"], ["h2"]),
        helper.make_node("Gemm", ["h2", "w2", "b2"], ["h3"]),
        helper.make_node("Tanh", ["h3"], ["actions"]),
    ]
    if mix_rows:
        nodes.insert(0, helper.make_node("ReduceMean", ["obs"], ["mean"], axes=[0], keepdims=1))
        nodes.insert(1, helper.make_node("Sub", ["obs", "mean"], ["centred"]))
        nodes[2].input[0] = "centred"
    weights = [
        _constant("w1", random.normal(size=(num_inputs, 16))),
        _constant("b1", random.normal(size=16)),
        _constant("w2", 0.1 * random.normal(size=(16, num_actions))),
        _constant("b2", np.zeros(num_actions)),
    ]
    graph = helper.make_graph(
        nodes,
        "mlp",
        [helper.make_tensor_value_info("obs", TensorProto.FLOAT, [batch, num_inputs])],
        [helper.make_tensor_value_info("actions", TensorProto.FLOAT, [batch, num_actions])],
        weights,
    )
    model = helper.make_model(graph, opset_imports=[helper.make_opsetid("", 17)], ir_version=8)
    helper.set_model_props(model, {f"taxelsim.{name}": value for name, value in (settings or {}).items()})
    onnx.save(model, file)
    return file
