"""Explorations on Ray, with Optuna and as a Slurm array give the results of one machine."""

import json
import os
import pathlib
import signal
import subprocess
import sys
import threading
import time

import pytest

import shiftvox

ROOT = pathlib.Path(__file__).resolve().parents[2]
SPREAD = ROOT / "python" / "spread"
sys.path.insert(0, str(SPREAD))

SCENE = "gen:menger,depth=3"
SPACE = """hardware = ["light", "paper"]
[ranges]
contexts = [2, 4]
node_cache.bytes = [4096, 16384]
bits = [28, 32]
"""


@pytest.fixture
def space(tmp_path):
    path = tmp_path / "space.toml"
    path.write_text(SPACE)
    return str(path)


def front(lines):
    return [(p["point"], p["cycles"], p["energy_pj"]) for p in lines[-1]["front"]]


def kill_a_worker_that_has_written(folder, killed, ended):
    """Kills the first worker of Ray whose file has a point, unless all have ended."""
    while not ended.is_set():
        for file in folder.glob("*.jsonl"):
            if '"point"' in file.read_text():
                found = subprocess.run(["pgrep", "-f", "ray::measure"], capture_output=True, text=True)
                for process in found.stdout.split():
                    os.kill(int(process), signal.SIGKILL)
                    killed.append(process)
                    return
        time.sleep(0.005)


def test_a_cluster_of_two_workers_finds_the_same_front(tmp_path, space):
    ray = pytest.importorskip("ray")
    import ray_explore

    alone = shiftvox.explore(SCENE, space=space, size=128)
    assert len(front(alone)) > 1
    killed = []
    folder = tmp_path / "results"
    ended = threading.Event()
    watcher = threading.Thread(target=kill_a_worker_that_has_written, args=(folder, killed, ended))
    path = f"{SPREAD}:{os.environ.get('PYTHONPATH', '')}"
    ray.init(num_cpus=2, include_dashboard=False, runtime_env={"env_vars": {"PYTHONPATH": path}})
    try:
        watcher.start()
        # Eight points take a worker about a second, time enough to find and kill it.
        spread = ray_explore.explore(SCENE, folder, per_task=8, space=space, size=128)
    finally:
        ended.set()
        watcher.join()
        ray.shutdown()
    assert killed, "no worker was killed: the test is void"
    assert spread[1:] == alone[1:]
    lines = [json.loads(line) for file in folder.glob("*..*.jsonl") for line in file.read_text().splitlines()]
    points = sorted(line["point"] for line in lines if line["kind"] == "point")
    assert points == list(range(16))


def test_a_search_finds_designs_of_the_space(space):
    pytest.importorskip("optuna")
    import optuna_search

    axes = {"contexts": [2, 4], "node_cache.bytes": [4096, 16384], "bits": [28, 32]}
    study = optuna_search.search(SCENE, 30, space=axes, seed=1, size=32)
    whole = shiftvox.explore(SCENE, space=space, size=32)
    key = lambda values: (values["contexts"], values["node_cache.bytes"], values["bits"])
    light = {key(p["values"]): p for p in whole if p["kind"] == "point" and p["values"]["hardware"] == "light"}
    for trial in study.trials:
        point = light[key(trial.params)]
        assert trial.values[0] == point["time_ms"] and trial.values[2] == point["energy_pj"]
    seen = {key(trial.params) for trial in study.trials}
    figures = lambda p: (p["time_ms"], p["area_nand2"], p["energy_pj"], p["wrong_samples"])
    beats = lambda a, b: a != b and all(x <= y for x, y in zip(a, b))
    best = {k for k in seen if not any(beats(figures(light[o]), figures(light[k])) for o in seen)}
    assert {key(trial.params) for trial in study.best_trials} == best


# With 6 per task, the last task has 4 of the 16 points.
@pytest.mark.parametrize("per_task, tasks", [(8, 2), (6, 3)])
def test_an_array_of_slurm_is_one_exploration(tmp_path, space, per_task, tasks):
    program = ROOT / "target" / "release" / "shiftvox"
    if not program.exists():
        pytest.skip("no shiftvox in target: cargo build --release")
    folder = tmp_path / "out"
    env = {**os.environ, "PATH": f"{program.parent}:{os.environ['PATH']}"}
    env.update(SPACE=space, SIZE="32", PER_TASK=str(per_task))
    for task in range(tasks):
        task_env = {**env, "SLURM_ARRAY_TASK_ID": str(task)}
        # Twice, as after a requeue.
        for _ in range(2):
            subprocess.run(["sh", SPREAD / "explore.sbatch", SCENE, folder], check=True, env=task_env)
    files = list(folder.glob("*.jsonl"))
    assert {f.name for f in files} == {f"{task * per_task}.jsonl" for task in range(tasks)}
    together = tmp_path / "all.jsonl"
    together.write_text("".join(f.read_text() for f in files))
    written = together.read_text()
    spread = shiftvox.explore(SCENE, space=space, size=32, results=together)
    assert together.read_text() == written, "something was measured again"
    assert front(spread) == front(shiftvox.explore(SCENE, space=space, size=32))
