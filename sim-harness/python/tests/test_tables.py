"""A table hands itself to pandas, polars, pyarrow and DuckDB; its numbers stay where they are."""

import math
import pickle
import re

import pytest

import rundown


@pytest.fixture(scope="module")
def table(reference):
    return rundown.replay(**reference).estimates()


def test_pyarrow_takes_it_without_a_copy(table):
    pyarrow = pytest.importorskip("pyarrow")
    first, second = pyarrow.table(table), pyarrow.table(table)
    assert first.column("r0").to_pylist() == table["r0"]
    address = lambda taken: taken.column("r0").chunk(0).buffers()[1].address
    assert address(first) == address(second)
    unit = first.schema.field("r2").metadata[b"unit"].decode()
    assert unit == "N/kg per (m/s)²" == table.units["r2"]
    assert first.schema.field("learning").type == pyarrow.int64()


def test_pandas_takes_it(table):
    pandas = pytest.importorskip("pandas")
    if not hasattr(pandas.DataFrame, "from_arrow"):
        pytest.skip("pandas before 3.0 takes Arrow through pyarrow only")
    frame = pandas.DataFrame.from_arrow(table)
    assert list(frame.columns) == table.column_names
    assert frame["speed_mps"].tolist() == table["speed_mps"]
    assert frame["innovation_speed_mps"].isna().sum() == table["innovation_speed_mps"].count(None) > 0


def test_polars_takes_it(table):
    polars = pytest.importorskip("polars")
    frame = polars.DataFrame(table)
    assert frame["location_m"].to_list() == table["location_m"]
    assert frame.filter(polars.col("learning") == 1).height == sum(table["learning"]) > 0


def test_duckdb_asks_it(table):
    duckdb = pytest.importorskip("duckdb")
    ticks = table
    found = duckdb.sql("select count(*), max(speed_mps) from ticks").fetchall()
    assert found == [(len(ticks), max(ticks["speed_mps"]))]


def test_a_column_that_is_not_there_is_a_key_error(table):
    with pytest.raises(KeyError, match="r3"):
        table["r3"]


def test_a_notebook_shows_its_ends_with_units_and_meanings(reference):
    learned = rundown.replay(**reference)
    ticks = learned.estimates()
    page = ticks._repr_html_()
    assert page.count("<tr>") == 1 + 11 and f"{len(ticks)} rows" in page
    head = page[page.index("r2<") - 300 : page.index("r2<") + 40]
    assert "N/kg per (m/s)²" in page and f'title="{ticks.meanings["r2"]}"' in head
    assert f"<td>{ticks['regime'][0]}</td>" in page and "\u2026" in page
    # Six digits are enough to look at; the values have all.
    shown = [float(text) for text in re.findall(r"<td>([-+.e0-9]+)</td>", page)]
    fast = max(ticks["speed_mps"][:5] + ticks["speed_mps"][-5:])
    assert any(number != fast and math.isclose(number, fast, rel_tol=1e-5) for number in shown)
    short = learned.parameters._repr_html_()
    assert short.count("<tr>") == 1 + len(learned.parameters) and "\u2026" not in short


def test_resistance_has_its_band(reference):
    learned = rundown.replay(**reference)
    speeds = [0.0, 20.0, 100 / 3.6]
    found = learned.resistance(speeds)
    last = learned.parameters
    r0, r1, r2 = (last[name][-1] for name in ["r0", "r1", "r2"])
    for index, v in enumerate(speeds):
        mean, sd = found["resistance_n_per_kg"][index], found["sd_n_per_kg"][index]
        assert math.isclose(mean, r0 + r1 * v + r2 * v * v, rel_tol=1e-12)
        assert math.isclose(found["high_n_per_kg"][index] - mean, 1.96 * sd, rel_tol=1e-9)
        assert math.isclose(mean - found["low_n_per_kg"][index], 1.96 * sd, rel_tol=1e-9)
    assert math.isclose(found["sd_n_per_kg"][0], last["sd_r0"][-1], rel_tol=1e-12)
    before = learned.resistance(speeds, of="before")
    assert before["sd_n_per_kg"][2] > found["sd_n_per_kg"][2], "a run narrows the band"
    assert len(learned.resistance(20.0)) == 1


def test_a_table_is_pickled_with_its_units(reference):
    pyarrow = pytest.importorskip("pyarrow")
    learned = rundown.replay(**reference)
    for table in (learned.parameters, learned.estimates(), learned.switching_points):
        again = pickle.loads(pickle.dumps(table))
        assert pyarrow.table(again).schema.equals(pyarrow.table(table).schema, check_metadata=True)
        # Bit for bit: a number that is none is not equal to itself.
        assert repr(again.to_dict()) == repr(table.to_dict()) and again.units == table.units
    with pytest.raises(TypeError, match="hand on its tables"):
        pickle.dumps(learned)
