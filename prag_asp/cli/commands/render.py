"""``prag-asp render``: pictures of the tasks in a file."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from prag_asp.cli import options, shell_completion
from prag_asp.cli.domain_options import OF_FILE, DomainOptions, domain_options
from prag_asp.cli.line_output import require_writable
from prag_asp.cli.options import whole
from prag_asp.cli.physics_options import parse_pixels
from prag_asp.cli.terminal import progress, say
from prag_asp.dataset.task_origin import MEND, errors_with_place, index_of, read_witness
from prag_asp.errors import QueryError
from prag_asp.output import file_in, make_folder, replace_file
from prag_asp.processes.progress_events import stage
from prag_asp.safe_reading import lines_of, open_text
from prag_asp.wording import plural

if TYPE_CHECKING:
    from prag_asp.dataset.jsonl import Record
    from prag_asp.dataset.language import InstructionWriter
    from prag_asp.physics import Demonstration, Witness
    from prag_asp.scene.scene import Scene
    from prag_asp.task import Task

SIZES = {"strip": (360, 320), "state": (960, 800), "gif": (400, 350), "webp": (400, 350), "mp4": (400, 350)}
"""The size of a frame in pixels for each form of picture."""

ANIMATED = ("gif", "webp", "mp4")
SCENES = ("html", "glb")
"""The forms of 3D scenes: a page that plays the episode, and binary glTF for 3D programs."""

FASTEST = 1000
"""The maximum factor by which an animation is sped up or slowed down."""

RECORD = "record it again with --demonstrate"
STILLS = (".png", ".jpg", ".jpeg", ".webp", ".tif", ".tiff", ".bmp")
"""The suffixes of files for still pictures."""

SMALLEST, LARGEST = 16, 4096


@click.command()
@click.argument("file", metavar="TASKS.jsonl", shell_complete=shell_completion.files)
@click.argument("numbers", metavar="[NUMBER]...", nargs=-1, type=whole(1))
@domain_options(*OF_FILE, options.trust)
@click.option(
    "--as",
    "form",
    type=click.Choice([*SIZES, *SCENES]),
    default="strip",
    show_default=True,
    help="All states side by side with captions; one state; an animation of the robot executing the task; "
    "or a 3D scene of it, as a page that plays it or as binary glTF.",
)
@click.option(
    "--state",
    type=whole(0),
    metavar="K",
    help="With --as state: number of the state, from 0.  [default: the final state]",
)
@click.option(
    "--size", metavar="WxH",
    help="Size of a frame in pixels.  [default: 360x320; state 960x800; animation 400x350]",
)  # fmt: skip
@click.option("--speed", type=float, default=2.0, show_default=True, help="Playback speed of an animation.")
@click.option(
    "--bystanders/--no-bystanders", default=True,
    help="Also draw objects that the task does not name, at places that it does not use.  [default: yes]",
)  # fmt: skip
@click.option("--columns", type=whole(1), default=3, show_default=True, help="Frames per row of a strip.")
@click.option(
    "--recordings", metavar="DIR", shell_complete=shell_completion.files,
    help="Draw the episodes that --demonstrate DIR has written.",
)  # fmt: skip
@options.seed
@click.option(
    "-o", "--output", metavar="PATH", default="pictures", show_default=True, shell_complete=shell_completion.files,
    help="File for one task; folder for several tasks, whose files are named after the tasks' numbers.",
)  # fmt: skip
def render(
    *,
    request: DomainOptions,
    file: str,
    numbers: tuple[int, ...],
    form: str,
    state: int | None,
    size: str | None,
    speed: float,
    bystanders: bool,
    columns: int,
    recordings: str | None,
    seed: int,
    output: str,
) -> None:
    """Draw pictures of the tasks in a file.

    Draws all tasks, or those with the given NUMBERs, which count the lines of the file from 1. Prints the names of the
    files written. A task without a witness is validated first. For an animation, the robot executes the task, unless
    --recordings contains an episode of it.
    """
    from prag_asp.dataset.language import instruction_writer_of
    from prag_asp.physics import require_physics

    if state is not None and form != "state":
        raise QueryError(f"--state {state} goes with --as state; got --as {form}")
    if not 1 / FASTEST <= speed <= FASTEST:
        raise QueryError(f"--speed {speed:g}: write a positive number up to {FASTEST}, such as 2 for twice as fast")
    pixels = _frame_size(form, size)
    drawing = _Renderer(
        form, state, pixels, columns, speed, bystanders, seed, None if recordings is None else Path(recordings)
    )
    _check_output(Path(output), form)
    require_physics()
    records = _read_chosen(file, numbers)
    targets = _targets(Path(output), tuple(records), form)
    writers: dict[str, InstructionWriter] = {}
    with progress() as show:
        for done, (number, record) in enumerate(records.items()):
            named = repr((record.task.domain, record.task.constants))
            if named not in writers:
                domain = request.of(record, Path(file).parent).domain()
                with errors_with_place(record, domain):
                    writers[named] = instruction_writer_of(domain)

            def tell(share: float, done: int = done) -> None:
                show("pictures", done + share, len(records))

            drawing.draw(record, number, writers[named], targets[number], tell)
            tell(1.0)
            say(targets[number])


def _frame_size(form: str, size: str | None) -> tuple[int, int]:
    """Return the size of a frame in pixels; `size` is a text such as ``360x320``, or None for the default of the form.

    Raises:
        QueryError: the text is not a size, the size is out of range, or the form has no size.
    """
    if size is None:
        return SIZES.get(form, SIZES["state"])
    if form in SCENES:
        raise QueryError(f"--size {size} goes with pictures; a 3D scene has no size in pixels")
    pixels = parse_pixels(size)
    if not all(SMALLEST <= side <= LARGEST for side in pixels):
        raise QueryError(f"--size {size}: a picture has {SMALLEST} to {LARGEST} pixels a side")
    return pixels


def _read_chosen(file: str, numbers: Sequence[int]) -> dict[int, Record]:
    """Return records of a file by number: those with the given numbers, or all if no numbers are given.

    Raises:
        QueryError: the file has no tasks, or no task with one of the numbers.
    """
    from prag_asp.dataset.jsonl import read_lines

    with open_text(file) as stream:
        records = list(read_lines(lines_of(stream), file))
    if not records:
        raise QueryError(f"{file}:1: no tasks in it; write some with prag-asp sample --format jsonl -o {file}")
    for number in numbers:
        if number > len(records):
            raise QueryError(f"{file}: it has {plural(len(records), 'task')}, so none has the number {number}")
    return {number: records[number - 1] for number in numbers or range(1, len(records) + 1)}


@dataclass(frozen=True)
class _Renderer:
    """A renderer of tasks in a given form."""

    form: str
    state: int | None
    size: tuple[int, int]
    columns: int
    speed: float
    bystanders: bool
    seed: int
    recordings: Path | None

    def draw(
        self, record: Record, number: int, writer: InstructionWriter, path: Path, tell: Callable[[float], None]
    ) -> None:
        """Draw a task into a file; `tell` receives the fraction that has been done.

        Raises:
            QueryError: the task has no witness and none is found, or the robot fails to execute it.
            OutputError: the file cannot be written.
        """
        from prag_asp.dataset.scenes import scene_of
        from prag_asp.physics import film_strip, still
        from prag_asp.physics.pictures.saving import save_picture

        domain, task = writer.lexicon.domain, record.task
        scene = scene_of(domain)
        stage("drawing pictures")
        with errors_with_place(record, domain):
            captions = writer.captions(task)
            shown = self._shown(record, number, scene)
            episode = _executed(task, shown, scene) if self.form in (*ANIMATED, *SCENES) else None
            state = len(task.actions) if self.state is None else self.state
            if state > len(task.actions):
                raise QueryError(f"--state {state}: the states of the task are 0 to {len(task.actions)}")
        with errors_with_place(record, domain, MEND if self.recordings is None else RECORD):
            drawing: dict[str, Any] = {"size": self.size, "bystanders": self.bystanders}
            if episode is not None:
                headings = [heading.partition(". ")[2] for heading, _ in captions[1:]]
                self._draw_episode(task, episode, scene, number, headings, path, tell)
                return
            if self.form == "strip":
                image = film_strip(task, shown, scene, columns=self.columns, captions=captions, **drawing)
            else:
                image = still(task, shown, scene, state, **drawing)
        save_picture(image, path, optimize=True)

    def _draw_episode(
        self, task: Task, episode: Demonstration, scene: Scene, number: int, headings: Sequence[str], path: Path,
        tell: Callable[[float], None],
    ) -> None:  # fmt: skip
        """Write an episode as an animation or a 3D scene."""
        from prag_asp.physics import animate, episode_glb, episode_page

        texts: dict[str, Any] = {"headings": headings, "bystanders": self.bystanders}
        if self.form == "glb":
            replace_file(path, episode_glb(task, episode, scene, **texts))
        elif self.form == "html":
            title = f"{task.domain}, task {number}"
            replace_file(path, episode_page(task, episode, scene, title=title, **texts).encode())
        else:
            animate(
                task, episode, scene, path, size=self.size, speed=self.speed,
                progress=lambda done, total: tell(done / total), **texts,
            )  # fmt: skip

    def _shown(self, record: Record, number: int, scene: Scene) -> Witness | Demonstration:
        """Return the episode of a task if there is a folder of episodes, or otherwise its witness."""
        from prag_asp.physics import Demonstration, check_demonstration, check_witness, validate_task

        if self.recordings is not None:
            name = (record.verdict or {}).get("demonstration", f"{number:06d}.npz")
            if not isinstance(name, str):
                raise QueryError(f"verdict.demonstration: needs the name of a file; got {name!r}; {RECORD}")
            try:
                recorded = Demonstration.load(self.recordings / name, within=self.recordings)
            except QueryError as error:
                raise QueryError(f"{error}; {RECORD}") from None
            for fault in check_demonstration(record.task, recorded, scene)[:1]:
                raise QueryError(f"{self.recordings / name} does not show this task: {fault}; {RECORD}")
            return recorded
        if record.witness is not None:
            witness = read_witness(record, scene)
            for fault in check_witness(record.task, witness, scene)[:1]:
                raise QueryError(f"its witness fails: {fault}; {MEND}")
            return witness
        verdict = validate_task(record.task, scene, seed=self.seed, index=index_of(record))
        if verdict.witness is None:
            raise QueryError(f"{verdict.status.replace('_', ' ')}: {verdict.reason}; only feasible tasks can be drawn")
        return verdict.witness


def _executed(task: Task, shown: Witness | Demonstration, scene: Scene) -> Demonstration:
    """Return an episode of a task; if only a witness is given, the robot executes the task.

    Raises:
        QueryError: the robot fails to execute it.
    """
    from prag_asp.physics import Demonstration, demonstrate

    if isinstance(shown, Demonstration):
        return shown
    episode = demonstrate(task, shown, scene)
    if not episode.success:
        raise QueryError(f"the robot fails to execute it: {episode.detail}; draw its states with --as strip")
    return episode


def _suffixes(form: str) -> tuple[str, ...]:
    """Return the possible suffixes for files of a form, beginning with the default one."""
    return (f".{form}",) if form in (*ANIMATED, *SCENES) else STILLS


def _check_output(output: Path, form: str) -> None:
    """Check, before anything is loaded, that the output can be a picture.

    Raises:
        QueryError: the suffix of the output does not fit the form.
        OutputError: the output or its folder cannot be written.
    """
    if _is_file(output):
        if output.suffix.lower() not in _suffixes(form):
            known = ", ".join(_suffixes(form))
            raise QueryError(
                f"--output {output}: a picture as {form} is a {known} file; or give a folder without a dot in its name"
            )
        require_writable(str(output))


def _is_file(output: Path) -> bool:
    """Return whether an output is a file; otherwise it is a folder."""
    return bool(output.suffix) and not output.is_dir()


def _targets(output: Path, numbers: Sequence[int], form: str) -> dict[int, Path]:
    """Return the file for each task.

    Raises:
        QueryError: the output is one file, but there are several tasks.
        OutputError: the folder cannot be created.
    """
    suffix = _suffixes(form)[0]
    if _is_file(output):
        if len(numbers) > 1:
            text = f"{plural(len(numbers), 'picture')} as {form} need a folder, or the number of one task"
            raise QueryError(f"--output {output}: {text}")
        return {numbers[0]: output}
    make_folder(output)
    return {number: file_in(output, f"{number:06d}{suffix}") for number in numbers}
