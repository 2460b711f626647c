"""The Parquet files of a dataset; each file is written atomically, and named after its part and number."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from hashlib import sha256
from pathlib import Path

import pyarrow as pa
import pyarrow.parquet as pq

from prag_asp.dataset.store.domain_snapshot import MEND, digest_of
from prag_asp.dataset.store.manifest import FOLDERS, Shard, ShardFile
from prag_asp.dataset.store.schema import ROW_GROUP, SCHEMAS
from prag_asp.errors import QueryError
from prag_asp.output import file_in, make_folder, replace_file
from prag_asp.safe_reading import is_inside, open_binary

LARGEST_GROUP = 1_000_000_000
"""The maximum unpacked size in bytes that a row group may declare, so that a damaged file cannot exhaust the memory."""


def shard_name(table: str, part: str, number: int) -> str:
    """Return the path of a shard in the folder of its dataset."""
    return f"{FOLDERS[table]}/{part}-{number:05d}.parquet"


def write_shard(folder: Path, table: str, part: str, number: int, rows: pa.Table) -> ShardFile:
    """Write rows as a shard, atomically, and return its record for dataset.json.

    Raises:
        OutputError: the file cannot be written.
    """
    buffer = pa.BufferOutputStream()
    pq.write_table(rows, buffer, compression="zstd", row_group_size=ROW_GROUP[table], version="2.6")
    content, name = buffer.getvalue().to_pybytes(), shard_name(table, part, number)
    make_folder(folder / FOLDERS[table])
    replace_file(file_in(folder, name), content, follow=False)
    return ShardFile(name, rows.num_rows, len(content), sha256(content).hexdigest())


@contextmanager
def open_shard(folder: Path, table: str, shard: ShardFile) -> Iterator[pq.ParquetFile]:
    """Open a shard without reading its rows.

    Raises:
        QueryError: the file is missing, damaged or too large, or differs from its record in dataset.json.
    """
    file = folder / shard.path
    if not is_inside(file, folder):
        raise QueryError(f"{file}: leads out of the dataset; {MEND}")
    try:
        # This only checks that the file is regular; Arrow opens it itself, because its threads must not need the
        # interpreter lock at exit.
        open_binary(file).close()
        with pa.OSFile(str(file)) as stream, pq.ParquetFile(stream) as opened:
            if not opened.schema_arrow.equals(SCHEMAS[table]):
                raise QueryError(f"{file}: its columns are not those of {table}; {MEND}")
            if opened.metadata.num_rows != shard.rows:
                rows = opened.metadata.num_rows
                raise QueryError(f"{file}: has {rows} rows, but dataset.json says {shard.rows}; {MEND}")
            size, groups = ROW_GROUP[table], [opened.metadata.row_group(at) for at in range(opened.num_row_groups)]
            if [group.num_rows for group in groups] != [
                min(size, shard.rows - at) for at in range(0, shard.rows, size)
            ]:
                raise QueryError(f"{file}: its rows are not in groups of {size}; {MEND}")
            if max((group.total_byte_size for group in groups), default=0) > LARGEST_GROUP:
                raise QueryError(f"{file}: {size} of its rows are larger than {LARGEST_GROUP / 10**6:,.0f} MB; {MEND}")
            yield opened
    except (OSError, pa.ArrowException) as error:
        why = getattr(error, "strerror", None) or " ".join(str(error).split())
        raise QueryError(f"{file}: cannot be read: {why}; {MEND}") from None


def row_groups(
    folder: Path, table: str, shard: Shard, columns: Sequence[str] | None = None, *, digest: bool = False
) -> Iterator[pa.Table]:
    """Yield the row groups of a table in a shard; no file stays open between them.

    Raises:
        QueryError: the file is missing or damaged or, with `digest`, differs from its record in dataset.json.
    """
    for group in range(-(-shard.rows(table) // ROW_GROUP[table])):
        file = shard.files[table]
        with open_shard(folder, table, file) as opened:
            if digest and not group and digest_of(folder / file.path) != file.sha256:
                raise QueryError(f"{folder / file.path}: differs from its record in dataset.json; {MEND}")
            rows = opened.read_row_group(group, columns=None if columns is None else [*columns])
        yield rows
