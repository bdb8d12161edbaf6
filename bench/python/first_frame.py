"""One side of rates.py: the frame that `taxelsim frame` computes. Its process is timed from start to end.

python first_frame.py SENSOR OBJECT LOAD
"""

import sys

import numpy as np

import taxelsim

sensor_file, object_file, load = sys.argv[1:]
shape = taxelsim.parse_object(object_file)
rotation = taxelsim.axis_angle((0, 0, 1), np.pi / 2)
pose = np.concatenate([[0, 0, 0], rotation])  # the load determines the height
model = taxelsim.Model(taxelsim.Device.open(), taxelsim.load_sensor(sensor_file), [shape])
simulator = taxelsim.Simulator(model)
simulator.set_objects(0, pose[np.newaxis])
simulator.set_loads(float(load))
simulator.step(0.001)
print(simulator.read().tactile_image)
