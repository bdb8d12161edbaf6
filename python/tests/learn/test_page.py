"""Tables and sentences of docs/notes/benchmark.md."""

import json
from pathlib import Path

import numpy as np
import pytest

from taxelsim.policies import compare, wilson_interval

ROOT = Path(__file__).resolve().parents[3]
NUM_EPISODES = 200


@pytest.fixture
def learn_page():
    from learn import page

    return page


def result(num_successes: int, controller: str = "policy") -> dict:
    return {
        "controller": controller,
        "num_episodes": NUM_EPISODES,
        "num_lost": 3,
        "peak_force": 4.25,
        "steady_errors": {"edge_angle": np.pi / 90, "total_force": 0.125},
        "successes": "1" * num_successes + "0" * (NUM_EPISODES - num_successes),
    }


def evaluations(servo: int, clone: int, ppo: int, blind: int) -> dict:
    """The same successes under all conditions."""
    row = {"servo": result(servo, "window"), "clone": result(clone), "ppo": result(ppo), "blind": result(blind)}
    return dict.fromkeys(("nominal", "randomized", "unseen"), row)


def test_a_rate_has_its_wilson_interval(learn_page):
    low, high = wilson_interval(50, NUM_EPISODES)
    assert learn_page.rate_cell(result(50)) == f"25.0 ({100 * low:.1f} to {100 * high:.1f})"


def test_a_difference_is_bold_where_the_interval_excludes_zero(learn_page):
    def cell(first: int, second: int) -> str:
        return learn_page.difference_cell(compare("a", np.arange(NUM_EPISODES) < first, "b", np.arange(NUM_EPISODES) < second))

    assert cell(120, 60).startswith("**+30.0 (")
    assert cell(60, 120).startswith("**-30.0 (")
    assert cell(60, 60).startswith("+0.0 (-")


def test_rates_are_policies_by_conditions(learn_page):
    lines = learn_page.rates(evaluations(100, 120, 80, 0)).splitlines()
    assert lines[0] == "| policy | `nominal` | `randomized` | `unseen` |"
    assert [line.split(" | ")[0] for line in lines[2:]] == ["| scripted servo", "| behaviour cloning", "| PPO", "| blind PPO"]
    assert {line.count("|") for line in lines} == {5}


def test_measures_are_in_the_units_of_the_tasks(learn_page):
    lines = learn_page.measures(evaluations(100, 120, 80, 0)).splitlines()
    assert lines[0] == "| condition | policy | edge angle, deg | total force, N | peak force, N | lost contact |"
    assert lines[2] == "| `nominal` | scripted servo | 2.00 | 0.12 | 4.2 | 3 |"


def test_findings_name_the_policies_that_are_better(learn_page):
    lines = learn_page.findings("EdgeAlign", evaluations(100, 140, 20, 0))
    assert lines[0] == "- `EdgeAlign`, `randomized`: behaviour cloning and PPO beat the blind PPO."
    assert lines[2] == "- `EdgeAlign`, `unseen`: behaviour cloning beats the scripted servo."
    assert lines[3] == "- `EdgeAlign`, `randomized`: behaviour cloning beats the scripted servo."
    assert learn_page.findings("EdgeAlign", evaluations(100, 100, 20, 0))[2].endswith("no learned policy beats the scripted servo.")


def test_the_page_is_that_of_the_committed_results(learn_page):
    from learn.__main__ import page_text

    assert (ROOT / "docs/notes/benchmark.md").read_text() == page_text()


def test_committed_results_are_complete(learn_page):
    files = sorted((ROOT / "bench/results").glob("learn-*.json"))
    assert files
    for file in files:
        content = json.loads(file.read_text())
        for condition in ("nominal", "randomized", "unseen"):
            policies = content["evaluations"][condition]
            assert list(policies) == ["servo", "clone", "ppo", "blind"]
            assert {len(entry["successes"]) for entry in policies.values()} == {entry["num_episodes"] for entry in policies.values()}
            assert min(entry["num_episodes"] for entry in policies.values()) >= 1000


@pytest.fixture
def dynamics():
    from learn import dynamics

    return dynamics


def scripted(shear: int, normal: int, blind: int) -> dict:
    row = {"shear": result(shear), "normal": result(normal), "blind": result(blind)}
    return {"Push": dict.fromkeys(("nominal", "randomized", "unseen"), row)}


def test_scripts_of_the_tasks_with_dynamics_are_rows(learn_page, dynamics):
    lines = dynamics.rates(scripted(150, 100, 0)).splitlines()
    assert lines[0] == "| task | script | `nominal` | `randomized` | `unseen` |"
    assert lines[3] == f"| `Push` | without shear | {' | '.join([learn_page.rate_cell(result(100))] * 3)} |"
    assert [line.split(" | ")[1] for line in lines[2:]] == ["with touch", "without shear", "blind"]


