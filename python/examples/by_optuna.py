"""Optuna's tree-structured Parzen estimator on the form of the lens: first row, last row and radius; beside granulens's own method lens-family."""

import numpy as np
import optuna

import granulens as gl
from problem import Judge, arguments, study, tell


def main() -> None:
    given = arguments(__doc__, 200)
    optuna.logging.set_verbosity(optuna.logging.WARNING)
    judge = Judge(given.evaluations)
    search = optuna.create_study(direction="maximize", sampler=optuna.samplers.TPESampler(seed=given.seed))
    while judge.left > 0:
        asked, layouts = [], []
        # As many at a time as a core's registers hold.
        while len(asked) < min(8, judge.left):
            trial = search.ask()
            first = trial.suggest_int("apex_row", 2, 7)
            form = {"apex_row": first, "back_row": first + trial.suggest_int("rows", 1, 9 - first),
                    "radius": f"{trial.suggest_float('radius', 2.0, 40.0, log=True)} D"}  # fmt: skip
            try:
                layouts.append(gl.design(judge.design, lens=form).propose().layout.materials)
                asked.append(trial)
            except gl.InputError:
                # No such lens can be.
                search.tell(trial, state=optuna.trial.TrialState.FAIL)
        for trial, contrast in zip(asked, judge.score(np.array(layouts))["contrast"]):
            search.tell(trial, float(contrast))
    ours = study.ours("lens-family", given.evaluations, given.seed)
    tell(evaluations=given.evaluations, optuna=judge.best, lens_family=ours.scores["contrast"])


if __name__ == "__main__":
    main()
