"""The package against pictures and figures of the program."""

import ast
import inspect
import json
import os
import pickle
import signal
import subprocess
import sys
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
    # The base is the array that was moved in.
    assert picture.rgba.base is not None and picture.rgba.base.size == picture.rgba.size
    seen = picture.nodes >= 0
    assert seen.any() and not seen.all()
    assert np.isfinite(picture.depth[seen]).all()
    assert np.allclose(np.linalg.norm(picture.normals[seen], axis=1), 1, atol=1e-3)
    assert (picture.voxels[~seen] == [0, 0, 0, -1]).all()


def interrupted(work):
    """Calls a function that is interrupted as by Ctrl-C a moment after its begin."""
    # A shell's background jobs ignore the signal.
    signal.signal(signal.SIGINT, signal.default_int_handler)
    timer = threading.Timer(0.2, os.kill, (os.getpid(), signal.SIGINT))
    with pytest.raises(KeyboardInterrupt):
        timer.start()
        work()


def test_ctrl_c_ends_every_call():
    """Uninterrupted, each of these would take many minutes."""
    scene = shiftvox.Scene.open(TREE)
    before = shiftvox.render(scene, size=64)
    interrupted(lambda: shiftvox.render(scene, size=4096, coverage="any"))
    interrupted(lambda: shiftvox.render(scene, size=2048, engine="rays"))
    assert shiftvox.render(scene, size=64).hash == before.hash
    # The first call of a process, too.
    script = f"""
import os, signal, threading, shiftvox
signal.signal(signal.SIGINT, signal.default_int_handler)
scene = shiftvox.Scene.open({str(TREE)!r})
threading.Timer(0.2, os.kill, (os.getpid(), signal.SIGINT)).start()
try:
    shiftvox.render(scene, size=4096, coverage="any")
except KeyboardInterrupt:
    print("ended")
"""
    ended = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, timeout=60)
    assert ended.stdout == "ended\n", ended.stderr


def test_notebooks_show_pictures(tmp_path):
    picture = shiftvox.render(shiftvox.Scene.generate("menger,depth=2"), size=32)
    picture.save_png(tmp_path / "saved.png")
    assert picture._repr_png_() == (tmp_path / "saved.png").read_bytes()
    assert shiftvox.__version__.count(".") == 2


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
    # Rows need not be contiguous.
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
    again = shiftvox.Scene.open(tmp_path / "t.vxg", verify=True)
    assert again.is_verified and again.warnings == []
    assert shiftvox.render(again, size=32, shaded=False).hash == picture.hash
    with pytest.raises(shiftvox.Error, match="row 1 has a corner"):
        shiftvox.Scene.from_mesh(positions, np.array([[0, 1, 2], [0, 1, 4]]))


def small(**settings):
    return shiftvox.render(shiftvox.Scene.generate("menger,depth=1"), size=8, **settings)


@pytest.mark.parametrize(
    "act, told",
    [
        (lambda: shiftvox.Scene.open("nowhere.vox"), "nowhere.vox"),
        (lambda: shiftvox.Scene.generate("nothing"), "nothing"),
        (lambda: shiftvox.Scene.from_numpy(np.zeros((3, 2), np.int32)), r"\(N, 3\)"),
        (lambda: shiftvox.Scene.from_numpy(np.zeros((0, 3), np.int32)), "voxel"),
        (lambda: shiftvox.Scene.from_numpy(np.zeros((3, 3), np.int32), np.zeros((2, 3), np.uint8)), "2 rows for 3"),
        (lambda: small(engine="gpu"), "none of fast, machine"),
        (lambda: small(samples=3), "1, 2 or 4"),
        (lambda: shiftvox.render(shiftvox.Scene.generate("menger,depth=1"), size="big"), "size"),
        (lambda: shiftvox.Scene.open(TREE, up="x"), "none of y, z"),
        (lambda: shiftvox.Scene.open(TREE, depth=-1), "depth: a number from 0"),
        (lambda: small(samples=-1), "samples: a number from 0"),
        (lambda: small(threads=2**70), "threads: a number from 0"),
        (lambda: small(threads=1025), "threads: 0 to 1024, not 1025"),
        (lambda: small(bits=-1), "bits: a number from 0"),
        (lambda: small(paper=True, coverage="exact"), "coverage: paper"),
        (lambda: small(paper=True, cage="frame"), "cage: paper"),
        (lambda: small(background=(0, 0, 0), transparent=True), "background: transparent"),
        (lambda: small(background=(0, 0, 256)), "background: three numbers"),
        (lambda: shiftvox.run(""), "no command"),
        (lambda: shiftvox.run("man"), "man: it prints no JSON"),
        (lambda: shiftvox.run("view", "bundled"), "view: it prints no JSON"),
        (lambda: shiftvox.run("model", print_hw=True), "no JSON document"),
        (lambda: shiftvox.Scene.from_numpy([[0, 0, 2**40]]), "indices: numbers from -2147483648"),
        (lambda: shiftvox.Scene.from_numpy([[0, 0, 0.5]]), "indices: float64"),
        (lambda: shiftvox.Scene.from_numpy([[0, 0, 0]], [[0, 0, 256]]), "colors: numbers from 0 to 255"),
        (lambda: shiftvox.Scene.from_mesh([["a", "b", "c"]], [[0, 0, 0]]), "positions: <U1"),
        (lambda: shiftvox.Scene.from_mesh(np.zeros((3, 3)), np.zeros((0, 3), int)), "triangles: there are none"),
    ],
)
def test_what_is_refused(act, told):
    with pytest.raises(shiftvox.Error, match=told):
        act()


