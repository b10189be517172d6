"""Export of the results to Parquet, for pandas, DuckDB, Spark and the like."""

from itertools import islice
from pathlib import Path

from sim.campaign.results.store import Results
from sim.errors import needing
from sim.record.whole_file import replacing

ROWS_A_GROUP = 10_000


def check_parquet() -> None:
    """Check that the results can be exported, before anything is flown.

    Raises:
        HarnessError: the package pyarrow is missing.
    """
    with needing("--parquet", "pyarrow", "parquet"):
        import pyarrow.parquet  # noqa: F401, PLC0415  an extra


def export(results: Results, path: Path) -> None:
    """Write table ``runs``, column by column as in SQLite; numbers are doubles, a missing figure is null.

    Raises:
        HarnessError: the package pyarrow is missing.
    """
    check_parquet()
    import pyarrow as pa  # noqa: PLC0415  an extra
    import pyarrow.parquet as pq  # noqa: PLC0415  an extra

    kinds = {"INTEGER": pa.int64(), "TEXT": pa.string(), "REAL": pa.float64(), "NUMERIC": pa.float64()}
    schema = pa.schema([(name, kinds[kind]) for name, kind in results.kinds().items()])
    schema = schema.with_metadata(results.all_meta())
    rows = results.each(schema.names)
    with replacing(path) as temporary, pq.ParquetWriter(temporary, schema) as writer:
        while block := list(islice(rows, ROWS_A_GROUP)):
            columns = zip(*block, strict=True)
            arrays = [pa.array(column, kind) for column, kind in zip(columns, schema.types, strict=True)]
            writer.write_table(pa.Table.from_arrays(arrays, schema=schema))
