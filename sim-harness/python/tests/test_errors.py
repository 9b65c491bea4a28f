"""Refusals are exceptions with their place."""

import _thread
import signal
import threading
import time

import pytest

import rundown


def test_a_wrong_field_names_its_place(reference, tmp_path):
    text = reference["train"].read_text().splitlines()
    line = next(index for index, one in enumerate(text) if one.strip().startswith("r0"))
    text[line] = "r0 = -1.0"
    train = tmp_path / "train.toml"
    train.write_text("\n".join(text))
    with pytest.raises(rundown.RundownError) as caught:
        rundown.replay(**{**reference, "train": train})
    error = caught.value
    assert (error.file, error.line) == (train, line + 1)
    assert error.column is not None and error.field.endswith("r0")
    assert "expected" in error.reason
    assert str(error).startswith(f"{train}:{line + 1}:")


def test_a_bad_row_names_its_place(reference, tmp_path):
    log = tmp_path / "bad.csv"
    lines = reference["runs"].read_text().splitlines()
    fields = lines[10].split(",")
    lines[10] = ",".join(["x", *fields[1:]])
    log.write_text("\n".join(lines) + "\n")
    with pytest.raises(rundown.RundownError) as caught:
        rundown.replay(**{**reference, "runs": log})
    error = caught.value
    assert (error.file, error.line, error.column, error.field) == (log, 11, 1, "time_s")
    assert str(error).startswith("none of 1 run logs could be used")
    left_out = rundown.replay(**{**reference, "runs": log}, skip_bad_rows=True)
    assert len(left_out.estimates()) == 115 and len(left_out.warnings) == 1
    both = rundown.replay(**{**reference, "runs": [log, reference["runs"]]})
    assert both.runs == ["run01"]
    [(path, text)] = both.failed
    assert path == log and f"{log}:11:1: time_s: " in text


def test_what_is_not_there_is_named(reference, tmp_path):
    nowhere = tmp_path / "nowhere.toml"
    with pytest.raises(rundown.RundownError, match="nowhere.toml") as caught:
        rundown.replay(**{**reference, "track": nowhere})
    assert caught.value.file == nowhere and caught.value.line is None
    with pytest.raises(rundown.RundownError, match="nowhere"):
        rundown.gap(tmp_path / "nowhere", train=reference["train"], track=reference["track"])
    scenario = tmp_path / "scenario.toml"
    scenario.write_text("rums = 3\n")
    with pytest.raises(rundown.RundownError) as caught:
        rundown.simulate(tmp_path / "out", scenario=scenario)
    assert (caught.value.file, caught.value.line, caught.value.column) == (scenario, 1, 1)


@pytest.mark.parametrize(
    ("option", "expected"),
    [
        ({"mode": "papre"}, "mode: expected paper, gated, measured"),
        ({"direction": "left"}, "direction: expected auto, up, down"),
        ({"tick": 0.0}, "tick: expected a number of seconds above 0"),
    ],
)
def test_a_wrong_option_says_what_is_expected(reference, option, expected):
    with pytest.raises(rundown.RundownError, match=expected):
        rundown.replay(**reference, **option)


def test_a_run_that_was_not_replayed_is_refused(reference):
    learned = rundown.replay(**reference)
    with pytest.raises(rundown.RundownError, match="run02"):
        learned.estimates("run02")


def test_an_import_is_refused_with_its_place(tmp_path):
    log = tmp_path / "export.csv"
    log.write_text("foo;bar\n1;2\n3;4\n5;6\n")
    with pytest.raises(rundown.RundownError, match="expected columns for time") as caught:
        rundown.import_logs(log, out=tmp_path / "runs")
    assert caught.value.file == log and caught.value.reason.startswith("expected columns")
    mapping = tmp_path / "import.toml"
    mapping.write_text("[runs]\ngap_s = -1.0\n")
    with pytest.raises(rundown.RundownError) as caught:
        rundown.import_logs(log, out=tmp_path / "runs", mapping=mapping)
    error = caught.value
    assert (error.file, error.line, error.field) == (mapping, 2, "runs.gap_s")
    with pytest.raises(rundown.RundownError, match="nowhere.csv") as caught:
        rundown.import_logs(tmp_path / "nowhere.csv", out=tmp_path / "runs")
    assert caught.value.file == tmp_path / "nowhere.csv"
    with pytest.raises(rundown.RundownError, match="chainage: expected as-is, stops, line, align"):
        rundown.import_logs(log, out=tmp_path / "runs", chainage="by eye")
    assert not (tmp_path / "runs").exists()


