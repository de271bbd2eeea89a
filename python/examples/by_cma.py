"""CMA-ES (package cma) on the amplitudes of cosines, whose sum decides by its sign which sphere is brass; beside granulens's own method level-set."""

import cma
import numpy as np

from problem import Judge, arguments, study, tell

ORDER = 4


def main() -> None:
    given = arguments(__doc__, 2000)
    judge = Judge(given.evaluations)
    z, x = judge.sites()
    waves = np.array([np.cos(np.pi * p * z) * np.cos(np.pi * q * x) for p in range(ORDER) for q in range(ORDER)])
    search = cma.CMAEvolutionStrategy(
        np.zeros(len(waves)), 1.0, {"seed": given.seed, "popsize": 16, "verbose": -9, "maxfevals": given.evaluations}
    )
    while judge.left >= 16 and not search.stop():
        asked = search.ask()
        letters = (np.array(asked) @ waves > 0).astype(np.uint8)
        contrast = judge.score(judge.layouts(letters))["contrast"]
        search.tell(asked, (-np.log(np.maximum(contrast, 1e-9))).tolist())
    made = given.evaluations - judge.left
    ours = study.ours("level-set", made, given.seed)
    tell(evaluations=made, cma=judge.best, level_set=ours.scores["contrast"])


if __name__ == "__main__":
    main()
