"""A fleet with DuckDB: SQL picks a unit's rows, a pool of threads replays (Rust works without the interpreter's lock)."""

import os
from concurrent.futures import ThreadPoolExecutor

import duckdb
import pyarrow.parquet
from unit import replay_unit


def learn(runs, train, track, out):
    connection = duckdb.connect()
    rows = f"read_parquet('{runs}/**/*.parquet', hive_partitioning = false)"
    units = [unit for (unit,) in connection.execute(f"select distinct unit from {rows} order by unit").fetchall()]

    def learned(unit):
        found = connection.cursor().sql(f"select * from {rows} where unit = ?", params=[unit])
        return replay_unit(found, train, track)

    writer = None
    with ThreadPoolExecutor(len(os.sched_getaffinity(0))) as pool:
        for parameters in pool.map(learned, units):
            writer = writer or pyarrow.parquet.ParquetWriter(out, parameters.schema)
            writer.write_table(parameters)
    writer.close()
