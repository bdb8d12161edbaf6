"""A scene whose shards take a fraction of a second."""

import pathlib

ROOT = pathlib.Path(__file__).resolve().parents[2]


def balls_scene(episodes, episodes_per_shard, record):
    """Text of the scene. record: words, separated by commas."""
    return f"""format_version: 1
name: balls
kind: contacts
sensor: {ROOT}/scenes/sensors/wts0614_soft_cover.yaml
objects: [{{sphere: {{radius_mm: 5}}}}]
randomization: {{load: [0.1, 1]}}
record: [{record}]
data_set: {{episodes: {episodes}, seed: 1, episodes_per_shard: {episodes_per_shard}}}
"""
