"""Runs come as a table, too: whatever hands itself over as Arrow. The numbers are those of the same rows in files."""

import csv
import json
import shutil

import pytest

import rundown

pyarrow = pytest.importorskip("pyarrow")


def rows_of(made):
    """The logs of a simulated set in one table; a cell that is empty is missing."""
    columns = {"run": []}
    for log in sorted(made.runs.glob("run[0-9]*.csv")):
        with log.open(newline="") as file:
            for row in csv.DictReader(line for line in file if not line.startswith("#")):
                columns["run"].append(log.stem)
                for name, text in row.items():
                    columns.setdefault(name, []).append(float(text) if text else None)
    return columns


@pytest.fixture(scope="module")
def table(made):
    return pyarrow.table(rows_of(made))


def parameters(runs, made, **options):
    learned = rundown.replay(runs, train=made.train, track=made.track, **options)
    found = pyarrow.table(learned.parameters)
    return found.drop_columns(["unit"]).to_pydict()


def test_a_table_is_replayed_as_its_files_are(made, table):
    assert parameters(table, made) == parameters(made.runs, made)


def test_every_library_hands_its_table_over(made, table):
    expected = parameters(table, made)
    pytest.importorskip("pandas")
    polars, duckdb = pytest.importorskip("polars"), pytest.importorskip("duckdb")
    rows, frame = table, polars.DataFrame(table)
    forms = [
        table.to_reader(max_chunksize=50),
        frame,
        frame.with_columns(polars.col("run").cast(polars.Categorical)),
        table.to_pandas(),
        duckdb.sql("select * from rows"),
    ]
    for form in forms:
        assert parameters(form, made) == expected, type(form)


def test_units_are_carried_apart(made, table):
    one = parameters(table, made)
    two = pyarrow.concat_tables([table.append_column("unit", [[unit] * len(table)]) for unit in ["a", "b"]])
    both = rundown.replay(two, train=made.train, track=made.track).parameters
    assert both["unit"] == ["a"] * 3 + ["b"] * 3
    assert both["r0"] == one["r0"] * 2


def test_a_file_of_runs_and_its_table_are_the_same(made, table, tmp_path):
    parquet = pytest.importorskip("pyarrow.parquet")
    parquet.write_table(table, tmp_path / "runs.parquet")
    assert parameters(tmp_path / "runs.parquet", made) == parameters(table, made)


@pytest.mark.parametrize(
    ("change", "field", "reason"),
    [
        (lambda table: table.drop_columns(["speed_kmh"]), "speed_kmh", "expected a column of this name, found none"),
        (
            lambda table: table.set_column(0, "run", [list(range(len(table)))]),
            "run",
            "expected texts in this column, found Int64",
        ),
        (
            lambda table: table.append_column("direction", [["UP"] * len(table)]),
            "direction",
            'expected up, down or an empty cell, found "UP"',
        ),
    ],
)
def test_what_is_wrong_is_named(made, table, change, field, reason):
    with pytest.raises(rundown.RundownError) as caught:
        rundown.replay(change(table), train=made.train, track=made.track)
    assert (caught.value.field, caught.value.reason) == (field, reason)
    assert str(caught.value).startswith("runs:")


def test_a_table_without_rows_is_refused(made, table):
    with pytest.raises(rundown.RundownError, match="expected at least one run"):
        rundown.replay(table.slice(0, 0), train=made.train, track=made.track)


@pytest.fixture
def bare(made, tmp_path):
    """The logs without their index: a table has no dates either."""
    for log in made.runs.glob("run[0-9]*.csv"):
        shutil.copy(log, tmp_path)
    return tmp_path


def test_a_table_is_checked_as_its_files_are(made, table, bare):
    ours, theirs = (pyarrow.table(rundown.check(runs).findings) for runs in (table, bare))
    assert ours.num_rows > 0
    # A table has the row, a log the line below its header.
    assert ours.drop_columns(["line", "text"]) == theirs.drop_columns(["line", "text"])


def test_a_gap_is_found_in_a_table_as_in_its_files(tunnel, tmp_path):
    made, _ = tunnel
    for log in made.runs.glob("run[0-9]*.csv"):
        shutil.copy(log, tmp_path)
    described = {"train": made.train, "track": made.track}
    ours, theirs = (rundown.gap(runs, **described) for runs in (pyarrow.table(rows_of(made)), tmp_path))
    assert ours.verdict == "explained"
    assert pyarrow.table(ours.residuals) == pyarrow.table(theirs.residuals)
    assert json.loads(ours.to_json())["effects"] == json.loads(theirs.to_json())["effects"]


def test_a_table_says_its_directions_itself(made, table):
    with pytest.raises(rundown.RundownError, match="direction: expected auto for a table"):
        rundown.gap(table, train=made.train, track=made.track, direction="up")


def test_a_check_names_what_is_wrong_in_a_table(table):
    with pytest.raises(rundown.RundownError) as caught:
        rundown.check(table.drop_columns(["speed_kmh"]))
    assert caught.value.field == "speed_kmh"
