"""Film strips of some tasks in a dataset, as pictures on a page."""

from __future__ import annotations

from base64 import b64encode
from collections.abc import Mapping, Sequence
from io import BytesIO

from prag_asp.errors import MissingError
from prag_asp.processes.progress_events import stage
from prag_asp.report.source import ReportedTask, ReportSource

STRIPS = 6
"""The default number of film strips; drawing one takes about a second."""

COLUMNS, SIZE, QUALITY = 6, (240, 210), 80
"""The maximum number of states in a row, the size of each in pixels, and the quality of the WebP images."""


def film_strips(source: ReportSource, count: int = STRIPS) -> Mapping[int, str]:
    """Return the data URIs of film strips for at most `count` tasks with witnesses, by task number.

    The tasks are spread evenly over the dataset. There are none if the source is not a dataset, if it has no witnesses,
    or if physics or Pillow is not installed.

    Raises:
        QueryError: a witness is damaged.
        SceneError: the domain's Python files are not trusted.
    """
    dataset = source.dataset
    if dataset is None or not count or not dataset.manifest.rows("witnesses"):
        return {}
    from prag_asp.dataset.language import instruction_writer_of  # noqa: PLC0415
    from prag_asp.dataset.scenes import scene_of  # noqa: PLC0415
    from prag_asp.physics import film_strip  # noqa: PLC0415 - heavy

    stage("drawing film strips")
    found = {}
    try:
        scene, writer = scene_of(dataset.domain), instruction_writer_of(dataset.domain)
        for task in _spread(source.tasks, count):
            assert task.task is not None, "the tasks of a dataset have states"
            entry, witness = dataset.entry(task.number), dataset.witness(task.number)
            captions = writer.captions(task.task)
            for step, (subgoal, (_, text)) in enumerate(zip(entry.subgoals, captions[1:], strict=True), 1):
                captions[step] = (f"{step}. {subgoal}", text)
            picture = film_strip(task.task, witness, scene, columns=COLUMNS, size=SIZE, captions=captions)
            buffer = BytesIO()
            picture.convert("RGB").save(buffer, "WEBP", quality=QUALITY, method=4)
            found[task.number] = f"data:image/webp;base64,{b64encode(buffer.getvalue()).decode()}"
    except MissingError:
        return {}
    return found


def _spread(tasks: Sequence[ReportedTask], count: int) -> list[ReportedTask]:
    """Return at most `count` evenly spaced tasks, including the first one."""
    step = max(len(tasks) / count, 1.0)
    return [tasks[int(place * step)] for place in range(min(count, len(tasks)))]
