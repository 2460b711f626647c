"""Film strips of the first tasks of a dataset, for its card."""

from __future__ import annotations

from hashlib import sha256
from pathlib import Path
from typing import TYPE_CHECKING

from prag_asp.dataset.language import sentence
from prag_asp.dataset.store.dataset import Dataset
from prag_asp.dataset.store.domain_snapshot import FileRecord
from prag_asp.errors import PicturesMissingError
from prag_asp.output import make_folder
from prag_asp.processes.progress_events import stage
from prag_asp.safe_reading import read_bytes

if TYPE_CHECKING:
    from prag_asp.dataset.store.manifest import Manifest
    from prag_asp.domain.load import Domain

PICTURES = "pictures"
STRIPS, STATES = 2, 4
"""The number of film strips, and of states in each: rendering a state takes as long as some dozen verdicts."""

SIZE = (240, 210)
"""The width and height in pixels of the picture of a state."""


def write_strips(folder: Path, manifest: Manifest, domain: Domain) -> list[FileRecord]:
    """Write film strips of the first tasks if the dataset has witnesses; none if Pillow is not installed.

    Raises:
        OutputError: a picture cannot be written.
    """
    if not manifest.rows("witnesses"):
        return []
    from prag_asp.dataset.scenes import scene_of
    from prag_asp.physics import film_strip
    from prag_asp.physics.pictures.saving import save_picture

    stage("drawing pictures")
    data = Dataset(folder, manifest, parts=tuple(part.name for part in manifest.parts))
    scene, language, records = scene_of(domain), domain.settings.language, []
    for number in range(min(STRIPS, data.count())):
        task = data.task(number)
        headings = [sentence(action, language) if action.name in language else None for action in task.actions]
        try:
            strip = film_strip(
                task, data.witness(number), scene, frames=STATES, columns=STATES, size=SIZE, headings=headings
            )
        except PicturesMissingError:
            return []
        name = f"{PICTURES}/{number:03d}.png"
        save_picture(strip, make_folder(folder / PICTURES) / Path(name).name)
        content = read_bytes(folder / name)
        records.append(FileRecord(name, len(content), sha256(content).hexdigest()))
    return records
