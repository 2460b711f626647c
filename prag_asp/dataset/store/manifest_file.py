"""Read and write the JSON file that describes a folder: dataset.json or suite.json."""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path
from typing import Generic, TypeVar

import msgspec

from prag_asp.errors import OutputError, QueryError
from prag_asp.output import file_in, replace_file
from prag_asp.safe_reading import read_bytes
from prag_asp.tables.json_fields import decoded, read

Contents = TypeVar("Contents", bound=msgspec.Struct)


@dataclass(frozen=True)
class ManifestFile(Generic[Contents]):
    """A kind of file that describes a folder: its `name`, format and version; `what` names such a folder in errors."""

    name: str
    contents: type[Contents]
    format: str
    version: int
    what: str

    def write(self, folder: Path, contents: Contents) -> None:
        """Write the file atomically.

        Raises:
            OutputError: the file cannot be written.
        """
        values = {"format": self.format, "version": self.version, **msgspec.to_builtins(contents)}
        text = json.dumps(values, indent=1, ensure_ascii=False)
        replace_file(file_in(folder, self.name), f"{text}\n".encode(), follow=False)

    def read(self, folder: Path) -> Contents | None:
        """Return the contents of the file in a folder, or None if there is none.

        Raises:
            QueryError: the file is damaged, or was written by another program or version; the message gives the path to
                the wrong value.
        """
        path = folder / self.name
        try:
            text = read_bytes(path, within=folder).decode()
        except FileNotFoundError:
            return None
        except UnicodeDecodeError:
            raise QueryError(f"{path}: it is not UTF-8; copy the {self.what} again") from None
        except OSError as error:
            why = error.strerror or error
            raise QueryError(f"{path}: cannot be read: {why}; name the folder of a {self.what}") from None
        try:
            values = decoded(text)
            if not isinstance(values, dict) or values.get("format") != self.format:
                raise QueryError(f"is not a {self.what} of prag_asp: it has no format {self.format!r}")
            if values.get("version") != self.version:
                other = values.get("version")
                raise QueryError(f"has version {other!r}, not {self.version}; use the prag_asp version that wrote it")
            return read(values, self.contents, "")
        except QueryError as error:
            raise QueryError(f"{path}: {error}") from None

    def require_folder(self, folder: Path, *others: str) -> None:
        """Check that a folder is new or empty, apart from `others`, or has this file, before anything is written.

        Raises:
            OutputError: the folder contains something else.
        """
        if folder.exists() and not folder.is_dir():
            raise OutputError(f"{folder}: is not a folder; name a new folder")
        if folder.is_dir() and not (folder / self.name).is_file():
            found = sorted({path.name for path in folder.iterdir()} - {f"{self.name}.part", *others})
            if found:
                raise OutputError(f"{folder}: holds {found[0]}, and is not a {self.what}; give a new folder")
