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
    # Not the same rows again, which would count once: a micrometre further on.
    place = table.column_names.index("location_m")
    moved = table.set_column(place, "location_m", pyarrow.array([m + 1e-6 for m in table["location_m"].to_pylist()]))
    two = pyarrow.concat_tables(
        [rows.append_column("unit", [[unit] * len(table)]) for unit, rows in [("a", table), ("b", moved)]]
    )
    both = rundown.replay(two, train=made.train, track=made.track).parameters
    assert both["unit"] == ["a"] * 3 + ["b"] * 3
    assert both["r0"] == pytest.approx(one["r0"] * 2, rel=1e-5)


def test_the_same_rows_of_another_unit_count_once(made, table):
    two = pyarrow.concat_tables([table.append_column("unit", [[unit] * len(table)]) for unit in ["a", "b"]])
    with pytest.warns(UserWarning, match="3 logs refused, the first: .*holds the same rows as another one"):
        learned = rundown.replay(two, train=made.train, track=made.track)
    assert learned.runs == ["run001", "run002", "run003"]


def test_a_file_of_runs_and_its_table_are_the_same(made, table, tmp_path):
    parquet = pytest.importorskip("pyarrow.parquet")
    parquet.write_table(table, tmp_path / "runs.parquet")
    assert parameters(tmp_path / "runs.parquet", made) == parameters(table, made)


def test_the_index_of_a_frame_is_no_column(made, table, tmp_path):
    pandas = pytest.importorskip("pandas")
    frame = table.to_pandas()
    parts = [part.reset_index(drop=True) for _, part in frame.groupby("run")]
    filtered = pandas.concat(parts)
    assert "__index_level_0__" in pyarrow.table(filtered).column_names
    filtered.to_parquet(tmp_path / "runs.parquet")
    filtered["speed_mps"] = filtered["speed_kmh"] / 3.6
    for runs, unknown in [(pandas.concat(parts), []), (tmp_path / "runs.parquet", []), (filtered, ["speed_mps"])]:
        learned = rundown.replay(runs, train=made.train, track=made.track)
        found = [text.split("found ")[1].split(";")[0] for text in learned.warnings if "no other columns" in text]
        assert found == unknown


def frames(table, without=()):
    """A table for each run, without these columns."""
    names = sorted(set(table["run"].to_pylist()))
    runs = table["run"].to_pylist()
    rows = {name: [row for row, run in enumerate(runs) if run == name] for name in names}
    return {name: table.take(pyarrow.array(rows[name])).drop_columns(list(without)) for name in names}


def test_several_tables_are_the_runs_of_one(made, table):
    expected = parameters(table, made)
    pandas = pytest.importorskip("pandas")
    with_run, bare = list(frames(table).values()), frames(table, ["run"])
    assert parameters(with_run, made) == expected
    assert parameters((one.to_pandas() for one in with_run), made) == expected
    assert parameters(dict(list(table.to_pandas().groupby("run"))), made) == expected
    assert parameters(bare, made) == expected
    # Two runs, then one: a table may have several.
    assert parameters([pyarrow.concat_tables(with_run[:2]), with_run[2]], made) == expected
    named = parameters([one.to_pandas() for one in bare.values()], made)
    assert named.pop("run") == ["table1", "table2", "table3"]
    assert named == {name: values for name, values in expected.items() if name != "run"}
    ours, theirs = (pyarrow.table(rundown.check(runs).findings) for runs in (with_run, table))
    assert ours.num_rows > 0 and ours.drop_columns(["line", "text"]) == theirs.drop_columns(["line", "text"])


def test_tables_that_are_not_clear_are_refused(made, table):
    first, second, third = frames(table).values()
    bare = frames(table, ["run"])["run001"]
    both = pyarrow.concat_tables([first, second])
    wrong = [
        ([first, first], "runs[1]", "run", 'expected each run in one table, found "run001" in an earlier one, too'),
        ([first, bare.slice(0, 0)], "runs[1]", None, "expected rows, found none"),
        ([both.drop_columns(["run"])], "runs[0]", "time_s", "expected times that rise, as there is no column run"),
        ({"run001": first, "b": second}, "runs['b']", "run", 'expected "b", the name of the table, found "run002"'),
        ([first, second.drop_columns(["time_s"])], "runs[1]", "time_s", "expected a column of this name, found none"),
    ]
    for runs, file, field, reason in wrong:
        with pytest.raises(rundown.RundownError) as caught:
            rundown.replay(runs, train=made.train, track=made.track)
        assert (str(caught.value.file), caught.value.field) == (file, field)
        assert caught.value.reason.startswith(reason), caught.value.reason
    for runs, place in [([first, "run002.csv"], r"runs\[1\]"), ({"a": "run001.csv"}, r"runs\['a'\]")]:
        with pytest.raises(TypeError, match=place + ": expected a table with Arrow's interface, found <class 'str'>"):
            rundown.replay(runs, train=made.train, track=made.track)
    with pytest.raises(ZeroDivisionError):
        rundown.replay((first if one else 1 / 0 for one in [1, 0]), train=made.train, track=made.track)
    # The same rows twice are one run, as everywhere.
    with pytest.warns(UserWarning, match="1 log refused, the first: .*holds the same rows as another one"):
        assert rundown.replay([bare, bare], train=made.train, track=made.track).runs == ["table1"]


