"""Exact voxel rendering on the CPU, and a model of hardware that needs only adders and shifts.

    import shiftvox
    scene = shiftvox.Scene.open("tree.vox")
    picture = shiftvox.render(scene, size=512, samples=2)
    picture.save_png("tree.png")
    nearest = picture.depth.min()      # NumPy arrays: rgba, depth, normals, voxels, nodes
"""

import hashlib
import json
import os
import tempfile

from ._core import Camera, Error, Picture, Scene, __version__, documents, render

__all__ = ["Camera", "Error", "Picture", "Scene", "__version__", "explore", "hardware", "model", "render", "run"]


def _words(options):
    """`size=(32, 24)` as `--size 32x24`, `bits=[24, 32]` as `--bits 24,32`, `paper=True` as `--paper`."""
    words = []
    for name, value in options.items():
        flag = "--" + name.rstrip("_").replace("_", "-")
        if value is True:
            words.append(flag)
        elif isinstance(value, (list, tuple)):
            words += [flag, ("x" if name == "size" else ",").join(map(str, value))]
        elif value is not None and value is not False:
            words += [flag, str(value)]
    return words


def _refused(told):
    """A command line that the program would end with exit code 2."""
    error = Error(told)
    error.exit_code = 2
    return error


def _kept(path, folder):
    """Moves a scene's file into a folder, under a name derived from its content."""
    with open(path, "rb") as file:
        content = hashlib.blake2b(digest_size=8)
        while piece := file.read(1 << 20):
            content.update(piece)
    kept = os.path.join(folder, f"scene-{content.hexdigest()}.vxg")
    os.replace(path, kept)
    return kept


def _run(command, scenes, options, parse):
    words = command.split()
    if not words or words[0].startswith("-"):
        raise _refused(f"{command!r} is no command, such as \"info\" or \"bench quality\"")
    # Results name scene files, so that of a `Scene` object stays beside them.
    results = options.get("results")
    beside = None if results is None else os.path.dirname(os.path.abspath(results))
    if beside is not None:
        os.makedirs(beside, exist_ok=True)
    with tempfile.TemporaryDirectory(dir=beside) as folder:
        names = []
        for number, scene in enumerate(scenes):
            if isinstance(scene, Scene):
                path = os.path.join(folder, f"scene-{number}.vxg")
                scene.save(path)
                scene = path if beside is None else _kept(path, beside)
            names.append(os.fspath(scene))
        text = documents(["--json", *words, *_words(options), "--", *names])
    try:
        return parse(text)
    except json.JSONDecodeError:
        raise _refused(f"{command}: with these flags it prints no JSON document") from None


def run(command, *scenes, **options):
    """Run a command of the program and return its --json output.

    `run("bench quality", "gen:wires,depth=5", size=48, runs=1)`; keywords are the flags that
    `shiftvox COMMAND --help` lists, with underscores for dashes. Scenes are files, generators, or
    `Scene` objects.

    Raises `Error` with the program's `exit_code`, also for commands without JSON (man, completions, view).
    """
    return _run(command, scenes, options, json.loads)


def model(scene="bundled", **options):
    """Operations, cycles, memory, area and energy of one frame on the light hardware, as a dictionary.

    `model("bundled", size=128, hw="paper")["simulated"]["cycles"]["cycles"]` are the cycles of a frame. Energies are
    in pJ, areas in NAND2 equivalents. Keywords are the flags of `shiftvox model`.
    """
    return run("model", scene, **options)


def hardware(name="light"):
    """The TOML text of a shipped hardware design (tiny, paper, light, wide) or of a file."""
    return documents(["model", "--print-hw", "--hw", os.fspath(name)])


def explore(*scenes, space="bundled", points=None, results=None, **options):
    """Measure many hardware designs, and find those that are Pareto-optimal in time, area, energy and wrong samples.

    Returns a list of dictionaries in the order of measurement. Their kinds are "space" (one per scene), "point" (one
    per design) and "front" (one per scene). `points` are numbers, such as "0..9". `results` is a file: new points are
    appended, and points in it are not measured again. A `Scene` object is kept beside it as scene-HASH.vxg.
    """
    options = {"explore": space, "points": points, "results": results, **options}
    return _run("model", scenes, options, lambda text: [json.loads(line) for line in text.splitlines()])
