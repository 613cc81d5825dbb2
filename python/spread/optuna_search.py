"""Optuna's multi-objective search, for spaces of designs too large to measure completely.

    pip install ./python optuna
    python optuna_search.py bundled --size 64 --trials 60

It minimises time, area and energy of a frame, and its wrong samples. Processes share a study with
`--study sqlite:///study.db`; several computers need a database server.
"""

import argparse
import os
import tempfile

import optuna

import shiftvox

# Keys of hardware descriptions, and the width of a word.
SPACE = {
    "bits": [24, 28, 32, 36],
    "contexts": [2, 4, 6, 8],
    "lanes": [1, 2],
    "node_cache.bytes": [4096, 16384, 65536],
    "stack.entries": [32, 64, 128],
    "organisation.joined_fill": [False, True],
}


def figures(scene, values, **options):
    """Time in ms, area in NAND2, energy in pJ and wrong samples of one design; None if it cannot draw."""
    lines = [f"{key} = {str(value).lower()}" for key, value in values.items()]
    with tempfile.TemporaryDirectory() as folder:
        space = os.path.join(folder, "point.toml")
        with open(space, "w") as file:
            file.write('hardware = ["light"]\n[ranges]\n' + "\n".join(lines) + "\n")
        point = shiftvox.explore(scene, space=space, **options)[1]
    if point["outcome"] != "drawn":
        return None
    return point["time_ms"], point["area_nand2"], point["energy_pj"], point["wrong_samples"]


def search(scene, trials, space=SPACE, study=None, seed=None, **options):
    """A study, whose `best_trials` are Pareto-optimal among the designs that were tried."""
    study = optuna.create_study(
        study_name=f"shiftvox {scene}",
        storage=study,
        load_if_exists=True,
        directions=["minimize"] * 4,
        sampler=optuna.samplers.TPESampler(seed=seed, multivariate=True),
    )

    def objective(trial):
        values = {key: trial.suggest_categorical(key, choices) for key, choices in space.items()}
        found = figures(scene, values, **options)
        if found is None:
            raise optuna.TrialPruned
        return found

    study.optimize(objective, n_trials=trials)
    return study


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("scene", nargs="?", default="bundled")
    parser.add_argument("--size", type=int, default=128)
    parser.add_argument("--trials", type=int, default=60)
    parser.add_argument("--study", help="where trials are kept, such as sqlite:///study.db")
    asked = parser.parse_args()
    optuna.logging.set_verbosity(optuna.logging.WARNING)
    study = search(asked.scene, asked.trials, study=asked.study, size=asked.size)
    for trial in sorted(study.best_trials, key=lambda trial: trial.values):
        time, area, energy, wrong = trial.values
        print(f"{time:8.3f} ms {area:10,.0f} NAND2 {energy / 1e6:7.1f} uJ {wrong:5.0f} wrong  {trial.params}")