def test_numbers_of_any_type_and_sizes_of_any_sequence(tmp_path):
    index = np.array([[0, 0, 0], [0, 1, -1]])
    color = np.array([[255, 0, 0], [0, 0, 255]])
    hashes = set()
    for kind in (np.int8, np.int32, np.int64):
        scene = shiftvox.Scene.from_numpy(index.astype(kind), color)
        hashes.add(shiftvox.render(scene, size=16).hash)
    hashes.add(shiftvox.render(shiftvox.Scene.from_numpy(index.tolist(), color.tolist()), size=[16, 16]).hash)
    assert len(hashes) == 1
    corners = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0]])
    meshes = [
        shiftvox.Scene.from_mesh(corners.astype(kind), np.array([[0, 1, 2]], rows), depth=3)
        for kind, rows in [(np.float64, np.int64), (np.float32, np.uint32), (np.int64, np.uint8)]
    ]
    assert len({shiftvox.render(mesh, size=16).hash for mesh in meshes}) == 1
    assert small(background=[1, 2, 3]).hash == small(background=(1, 2, 3)).hash != small().hash
    for size in ((32, 24), [32, 24]):
        assert shiftvox.model("gen:menger,depth=1", size=size)["height"] == 24


def test_sizes_are_the_pictures_whatever_becomes_of_its_arrays(tmp_path):
    picture = shiftvox.render(shiftvox.Scene.generate("menger,depth=1"), size=(32, 24))
    picture.depth.shape = (32 * 24,)
    picture.rgba.shape = (32 * 24 * 4,)
    assert (picture.width, picture.height) == (32, 24)
    assert repr(picture) == "<shiftvox.Picture of 32 x 24 pixels>"
    picture.save_png(tmp_path / "p.png")
    assert (tmp_path / "p.png").read_bytes()[16:24] == bytes([0, 0, 0, 32, 0, 0, 0, 24])


FORKING = """
import multiprocessing
import shiftvox
scene = shiftvox.Scene.generate("menger,depth=2")
def draw(_):
    return shiftvox.render(scene, size=64, threads=0).hash, shiftvox.model("gen:menger,depth=1", size=16)["height"]
here = draw(0)
with multiprocessing.get_context("fork").Pool(2) as pool:
    there = pool.map_async(draw, range(4)).get(timeout=20)  # the children end with the pool
assert there == [here] * 4, there
"""


@pytest.mark.skipif(not hasattr(os, "fork"), reason="this system does not fork")
def test_a_child_by_fork_draws_after_its_parent_drew():
    subprocess.run([sys.executable, "-c", FORKING], check=True)


def public():
    """Public names and their objects."""
    for name in shiftvox.__all__:
        thing = getattr(shiftvox, name)
        yield name, thing
        if inspect.isclass(thing) and thing is not shiftvox.Error:
            yield from ((f"{name}.{m}", getattr(thing, m)) for m in vars(thing) if not m.startswith("_"))


def test_everything_public_says_what_it_is_and_has_a_stub():
    told = {name: inspect.getdoc(thing) for name, thing in public()}
    assert [name for name, text in told.items() if not text] == []
    stubs = {"documents", "Error"}
    for node in ast.parse((Path(shiftvox.__file__).parent / "_core.pyi").read_text()).body:
        if isinstance(node, (ast.ClassDef, ast.FunctionDef)):
            stubs.add(node.name)
        if isinstance(node, ast.ClassDef) and node.name != "Error":
            stubs |= {f"{node.name}.{getattr(part, 'name', None) or part.target.id}" for part in node.body}
    classes = ("Scene", "Camera", "Picture", "Error", "render")
    assert {name for name in told if name.split(".")[0] in classes} | {"documents"} == stubs


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
    # A scene in memory.
    scene = shiftvox.Scene.generate("menger,depth=2")
    assert shiftvox.model(scene, size=32, hw="paper")["record_bits"] == theirs["record_bits"]
    with pytest.raises(shiftvox.Error, match="nothing.toml") as refused:
        shiftvox.model(hw="nothing.toml")
    assert refused.value.exit_code == 4


