"""Evaluates a policy in an ONNX file, with a controller of the scene as the control arm.

Without a file it writes the smallest policy: a layer of weights that moves the sensor towards the centre of pressure of a rolling ball.
Prints the success rate of both, with the 95 % interval. The same: python3 -m taxelsim evaluate SCENE --policy FILE --controller p

python3 examples/evaluate_onnx.py [PICTURE] [SCENE] [FILE] [NUM_EPISODES]    needs onnx and onnxruntime
"""

import sys
import tempfile
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
import onnx
from onnx import TensorProto, helper, numpy_helper

import taxelsim
from taxelsim.pictures import colour_map, save_figure
from taxelsim.policies import wilson_interval

GAIN, LIMIT = 15, 0.08  # 1/s; m/s, action 1


def write_tracker(file: Path) -> None:
    """Observation `contact` (6): centre of pressure, m, then force. Actions v_x, v_y in units of LIMIT."""
    weights = np.zeros((6, 2), np.float32)
    weights[0, 0] = weights[1, 1] = GAIN / LIMIT
    layer = helper.make_node("MatMul", ["contact", "weights"], ["actions"])
    inputs = [helper.make_tensor_value_info("contact", TensorProto.FLOAT, ["batch", 6])]
    outputs = [helper.make_tensor_value_info("actions", TensorProto.FLOAT, ["batch", 2])]
    graph = helper.make_graph([layer], "tracker", inputs, outputs, [numpy_helper.from_array(weights, "weights")])
    model = helper.make_model(graph, opset_imports=[helper.make_opsetid("", 17)], ir_version=8)
    settings = {"observations": "contact", "actions": "v_x,v_y", "linear_scale": str(LIMIT)}
    helper.set_model_props(model, {f"taxelsim.{name}": value for name, value in settings.items()})
    onnx.save(model, file)


def main() -> None:
    picture, scene_file, file, count = (*sys.argv[1:], *("evaluate_onnx.png", "", "", "400")[len(sys.argv) - 1 :])
    scene = taxelsim.load_scene(scene_file or taxelsim.SCENES / "benchmark/roll_track.yaml", num_episodes=int(count))
    if not file:
        file = Path(tempfile.mkdtemp()) / "tracker.onnx"
        write_tracker(file)
    plt.rcParams.update({"font.size": 15, "lines.linewidth": 3})
    figure, axes = plt.subplots(figsize=(12, 4), layout="constrained")
    for evaluation in taxelsim.evaluate(scene, [scene.controllers[-1]], policy=file):
        success = evaluation.verdicts["success"]
        low, high = wilson_interval(int(success.sum()), len(success))
        print(f"{evaluation.controller:16s} {success.mean():6.1%} of {len(success)} episodes ({low:.1%} to {high:.1%})")
        axes.barh(evaluation.controller, 100 * success.mean(), color=colour_map()(0.45))
        axes.plot([100 * low, 100 * high], [evaluation.controller] * 2, color="black", marker="|", markersize=20)
    axes.set(xlabel=f"success (%) in {count} episodes of {scene.name}, with 95 % interval", xlim=(0, 100))
    save_figure(picture, figure)


if __name__ == "__main__":
    main()