@pytest.mark.parametrize(
    ("change", "field", "reason"),
    [
        (lambda table: table.drop_columns(["speed_kmh"]), "speed_kmh", "expected a column of this name, found none"),
        (
            lambda table: table.set_column(0, "run", [[0.5] * len(table)]),
            "run",
            "expected texts or whole numbers in this column, found Float64",
        ),
        (
            lambda table: table.append_column("direction", [["UP"] * len(table)]),
            "direction",
            'expected up, down or an empty cell, found "UP"',
        ),
        (
            lambda table: table.drop_columns(["run"]),
            "run",
            "expected a column of this name, found none; in a list a table without it is a run: runs=[table]",
        ),
        (
            lambda table: table.set_column(0, "run", [[None] * len(table)]),
            "run",
            "expected the name of the run in each row, found an empty cell",
        ),
        (
            lambda table: table.set_column(1, "time_s", table["time_s"].cast("int64", safe=False).cast(pyarrow.timestamp("s"))),
            "time_s",
            "expected numbers in this column, found Timestamp(s); seconds are (t - t.min()).dt.total_seconds() in pandas",
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


def test_a_gap_is_found_in_tables_as_in_their_files(tunnel, tmp_path):
    made, _ = tunnel
    for log in made.runs.glob("run[0-9]*.csv"):
        shutil.copy(log, tmp_path)
    described = {"train": made.train, "track": made.track}
    tables = frames(pyarrow.table(rows_of(made)), ["run"])
    ours, theirs = (rundown.gap(runs, **described) for runs in (tables, tmp_path))
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


def test_rows_that_are_not_together_are_refused(made, table):
    shuffled = table.take(pyarrow.array(sorted(range(len(table)), key=lambda row: row % 7)))
    for mixed in [table.sort_by("time_s"), shuffled]:
        with pytest.raises(rundown.RundownError, match="sort by run and time_s") as refused:
            rundown.replay(mixed, train=made.train, track=made.track)
        assert refused.value.field == "run"


def test_runs_may_be_numbered(made, table):
    numbers = pyarrow.array([int(name.removeprefix("run")) for name in table["run"].to_pylist()])
    numbered = rundown.replay(table.set_column(0, "run", numbers), train=made.train, track=made.track)
    named = rundown.replay(table, train=made.train, track=made.track)
    assert numbered.runs == [str(int(name.removeprefix("run"))) for name in named.runs]


def test_what_a_person_should_know_is_a_warning(made, tmp_path):
    logs = [tmp_path / log.name for log in sorted(made.runs.glob("run[0-9]*.csv"))]
    for log in logs:
        shutil.copy(made.runs / log.name, log)
    logs[0].write_text("time_s;location_m\n")
    with pytest.warns(UserWarning, match="1 log refused, the first: .*run001.csv"):
        learned = rundown.replay((log for log in logs), train=made.train, track=made.track)
    assert "1 log refused" in repr(learned) and "run001.csv" in str(learned)
    with pytest.warns(UserWarning, match="beyond the speeds of the runs"):
        learned.resistance(100)
    with pytest.raises(rundown.RundownError, match="expected speeds from 0 m/s on, found -1"):
        learned.resistance([10, -1])
    assert learned.resistance(v for v in [10, 20]).to_dict() == learned.resistance([10, 20]).to_dict()
    for wrong in ["20", ["20"], None]:
        with pytest.raises(TypeError, match="speeds_mps: expected a speed or several, m/s, found <class"):
            learned.resistance(wrong)
    with pytest.warns(UserWarning, match="1 log refused, the first: .*run001.csv"):
        assert rundown.check(logs).failed[0][0] == logs[0]


def test_what_is_no_table_is_refused_with_its_type(made):
    class Lazy:
        def collect(self):
            return None

    for wrong, found in [(5, "int"), (None, "NoneType"), (Lazy(), r"Lazy.*call its collect\(\)")]:
        with pytest.raises(TypeError, match="runs: expected a path, several paths, or a table.*" + found):
            rundown.replay(wrong, train=made.train, track=made.track)


def test_tables_are_frames_and_dictionaries(made, table):
    learned = rundown.replay(table, train=made.train, track=made.track)
    columns = learned.parameters.to_dict()
    assert columns["run"] == learned.runs and list(columns) == learned.parameters.column_names
    with pytest.raises(KeyError, match="expected a column of this table, found .rr0.; there are run, r0, "):
        learned.parameters["rr0"]
    pandas = pytest.importorskip("pandas")
    assert isinstance(learned.parameters.to_pandas(), pandas.DataFrame)
    assert learned.to_dict() == json.loads(learned.to_json())


def test_each_unit_has_its_own_resistance(made, table):
    of_run = table["run"].to_pylist()
    units = pyarrow.array(["202" if run == "run002" else "201" for run in of_run])
    at = table.column_names.index("unit") if "unit" in table.column_names else None
    of_units = table.append_column("unit", units) if at is None else table.set_column(at, "unit", units)
    learned = rundown.replay(of_units, train=made.train, track=made.track)
    assert learned.units == ["201", "202"]
    both = learned.resistance([20.0, 30.0])
    assert both["unit"] == ["201", "201", "202", "202"]
    for first, unit, last in [(0, "201", "run003"), (2, "202", "run002")]:
        own = learned.resistance([20.0, 30.0], unit=unit)
        assert own["resistance_n_per_kg"] == both["resistance_n_per_kg"][first : first + 2]
        assert own["resistance_n_per_kg"] == learned.resistance([20.0, 30.0], last)["resistance_n_per_kg"]
        assert "unit" not in own.column_names
    assert both["resistance_n_per_kg"][0] != both["resistance_n_per_kg"][2]
    with pytest.raises(rundown.RundownError, match="unit: expected one of 201, 202, found '?\"?203"):
        learned.resistance(20.0, unit="203")
    with pytest.raises(rundown.RundownError, match="run, unit: expected one of them, found both"):
        learned.resistance(20.0, "run002", unit="202")
    with pytest.raises(rundown.RundownError, match="unit: expected one of 201, 202: a picture is of one unit"):
        learned.plot()
    assert learned.plot(unit="201").svg != learned.plot(unit="202").svg