def test_differences_are_those_of_the_script_with_touch(dynamics):
    lines = dynamics.differences(scripted(150, 100, 150)).splitlines()
    assert lines[2].startswith("| `Push` | with touch - without shear | **+25.0 (")
    assert lines[3].startswith("| `Push` | with touch - blind | +0.0 (")


def test_committed_results_of_dynamics_are_complete(dynamics):
    content = json.loads((ROOT / "bench/results/dynamics.json").read_text())
    assert list(content["evaluations"]) == ["Push", "Roll", "GraspHold", "PegInsert"]
    for task in content["evaluations"].values():
        assert list(task) == ["nominal", "randomized", "unseen"]
        for scripts in task.values():
            assert list(scripts) == list(dynamics.SCRIPTS)
            assert {len(entry["successes"]) for entry in scripts.values()} == {content["episodes"]}
    assert content["episodes"] >= 100


def test_policies_are_compared_with_the_script_and_with_each_other(dynamics):
    lines = dynamics.trained_differences(scripted(150, 100, 50), scripted(90, 100, 0)).splitlines()
    assert lines[2].startswith("| `Push` | PPO with touch - the script with touch | **+30.0 (")
    assert lines[3].startswith("| `Push` | PPO with touch - PPO without shear | **+25.0 (")
    assert lines[4].startswith("| `Push` | PPO with touch - blind PPO | **+50.0 (")


def test_findings_about_ppo_name_the_conditions(dynamics):
    trained, scripts = scripted(100, 60, 100)["Push"], scripted(150, 100, 0)
    trained["unseen"] = {"shear": result(20), "normal": result(60), "blind": result(20)}
    assert dynamics.trained_findings({"Push": [trained]}, scripts) == (
        "- `Push`: PPO with touch is worse than the script with touch under `nominal`, `randomized`, `unseen`; better than PPO "
        "without shear under `nominal`, `randomized`; worse than PPO without shear under `unseen`; not shown to differ from blind PPO."
    )


def test_findings_about_ppo_are_those_of_all_trainings(dynamics):
    first, second = scripted(100, 60, 0)["Push"], scripted(60, 60, 0)["Push"]
    assert dynamics.trained_findings({"Push": [first, second]}, scripted(150, 100, 0)) == (
        "- `Push`: PPO with touch is in each of 2 trainings worse than the script with touch under `nominal`, `randomized`, `unseen`; "
        "not shown to differ from PPO without shear; better than blind PPO under `nominal`, `randomized`, `unseen`."
    )


def test_committed_results_of_ppo_are_complete(dynamics):
    file = ROOT / "bench/results/dynamics-ppo.json"
    if not file.exists():
        pytest.skip("not trained")
    tasks, scripts = json.loads(file.read_text())["tasks"], json.loads((ROOT / "bench/results/dynamics.json").read_text())
    for content in [one for task in tasks.values() for one in (task, *task.get("repetitions", {}).values())]:
        assert (content["seed"], content["episodes"]) == (scripts["seed"], scripts["episodes"])
        assert list(content["evaluations"]) == ["nominal", "randomized", "unseen"]
        assert list(content["trainings"]) == list(dynamics.SCRIPTS)
        for policies in content["evaluations"].values():
            assert list(policies) == list(dynamics.SCRIPTS)
            assert {len(entry["successes"]) for entry in policies.values()} == {content["episodes"]}


def test_controls_are_compared_with_contact_and_shear(learn_page):
    from learn import controls

    senses = {sense: {**result(n), "mean_force": 1.125} for sense, n in zip(controls.POLICIES, (150, 100, 150, 90, 0), strict=True)}
    one = {"evaluations": dict.fromkeys(("nominal", "randomized", "unseen"), senses)}
    lines = controls.rates({"GraspHold": one}).splitlines()
    assert [line.split(" | ")[1] for line in lines[2:]] == list(controls.POLICIES.values())
    assert lines[4] == f"| `GraspHold` | centre of pressure | {' | '.join([learn_page.rate_cell(result(150))] * 3)} |"
    lines = controls.differences({"GraspHold": one}).splitlines()
    assert lines[2].startswith("| `GraspHold` | contact and shear - raw image | **+25.0 (")
    assert lines[3].startswith("| `GraspHold` | contact and shear - centre of pressure | +0.0 (")
    assert (
        controls.forces({"GraspHold": one}).splitlines()[2] == "| `GraspHold` | contact and shear | 4.25, 1.12 | 4.25, 1.12 | 4.25, 1.12 |"
    )
    assert controls.section({}, "notes") == ""
