"""The package against the program's own pictures and figures."""

import json
import os
import subprocess
import threading
import time
from pathlib import Path

import numpy as np
import pytest

import shiftvox

ROOT = Path(__file__).resolve().parents[2]
TREE = ROOT / "assets" / "tree.vox"


def program():
    """The command line, where it is built."""
    for profile in ("release", "debug"):
        path = ROOT / "target" / profile / "shiftvox"
        if path.exists():
            return path
    pytest.skip("no shiftvox in target: cargo build --release")


def test_hash_is_that_of_the_command_line(tmp_path):
    drawn = subprocess.run(
        [program(), "render", TREE, "-o", tmp_path / "t.png", "--size", "200x120", "--json"],
        check=True,
        capture_output=True,
    )
    told = json.loads(drawn.stdout)
    picture = shiftvox.render(shiftvox.Scene.open(TREE), size=(200, 120))
    assert picture.hash in json.dumps(told)


def test_arrays_are_the_buffers():
    picture = shiftvox.render(shiftvox.Scene.generate("menger,depth=2"), size=(64, 48))
    assert picture.rgba.shape == (48, 64, 4) and picture.rgba.dtype == np.uint8
    assert picture.depth.shape == (48, 64) and picture.depth.dtype == np.float32
    assert picture.normals.shape == (48, 64, 3)
    assert picture.voxels.shape == (48, 64, 4) and picture.voxels.dtype == np.int32
    assert picture.nodes.shape == (48, 64)
    assert np.shares_memory(picture.depth, picture.depth)
    assert picture.rgba is picture.rgba
    # Not a copy: what is written is there when the picture is asked again.
    picture.depth[0, 0] = 7
    assert picture.depth[0, 0] == 7
    # Owned by the array that was moved in, not by a copy of it.
    assert picture.rgba.base is not None and picture.rgba.base.size == picture.rgba.size
    seen = picture.nodes >= 0
    assert seen.any() and not seen.all()
    assert np.isfinite(picture.depth[1:][seen[1:]]).all()
    assert np.allclose(np.linalg.norm(picture.normals[seen], axis=1), 1, atol=1e-3)
    assert (picture.voxels[~seen] == [0, 0, 0, -1]).all()


def test_engines_agree():
    scene = shiftvox.Scene.generate("terrain,depth=5,seed=3")
    camera = shiftvox.Camera.fit(scene, azimuth=30, elevation=20, zoom=1.5, fov=50)
    hashes = {shiftvox.render(scene, camera, 64, engine=e).hash for e in ("fast", "machine", "rays")}
    assert len(hashes) == 1
    assert shiftvox.render(scene, camera, 64, engine="machine", paper=True).hash not in hashes


def test_voxels_of_an_array():
    index = np.array([[0, 0, 0], [0, 1, 0]], dtype=np.int32)
    color = np.array([[255, 0, 0], [0, 0, 255]], dtype=np.uint8)
    scene = shiftvox.Scene.from_numpy(index, color)
    assert scene.voxels == 2
    camera = shiftvox.Camera.fit(scene, azimuth=0, elevation=0)
    picture = shiftvox.render(scene, camera, 33, shaded=False, transparent=True)
    assert picture.rgba[16, 16].tolist() == [255, 0, 0, 255]
    assert picture.rgba[0, 0, 3] == 0
    assert picture.voxels[16, 16, :3].tolist() == [0, 0, 0]
    # Rows that are not contiguous are read as they are.
    wide = np.zeros((2, 6), dtype=np.int32)
    wide[:, ::2] = index
    assert shiftvox.Scene.from_numpy(wide[:, ::2], color).voxels == 2


def test_a_mesh_of_arrays(tmp_path):
    positions = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], dtype=float)
    triangles = np.array([[0, 1, 2], [0, 1, 3], [0, 2, 3], [1, 2, 3]])
    colors = np.tile(np.array([[0, 200, 0]], dtype=np.uint8), (4, 1))
    scene = shiftvox.Scene.from_mesh(positions, triangles, colors, depth=5)
    assert scene.depth == 5 and scene.voxels > 500
    picture = shiftvox.render(scene, size=32, shaded=False)
    seen = picture.rgba[picture.nodes >= 0]
    assert len(seen) > 50 and (seen[:, 1] > 150).all() and (seen[:, 0] < 60).all()
    scene.save(tmp_path / "t.vxg")
    again = shiftvox.Scene.open(tmp_path / "t.vxg")
    assert shiftvox.render(again, size=32, shaded=False).hash == picture.hash
    with pytest.raises(shiftvox.Error, match="row 1 has a corner"):
        shiftvox.Scene.from_mesh(positions, np.array([[0, 1, 2], [0, 1, 4]]))


