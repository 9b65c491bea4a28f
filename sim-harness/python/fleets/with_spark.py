"""A fleet with Spark: `groupBy("unit").applyInArrow`, a Python worker beside each core."""

import os
import sys

import pyarrow.dataset
import pyarrow.parquet
from pyspark.sql import SparkSession
from pyspark.sql.pandas.types import from_arrow_schema
from unit import replay_unit


def learn(runs, train, track, out):
    # Spark asks for the columns before there are rows: those of a unit are those of all.
    rows = pyarrow.dataset.dataset(runs, partitioning=None)
    unit = rows.head(1).column("unit")[0]
    columns = replay_unit(rows.to_table(filter=pyarrow.dataset.field("unit") == unit), train, track).schema
    # The workers are this interpreter, which has the module.
    os.environ["PYSPARK_PYTHON"] = sys.executable
    session = SparkSession.builder.master("local[*]").config("spark.ui.enabled", "false").getOrCreate()
    session.sparkContext.setLogLevel("ERROR")
    # The tasks are given this folder's modules, as to the workers of a cluster.
    session.sparkContext.addPyFile(__file__.replace("with_spark.py", "unit.py"))
    table = session.read.option("recursiveFileLookup", True).parquet(str(runs))
    learned = table.groupBy("unit").applyInArrow(
        lambda unit_runs: replay_unit(unit_runs, train, track), from_arrow_schema(columns)
    )
    pyarrow.parquet.write_table(learned.toArrow(), out)
    session.stop()