def test_an_export_is_refused_with_its_place(made, tmp_path):
    learned, out = tmp_path / "learned", tmp_path / "out"
    about = {"train": made.train, "max_speed": 140, "out": out}
    with pytest.raises(rundown.RundownError, match="rundown replay --out") as caught:
        rundown.export(learned, to="sumo", **about)
    assert caught.value.file == learned / "replay.json"
    with pytest.raises(rundown.RundownError, match="expected a recording of a board .* found none in 0 frames"):
        rundown.export(made.train, to="sumo", **about)
    rundown.replay(made.runs, train=made.train, track=made.track).write(learned)
    with pytest.raises(rundown.RundownError) as caught:
        rundown.export(learned, to="sumo", unit="nobody", **about)
    assert (caught.value.file, caught.value.field) == (learned / "replay.json", "unit")
    wrong = [
        ({"to": "matlab"}, "to: expected sfera, sumo, sumo-table, osrd, trainruns, altrios"),
        ({"to": "osrd"}, "traction: expected for sfera and osrd, found none"),
        ({"to": "osrd", "traction": "steam"}, "traction: expected diesel, battery"),
        ({"to": "sfera", "traction": "diesel"}, "company: expected for sfera, found none"),
        ({"to": "sfera", "traction": "diesel", "company": "84"}, "company: expected a RICS code .* found \"84\""),
        ({"to": "sumo", "max_speed": 0}, "max_speed: expected 1 to 600 km/h, found 0"),
    ]
    for options, expected in wrong:
        with pytest.raises(rundown.RundownError, match=expected):
            rundown.export(learned, **{**about, **options})
    assert not out.exists()


def test_messages_name_the_arguments_of_python(made, reference, tmp_path):
    with pytest.raises(rundown.RundownError, match="overwrite with force=True$") as caught:
        rundown.simulate(made.folder)
    assert caught.value.reason.endswith("overwrite with force=True")
    bad, text = tmp_path / "bad.csv", reference["runs"].read_text()
    bad.write_text(text.replace("\n100.0,", "\nx,", 1))
    assert bad.read_text() != text
    with pytest.raises(rundown.RundownError, match="leave such rows out with skip_bad_rows=True$"):
        rundown.replay(**{**reference, "runs": bad})
    with pytest.warns(UserWarning, match="leave such rows out with skip_bad_rows=True"):
        learned = rundown.replay(**{**reference, "runs": [bad, reference["runs"]]})
    assert learned.failed[0][1].endswith("skip_bad_rows=True") and "skip_bad_rows=True" in str(learned)
    # The command's own words stay in what the command writes.
    assert "--skip-bad-rows" in learned.to_json()


def test_notes_name_the_arguments_of_python(tunnel, made, tmp_path):
    hidden, _ = tunnel
    described = {"train": hidden.train, "track": hidden.track}
    with pytest.warns(UserWarning, match='effort_n_per_kg is not used: mode="measured" learns from it'):
        learned = rundown.replay(hidden.runs, **described)
    assert any('mode="measured"' in note for note in learned.notes) and "--" not in str(learned)
    with pytest.raises(rundown.RundownError, match=r"^hold_out=10: an analysis needs 5 runs and there are 10"):
        rundown.gap(hidden.runs, hold_out=10, **described)
    described, out = {"train": made.train, "track": made.track}, tmp_path / "out"
    learned = rundown.replay(made.runs, **described)
    rundown.export(learned, to="sumo", max_speed=140, out=out, train=made.train)
    again = rundown.export(learned, to="altrios", max_speed=140, out=out, train=made.train)
    assert again.notes[-1].endswith("kept as an earlier export wrote them: sumo.add.xml")
    apart = rundown.replay(made.runs, carry=False, **described)
    with pytest.raises(rundown.RundownError, match="found a replay made with carry=False"):
        rundown.export(apart, to="sumo", max_speed=140, out=out, train=made.train)


