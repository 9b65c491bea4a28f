"""The example of a fleet with DuckDB, on a small one: the same bits as the command. All engines: `cargo xtask fleets`."""

import sys
from pathlib import Path

import pytest

parquet = pytest.importorskip("pyarrow.parquet")
pytest.importorskip("duckdb")


@pytest.fixture
def examples(monkeypatch):
    monkeypatch.syspath_prepend(str(Path(__file__).resolve().parents[1] / "fleets"))
    yield
    for name in ["unit", "with_duckdb", "fleet"]:
        sys.modules.pop(name, None)


def test_duckdb_and_the_command_learn_the_same(examples, command, tmp_path):
    import fleet
    import with_duckdb

    whole, study = tmp_path / "runs.parquet", tmp_path / "study"
    # The simulated units have 67 runs each: a second one begins.
    command("study", "--count", 70, "--out", study, "--keep-runs", whole)
    train, track, runs = study / "train.toml", study / "track.toml", tmp_path / "runs"
    fleet.partition(whole, runs)
    assert sorted(path.name for path in runs.iterdir()) == ["unit=unit001", "unit=unit002"]
    out = tmp_path / "replay"
    command("replay", "--format", "parquet", "--no-estimates", "--train", train, "--track", track, "--out", out, runs)
    expected = parquet.read_table(out / "parameters.parquet")
    with_duckdb.learn(runs, train, track, tmp_path / "learned.parquet")
    found = parquet.read_table(tmp_path / "learned.parquet")
    assert found.num_rows == 70
    assert fleet.differences(expected, found) == []
    # A comparison that sees no difference would prove nothing.
    wrong = found.set_column(1, "r0", [[value * (1 + 2**-52) for value in found["r0"].to_pylist()]])
    assert fleet.differences(expected, wrong) == ["r0"]
