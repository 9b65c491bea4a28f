"""A fleet in a folder, and whether two tables of it are the same to the last bit."""

import duckdb
import pyarrow
import pyarrow.compute


def partition(runs, folder, most=None):
    """Writes a Parquet file of runs as `unit=U/*.parquet`, the layout of docs/scale.md; `most` runs of it."""
    some = f"where run in (select distinct run from '{runs}' order by run limit {most})" if most else ""
    options = "format parquet, compression zstd, partition_by (unit), write_partition_columns true"
    # Threads write files of their own, and a run must not go on in another file.
    with duckdb.connect(config={"threads": 1}) as connection:
        connection.execute(f"copy (select * from '{runs}' {some} order by unit, run, time_s) to '{folder}' ({options})")


def differences(one, other):
    """Names of the columns in which two tables of runs differ in a bit, whatever the order of their rows."""
    if set(one.column_names) != set(other.column_names) or one.num_rows != other.num_rows:
        return ["columns or number of rows"]
    keys = [("unit", "ascending"), ("run", "ascending")]
    one, other = one.sort_by(keys), other.sort_by(keys)
    return [name for name in one.column_names if bits(one.column(name)) != bits(other.column(name))]


def bits(column):
    """The values, numbers by their bits: a NaN equals itself, and -0.0 is not 0.0."""
    values = column.combine_chunks()
    if pyarrow.types.is_floating(values.type):
        values = values.view(pyarrow.int64())
    return values.to_pylist()
