"""Pictures as files."""

from __future__ import annotations

from io import BytesIO
from pathlib import Path
from typing import TYPE_CHECKING, Any

from prag_asp.errors import OutputError
from prag_asp.output import replace_file

if TYPE_CHECKING:
    from PIL import Image


def save_picture(picture: Image.Image, path: Path, **options: Any) -> None:
    """Write a picture atomically, in the format given by the file's suffix; `options` are passed to Pillow.

    Raises:
        OutputError: the file cannot be written.
    """
    from PIL import Image  # noqa: PLC0415 - heavy

    buffer = BytesIO()
    try:
        picture.save(buffer, Image.registered_extensions().get(path.suffix.lower()), **options)
    except (OSError, ValueError) as error:
        raise OutputError(f"{path}: the picture cannot be written: {error}") from None
    replace_file(path, buffer.getvalue())
