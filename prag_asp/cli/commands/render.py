"""``prag-asp render``: pictures of tasks from a file."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import click

from prag_asp.cli import options, shell_completion
from prag_asp.cli.arguments import pixels as pixels_of
from prag_asp.cli.domain_options import Asked
from prag_asp.cli.line_output import require_writable
from prag_asp.cli.options import asks
from prag_asp.cli.run_fingerprint import run_on_file
from prag_asp.cli.terminal import progress, say, whole_lines
from prag_asp.dataset.task_origin import MEND, index_of, read_witness, told_with_place
from prag_asp.errors import QueryError
from prag_asp.output import Steps, file_in, make_folder
from prag_asp.processes.progress_events import stage
from prag_asp.safe_reading import lines_of, open_text, read_bytes
from prag_asp.wording import plural

if TYPE_CHECKING:
    from prag_asp.dataset.jsonl import Record
    from prag_asp.dataset.language import InstructionWriter
    from prag_asp.physics import Demonstration, Witness
    from prag_asp.scene.scene import Scene

SIZES = {"strip": (360, 320), "state": (960, 800), "gif": (400, 350), "webp": (400, 350)}
"""Pixels of a frame for each form of picture."""

ANIMATED = ("gif", "webp")
FASTEST = 1000
"""How many times as fast, or as slow, an animation plays at most."""

RECORD = "record it anew with --demonstrate"
STILLS = (".png", ".jpg", ".jpeg", ".webp", ".tif", ".tiff", ".bmp")
"""What pictures that do not move can be written as, by the ends of the names of files."""

SMALLEST, LARGEST = 16, 4096


@click.command()
@click.argument("file", metavar="TASKS.jsonl", shell_complete=shell_completion.files)
@click.argument("numbers", metavar="[NUMBER]...", nargs=-1, type=options.whole(1))
@asks((*options.OF_FILE, options.TRUST))
@click.option(
    "--as",
    "form",
    type=click.Choice(list(SIZES)),
    default="strip",
    show_default=True,
    help="All states side by side with captions; one state; an animation of the robot performing the task.",
)
@click.option("--state", type=options.whole(0), metavar="K", help="State to draw with --as state.  [default: last]")
@click.option("--size", metavar="WxH", help="Pixels of a frame.  [default: 360x320; state 960x800; animation 400x350]")
@click.option("--speed", type=float, default=2.0, show_default=True, help="How fast an animation plays.")
@click.option("--columns", type=options.whole(1), default=6, show_default=True, help="Frames in a row of a strip.")
@click.option(
    "--recordings", metavar="DIR", shell_complete=shell_completion.files,
    help="Draw the demonstrations that --demonstrate DIR has written.",
)  # fmt: skip
@options.seed
@click.option(
    "-o", "--output", metavar="PATH", default="pictures", show_default=True, shell_complete=shell_completion.files,
    help="A file for one task, otherwise the folder for files named after the tasks' numbers.",
)  # fmt: skip
def render(
    *,
    asked: Asked,
    file: str,
    numbers: tuple[int, ...],
    form: str,
    state: int | None,
    size: str | None,
    speed: float,
    columns: int,
    recordings: str | None,
    seed: int,
    output: str,
) -> None:
    """Draw the tasks of a file, or those of the NUMBERs, which count its lines from 1; prints the files written.

    A task without a witness is validated first. For an animation the robot performs the task, unless --recordings
    has what it did. Each picture is written whole; a run that was broken off goes on where it was when it is started
    again.
    """
    from prag_asp.dataset.jsonl import read_lines
    from prag_asp.physics import require_physics

    _refuse_at_odds(form, state, speed)
    pixels = SIZES[form] if size is None else _pixels(size)
    drawing = _Drawing(form, state, pixels, columns, speed, seed, None if recordings is None else Path(recordings))
    _refuse_file(Path(output), form)
    require_physics()
    with open_text(file) as stream:
        records = list(read_lines(lines_of(stream), file))
    chosen = tuple(dict.fromkeys(numbers)) or range(1, len(records) + 1)
    if not records:
        raise QueryError(f"{file}:1: no tasks in it; write some with prag-asp sample --format jsonl -o {file}")
    for number in chosen:
        if number > len(records):
            raise QueryError(f"{file}: it has {plural(len(records), 'task')}, so none has the number {number}")
    targets = _targets(Path(output), chosen, form)
    steps = None if len(chosen) == 1 else _steps(asked, file, drawing, Path(output), [targets[n] for n in chosen])
    tellers: dict[str, InstructionWriter] = {}
    with progress() as show, whole_lines():
        for done, number in enumerate(chosen):
            if steps is None or done >= steps.done:
                record = records[number - 1]
                named = repr((record.task.domain, record.task.constants))
                if named not in tellers:
                    tellers[named] = _teller(asked, record, Path(file).parent)

                def tell(share: float, done: int = done) -> None:
                    show("pictures", done + share, len(chosen))

                drawing.draw(record, number, tellers[named], targets[number], tell)
                tell(1.0)
                if steps is not None:
                    steps.do(done + 1)
            say(targets[number])
    if steps is not None:
        steps.finish()


def _teller(asked: Asked, record: Record, folder: Path) -> InstructionWriter:
    """Return what tells the tasks of the domain of a record.

    Raises:
        PragError: the domain cannot be loaded, or not told in words.
    """
    from prag_asp.dataset.language import instruction_writer_of

    domain = asked.of(record, folder).domain()
    with told_with_place(record, domain):
        return instruction_writer_of(domain)


def _steps(asked: Asked, file: str, drawing: _Drawing, output: Path, pictures: Sequence[Path]) -> Steps | None:
    """Return how many pictures a broken run of the same has drawn, None where nobody can know."""
    from hashlib import blake2b

    recordings = () if drawing.recordings is None else sorted(drawing.recordings.glob("*.npz"))
    shown = [(path.name, blake2b(read_bytes(path, within=drawing.recordings)).hexdigest()) for path in recordings]
    run = run_on_file(asked, file, told=[str(output), shown])
    if run is None:
        return None
    steps = Steps(output.with_name(f"{output.name}.run"), run)
    if not all(picture.is_file() for picture in pictures[: steps.done]):
        steps.done = 0
    return steps


@dataclass(frozen=True)
class _Drawing:
    """How tasks are drawn, and the drawing of one."""

    form: str
    state: int | None
    size: tuple[int, int]
    columns: int
    speed: float
    seed: int
    recordings: Path | None

    def draw(
        self, record: Record, number: int, teller: InstructionWriter, path: Path, tell: Callable[[float], None]
    ) -> None:
        """Draw one task into a file, and tell what share of it is done.

        Raises:
            QueryError: it has no witness, and none is found; or the robot fails to perform it.
            OutputError: the file cannot be written.
        """
        from prag_asp.dataset.scenes import scene_of
        from prag_asp.physics import Demonstration, animate, film_strip, still
        from prag_asp.physics.pictures.saving import save_picture

        domain, task = teller.lexicon.domain, record.task
        scene = scene_of(domain)
        animated = self.form in ANIMATED
        stage("drawing pictures")
        with told_with_place(record, domain):
            told = teller.captions(task)
            shown = self._shown(record, number, scene)
            if animated:
                shown = self._performed(record, shown, scene)
            state = len(task.actions) if self.state is None else self.state
            if state > len(task.actions):
                raise QueryError(f"--state {state}: the states of the task are 0 to {len(task.actions)}")
        with told_with_place(record, domain, MEND if self.recordings is None else RECORD):
            if self.form == "strip":
                image = film_strip(task, shown, scene, columns=self.columns, captions=told, size=self.size)
            elif self.form == "state":
                image = still(task, shown, scene, state, size=self.size)
            else:
                assert isinstance(shown, Demonstration)
                animate(
                    task,
                    shown,
                    scene,
                    path,
                    size=self.size,
                    speed=self.speed,
                    headings=[heading.partition(". ")[2] for heading, _ in told[1:]],
                    progress=lambda done, total: tell(done / total),
                )
                return
        save_picture(image, path, optimize=True)

    def _shown(self, record: Record, number: int, scene: Scene) -> Witness | Demonstration:
        """Return what is drawn of a task: its recording where there is a folder of them, otherwise its witness."""
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

    def _performed(self, record: Record, shown: Witness | Demonstration, scene: Scene) -> Demonstration:
        """Return the recording of the robot performing a task."""
        from prag_asp.physics import Witness, demonstrate

        if not isinstance(shown, Witness):
            return shown
        demonstration = demonstrate(record.task, shown, scene)
        if not demonstration.success:
            raise QueryError(f"the robot fails to perform it: {demonstration.detail}; draw its states in place of that")
        return demonstration


def _refuse_at_odds(form: str, state: int | None, speed: float) -> None:
    """Refuse options that do not go together, before anything is loaded.

    Raises:
        QueryError: there are some.
    """
    if state is not None and form != "state":
        raise QueryError(f"--state {state} goes with --as state; got --as {form}")
    if not 1 / FASTEST <= speed <= FASTEST:
        raise QueryError(f"--speed {speed:g}: write a positive number up to {FASTEST}, such as 2 for twice as fast")


def _suffixes(form: str) -> tuple[str, ...]:
    """Return the ends of names that files of a form can have, the usual one first."""
    return (f".{form}",) if form in ANIMATED else STILLS


def _refuse_file(output: Path, form: str) -> None:
    """Refuse a file that cannot become a picture, before anything is loaded.

    Raises:
        QueryError: its suffix is none of the form.
        OutputError: it, or its folder, cannot be written.
    """
    if _is_file(output):
        if output.suffix.lower() not in _suffixes(form):
            known = ", ".join(_suffixes(form))
            raise QueryError(
                f"--output {output}: a picture as {form} is a {known} file; or give a folder without a dot in its name"
            )
        require_writable(str(output))


def _is_file(output: Path) -> bool:
    """Tell whether the name of an output is that of a file, otherwise of a folder."""
    return bool(output.suffix) and not output.is_dir()


def _targets(output: Path, numbers: Sequence[int], form: str) -> dict[int, Path]:
    """Return the file for each task.

    Raises:
        QueryError: there is one file for several tasks.
        OutputError: the folder cannot be made.
    """
    suffix = _suffixes(form)[0]
    if _is_file(output):
        if len(numbers) > 1:
            text = f"{plural(len(numbers), 'picture')} as {form} need a folder, or the number of one task"
            raise QueryError(f"--output {output}: {text}")
        return {numbers[0]: output}
    make_folder(output)
    return {number: file_in(output, f"{number:06d}{suffix}") for number in numbers}


def _pixels(text: str) -> tuple[int, int]:
    """Return the width and height that an option states.

    Raises:
        QueryError: it is not of the form WxH, or a side is not from `SMALLEST` to `LARGEST`.
    """
    found = pixels_of(text)
    if not all(SMALLEST <= side <= LARGEST for side in found):
        raise QueryError(f"--size {text}: a picture has {SMALLEST} to {LARGEST} pixels a side")
    return found
