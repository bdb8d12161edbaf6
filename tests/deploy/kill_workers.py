#!/usr/bin/env python3
"""Kills workers that write one data set together, and compares the result with that of one process.

    kill_workers.py TAXELSIM [--kills N] [--seed S]

Rounds of workers with overlapping parts of one directory. SIGKILL, SIGTERM or SIGINT end a worker, or `finish`, at a random time; a worker
that was ended is started again. No file with its final name may differ at any time from that of one process; at the end of a round, when all
parts and `finish` have succeeded, all files must be equal. Neither the times nor the load of the machine decide whether it passes.
"""

import argparse
import collections
import pathlib
import random
import signal
import subprocess
import sys
import tempfile
import time

from balls_scene import balls_scene

EPISODES, EPISODES_PER_SHARD = 48, 2
CHOICES = (["--part", "1/3"], ["--part", "2/3"], ["--part", "3/3"], ["--shards", "5..18"])
SIGNALS = (signal.SIGKILL, signal.SIGTERM, signal.SIGINT)
STOPPED = 130  # exit status after SIGTERM and SIGINT: complete shards are kept
TIMEOUT = 300  # s, of one process
SCENE = balls_scene(EPISODES, EPISODES_PER_SHARD, "tactile_image, ground_truth")


def files_of(folder):
    """Files with their final names; a listing while others write can name a file that is gone."""
    files = {}
    for file in folder.iterdir() if folder.exists() else ():
        if not file.name.startswith(".") and ".tmp-" not in file.name:
            try:
                files[file.name] = file.read_bytes()
            except FileNotFoundError:
                pass
    return files


class Campaign:
    def __init__(self, program, folder, seed, max_kills):
        self.program, self.folder, self.max_kills = program, folder, max_kills
        self.random = random.Random(seed)
        self.kills = collections.Counter()  # by name of the signal, of processes that were alive
        self.midway = 0  # of these, ended by the signal
        self.scene = folder / "scene.yaml"
        self.scene.write_text(SCENE)
        begin = time.monotonic()
        self.wait(self.start("generate", str(self.scene), "-o", str(folder / "one")), {0})
        self.lifetime = time.monotonic() - begin
        self.expected = files_of(folder / "one")

    def start(self, *words):
        return subprocess.Popen([self.program, *words], stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)

    def worker(self, out, choice):
        return self.start("generate", str(self.scene), "-o", str(out), *choice, "--batch-size", "2")

    def wait(self, process, allowed):
        _, errors = process.communicate(timeout=TIMEOUT)
        assert process.returncode in allowed, f"status {process.returncode}: {errors}"
        return process.returncode

    def kill(self, process):
        """Sends a signal to a process that may have ended. Whether it must be started again."""
        chosen = self.random.choice(SIGNALS)
        if process.poll() is None:
            self.kills[chosen.name] += 1
            process.send_signal(chosen)
        status = self.wait(process, {0, STOPPED, -chosen})  # -signal: before it is handled
        self.midway += status != 0
        return status != 0

    def check(self, out):
        for name, content in files_of(out).items():
            assert content == self.expected[name], f"{out / name} differs after {self.kills}"

    def has_kills_left(self):
        return self.kills.total() < self.max_kills

    def run_round(self, number):
        out = self.folder / f"many-{number}"
        workers = [(choice, self.worker(out, choice)) for choice in CHOICES]
        while workers:
            choice, process = workers.pop(self.random.randrange(len(workers)))
            if self.has_kills_left():
                time.sleep(self.random.uniform(0, self.lifetime / 2))
                is_lost = self.kill(process)
            else:
                is_lost = self.wait(process, {0}) != 0
            self.check(out)
            if is_lost:
                workers.append((choice, self.worker(out, choice)))
        while self.has_kills_left():
            process = self.start("finish", str(out))
            time.sleep(self.random.uniform(0, self.lifetime / 4))
            if not self.kill(process):
                break
            self.check(out)
        self.wait(self.start("finish", str(out)), {0})
        assert {file.name: file.read_bytes() for file in out.iterdir()} == self.expected, "files differ at the end"


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("program", type=pathlib.Path)
    parser.add_argument("--kills", type=int, default=5)
    parser.add_argument("--seed", type=int, default=1)
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as directory:
        campaign = Campaign(str(options.program.resolve()), pathlib.Path(directory), options.seed, options.kills)
        rounds = 0
        while rounds == 0 or campaign.has_kills_left():
            rounds += 1
            campaign.run_round(rounds)
    counts = ", ".join(f"{count} {name}" for name, count in sorted(campaign.kills.items()))
    print(f"{campaign.kills.total()} signals ({counts}) in {rounds} data sets, {campaign.midway} ended a process: the bytes of one process")


if __name__ == "__main__":
    sys.exit(main())
