"""python solve.py INSTANCE SECONDS: HiGHS on a multiple-choice knapsack, as JSON on standard output.

Solves the linear relaxation, then the integer programme at HiGHS's default gap, then at none, giving up after SECONDS.
Times are the processor's, and those of `run` alone: the model is in HiGHS's hands, presolve is not done. One thread.
"""

import json
import sys
import time

import highspy
import numpy


def model(instance, integer):
    """A column per item; a row for the budget, and one per class, of whose items one is chosen."""
    items = [item for items in instance["classes"] for item in items]
    owner = [c for c, items in enumerate(instance["classes"]) for _ in items]
    rows = 1 + len(instance["classes"])
    lp = highspy.HighsLp()
    lp.num_col_, lp.num_row_ = len(items), rows
    lp.sense_ = highspy.ObjSense.kMaximize
    lp.col_cost_ = numpy.array([benefit for _, benefit in items])
    lp.col_lower_, lp.col_upper_ = numpy.zeros(len(items)), numpy.ones(len(items))
    lp.row_lower_ = numpy.array([-highspy.kHighsInf] + [1.0] * (rows - 1))
    lp.row_upper_ = numpy.array([instance["budget"]] + [1.0] * (rows - 1))
    lp.a_matrix_.format_ = highspy.MatrixFormat.kColwise
    lp.a_matrix_.start_ = 2 * numpy.arange(len(items) + 1)
    lp.a_matrix_.index_ = numpy.array([row for c in owner for row in (0, 1 + c)])
    lp.a_matrix_.value_ = numpy.array([value for cost, _ in items for value in (cost, 1.0)])
    if integer:
        lp.integrality_ = [highspy.HighsVarType.kInteger] * len(items)
    return lp


def solve(instance, integer, **options):
    """What HiGHS makes of it: seconds, its bound, and the chosen item per class; None where it has none."""
    highs = highspy.Highs()
    for name, value in {"output_flag": False, "threads": 1, **options}.items():
        highs.setOptionValue(name, value)
    highs.passModel(model(instance, integer))
    start = time.process_time()
    highs.run()
    seconds = time.process_time() - start
    info, solution = highs.getInfo(), highs.getSolution()
    optimal = highs.getModelStatus() == highspy.HighsModelStatus.kOptimal
    bound = info.mip_dual_bound if integer else info.objective_function_value
    return {
        "time_s": seconds,
        "bound": bound if (integer or optimal) and abs(bound) < highspy.kHighsInf else None,
        "choice": chosen(instance, solution.col_value) if integer and solution.value_valid else None,
        "proved": options.get("mip_rel_gap") == 0.0 and optimal,
    }


def chosen(instance, found):
    """The item of each class that has the largest share, which of a solution in integers is one."""
    values = iter(found)
    shares = [[next(values) for _ in items] for items in instance["classes"]]
    return [of_class.index(max(of_class)) for of_class in shares]


def main(path, limit_s):
    with open(path, encoding="utf-8") as file:
        instance = json.load(file)
    limited = {"time_limit": limit_s}
    exact = {"mip_rel_gap": 0.0, "mip_abs_gap": 0.0, **limited}
    answer = {
        "version": highspy.Highs().version(),
        "relaxation": solve(instance, integer=False, **limited),
        "default_gap": solve(instance, integer=True, **limited),
        "proof": solve(instance, integer=True, **exact),
    }
    print(json.dumps(answer))


main(sys.argv[1], float(sys.argv[2]))
