#!/usr/bin/env python3
"""A fleet's logs, partitioned by unit and day, through `rundown study` on every core, and asked with DataFusion.

    pip install datafusion==55.0.0
    cargo build --release -p sim-harness
    python3 docs/scale/fleet_year.py --units 8 --work out/scale

The way is that of a cluster; here one node plays all of it:

    runs.parquet --(DataFusion: COPY ... PARTITIONED BY)--> runs/unit=U/day=D/*.parquet
    each unit is a task: rundown study --runs runs/unit=U --> results/unit=U/runs.parquet
    results/*/runs.parquet --(DataFusion: SQL)--> one table

A unit is the smallest task, because what is learned is carried from run to run; days follow each other within it.
"""

import argparse
import os
import pathlib
import subprocess
import sys
import time
from concurrent.futures import ThreadPoolExecutor

import pyarrow
from datafusion import SessionConfig, SessionContext

ROOT = pathlib.Path(__file__).resolve().parents[2]
RUNDOWN = ROOT / "target/release/rundown"
RUNS_OF_A_UNIT = 67  # of the simulated fleet
RUNS_A_DAY = 8


def command(*words):
    done = subprocess.run([RUNDOWN, *map(str, words)], capture_output=True, text=True)
    if done.returncode:
        sys.exit(f"rundown {' '.join(map(str, words))}: exit code {done.returncode}\n{done.stderr}")
    return done.stdout


def timed(name, work):
    start = time.monotonic()
    result = work()
    print(f"{name:46} {time.monotonic() - start:6.1f} s")
    return result


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--units", type=int, default=8)
    parser.add_argument("--work", type=pathlib.Path, default=pathlib.Path("out/scale"))
    parser.add_argument("--workers", type=int, default=os.cpu_count())
    given = parser.parse_args()
    work = given.work
    work.mkdir(parents=True, exist_ok=True)
    count = given.units * RUNS_OF_A_UNIT

    fleet = work / "fleet"
    timed(
        f"simulate and study {count} runs",
        lambda: command("study", "--count", count, "--out", fleet, "--keep-runs", work / "runs.parquet"),
    )

    # One partition of the plan keeps the rows of a run in their order.
    context = SessionContext(SessionConfig().with_target_partitions(1))
    context.register_parquet("rows", str(work / "runs.parquet"))
    partitioned = work / "runs"
    day = f"lpad(cast((cast(right(run, 2) as int) - 1) / {RUNS_A_DAY} as varchar), 3, '0')"
    split = f"""
        COPY (SELECT run, direction, time_s, location_m, speed_kmh, unit, {day} AS day
              FROM rows ORDER BY unit, run, time_s)
        TO '{partitioned}/' STORED AS PARQUET PARTITIONED BY (unit, day) OPTIONS ('format.compression' 'snappy')
    """
    timed("partition by unit and day", lambda: context.sql(split).collect())
    units = sorted(partitioned.glob("unit=*"))
    days = sum(len(list(unit.glob("day=*"))) for unit in units)
    print(f"{'':46} {len(units)} units, {days} days of units")

    results = work / "results"
    # One thread a task: the tasks are what runs side by side.
    os.environ["RAYON_NUM_THREADS"] = "1"

    def study(unit):
        out = results / f"unit_id={unit.name.split('=')[1]}"
        description = ["--train", fleet / "train.toml", "--track", fleet / "track.toml"]
        command("study", "--runs", unit, *description, "--out", out)

    with ThreadPoolExecutor(given.workers) as pool:
        timed(f"study of each unit, {given.workers} side by side", lambda: list(pool.map(study, units)))

    context = SessionContext()
    context.register_parquet("results", str(results), table_partition_cols=[("unit_id", pyarrow.string())])
    answer = context.sql(
        """
        SELECT unit_id, count(*) AS runs,
               round(avg(gated_final_coast_s), 0) AS coast_s,
               round(avg(gated_cruise_kmh), 1) AS cruise_kmh,
               round(1000 * last_value(gated_r0 + gated_r1 * 27.78 + gated_r2 * 27.78 * 27.78 ORDER BY run), 2)
                   AS last_r100_mn_per_kg
        FROM results GROUP BY unit_id ORDER BY unit_id
        """
    )
    table = timed("ask all results", lambda: answer.to_pylist())
    print(f"\n{'unit':10} {'runs':>5} {'coast, s':>9} {'cruise, km/h':>13} {'r(100 km/h) of the last run, mN/kg':>35}")
    for row in table:
        print(
            f"{row['unit_id']:10} {row['runs']:5} {row['coast_s']:9.0f} {row['cruise_kmh']:13.1f}"
            f" {row['last_r100_mn_per_kg']:35.2f}"
        )

    # The same runs in one go and as partitions must say the same.
    context.register_parquet("whole", str(fleet / "runs.parquet"))
    same = context.sql(
        """
        SELECT count(*) AS runs, max(abs(w.gated_r0 - p.gated_r0)) AS r0, max(abs(w.gated_r2 - p.gated_r2)) AS r2
        FROM whole AS w JOIN results AS p ON w.run = p.run
        """
    ).to_pylist()[0]
    print(f"\nin one go and as partitions: {same['runs']} runs, largest difference r0 {same['r0']}, r2 {same['r2']}")
    if same["runs"] != count or same["r0"] != 0 or same["r2"] != 0:
        sys.exit("the partitions do not say what the whole says")


if __name__ == "__main__":
    main()
