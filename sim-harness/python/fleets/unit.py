"""What every engine runs: the replay of one unit. What is learned in a run is carried to the next one, so a unit is the smallest task."""

import os

# One thread a task: the engine decides how many tasks run side by side.
os.environ.setdefault("RAYON_NUM_THREADS", "1")

import pyarrow

import rundown


def replay_unit(runs, train, track):
    """The vehicle after each run of a unit, as `parameters.csv` has it: Arrow in, Arrow out.

    Engines bring the rows of a group in any order. Names of runs sort as the runs followed each other.
    """
    in_order = pyarrow.table(runs).sort_by([("run", "ascending"), ("time_s", "ascending")])
    learned = rundown.replay(in_order, train=train, track=track)
    return pyarrow.table(learned.parameters)
