"""Histories as NetCDF-4 by the CF conventions, for xarray, Panoply and the like."""

from pathlib import Path

import numpy as np

from sim.errors import needing
from sim.export.history_table import AXES, Block, HistoryTable
from sim.export.source import Source
from sim.progress import Watch

_AXES = {3: "xyz", 4: "wxyz"}
"""The second dimension of a quantity, by its width."""


def write_netcdf(source: Source, path: Path, watch: Watch) -> list[str]:
    """Write a NetCDF file: a variable a quantity over time, with units and meaning.

    Raises:
        HarnessError: the package h5netcdf is missing.
    """
    with needing("netcdf", "h5netcdf", "export"):
        import h5netcdf  # noqa: PLC0415  an extra
    table = HistoryTable(source)
    with h5netcdf.File(path, "w") as file:
        file.dimensions = {"time": table.ticks} | {name: len(name) for name in _AXES.values()}
        file.attrs.update({"Conventions": "CF-1.11", "title": "Torquer flight"} | source.identity)
        for width, name in _AXES.items():
            labels = file.create_variable(name, (name,), "S1")
            labels[:] = np.array([axis[1:] for axis in AXES[width]], dtype="S1")
        time = file.create_variable("time", ("time",), "f8")
        time.attrs["units"] = f"seconds since {source.identity['epoch_utc']}"
        time.attrs["calendar"] = "standard"
        time.attrs["standard_name"] = "time"
        for quantity in table.quantities:
            dimensions = ("time",) if quantity.width == 1 else ("time", _AXES[quantity.width])
            variable = file.create_variable(quantity.name, dimensions, "f8", fillvalue=np.nan)
            variable.attrs["units"] = quantity.unit
            variable.attrs["long_name"] = quantity.meaning
        written = 0

        def take(block: Block) -> None:
            nonlocal written
            here = slice(written, written + len(block["t_s"]))
            file.variables["time"][here] = block["t_s"]
            for name, values in block.items():
                file.variables[name][here] = values
            written = here.stop

        return table.read(take, watch)
