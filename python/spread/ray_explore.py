"""An exploration on a Ray cluster: the same front as on one machine.

    pip install ./python ray
    python ray_explore.py bundled --size 64 --results out/      # on the cluster's head, or alone on one machine

Each task appends points to its own file; if its worker dies, it resumes there. All workers must see the folder.
"""

import argparse
import pathlib

import ray

import shiftvox


@ray.remote(num_cpus=1, max_retries=5)
def measure(scene, points, results, options):
    shiftvox.explore(scene, points=points, results=results, threads=1, **options)


def explore(scene, folder, per_task=8, **options):
    """All points of a space, and its front, as `shiftvox.explore` returns them."""
    folder = pathlib.Path(folder).absolute()
    folder.mkdir(parents=True, exist_ok=True)
    size = shiftvox.explore(scene, points="0..0", **options)[0]["space_points"]
    files, tasks = [], []
    for first in range(0, size, per_task):
        points = f"{first}..{min(first + per_task, size) - 1}"
        files.append(folder / f"{points}.jsonl")
        tasks.append(measure.remote(scene, points, str(files[-1]), options))
    ray.get(tasks)
    # Concatenated, the files are one, from which the front follows without measurements.
    together = folder / "all.jsonl"
    together.write_text("".join(file.read_text() for file in files))
    return shiftvox.explore(scene, results=together, **options)


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("scene", nargs="?", default="bundled")
    parser.add_argument("--space", default="bundled")
    parser.add_argument("--size", type=int, default=128)
    parser.add_argument("--results", required=True, help="a folder that all workers see")
    parser.add_argument("--per-task", type=int, default=8)
    asked = parser.parse_args()
    ray.init(ignore_reinit_error=True, include_dashboard=False)
    found = explore(asked.scene, asked.results, asked.per_task, space=asked.space, size=asked.size)
    for point in found[-1]["front"]:
        energy, area = point["energy_pj"] / 1e6, point["area_nand2"]
        print(f"{point['point']:5} {point['time_ms']:8.3f} ms {area:10,.0f} NAND2 {energy:7.1f} uJ  {point['hardware_says']}")
