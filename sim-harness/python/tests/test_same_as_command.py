"""The module and the command say the same, to the last byte."""

import csv
import json

import rundown


def cells(table):
    """The table as the text of a CSV file."""
    columns = [table[name] for name in table.column_names]
    rows = [list(row) for row in zip(*columns)] if len(table) else []
    return table.column_names, rows


def same(table, path, without=()):
    """Number for number: each field of the file, read as Python reads it, is the value of the table."""
    names, rows = cells(table)
    with path.open(newline="") as file:
        header, *lines = list(csv.reader(file))
    kept = [index for index, name in enumerate(names) if name not in without]
    assert [names[index] for index in kept] == header
    assert len(rows) == len(lines)
    for row, line in zip(rows, lines):
        for index, field in zip(kept, line):
            value = row[index]
            if value is None:
                assert field == "", names[index]
            elif isinstance(value, str):
                assert field == value
            else:
                # The very bits: no tolerance.
                assert type(value)(field) == value, names[index]
                assert repr(type(value)(field)) == repr(value), names[index]


def without_times(paths):
    """All files but the manifest: it alone says when they were written."""
    return sorted(path for path in paths if "manifest.json" not in str(path))


def files(folder):
    """Names of all files, those in folders of it too."""
    return sorted(path.relative_to(folder).as_posix() for path in folder.rglob("*") if path.is_file())


def test_replay_of_the_reference_run(reference, command, tmp_path):
    ran, written = tmp_path / "command", tmp_path / "python"
    options = ["--train", reference["train"], "--track", reference["track"]]
    command("replay", *options, "--out", ran, reference["runs"])
    learned = rundown.replay(**reference)
    same(learned.estimates("run01"), ran / "run01.estimates.csv", without=["run"])
    same(learned.coast_ahead("run01"), ran / "run01.coast_ahead.csv", without=["run"])
    same(learned.features, ran / "features.csv")
    same(learned.parameters, ran / "parameters.csv")
    same(learned.switching_points, ran / "switching_points.csv")
    assert len(learned.estimates()) == 116
    learned.write(written)
    names = files(ran)
    assert names == files(written)
    assert {"run01.estimates.csv", "report.html", "report/run0001.html", "replay.json"} <= set(names)
    for name in without_times(names):
        assert (ran / name).read_bytes() == (written / name).read_bytes(), name
    assert learned.to_json().encode() == (ran / "replay.json").read_bytes()


def test_options_reach_the_estimator(made, command, tmp_path):
    options = ["--train", made.train, "--track", made.track, "--mode", "paper", "--no-carry", "--as-recorded"]
    text = command("replay", *options, "--tick", 20, "--direction", "up", "--json", "--out", tmp_path, made.runs)
    same_options = {"mode": "paper", "carry": False, "as_recorded": True, "tick": 20, "direction": "up"}
    learned = rundown.replay(made.runs, train=made.train, track=made.track, **same_options)
    assert learned.to_json() == text
    assert json.loads(text)["tick_s"] == 20
    usual = rundown.replay([made.runs], train=str(made.train), track=str(made.track))
    assert usual.to_json() != text


def test_simulate(made, command, tmp_path):
    command("simulate", "--out", tmp_path / "set", "--runs", 3, "--seed", 7, "--recorder", "event_recorder")
    for path in without_times((tmp_path / "set").rglob("*.*")):
        other = made.folder / path.relative_to(tmp_path / "set")
        assert path.read_bytes() == other.read_bytes(), path.name


def test_check(made, command):
    found = rundown.check(made.runs)
    assert found.to_json() + "\n" == command("check", "--json", made.runs)
    assert str(found) == command("check", made.runs)
    assert "truncated_speed" in found.findings["kind"]


def test_gap(tunnel, command, tmp_path):
    made, found = tunnel
    options = ["--train", made.train, "--track", made.track, "--runs", made.runs]
    command("gap", *options, "--out", tmp_path / "command")
    found.write(tmp_path / "python")
    for path in without_times((tmp_path / "command").rglob("*.*")):
        other = tmp_path / "python" / path.relative_to(tmp_path / "command")
        assert path.read_bytes() == other.read_bytes(), path.name
    same(found.residuals, tmp_path / "command" / "residuals.csv")
    same(found.pulls, tmp_path / "command" / "pulls.csv")
    same(found.before_after, tmp_path / "command" / "before_after.csv")
    assert found.to_json() == (tmp_path / "command" / "gap.json").read_text()