@pytest.mark.parametrize(
    "act, told",
    [
        (lambda: shiftvox.Scene.open("nowhere.vox"), "nowhere.vox"),
        (lambda: shiftvox.Scene.generate("nothing"), "nothing"),
        (lambda: shiftvox.Scene.from_numpy(np.zeros((3, 2), np.int32)), r"\(N, 3\)"),
        (lambda: shiftvox.Scene.from_numpy(np.zeros((0, 3), np.int32)), "voxel"),
        (lambda: shiftvox.Scene.from_numpy(np.zeros((3, 3), np.int32), np.zeros((2, 3), np.uint8)), "2 rows for 3"),
        (lambda: shiftvox.render(shiftvox.Scene.generate("menger,depth=1"), engine="gpu"), "none of fast, machine"),
        (lambda: shiftvox.render(shiftvox.Scene.generate("menger,depth=1"), samples=3), "1, 2 or 4"),
        (lambda: shiftvox.render(shiftvox.Scene.generate("menger,depth=1"), size="big"), "size"),
        (lambda: shiftvox.Scene.open(TREE, up="x"), "none of y, z"),
    ],
)
def test_what_is_refused(act, told):
    with pytest.raises(shiftvox.Error, match=told):
        act()


def test_other_threads_run_while_it_draws():
    scene = shiftvox.Scene.generate("menger,depth=3")
    done = threading.Event()
    ticks = 0

    def draw():
        shiftvox.render(scene, size=512, engine="machine", threads=1)
        done.set()

    thread = threading.Thread(target=draw)
    thread.start()
    while not done.is_set():
        ticks += 1
        time.sleep(0.001)
    thread.join()
    assert ticks > 10


def test_the_model_is_the_programs(tmp_path):
    ours = shiftvox.model("gen:menger,depth=2", size=32, hw="paper")
    command = [program(), "model", "gen:menger,depth=2", "--size", "32", "--hw", "paper", "--json"]
    theirs = json.loads(subprocess.run(command, check=True, capture_output=True).stdout)
    assert ours["simulated"]["cycles"]["cycles"] == theirs["simulated"]["cycles"]["cycles"] > 0
    assert ours["cost"] == theirs["cost"]
    # A scene that is in memory.
    scene = shiftvox.Scene.generate("menger,depth=2")
    assert shiftvox.model(scene, size=32, hw="paper")["record_bits"] == theirs["record_bits"]
    with pytest.raises(shiftvox.Error, match="nothing.toml") as refused:
        shiftvox.model(hw="nothing.toml")
    assert refused.value.exit_code == 4


def test_exploration_goes_on_where_it_stopped(tmp_path):
    results = tmp_path / "results.jsonl"
    first = shiftvox.explore("gen:menger,depth=2", size=16, points="0..3", results=results)
    points = [line for line in first if line["kind"] == "point"]
    assert [p["point"] for p in points] == [0, 1, 2, 3]
    written = results.read_text()
    both = shiftvox.explore("gen:menger,depth=2", size=16, points="0..5", results=results)
    assert results.read_text().startswith(written)
    assert [p for p in both if p["kind"] == "point"][:4] == points
    assert both[-1]["kind"] == "front" and both[-1]["front"]


def test_nothing_is_printed(capfd):
    shiftvox.run("info", "gen:menger,depth=1")
    shiftvox.run("bench error", "gen:menger,depth=1", size=16, runs=1, coverages=["exact"], bits=[64])
    assert capfd.readouterr().out == ""
    with pytest.raises(shiftvox.Error) as refused:
        shiftvox.run("model", nonsense=1)
    assert refused.value.exit_code == 2 and "--nonsense" in str(refused.value)
    assert capfd.readouterr().out == ""


@pytest.mark.parametrize("script", sorted(p.name for p in (ROOT / "python" / "examples").glob("*.py")))
def test_examples_run(script, tmp_path):
    path = ROOT / "python" / "examples" / script
    env = {**os.environ, "SHIFTVOX_ASSETS": str(ROOT / "assets")}
    subprocess.run(["python3", path], cwd=tmp_path, check=True, env=env)