def test_exploration_goes_on_where_it_stopped(tmp_path):
    results = tmp_path / "results.jsonl"
    first, both = (
        shiftvox.explore(shiftvox.Scene.generate("menger,depth=2"), size=16, points=points, results=results)
        for points in ("0..1", "0..2")
    )
    assert [line["kind"] for line in both] == ["space", "point", "point", "point", "front"] and both[-1]["front"]
    assert [line["point"] for line in both[1:4]] == [0, 1, 2] and both[:3] == first[:3]
    written = results.read_text()
    assert [line["kind"] for line in map(json.loads, written.splitlines())] == ["space"] + 3 * ["point"]
    # The exploration also resumes with the scene's file.
    (kept,) = tmp_path.glob("scene-*.vxg")
    assert shiftvox.explore(kept, size=16, points="0..2", results=results) == both
    assert results.read_text() == written


def test_nothing_is_printed(capfd):
    shiftvox.run("info", "gen:menger,depth=1")
    shiftvox.run("bench quality", "gen:menger,depth=1", size=16, runs=1, methods=["exact:bits=64"])
    assert capfd.readouterr().out == ""
    with pytest.raises(shiftvox.Error) as refused:
        shiftvox.run("model", nonsense=1)
    assert refused.value.exit_code == 2 and "--nonsense" in str(refused.value)
    assert capfd.readouterr().out == ""


def test_arrays_come_and_go():
    tree = shiftvox.Scene.open(TREE)
    indices, colors = tree.to_numpy()
    assert indices.shape == colors.shape == (tree.voxels, 3)
    again = shiftvox.Scene.from_numpy(indices, colors)
    size = (64, 48)
    camera = shiftvox.Camera.fit(tree, ortho=True).placed(size)
    drawn = shiftvox.render(tree, camera, size)
    assert (shiftvox.render(again, camera, size).rgba == drawn.rgba).all()
    # A dense grid, with colours.
    low = indices.min(axis=0)
    grid = np.zeros(indices.max(axis=0) - low + 1, dtype=bool)
    grid[tuple((indices - low).T)] = True
    painted = np.zeros((*grid.shape, 3), dtype=np.uint8)
    painted[tuple((indices - low).T)] = colors
    dense, rows = shiftvox.Scene.from_numpy(grid, painted), shiftvox.Scene.from_numpy(indices - low, colors)
    assert shiftvox.render(dense, size=48).hash == shiftvox.render(rows, size=48).hash
    below = tree.crop(z=(None, 69))
    assert len(below.to_numpy()[0]) == (indices[:, 2] < 69).sum()
    with pytest.raises(shiftvox.Error):
        tree.crop(x=(10**6, None))
    with pytest.raises(shiftvox.Error, match="not that of the grid"):
        shiftvox.Scene.from_numpy(grid, painted[1:])


def test_scenes_and_placed_cameras_are_pickled():
    for scene in (shiftvox.Scene.open(TREE), shiftvox.Scene.generate("menger,depth=2")):
        again = pickle.loads(pickle.dumps(scene))
        assert shiftvox.render(again, size=40).hash == shiftvox.render(scene, size=40).hash
        for options in ({}, {"ortho": True}, {"fov": 12.0, "azimuth": 100}):
            fitted = shiftvox.Camera.fit(scene, **options)
            placed = fitted.placed((40, 30))
            camera = pickle.loads(pickle.dumps(placed))
            assert (camera.eye, camera.up, camera.fov, camera.ortho) == (placed.eye, placed.up, placed.fov, placed.ortho)
            assert (camera.fov is None) == (camera.ortho is not None) == ("ortho" in options)
            hashes = {shiftvox.render(scene, view, (40, 30)).hash for view in (fitted, placed, camera)}
            assert len(hashes) == 1
            assert repr(eval(repr(placed), {"Camera": shiftvox.Camera})) == repr(placed)
        with pytest.raises(shiftvox.Error, match="placed"):
            fitted.eye
        with pytest.raises(shiftvox.Error, match="placed"):
            pickle.dumps(fitted)


def test_parallel_rays_are_the_programs(tmp_path):
    command = [program(), "render", TREE, "--ortho", "--size", "80x60", "--json", "--hash"]
    told = json.loads(subprocess.run(command, check=True, capture_output=True, cwd=tmp_path).stdout)
    scene = shiftvox.Scene.open(TREE)
    picture = shiftvox.render(scene, shiftvox.Camera.fit(scene, ortho=True), (80, 60))
    assert picture.hash in json.dumps(told)


EXAMPLES = sorted(p.name for p in (ROOT / "python" / "examples").iterdir() if p.suffix in (".py", ".ipynb"))


@pytest.mark.parametrize("name", EXAMPLES)
def test_examples_run(name, tmp_path):
    path = ROOT / "python" / "examples" / name
    text = path.read_text()
    if path.suffix == ".ipynb":
        cells = (cell for cell in json.loads(text)["cells"] if cell["cell_type"] == "code")
        text = "\n".join("".join(cell["source"]) for cell in cells)
    env = {**os.environ, "SHIFTVOX_ASSETS": str(ROOT / "assets"), "MPLBACKEND": "agg"}
    subprocess.run([sys.executable, "-c", text], cwd=tmp_path, check=True, env=env)
    assert list(tmp_path.iterdir()), "it wrote no picture"
