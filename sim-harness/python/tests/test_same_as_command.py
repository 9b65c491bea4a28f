"""The module and the command say the same, to the last byte."""

import csv
import json

import pytest

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
    described = rundown.check(made.runs, train=made.train, track=made.track)
    options = ["--train", made.train, "--track", made.track]
    assert described.to_json() + "\n" == command("check", "--json", *options, made.runs)


def test_gap(tunnel, command, tmp_path):
    made, found = tunnel
    options = ["--train", made.train, "--track", made.track, "--runs", made.runs]
    command("gap", *options, "--out", tmp_path / "command")
    found.write(tmp_path / "python")
    for path in without_times((tmp_path / "command").rglob("*.*")):
        other = tmp_path / "python" / path.relative_to(tmp_path / "command")
        assert path.read_bytes() == other.read_bytes(), path.name
    same(found.residuals, tmp_path / "command" / "residuals.csv")
    same(found.powering, tmp_path / "command" / "powering.csv")
    same(found.before_after, tmp_path / "command" / "before_after.csv")
    assert found.to_json() == (tmp_path / "command" / "gap.json").read_text()


def same_files(one, other):
    """The same names and, but for the manifest, the same bytes."""
    names = files(one)
    assert names == files(other)
    for name in without_times(names):
        assert (one / name).read_bytes() == (other / name).read_bytes(), name


@pytest.fixture
def recorded(tmp_path):
    """Two exports of a recorder from stop to stop: a semicolon between columns, decimal commas, and units in the headers."""
    for number in (1, 2):
        rows, location = [], 0.0
        for second in range(300):
            speed = min(second, 10 + number, (299 - second) / 2)
            location += speed
            rows.append(f"{second};{location};{3.6 * speed:.1f}".replace(".", ","))
        text = "\n".join(["time [s];location [m];speed [km/h]", *rows])
        (tmp_path / f"export{number}.csv").write_text(text + "\n")
    return [tmp_path / "export1.csv", tmp_path / "export2.csv"]


def test_import(recorded, command, tmp_path):
    text = command("import", "--out", tmp_path / "out", "--track-out", tmp_path / "track.toml", *recorded)
    (tmp_path / "out").rename(tmp_path / "command")
    track = (tmp_path / "track.toml").read_bytes()
    (tmp_path / "track.toml").unlink()
    # Into the same place: `print` names it.
    imported = rundown.import_logs(recorded, out=tmp_path / "out", track_out=tmp_path / "track.toml")
    assert str(imported) == text
    assert (len(imported), imported.failed) == (2, [])
    same_files(tmp_path / "command", imported.folder)
    assert (tmp_path / "track.toml").read_bytes() == track
    again = rundown.import_logs(mapping=imported.folder / "import.toml", out=tmp_path / "again")
    assert (again.folder / "export1_01.csv").read_bytes() == (imported.folder / "export1_01.csv").read_bytes()


def test_the_options_of_an_import_reach_it(recorded, command, tmp_path):
    command("import", "--chainage", "as-is", "--out", tmp_path / "command", *recorded)
    rundown.import_logs(recorded, out=tmp_path / "python", chainage="as-is")
    same_files(tmp_path / "command", tmp_path / "python")
    usual = rundown.import_logs(recorded, out=tmp_path / "usual")
    placed = json.loads((usual.folder / "import.json").read_text())["chainage"]
    assert placed == "stops"


def test_export(made, command, tmp_path):
    learned = tmp_path / "learned"
    rundown.replay(made.runs, train=made.train, track=made.track).write(learned)
    formats = ["sfera", "sumo", "sumo-table", "osrd", "trainruns", "altrios"]
    about = ["--train", made.train, "--max-speed", 140, "--company", "0084", "--traction", "1500V"]
    named = ["--id", "unit 7", "--tc-version", "3"]
    out = tmp_path / "out"
    text = command("export", "--to", ",".join(formats), *about, *named, "--out", out, learned)
    out.rename(tmp_path / "command")
    options = {"train": made.train, "max_speed": 140, "company": "0084", "traction": "1500V"}
    exported = rundown.export(learned, to=formats, out=out, id="unit 7", tc_version="3", **options)
    assert str(exported) == text
    same_files(tmp_path / "command", out)
    assert exported.files[-1] == out / "train.toml" and len(exported.files) == len(formats) + 1
    # A replay in memory is that of its folder; what it was made from stands in the manifest.
    replayed = rundown.replay(made.runs, train=made.train, track=made.track)
    again = rundown.export(replayed, to=formats, out=tmp_path / "again", id="unit 7", tc_version="3", **options)
    same_files(out, again.folder)
    inputs = [one["file"] for one in json.loads((again.folder / "manifest.json").read_text())["inputs"]]
    assert inputs.count(str(made.train)) == 1 and str(made.runs / "run001.csv") in inputs
    other = tmp_path / "other.toml"
    other.write_text(made.train.read_text().replace("364000", "365000"))
    with pytest.raises(rundown.RundownError, match="replay: train: expected the train that was replayed"):
        rundown.export(replayed, to="sumo", max_speed=140, train=other, out=tmp_path / "other")
    with pytest.raises(TypeError, match="replay: expected a rundown.Replay, the folder of one, .* found <class 'int'>"):
        rundown.export(7, to="sumo", max_speed=140, train=other, out=tmp_path / "other")
    # The learned train is one for a replay.
    rundown.replay(made.runs, train=exported.files[-1], track=made.track)
    one = rundown.export(learned, to="sumo", train=made.train, max_speed=140, out=tmp_path / "one")
    assert [path.name for path in one.files] == ["sumo.add.xml", "train.toml"]


def test_preview(recorded, command, tmp_path):
    text = command("import", f"--preview={tmp_path / 'speeds.svg'}", *recorded)
    preview = rundown.preview_logs(recorded)
    assert text.startswith(f"{preview}\n") and preview.failed == []
    assert preview.plot().svg == (tmp_path / "speeds.svg").read_text()
    assert rundown.import_logs(recorded, out=tmp_path / "runs").notes[: len(preview.notes)] == preview.notes


def test_convert(made, command, tmp_path):
    rundown.replay(made.runs, train=made.train, track=made.track).write(tmp_path / "learned")
    out = tmp_path / "out"
    rundown.export(tmp_path / "learned", train=made.train, to="altrios", max_speed=140, out=out)
    given = {"max_tractive_effort_n": 2e5, "max_power_w": 2e6}
    set = [word for name, value in given.items() for word in ("--set", f"{name}={value}")]
    command("convert", out / "altrios.yaml", *set, "--out", tmp_path / "command.toml")
    converted = rundown.convert(out / "altrios.yaml", out=tmp_path / "python.toml", set=given)
    assert (converted.kind, converted.file) == ("train", tmp_path / "python.toml")
    assert converted.file.read_bytes() == (tmp_path / "command.toml").read_bytes() and converted.notes
    wrong = [
        ({"out": converted.file, "set": given}, "out: expected a new file"),
        ({"out": tmp_path / "new.toml"}, "max_tractive_effort_n: expected a value, found none"),
        ({"out": tmp_path / "new.toml", "set": {"mass": 1.0}}, "set: expected a field of mass_kg"),
        ({"out": tmp_path / "new.toml", "set": {"mass_kg": float("nan")}}, "set: mass_kg: expected a finite number"),
    ]
    for options, expected in wrong:
        with pytest.raises(rundown.RundownError, match=expected):
            rundown.convert(out / "altrios.yaml", **options)
    assert not (tmp_path / "new.toml").exists()
