#!/usr/bin/env python3
"""Runs the templates in deploy/ under a scheduler that kills workers, and compares the data set with that of one process.

    fake_scheduler.py TAXELSIM

Stands for Slurm (`sbatch` arrays, `scontrol requeue`) and for the Job controller of Kubernetes (indices, exit codes, tries per index). A
worker that is to be lost is killed with SIGKILL, with all its children, once it has claimed a shard.
"""

import os
import pathlib
import re
import signal
import subprocess
import sys
import tempfile
import time

import yaml

from balls_scene import ROOT, balls_scene

DEPLOY = ROOT / "deploy"
PARTS = 2
EPISODES = 24
TIMEOUT = 300  # s, of one worker
SCENE = balls_scene(EPISODES, 4, "tactile_image")


def files_of(folder):
    return {file.name: file.read_bytes() for file in folder.iterdir()}


class Worker:
    """A process with its children, as a scheduler starts it."""

    def __init__(self, command, environment, out):
        self.out = out
        self.process = subprocess.Popen(command, env=os.environ | environment, start_new_session=True, stderr=subprocess.PIPE, text=True)

    def kill(self):
        """SIGKILL to all, once the worker writes. A worker that ends before that was not lost."""
        while self.process.poll() is None and not (self.out / ".claims").exists():
            time.sleep(0.001)
        try:
            os.killpg(self.process.pid, signal.SIGKILL)
        except ProcessLookupError:
            pass
        self.wait()

    def wait(self):
        _, self.errors = self.process.communicate(timeout=TIMEOUT)
        return self.process.returncode


class Slurm:
    def __init__(self, folder, program):
        self.folder = folder
        binaries = folder / "slurm"
        binaries.mkdir()
        (binaries / "taxelsim").symlink_to(program)
        self.requeued = folder / "requeued.txt"
        scontrol = binaries / "scontrol"
        scontrol.write_text(f'#!/bin/sh\necho "$@" >> {self.requeued}\n')
        scontrol.chmod(0o755)
        self.path = f"{binaries}:{os.environ['PATH']}"

    def start(self, script, out, scene, task=1, restarts=0):
        environment = {
            "PATH": self.path, "TAXELSIM_SCENE": str(scene), "TAXELSIM_OUT": str(out), "TAXELSIM_EPISODES": str(EPISODES),
            "TAXELSIM_PARTS": str(PARTS), "TAXELSIM_BACKOFF_SECONDS": "0", "SLURM_ARRAY_JOB_ID": "7", "SLURM_ARRAY_TASK_ID": str(task),
            "SLURM_RESTART_COUNT": str(restarts),
        }  # fmt: skip
        return Worker(["bash", str(DEPLOY / "slurm" / script)], environment, out)

    def requests(self):
        return self.requeued.read_text().splitlines() if self.requeued.exists() else []


def check_slurm(folder, program, scene, expected):
    options = dict(re.findall(r"^#SBATCH --([\w-]+)(?:=(\S+))?", (DEPLOY / "slurm/generate.sbatch").read_text(), re.MULTILINE))
    assert "requeue" in options and options["array"].startswith("1-") and options["signal"].startswith("B:TERM"), options

    slurm, out = Slurm(folder, program), folder / "out-slurm"
    lost = slurm.start("generate.sbatch", out, scene, task=1)
    lost.kill()  # with its node: Slurm itself starts the task again
    workers = [slurm.start("generate.sbatch", out, scene, task, restarts=2 - task) for task in (1, 2)]
    for worker in workers:
        assert worker.wait() == 0, worker.errors
    assert slurm.requests() == [], "a complete part is not requeued"
    finish = slurm.start("finish.sbatch", out, scene)
    assert finish.wait() == 0, finish.errors
    assert files_of(out) == expected

    bad = slurm.start("generate.sbatch", out, folder / "none.yaml")
    assert bad.wait() == 2 and slurm.requests() == [], bad.errors
    (folder / "file").touch()
    blocked = folder / "file" / "out"  # a directory that cannot be made: an error of the file system
    failed = slurm.start("generate.sbatch", blocked, scene, restarts=1)
    assert failed.wait() == 1 and slurm.requests() == ["requeue 7_1"], (failed.errors, slurm.requests())
    failed = slurm.start("generate.sbatch", blocked, scene, restarts=6)
    assert failed.wait() == 1 and len(slurm.requests()) == 1, "the number of restarts has a limit"


class Job:
    """A Job of Kubernetes: runs the command of its container, with /data and /scene in `folder`."""

    def __init__(self, manifest, folder, program):
        self.spec = yaml.safe_load((DEPLOY / "kubernetes" / manifest).read_text())["spec"]
        self.pod = self.spec["template"]["spec"]
        self.container = self.pod["containers"][0]
        self.folder = folder
        (folder / "bin").mkdir(exist_ok=True)
        if not (folder / "bin/taxelsim").exists():
            (folder / "bin/taxelsim").symlink_to(program)

    def start(self, index=0, **variables):
        environment = {variable["name"]: variable["value"] for variable in self.container.get("env", [])} | variables
        environment |= {"PATH": f"{self.folder}/bin:{os.environ['PATH']}", "JOB_COMPLETION_INDEX": str(index)}
        script = self.container["args"][0].replace("/data/", f"{self.folder}/").replace("/scene/", f"{self.folder}/")
        return Worker([*self.container["command"], script], environment, self.folder / "out")

    def action(self, status):
        """What podFailurePolicy says of an exit status."""
        for rule in self.spec["podFailurePolicy"]["rules"]:
            codes = rule.get("onExitCodes", {})
            if codes.get("containerName", self.container["name"]) == self.container["name"] and status in codes.get("values", []):
                return rule["action"]
        return "Count"


def check_kubernetes(folder, program, expected):
    job = Job("generate.yaml", folder, program)
    parts = next(int(variable["value"]) for variable in job.container["env"] if variable["name"] == "PARTS")
    assert job.spec["completionMode"] == "Indexed" and job.spec["completions"] == parts >= job.spec["parallelism"]
    assert job.pod["restartPolicy"] == "Never", "podFailurePolicy needs it"
    mounts = {mount["name"] for mount in job.container["volumeMounts"]}
    assert mounts == {volume["name"] for volume in job.pod["volumes"]}
    assert job.pod["securityContext"]["runAsNonRoot"] and job.container["securityContext"]["readOnlyRootFilesystem"]
    assert job.action(2) == "FailJob" and job.action(1) == "Count" and job.action(137) == "Count"

    small = {"PARTS": str(PARTS), "EPISODES": str(EPISODES)}
    job.start(index=1, **small).kill()
    workers = [job.start(index, **small) for index in range(PARTS)]
    for worker in workers:
        assert worker.wait() == 0, worker.errors
    finish = Job("finish.yaml", folder, program).start()
    assert finish.wait() == 0, finish.errors
    assert files_of(folder / "out") == expected


def main():
    program = pathlib.Path(sys.argv[1]).resolve()
    with tempfile.TemporaryDirectory() as directory:
        folder = pathlib.Path(directory)
        scene = folder / "scene.yaml"
        scene.write_text(SCENE)
        one = [str(program), "generate", str(scene), "-o", str(folder / "one")]
        subprocess.run(one, check=True, capture_output=True)
        expected = files_of(folder / "one")
        check_slurm(folder, program, scene, expected)
        check_kubernetes(folder, program, expected)
    print("Slurm and Kubernetes: the bytes of one process")


if __name__ == "__main__":
    main()
