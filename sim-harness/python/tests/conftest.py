"""What the tests share: the reference run, a small simulated set, the command."""

import os
import subprocess
from pathlib import Path

import pytest

import rundown

ROOT = Path(__file__).resolve().parents[3]
REFERENCE = ROOT / "data" / "reference"


@pytest.fixture(scope="session")
def reference():
    """Log, train and track of the reference run."""
    return {"runs": REFERENCE / "run01.csv", "train": REFERENCE / "train.toml", "track": REFERENCE / "track.toml"}


@pytest.fixture(scope="session")
def made(tmp_path_factory):
    """Three simulated runs of a recorder that truncates."""
    folder = tmp_path_factory.mktemp("made")
    return rundown.simulate(folder, runs=3, seed=7, recorder="event_recorder")


@pytest.fixture(scope="session")
def command():
    """Runs the command `rundown` that was built beside the module. Without it the comparison would mean nothing."""
    program = os.environ.get("RUNDOWN_COMMAND")
    assert program, "RUNDOWN_COMMAND: expected the path of the command `rundown`; `cargo xtask python` sets it"

    def run(*arguments):
        arguments = [program, *map(str, arguments)]
        return subprocess.run(arguments, check=True, capture_output=True, text=True).stdout

    return run


@pytest.fixture(scope="session")
def tunnel(tmp_path_factory):
    """Runs through a tunnel that the described track lacks, and what the gap workflow says of them."""
    made = rundown.simulate(tmp_path_factory.mktemp("tunnel"), example="hidden_effect", runs=10)
    return made, rundown.gap(made.runs, train=made.train, track=made.track)
