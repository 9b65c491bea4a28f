"""Rundown learns the running resistance of a train from location and speed.

The functions are the commands of ``rundown``, and give the same numbers:

- ``import_logs``: run logs out of the logs of any recorder; ``preview_logs`` looks first
- ``replay``: what the board would have learned from recorded runs
- ``simulate``: runs with known truth, and with effects that the description does not have
- ``check``: what the recorder of some logs did to speed, location and clock
- ``gap``: which effect a model lacks, and the model with it
- ``export``: the learned train for SUMO, OSRD, TrainRuns, ALTRIOS, SFERA; ``convert`` reads theirs

Their tables hand themselves to pandas, polars, pyarrow and DuckDB without a copy (Arrow's PyCapsule interface).
"""

from ._rundown import (
    Check,
    Converted,
    Exported,
    Figure,
    Gap,
    Imported,
    Preview,
    Replay,
    RundownError,
    Simulated,
    Table,
    __version__,
    check,
    convert,
    export,
    gap,
    import_logs,
    preview_logs,
    replay,
    simulate,
)

__all__ = [
    "Check",
    "Converted",
    "Exported",
    "Figure",
    "Gap",
    "Imported",
    "Preview",
    "Replay",
    "RundownError",
    "Simulated",
    "Table",
    "__version__",
    "check",
    "convert",
    "export",
    "gap",
    "import_logs",
    "preview_logs",
    "replay",
    "simulate",
]
