from collections.abc import Callable, Iterable, Mapping, Sequence
from os import PathLike
from pathlib import Path
from typing import Any, Literal, Protocol, Union, final

_Path = Union[str, PathLike[str]]
_Paths = Union[_Path, Iterable[_Path]]
_Direction = Literal["auto", "up", "down"]
_Format = Literal["sfera", "sumo", "sumo-table", "osrd", "trainruns", "altrios"]
_Runs = Union[bool, Callable[[int, int], object]]

__version__: str

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

class _ArrowTable(Protocol):
    def __arrow_c_stream__(self, requested_schema: object | None = None) -> object: ...

# One, several, or several with the names of their runs.
_Tables = Union[_ArrowTable, Iterable[_ArrowTable], Mapping[str, _ArrowTable]]

class RundownError(Exception):
    file: Path | None
    line: int | None
    column: int | None
    field: str | None
    reason: str

@final
class Table:
    def __reduce__(self) -> tuple[Any, ...]: ...
    @property
    def column_names(self) -> list[str]: ...
    @property
    def units(self) -> dict[str, str]: ...
    @property
    def meanings(self) -> dict[str, str]: ...
    def __getitem__(self, name: str, /) -> list[Any]: ...
    def to_dict(self) -> dict[str, list[Any]]: ...
    def to_pandas(self) -> Any: ...
    def __len__(self) -> int: ...
    def _repr_html_(self) -> str: ...
    def __arrow_c_stream__(self, requested_schema: object | None = None) -> object: ...
    def __arrow_c_schema__(self) -> object: ...

@final
class Figure:
    @property
    def svg(self) -> str: ...
    def save(self, path: _Path) -> None: ...
    def _repr_svg_(self) -> str: ...

@final
class Simulated:
    @property
    def folder(self) -> Path: ...
    @property
    def train(self) -> Path: ...
    @property
    def track(self) -> Path: ...
    @property
    def runs(self) -> Path: ...
    @property
    def truth(self) -> Path: ...

@final
class Replay:
    @property
    def runs(self) -> list[str]: ...
    @property
    def units(self) -> list[str]: ...
    @property
    def failed(self) -> list[tuple[Path, str]]: ...
    @property
    def notes(self) -> list[str]: ...
    @property
    def warnings(self) -> list[str]: ...
    @property
    def features(self) -> Table: ...
    @property
    def parameters(self) -> Table: ...
    @property
    def switching_points(self) -> Table: ...
    def estimates(self, run: str | None = None) -> Table: ...
    def coast_ahead(self, run: str | None = None) -> Table: ...
    def resistance(
        self,
        speeds_mps: float | Iterable[float],
        run: str | None = None,
        *,
        unit: str | None = None,
        of: Literal["vehicle", "run", "before"] = "vehicle",
    ) -> Table: ...
    def plot(
        self,
        what: Literal["resistance", "history", "motion", "terms", "regimes", "innovations"] = "resistance",
        run: str | None = None,
        *,
        unit: str | None = None,
    ) -> Figure: ...
    def to_json(self) -> str: ...
    def to_dict(self) -> dict[str, Any]: ...
    def write(self, out: _Path) -> None: ...

@final
class Check:
    @property
    def findings(self) -> Table: ...
    @property
    def failed(self) -> list[tuple[Path, str]]: ...
    @property
    def notes(self) -> list[str]: ...
    def to_json(self) -> str: ...
    def to_dict(self) -> dict[str, Any]: ...

@final
class Gap:
    @property
    def verdict(self) -> str: ...
    @property
    def notes(self) -> list[str]: ...
    @property
    def residuals(self) -> Table: ...
    @property
    def powering(self) -> Table: ...
    @property
    def before_after(self) -> Table: ...
    @property
    def effects(self) -> list[dict[str, Any]]: ...
    @property
    def gap(self) -> dict[str, Any]: ...
    def to_json(self) -> str: ...
    def to_dict(self) -> dict[str, Any]: ...
    def write(self, out: _Path) -> None: ...
    def plot(self, what: Literal["residual", "coordinates", "law", "before_after"] = "residual") -> Figure: ...

@final
class Imported:
    @property
    def folder(self) -> Path: ...
    @property
    def failed(self) -> list[str]: ...
    @property
    def notes(self) -> list[str]: ...
    @property
    def warnings(self) -> list[str]: ...
    def __len__(self) -> int: ...

@final
class Converted:
    @property
    def file(self) -> Path: ...
    @property
    def kind(self) -> Literal["train", "track"]: ...
    @property
    def notes(self) -> list[str]: ...

@final
class Exported:
    @property
    def folder(self) -> Path: ...
    @property
    def files(self) -> list[Path]: ...
    @property
    def notes(self) -> list[str]: ...

@final
class Preview:
    @property
    def failed(self) -> list[str]: ...
    @property
    def notes(self) -> list[str]: ...
    def plot(self) -> Figure: ...

def import_logs(
    files: _Paths | None = None,
    *,
    out: _Path,
    mapping: _Path | None = None,
    chainage: Literal["as-is", "stops", "line", "align"] | None = None,
    track: _Path | None = None,
    track_out: _Path | None = None,
    strict: bool = False,
) -> Imported: ...
def preview_logs(files: _Paths | None = None, *, mapping: _Path | None = None) -> Preview: ...
def convert(file: _Path, *, out: _Path, set: dict[str, float] | None = None) -> Converted: ...
def replay(
    runs: _Paths | _Tables,
    *,
    train: _Path,
    track: _Path,
    config: _Path | None = None,
    mode: Literal["paper", "gated", "measured"] | None = None,
    tick: float | None = None,
    direction: _Direction = "auto",
    carry: bool = True,
    as_recorded: bool = False,
    skip_bad_rows: bool = False,
    progress: _Runs | None = None,
) -> Replay: ...
def simulate(
    out: _Path,
    *,
    scenario: _Path | None = None,
    example: Literal["case_study", "hidden_effect"] | None = None,
    seed: int | None = None,
    runs: int | None = None,
    recorder: str | None = None,
    force: bool = False,
    progress: _Runs | None = None,
) -> Simulated: ...
def check(
    runs: _Paths | _Tables,
    *,
    track: _Path | None = None,
    train: _Path | None = None,
    progress: _Runs | None = None,
) -> Check: ...
def gap(
    runs: _Paths | _Tables,
    *,
    train: _Path,
    track: _Path,
    config: _Path | None = None,
    hold_out: int | None = None,
    direction: _Direction = "auto",
    as_recorded: bool = False,
    progress: bool | Callable[[str], object] | None = None,
) -> Gap: ...
def export(
    replay: Replay | _Path,
    *,
    train: _Path,
    to: _Format | Sequence[_Format],
    max_speed: int,
    out: _Path,
    traction: str | None = None,
    company: str | None = None,
    unit: str | None = None,
    id: str | None = None,
    tc_version: str = "1",
) -> Exported: ...
