"""Evaluates a policy in an ONNX file, with a controller of the scene as the control arm. Needs onnx and onnxruntime.

python3 examples/evaluate_onnx.py [SCENE] [FILE] [NUM_EPISODES]

Without a file it writes the smallest one: a layer of weights that moves the sensor towards the centre of pressure.
The same from the command line: python3 -m taxelsim evaluate SCENE --policy FILE --controller p
"""

import sys
import tempfile
from pathlib import Path

import numpy as np
import onnx
from onnx import TensorProto, helper, numpy_helper

import taxelsim
from taxelsim.policies import wilson_interval

GAIN = 15  # 1/s
LIMIT = 0.08  # m/s, action 1


def write_tracker(file: Path) -> None:
    """Observation `contact` (6): centre of pressure, m, then force. Actions v_x, v_y in units of LIMIT."""
    weights = np.zeros((6, 2), np.float32)
    weights[0, 0] = weights[1, 1] = GAIN / LIMIT
    graph = helper.make_graph(
        [helper.make_node("MatMul", ["contact", "weights"], ["actions"])],
        "tracker",
        [helper.make_tensor_value_info("contact", TensorProto.FLOAT, ["batch", 6])],
        [helper.make_tensor_value_info("actions", TensorProto.FLOAT, ["batch", 2])],
        [numpy_helper.from_array(weights, "weights")],
    )
    model = helper.make_model(graph, opset_imports=[helper.make_opsetid("", 17)], ir_version=8)
    settings = {"observations": "contact", "actions": "v_x,v_y", "linear_scale": str(LIMIT)}
    helper.set_model_props(model, {f"taxelsim.{name}": value for name, value in settings.items()})
    onnx.save(model, file)


def main() -> None:
    arguments = sys.argv[1:]
    scene_file = arguments[0] if arguments else taxelsim.SCENES / "benchmark/roll_track.yaml"
    file = Path(arguments[1]) if len(arguments) > 1 else Path(tempfile.mkdtemp()) / "tracker.onnx"
    if len(arguments) < 2:
        write_tracker(file)
    scene = taxelsim.load_scene(scene_file, num_episodes=int(arguments[2]) if len(arguments) > 2 else 400)
    for evaluation in taxelsim.evaluate(scene, [scene.controllers[-1]], policy=file):
        success = evaluation.verdicts["success"]
        low, high = wilson_interval(int(success.sum()), len(success))
        print(f"{evaluation.controller:16s} {success.mean():6.1%} of {len(success)} episodes ({low:.1%} to {high:.1%})")


if __name__ == "__main__":
    main()
