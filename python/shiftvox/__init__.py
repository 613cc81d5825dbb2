"""Exact voxel rendering on the CPU, and a model of hardware that needs only adders and shifts.

    import shiftvox
    scene = shiftvox.Scene.open("tree.vox")
    picture = shiftvox.render(scene, size=512, samples=2)
    picture.save_png("tree.png")
    nearest = picture.depth.min()      # arrays of NumPy: rgba, depth, normals, voxels, nodes
"""

import json
import os
import tempfile

from ._core import Camera, Error, Picture, Scene, documents, render

__all__ = ["Camera", "Error", "Picture", "Scene", "explore", "hardware", "model", "render", "run"]


def _words(options):
    """Keywords as flags: `size=128` is `--size 128`, `rules=True` is `--rules`."""
    words = []
    for name, value in options.items():
        flag = "--" + name.rstrip("_").replace("_", "-")
        if value is True:
            words.append(flag)
        elif isinstance(value, (list, tuple)):
            words += [flag, ",".join(map(str, value))]
        elif value is not None and value is not False:
            words += [flag, str(value)]
    return words


def _run(command, scenes, options, parse):
    with tempfile.TemporaryDirectory() as folder:
        names = []
        for number, scene in enumerate(scenes):
            if isinstance(scene, Scene):
                # A command knows scenes by their files.
                path = os.path.join(folder, f"scene-{number}.vxg")
                scene.save(path)
                scene = path
            names.append(os.fspath(scene))
        return parse(documents(["--json", *command.split(), *_words(options), "--", *names]))


def run(command, *scenes, **options):
    """Run a command of the program and return what it prints with --json.

    `run("bench error", "gen:wires,depth=5", size=48, runs=1)`; keywords are the flags that
    `shiftvox COMMAND --help` lists, with underscores for dashes. Scenes are files, generators, or
    `Scene` objects.

    Raises `Error`; its `exit_code` is what the program would have ended with.
    """
    return _run(command, scenes, options, json.loads)


def model(scene="bundled", **options):
    """Operations, cycles, memory, area and energy of one frame on the light hardware, as a dictionary.

    `model("bundled", size=128, hw="paper")["simulated"]["cycles"]["cycles"]` are the cycles of a frame; energies are
    in pJ, areas in NAND2 equivalents. Keywords are the flags of `shiftvox model`.
    """
    return run("model", scene, **options)


def hardware(name="light"):
    """The TOML text of a hardware design: one that ships (tiny, paper, light, wide), or a file's."""
    return documents(["model", "--print-hw", "--hw", os.fspath(name)])


def explore(*scenes, space="bundled", points=None, results=None, **options):
    """Many hardware designs, and those that no other beats in time, area, energy and wrong samples.

    Returns a list of dictionaries in the order of measurement: one of kind "space" for each scene, one of
    kind "point" for each design, one of kind "front" for each scene. `points` are numbers, such as "0..9";
    `results` is a file to which points are appended and from which those are taken that it has.
    """
    options = {"explore": space, "points": points, "results": results, **options}
    return _run("model", scenes, options, lambda text: [json.loads(line) for line in text.splitlines()])
