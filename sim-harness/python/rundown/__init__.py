"""Rundown learns the running resistance of a train from location and speed.

The functions are the commands of ``rundown``, and give the same numbers:

- ``import_logs``: run logs out of the logs of any recorder
- ``replay``: what the board would have learned from recorded runs
- ``simulate``: runs with known truth, and with effects that the description does not have
- ``check``: what the recorder of some logs did to speed, location and clock
- ``gap``: which effect a model lacks, and the model with it
- ``export``: the learned train for SUMO, OSRD, TrainRuns, ALTRIOS, SFERA

Their tables hand themselves to pandas, polars, pyarrow and DuckDB without a copy (Arrow's PyCapsule interface).
"""

from ._rundown import (
    Check,
    Exported,
    Figure,
    Gap,
    Imported,
    Replay,
    RundownError,
    Simulated,
    Table,
    __version__,
    check,
    export,
    gap,
    import_logs,
    replay,
    simulate,
)

__all__ = [
    "Check",
    "Exported",
    "Figure",
    "Gap",
    "Imported",
    "Replay",
    "RundownError",
    "Simulated",
    "Table",
    "__version__",
    "check",
    "export",
    "gap",
    "import_logs",
    "replay",
    "simulate",
]
