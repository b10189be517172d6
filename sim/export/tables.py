"""Histories as CSV and Parquet: a row a tick, a column a component, its unit in its name."""

import csv
from math import isnan
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from sim.errors import needing
from sim.export.history_table import Block, HistoryTable
from sim.export.source import Source
from sim.progress import Watch


def _columns(block: Block) -> NDArray[np.float64]:
    """The columns side by side, (n, columns)."""
    return np.column_stack(list(block.values()))


def write_csv(source: Source, path: Path, watch: Watch) -> list[str]:
    """Write a CSV file with one line of names; numbers read back to the last bit, none is an empty field."""
    table = HistoryTable(source)
    with path.open("w", encoding="ascii", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow([name for quantity in table.quantities for name in quantity.columns])

        def take(block: Block) -> None:
            for row in _columns(block).tolist():
                writer.writerow(["" if isnan(value) else repr(value) for value in row])

        return table.read(take, watch)


def write_parquet(source: Source, path: Path, watch: Watch) -> list[str]:
    """Write a Parquet file; columns have unit and meaning as metadata, the file what identifies the flight.

    Raises:
        HarnessError: the package pyarrow is missing.
    """
    with needing("parquet", "pyarrow", "export"):
        import pyarrow as pa  # noqa: PLC0415  an extra
        import pyarrow.parquet as pq  # noqa: PLC0415  an extra
    table = HistoryTable(source)
    fields = [
        pa.field(name, pa.float64(), metadata={"unit": quantity.unit, "meaning": quantity.meaning})
        for quantity in table.quantities
        for name in quantity.columns
    ]
    schema = pa.schema(fields, metadata={key: str(value) for key, value in source.identity.items()})
    with pq.ParquetWriter(path, schema) as writer:

        def take(block: Block) -> None:
            arrays = [pa.array(column, from_pandas=True) for column in _columns(block).T]  # NaN is null
            writer.write_table(pa.Table.from_arrays(arrays, schema=schema))

        return table.read(take, watch)
