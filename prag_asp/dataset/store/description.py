"""dataset.json and suite.json: a JSON file that says what a folder holds, whole, of one format and version."""

from __future__ import annotations

import json
from pathlib import Path
from typing import TypeVar

import msgspec

from prag_asp.errors import QueryError
from prag_asp.output import file_in, replace_file
from prag_asp.safe_reading import read_bytes
from prag_asp.tables.json_fields import decoded, read

Description = TypeVar("Description", bound=msgspec.Struct)


def write_description(folder: Path, name: str, description: msgspec.Struct) -> None:
    """Write what a folder holds into a file of it, whole.

    Raises:
        OutputError: it cannot be written.
    """
    content = json.dumps(msgspec.to_builtins(description), indent=1, ensure_ascii=False)
    replace_file(file_in(folder, name), f"{content}\n".encode(), follow=False)


def read_description(
    folder: Path, name: str, kind: type[Description], form: tuple[str, int], what: str
) -> Description | None:
    """Return what a file of a folder says that the folder holds, None where there is none.

    `form` is the format that it has to have and its version; `what` is what errors call the folder, "data set".

    Raises:
        QueryError: it is damaged, of another program, or of another version.
    """
    path = folder / name
    try:
        text = read_bytes(path, within=folder).decode()
    except FileNotFoundError:
        return None
    except UnicodeDecodeError:
        raise QueryError(f"{path}: it is not UTF-8; copy the {what} once more") from None
    except OSError as error:
        raise QueryError(f"{path}: cannot be read: {error.strerror or error}; name a folder of a {what}") from None
    own, version = form
    try:
        told = decoded(text)
        if not isinstance(told, dict) or told.get("format") != own:
            raise QueryError(f"is no {what} of prag_asp, for it has no format {own!r}")
        if told.get("version") != version:
            other = told.get("version")
            raise QueryError(f"has the form {other!r}, but {version} is read; use the prag_asp that made it")
        return read(told, kind, "")
    except QueryError as error:
        raise QueryError(f"{path}: {error}") from None
