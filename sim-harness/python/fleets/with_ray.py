"""A fleet with Ray Data: rows are grouped by unit among the workers, each group is replayed where it lies."""

import functools

import pyarrow.parquet
import ray
from unit import replay_unit


def learn(runs, train, track, out):
    ray.init(include_dashboard=False, log_to_driver=False)
    ray.data.DataContext.get_current().enable_progress_bars = False
    rows = ray.data.read_parquet(str(runs), partitioning=None)
    task = functools.partial(replay_unit, train=str(train), track=str(track))
    learned = rows.groupby("unit").map_groups(task, batch_format="pyarrow")
    parts = [ray.get(part) for part in learned.to_arrow_refs()]
    pyarrow.parquet.write_table(pyarrow.concat_tables(part for part in parts if part.num_rows), out)
    ray.shutdown()
