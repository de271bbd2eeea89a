"""pymoo's NSGA-II on single spheres, contrast traded for mass; beside granulens's own method nsga2. What counts is the hypervolume of ln C and ln mass
below the start's."""

import numpy as np
from pymoo.algorithms.moo.nsga2 import NSGA2
from pymoo.core.problem import Problem
from pymoo.indicators.hv import HV
from pymoo.operators.crossover.pntx import TwoPointCrossover
from pymoo.operators.mutation.bitflip import BitflipMutation
from pymoo.operators.sampling.rnd import BinaryRandomSampling
from pymoo.optimize import minimize

from problem import Judge, arguments, study, tell


class Spheres(Problem):
    def __init__(self, judge: Judge) -> None:
        super().__init__(n_var=len(judge.free), n_obj=2, xl=0, xu=1, vtype=bool)
        self.judge = judge

    def _evaluate(self, x, out, *args, **kwargs) -> None:
        table = self.judge.score(self.judge.layouts(x.astype(np.uint8)))
        out["F"] = np.column_stack([-np.log(np.maximum(table["contrast"], 1e-9)), np.log(table["piece_mass_kg"])])


def main() -> None:
    given = arguments(__doc__, 2000)
    judge = Judge(given.evaluations + 1)
    start = judge.score(judge.base[None])
    reference = np.array([-np.log(start["contrast"][0]), np.log(start["piece_mass_kg"][0])])
    population = 40
    generations = given.evaluations // population
    algorithm = NSGA2(population, sampling=BinaryRandomSampling(), crossover=TwoPointCrossover(), mutation=BitflipMutation())
    found = minimize(Spheres(judge), algorithm, ("n_gen", generations), seed=given.seed, verbose=False)
    ours = study.ours("nsga2", generations * population, given.seed, "mass = { minimise = 1 }")
    front = np.column_stack([-np.log(ours.front["contrast"]), np.log(ours.front["piece_mass_kg"])])
    volume = HV(ref_point=reference)
    tell(
        evaluations=generations * population,
        pymoo={"hypervolume": volume(found.F), "contrast": np.exp(-found.F[:, 0].min())},
        nsga2={"hypervolume": volume(front), "contrast": np.exp(-front[:, 0].min())},
    )


if __name__ == "__main__":
    main()