def test_what_an_import_leaves_out_is_said_in_words_of_python(tmp_path):
    """Runs whose locations begin at 0, at stops that do not agree."""
    for number in (1, 2, 3):
        rows, location = [], 0.0
        for second in range(600):
            speed = 12.0 if second % (100 + 37 * number) > 20 else 0.0
            location += speed
            rows.append(f"{second};{location};{3.6 * speed}")
        (tmp_path / f"log{number}.csv").write_text("\n".join(["time [s];location [m];speed [km/h]", *rows]))
    with pytest.warns(UserWarning, match="the first: .*all in .warnings$"):
        imported = rundown.import_logs(tmp_path, out=tmp_path / "runs")
    said = "\n".join(imported.notes)
    assert 'chainage="as-is" keeps the locations as they are, track="K.toml" places runs by the stops of a track' in said
    with pytest.raises(rundown.RundownError, match="strict=True: expected nothing to be warned of"):
        rundown.import_logs(tmp_path, out=tmp_path / "strict", strict=True)


def test_one_of_two_sources_is_asked_for(made, tmp_path):
    with pytest.raises(rundown.RundownError, match="scenario, example: expected one of them, found both"):
        rundown.simulate(tmp_path / "set", scenario=made.truth / "scenario.toml", example="hidden_effect")
    with pytest.raises(rundown.RundownError, match="train: expected a track beside it, found none"):
        rundown.check(made.runs, train=made.train)


def test_progress_counts_the_runs(made, capsys):
    told = []
    rundown.replay(made.runs, train=made.train, track=made.track, progress=lambda *now: told.append(now))
    assert told == [(1, 3), (2, 3), (3, 3)]
    assert capsys.readouterr().err == ""
    rundown.replay(made.runs, train=made.train, track=made.track, progress=True)
    assert capsys.readouterr().err.endswith("3 of 3 runs\n")


def test_what_progress_raises_is_raised(made):
    def stop(done, total):
        raise KeyboardInterrupt(f"{done} of {total}")

    with pytest.raises(KeyboardInterrupt, match="1 of 3"):
        rundown.replay(made.runs, train=made.train, track=made.track, progress=stop)


def test_a_check_says_its_progress(made):
    told = []
    rundown.check(made.runs, progress=lambda *now: told.append(now))
    assert sorted(told) == [(1, 3), (2, 3), (3, 3)]


def interrupted(call):
    """Seconds from an interrupt of the keyboard to its exception in the call."""
    sent = []

    def interrupt():
        sent.append(time.monotonic())
        _thread.interrupt_main()

    # A shell that runs the tests in the background has the signal ignored.
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    timer = threading.Timer(0.3, interrupt)
    timer.start()
    try:
        with pytest.raises(KeyboardInterrupt):
            call()
    finally:
        timer.join()
        signal.signal(signal.SIGINT, before)
    return time.monotonic() - sent[0]


def test_an_interrupt_ends_the_call_and_leaves_nothing(tmp_path):
    # Without the interrupt it takes a minute.
    waited = interrupted(lambda: rundown.simulate(tmp_path / "set", runs=4000))
    assert waited < 5.0
    assert not (tmp_path / "set").exists()
    # The next call is another one.
    assert rundown.simulate(tmp_path / "set", runs=1).runs.exists()


def test_other_threads_go_on_while_it_works(tmp_path):
    ticks, done = [], threading.Event()

    def count():
        while not done.is_set():
            ticks.append(time.monotonic())
            time.sleep(0.005)

    thread = threading.Thread(target=count)
    thread.start()
    begun = time.monotonic()
    rundown.simulate(tmp_path / "set", runs=40)
    ended = time.monotonic()
    done.set()
    thread.join()
    inside = [begun, *(tick for tick in ticks if begun < tick < ended), ended]
    longest = max(after - before for before, after in zip(inside, inside[1:]))
    assert ended - begun > 0.1, "too short to be a test"
    assert longest < 0.5 * (ended - begun), (longest, ended - begun)


def test_what_a_frame_of_pandas_lacks_is_named_with_what_installs_it(made):
    class Frame:
        """As one of pandas where pyarrow is not installed."""

        def __arrow_c_stream__(self, requested_schema=None):
            raise ImportError("Import pyarrow failed.")

    with pytest.raises(ImportError, match="runs.*: expected .*Frame.*`pip install pyarrow`") as refused:
        rundown.replay({"a": Frame()}, train=made.train, track=made.track)
    assert "Import pyarrow failed" in str(refused.value.__cause__)
