"""Columns of equal length: arrays of numpy, which other libraries take without a copy."""

from __future__ import annotations

import os
from collections.abc import Iterator, Mapping
from typing import Any


class Table(Mapping[str, Any]):
    """Columns by their names, each an array of numpy.

    >>> import numpy
    >>> table = Table({"t_s": numpy.array([0.0, 0.001])})
    >>> list(table), len(table["t_s"])
    (['t_s'], 2)

    `pyarrow.table(t)` and `polars.DataFrame(t)` take a table as it is; both need pyarrow.
    """

    def __init__(self, columns: dict[str, Any]) -> None:
        self._columns = columns

    def __getitem__(self, name: str) -> Any:
        return self._columns[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self._columns)

    def __len__(self) -> int:
        return len(self._columns)

    def __repr__(self) -> str:
        rows = len(next(iter(self._columns.values()), ()))
        return f"<feedwright.Table of {rows} rows: {', '.join(self._columns)}>"

    def to_arrow(self) -> Any:
        """As a table of pyarrow; only the column `cutting`, whose bits Arrow packs, is copied."""
        import pyarrow

        return pyarrow.table({name: pyarrow.array(column) for name, column in self._columns.items()})

    def to_parquet(self, path: str | os.PathLike[str]) -> None:
        """Writes a Parquet file, by pyarrow."""
        from pyarrow import parquet

        parquet.write_table(self.to_arrow(), path)

    def to_pandas(self) -> Any:
        """As a data frame of pandas."""
        import pandas

        return pandas.DataFrame(dict(self._columns), copy=False)

    def __arrow_c_stream__(self, requested_schema: object | None = None) -> object:
        return self.to_arrow().__arrow_c_stream__(requested_schema)
