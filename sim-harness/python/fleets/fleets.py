"""Replays a fleet with DuckDB, Ray Data and Spark, and compares each with the command `rundown replay`. `cargo xtask fleets` runs this.

    python sim-harness/python/fleets/fleets.py --runs 2010 --work out/fleets

RUNDOWN_COMMAND is the path of the command. Exit code 1: an engine's table differs from the command's in a bit.
"""

import argparse
import os
import shutil
import subprocess
import sys
from pathlib import Path

import pyarrow.parquet
from fleet import differences, partition
from measure import measured

ENGINES = ["duckdb", "ray", "spark"]


def command(*words):
    subprocess.run([os.environ["RUNDOWN_COMMAND"], *map(str, words)], check=True, stdout=subprocess.DEVNULL)


def made(work, count):
    """Simulated runs of units, each with a train of its own, and their description."""
    fleet, runs = work / "fleet", work / "runs.parquet"
    if not (runs.exists() and pyarrow.parquet.ParquetFile(runs).metadata.num_rows and (work / str(count)).exists()):
        # Only what is made here: the folder may hold other things.
        shutil.rmtree(fleet, ignore_errors=True)
        runs.unlink(missing_ok=True)
        work.mkdir(parents=True, exist_ok=True)
        print(f"{count} runs are simulated", flush=True)
        command("study", "--count", count, "--out", fleet, "--keep-runs", runs)
        (work / str(count)).touch()
    return runs, fleet / "train.toml", fleet / "track.toml"


def by_command(runs, train, track, out):
    shutil.rmtree(out, ignore_errors=True)
    words = ["replay", "--format", "parquet", "--no-estimates", "--train", train, "--track", track, "--out", out, runs]
    taken = measured([os.environ["RUNDOWN_COMMAND"], *map(str, words)])
    return taken, pyarrow.parquet.read_table(out / "parameters.parquet")


def by_engine(engine, runs, train, track, out):
    # A process of its own: what it takes is the engine's alone.
    script = f"from with_{engine} import learn; import sys; learn(*sys.argv[1:])"
    taken = measured([sys.executable, "-c", script, *map(str, [runs, train, track, out])])
    return taken, pyarrow.parquet.read_table(out)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--runs", type=int, default=2010)
    parser.add_argument("--work", type=Path, default=Path("out/fleets"))
    parser.add_argument("--engines", nargs="+", choices=ENGINES, default=ENGINES)
    given = parser.parse_args()
    work = given.work.resolve()
    # Where the engines' own processes find the modules.
    os.environ["PYTHONPATH"] = os.pathsep.join([str(Path(__file__).parent), os.environ.get("PYTHONPATH", "")])
    whole, train, track = made(work, given.runs)
    differ = False
    print(f"{'':8} {'runs':>6} {'elapsed, s':>11} {'processor, s':>13} {'memory, MB':>11}  bits", flush=True)
    for count in [given.runs // 4, given.runs]:
        runs = work / f"runs_{count}"
        shutil.rmtree(runs, ignore_errors=True)
        partition(whole, runs, count)
        taken, expected = by_command(runs, train, track, work / "replay")
        said("command", count, taken, "")
        for engine in given.engines:
            taken, found = by_engine(engine, runs, train, track, work / f"{engine}.parquet")
            columns = differences(expected, found)
            differ |= bool(columns)
            said(engine, count, taken, "the same" if not columns else f"differ in {', '.join(columns)}")
    sys.exit(int(differ))


def said(name, count, taken, word):
    elapsed_s, processor_s, memory_mb = taken
    print(f"{name:8} {count:6} {elapsed_s:11.1f} {processor_s:13.1f} {memory_mb:11.0f}  {word}", flush=True)


if __name__ == "__main__":
    main()
