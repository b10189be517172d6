"""Where the runs of a campaign are flown: processes of this machine, or an existing Dask cluster."""
