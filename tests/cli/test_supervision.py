"""Limits, signals and crashes: one line on stderr, the right exit code, and nothing left behind."""

from __future__ import annotations

import os
import pty
import resource
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from contextlib import ExitStack
from pathlib import Path

import pytest

from prag_asp.cli.exit_control import report_end
from prag_asp.cli.exits import Exit
from prag_asp.cli.supervision import POLL, SOON
from tests.commands import PRAG, run, run_apart
from tests.processes import family, gone, interrupt, interruptible, terminate, until_it_works

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="there is no supervision elsewhere")

LAMP = """
class(lamp). entity(one,lamp). fluent(on). action(on;off;wave).
precondition(on,on,false). postcondition(on,on,true). initially(on,false).
precondition(off,on,true). postcondition(off,on,false). postcondition(wave,on,true).
"""
PRODUCT = f"{LAMP} n(1..3000). m(X,Y,Z) :- n(X), n(Y), n(Z)."

DEAF = """
import ctypes, signal, sys, time
from prag_asp.cli import terminal
from prag_asp.processes.progress_events import stage
import prag_asp.cli.commands.domains as commands

def work(*arguments):
    stage("working")
    {work}

import prag_asp.program.paths
prag_asp.program.paths.shipped_domains = work
from prag_asp.cli import main
main()
"""
"""The command ``domains``, doing something else."""

HOLDS_THE_INTERPRETER = """
    print('begun', flush=True)
    lock = ctypes.create_string_buffer(256)  # larger than a mutex anywhere; all zeros are one that is free
    for _ in range(2): ctypes.PyDLL(None).pthread_mutex_lock(lock)"""
"""Native code that waits for what does not come, with the interpreter, and goes on to wait after each signal."""

SWALLOWS = """while True:
        try: print('begun', flush=True); time.sleep(600)
        except BaseException: pass"""
LISTENS = "print('begun', flush=True); time.sleep(600)"


def working(work: str, *arguments: str) -> list[str]:
    return [sys.executable, "-c", DEAF.format(work=work), "domains", *arguments]


def begun(process: subprocess.Popen[str]) -> None:
    """Wait until a command has begun to work."""
    assert process.stdout is not None and process.stdout.readline() == "begun\n"


def ends(work: str, *arguments: str) -> tuple[int, str]:
    """Return with which code a command that does something ends, and what it says."""
    done = subprocess.run(working(work, *arguments), capture_output=True, text=True, timeout=300, check=False)
    return done.returncode, done.stderr.removeprefix("\n")


def test_a_grounding_of_hours_ends_at_the_limit_of_time_with_one_line(tmp_path: Path) -> None:
    (tmp_path / "large.lp").write_text(PRODUCT)
    for seconds in (1, 5, 25, 75):
        done = run_apart("count", "large.lp", "--length", "3", "--time", str(seconds), cwd=tmp_path)
        assert (done.returncode, done.stdout) == (3, "")
        assert done.stderr.startswith(f"the time limit of {seconds} s was reached")
        assert done.stderr.endswith("; allow more with --time\n") and done.stderr.count("\n") == 1
        if " while grounding the domain, with " in done.stderr:
            return
    pytest.fail(f"a machine that is so slow that it does not come to ground anything: {done.stderr}")


@pytest.mark.parametrize("command", ["check", "sample", "export"])
def test_memory_is_limited_in_every_command(command: str, tmp_path: Path) -> None:
    (tmp_path / "large.lp").write_text(PRODUCT)
    length = () if command == "check" else ("--length", "3")
    done = run_apart(command, "large.lp", *length, "--memory", "150MB", cwd=tmp_path)
    assert (done.returncode, done.stdout) == (3, "")
    told = "the memory limit of 150 MB was reached while grounding the domain; allow more with --memory\n"
    assert done.stderr == told


def test_memory_of_all_processes_counts_and_is_never_far_above_the_limit() -> None:
    fill = """
    import os
    if os.fork():
        os.wait()
    ctypes.CDLL(None).prctl(1, signal.SIGKILL)  # as our own children, it ends with the command
    kept = []
    while True: kept.append(b"x" * 10**6)"""
    code, told = ends(fill, "--memory", "400MB")
    assert (code, told) == (3, "the memory limit of 400 MB was reached while working; allow more with --memory\n")


@pytest.mark.parametrize(
    ("engine", "command"),
    [("sat", ("sample", "--no-physics")), ("clingo", ("stats",)), ("sat", ("enumerate", "-o", "out.txt"))],
)
def test_engines_that_search_obey_the_limit_of_time_in_all_they_do(
    engine: str, command: tuple[str, ...], tmp_path: Path
) -> None:
    (tmp_path / "lamp.lp").write_text(LAMP)
    done = run_apart(
        command[0], "lamp.lp", "--length", "30", "--engine", engine, "--time", "1", *command[1:], cwd=tmp_path
    )
    assert done.returncode == 3
    *kept, told = done.stderr.splitlines()
    assert told.startswith("the time limit of 1 s was reached") and "--time" in told
    assert not kept or (len(kept) == 1 and kept[0].startswith("out.txt.part keeps "))


def test_a_count_that_ends_late_after_its_limit_says_so_once(tmp_path: Path) -> None:
    (tmp_path / "lamp.lp").write_text(LAMP)
    code = """import time
from prag_asp.cli import exit_control, main, terminal
told = terminal.tell_line
terminal.tell_line = exit_control.tell_line = lambda line: (told(line), time.sleep(2))
main()"""
    command = [sys.executable, "-c", code, "count", "lamp.lp", "--length", "30", "--engine", "sat", "--time", "1"]
    done = subprocess.run(command, check=False, cwd=tmp_path, capture_output=True, text=True, timeout=120)
    assert (done.returncode, done.stderr.count("\n")) == (3, 1), done.stderr


@pytest.mark.parametrize(("command", "engine"), [("count", "clingo"), ("sample", "sat"), ("stats", "clingo")])
def test_ctrl_c_ends_engines_that_search_as_it_ends_everything(command: str, engine: str, tmp_path: Path) -> None:
    (tmp_path / "lamp.lp").write_text(LAMP)
    with interruptible([*PRAG, command, "lamp.lp", "--length", "30", "--engine", engine], tmp_path) as process:
        until_it_works(process, seconds=1.5)
        assert interrupt(process).splitlines()[-1] == "interrupted"
    assert process.returncode == 130


@pytest.mark.parametrize(
    ("command", "told"),
    [
        (("count", "intervals.lp", "-n", "3"), "intervals.lp:5: this fact stands for 1,000,000,000 atoms"),
        (("count", "product.lp", "-n", "3"), "product.lp:6: this fact stands for 10,000,000,000 atoms"),
        (("check", "deep.lp"), "deep.lp:5: parentheses are nested more than 300 deep"),
        (("count", "lamp.lp", "-n", "100000000"), "--length 100000000: a plan has at most 1,000,000 actions"),
        (("count", "lamp.lp", "-n", "3", "--where", "(" * 5000 + "uses one" + ")" * 5000), "condition '("),
    ],
)
def test_what_is_too_large_is_refused_before_any_work(command: tuple[str, ...], told: str, tmp_path: Path) -> None:
    (tmp_path / "lamp.lp").write_text(LAMP)
    (tmp_path / "intervals.lp").write_text(f"{LAMP}n(1..1000000000).")
    (tmp_path / "product.lp").write_text(f"{LAMP}#const k = 100000.\nn(-k+k..k,5) :- on. n(1..k,1..k).")
    (tmp_path / "deep.lp").write_text(f"{LAMP}n({'f(' * 20000}a{')' * 20000}).")
    done = run(*command, cwd=tmp_path)
    assert done.returncode == 2 and done.stderr.startswith(told)
    assert done.stderr.count("\n") == 1


def test_a_command_that_does_not_react_is_killed_soon(tmp_path: Path) -> None:
    """All commands run at once, because their supervisors wait for seconds."""
    cases = [
        (work, number, end)
        for work in (HOLDS_THE_INTERPRETER, SWALLOWS)
        for number, end in ((signal.SIGINT, (130, "interrupted\n")), (signal.SIGTERM, (143, "terminated\n")))
    ]
    with ExitStack() as commands:
        started = [commands.enter_context(interruptible(working(work), tmp_path)) for work, _, _ in cases]
        for process in started:
            begun(process)
        born, now = [family(process.pid) for process in started], time.monotonic()
        for process, (_, number, _) in zip(started, cases, strict=True):
            process.send_signal(number)
        for process, (work, _, end), family_of_one in zip(started, cases, born, strict=True):
            said = process.communicate(timeout=120)[1]
            assert time.monotonic() - now < 100, work
            assert (process.returncode, said.removeprefix("\n")) == end, work  # it may hear before it is deaf
            assert gone(family_of_one), work


def test_a_second_ctrl_c_kills() -> None:
    with interruptible(_waiting(600, SWALLOWS), Path()) as process:
        begun(process)
        until = time.monotonic() + 300
        while process.poll() is None and time.monotonic() < until:
            # Where the machine stands still, what is sent before and after it comes at once, and is one wish.
            os.killpg(process.pid, signal.SIGINT)
            time.sleep(2 * SOON)
        assert process.returncode == 130
        assert process.communicate()[1] == "interrupted\n"


def _waiting(seconds: float, work: str) -> list[str]:
    """Return a command whose supervisor waits so long for the end of one that has heard that it shall end."""
    code = f"import prag_asp.cli.supervision\nprag_asp.cli.supervision.HEARD = {seconds}\n{DEAF.format(work=work)}"
    return [sys.executable, "-c", code, "domains"]


def test_native_code_that_ends_the_process_after_a_signal_is_no_crash(tmp_path: Path) -> None:
    work = """
    try: print('begun', flush=True); time.sleep(600)
    except KeyboardInterrupt: signal.raise_signal(signal.SIGABRT)"""
    with interruptible(working(work), tmp_path) as process:
        begun(process)
        assert interrupt(process) == "interrupted\n"
    assert process.returncode == 130


@pytest.mark.parametrize("work", [HOLDS_THE_INTERPRETER, LISTENS])
def test_a_command_ends_with_its_supervisor_even_while_native_code_runs(work: str, tmp_path: Path) -> None:
    with interruptible(working(work), tmp_path) as process:
        begun(process)
        born = family(process.pid)
        assert len(born) == 2
        process.kill()
        assert gone(born, seconds=50)


@pytest.mark.parametrize("send", [interrupt, terminate, lambda process: _one(process, signal.SIGINT)])
def test_a_command_handles_a_signal_once_whoever_sends_it(
    send: Callable[[subprocess.Popen[str]], str], tmp_path: Path
) -> None:
    tidy = """try: print('begun', flush=True); time.sleep(600)
    finally:
        time.sleep(0.5)
        print('tidied', flush=True)"""
    with interruptible(working(tidy), tmp_path) as process:
        begun(process)
        pipe, process.stdout = process.stdout, None
        said = send(process)
        assert pipe.readline() == "tidied\n"
        pipe.close()
    assert (process.returncode, said.strip()) in [(130, "interrupted"), (143, "terminated")]


def _one(process: subprocess.Popen[str], number: int) -> str:
    process.send_signal(number)
    return process.communicate(timeout=300)[1]


@pytest.mark.parametrize(
    ("work", "line"),
    [
        ("signal.raise_signal(signal.SIGSEGV)", "the command was killed by SIGSEGV while working; native code failed"),
        ("signal.raise_signal(signal.SIGRTMIN + 3)", f"the command was killed by signal {signal.SIGRTMIN + 3} while"),
        ("signal.raise_signal(signal.SIGKILL)", "the command was killed by SIGKILL while working; if the machine ran"),
        ("import os; os._exit(10)", "native code ended the command with code 10 while working; native code failed"),
        ("raise MemoryError", "out of memory while working; "),
        ("raise TypeError from MemoryError()", "out of memory while working; "),
        ("raise OSError(12, 'Cannot allocate memory', 'large.lp')", "out of memory while working; "),
        (
            "import resource; resource.setrlimit(resource.RLIMIT_AS, (10**9,) * 2); bytearray(10**10)",
            "out of memory while working; ",
        ),
    ],
)
def test_a_crash_is_one_line_and_a_code(work: str, line: str) -> None:
    code, said = ends(work)
    assert code == 3 and said.startswith(line) and said.count("\n") == 1


@pytest.mark.parametrize("megabytes", [20, 150])
def test_too_few_addresses_for_the_libraries_are_reported_before_these_fail(megabytes: int) -> None:
    def allow() -> None:
        resource.setrlimit(resource.RLIMIT_AS, (megabytes << 20,) * 2)

    done = subprocess.run(
        [*PRAG, "count", "prag", "-n", "3"], preexec_fn=allow, capture_output=True, text=True, timeout=300, check=False
    )
    assert (done.returncode, done.stdout) == (3, "")
    assert done.stderr.startswith("the system allows only ") and done.stderr.endswith("allow 200 MB or more\n")


def test_causes_of_an_error_that_form_a_cycle_are_followed_once() -> None:
    one, two = ValueError("one"), ValueError("two")
    one.__cause__, two.__cause__ = two, one
    with pytest.raises(ValueError, match="one"):
        report_end(one)
    two.__cause__ = MemoryError()
    assert report_end(one) == Exit.LIMIT


@pytest.mark.parametrize("command", [("sample", "--no-physics"), ("stats",), ("export",)])
def test_without_memory_no_file_is_cut(
    command: tuple[str, ...], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    from prag_asp.output.atomic_file import AtomicFile

    def refuse(*arguments: object) -> None:
        raise MemoryError

    (tmp_path / "lamp.lp").write_text(LAMP)
    (tmp_path / "out.txt").write_text("before")
    monkeypatch.setattr(AtomicFile, "replace", refuse)
    done = run(command[0], "lamp.lp", "-n", "2", "-o", "out.txt", *command[1:], cwd=tmp_path)
    assert done.returncode == 3 and done.stderr.splitlines()[-1].startswith("out of memory")
    assert "Traceback" not in done.stderr and (tmp_path / "out.txt").read_text() == "before"


def test_an_error_of_ours_is_a_traceback_and_too_deep_an_input_one_line() -> None:
    code, said = ends("raise TypeError('odd')")
    assert code == 1 and said.endswith("TypeError: odd\n")
    code, said = ends("again = lambda: again(); again()")
    assert (code, said) == (2, "the input is nested too deeply while working; make it flatter\n")


def test_an_interruption_that_native_code_turns_into_another_error_is_an_interruption() -> None:
    work = """
    try: signal.raise_signal(signal.SIGINT)
    except KeyboardInterrupt: raise RuntimeError("error in callback") from None"""
    assert ends(work) == (130, "interrupted\n")


SECOND = """
    import threading
    start = threading.Timer.start
    def interrupted_start(timer):
        signal.raise_signal(signal.SIGINT)
        start(timer)
    threading.Timer.start = interrupted_start"""
"""A second signal arrives while the dropped exception of the first one is about to be raised again."""


@pytest.mark.parametrize("second", ["", SECOND])
def test_an_interruption_while_a_value_is_freed_ends_the_command_in_the_end(second: str, tmp_path: Path) -> None:
    """Python drops it; it is raised again, before the command would end by itself."""
    dropped = f"""{second}
    class Freed:
        def __del__(self):
            print("begun", flush=True)
            time.sleep(600)
    Freed()
    time.sleep(30)"""
    with interruptible(working(dropped), tmp_path) as process:
        begun(process)
        assert interrupt(process) == "interrupted\n"
    assert process.returncode == 130


@pytest.mark.parametrize(
    ("module", "end"), [("registry", (130, "interrupted\n")), ("supervision", (-signal.SIGINT, ""))]
)
def test_an_interruption_while_the_command_is_loaded_is_at_most_one_line(module: str, end: tuple[int, str]) -> None:
    """Before a supervisor starts, the signal ends the process by itself, for which a shell reports 130 as well."""
    code = f"""
import signal, sys
class Finder:
    def find_spec(name, path=None, target=None):
        if name == "prag_asp.cli.{module}":
            signal.raise_signal(signal.SIGINT)
sys.meta_path.insert(0, Finder)
from prag_asp.cli import main
main()
"""
    assert _program(code, "domains") == end


def test_an_interruption_after_the_end_is_ignored() -> None:
    code = """
import atexit, signal
from prag_asp.cli import main
atexit.register(signal.raise_signal, signal.SIGINT)
main()
"""
    assert _program(code, "--help") == (0, "")


def _program(code: str, *arguments: str) -> tuple[int, str]:
    """Return the exit code of a program, and what it prints on stderr."""
    done = subprocess.run(
        [sys.executable, "-c", code, *arguments], capture_output=True, text=True, timeout=300, check=False
    )
    return done.returncode, done.stderr


def test_figures_are_printed_when_native_code_turns_an_interruption_into_a_mistake() -> None:
    work = """
    from prag_asp.cli.summary import tallied
    from prag_asp.dataset import Tally
    from prag_asp.errors import DomainError
    tally = Tally()
    tally.count("feasible", "", {{}})
    with tallied(tally, lambda: "one task"):
        try: {raised}
        except KeyboardInterrupt: pass
        raise DomainError("error in callback")"""
    assert ends(work.format(raised="signal.raise_signal(signal.SIGINT)")) == (130, "one task\ninterrupted\n")
    assert ends(work.format(raised="pass")) == (2, "error in callback\n")


@pytest.mark.parametrize("raised", ['LimitReached("own line", 0, StopReason(StopKind.TIME))', "SystemExit(3)"])
def test_a_limit_that_is_reached_while_a_command_ends_adds_no_line(raised: str) -> None:
    work = f"""
    import atexit
    from prag_asp.cli import exit_control
    from prag_asp.errors import LimitReached
    from prag_asp.stop_reason import StopKind, StopReason
    atexit.register(time.sleep, 2)
    atexit.register(exit_control.set_limits, 0.3)
    raise {raised}"""
    code, said = ends(work)
    assert (code, said) == (3, "own line\n" if "own" in raised else "")


def test_time_in_which_the_machine_stands_still_does_not_count() -> None:
    work = """
    try: print("begun", flush=True); time.sleep(60)
    except KeyboardInterrupt: time.sleep(0.7); print("ended", flush=True); raise"""
    with interruptible(_waiting(3, work), Path()) as process:
        begun(process)
        os.killpg(process.pid, signal.SIGINT)
        time.sleep(0.3)
        os.killpg(process.pid, signal.SIGSTOP)
        time.sleep(4)
        os.killpg(process.pid, signal.SIGCONT)
        out, err = process.communicate(timeout=300)
        assert (out, err.lstrip()) == ("ended\n", "interrupted\n")


def test_a_supervisor_that_is_stopped_and_continued_ends_nothing() -> None:
    with interruptible(working(LISTENS), Path()) as process:
        begun(process)
        for _ in range(20):
            process.send_signal(signal.SIGSTOP)
            time.sleep(2 * POLL)
            process.send_signal(signal.SIGCONT)
            time.sleep(POLL / 2)
        assert process.poll() is None
        assert interrupt(process).lstrip() == "interrupted\n"


def test_half_made_objects_that_an_interruption_leaves_print_nothing() -> None:
    work = """
    class Half:
        def __init__(self):
            {made}
            self.rep = 1
        def __del__(self): self.rep
    Half()"""
    assert ends(work.format(made="signal.raise_signal(signal.SIGINT)")) == (130, "interrupted\n")
    assert "AttributeError: 'Half' object has no attribute 'rep'\n" in ends(work.format(made="return"))[1]


@pytest.mark.parametrize("code", [0, 77])
def test_codes_and_streams_are_those_of_the_command(code: int) -> None:
    work = f"sys.stdout.write(sys.stdin.read() + 'out'); sys.stderr.write('err'); sys.exit({code})"
    done = subprocess.run(working(work), input="in ", capture_output=True, text=True, timeout=300, check=False)
    assert (done.returncode, done.stdout, done.stderr) == (code, "in out", "err")


def test_a_closed_pipe_ends_the_command_silently(tmp_path: Path) -> None:
    command = " ".join(["'" + part.replace("'", "'\\''") + "'" for part in [*PRAG, "enumerate", "prag", "-n", "9"]])
    piped = f"{command} | head -n 2"
    done = subprocess.run(piped, shell=True, capture_output=True, text=True, timeout=300, check=False)
    assert len(done.stdout.splitlines()) == 2 and not done.stderr


def _with_closed(stream: int, *arguments: str, cwd: Path) -> subprocess.CompletedProcess[str]:
    """Run a command with a standard stream closed, as the shell does by ``>&-``."""
    program = f"import os, sys; os.close({stream}); os.execv(sys.executable, [sys.executable, *sys.argv[1:]])"
    command = [sys.executable, "-c", program, *PRAG[1:], *arguments]
    return subprocess.run(command, cwd=cwd, capture_output=True, text=True, timeout=300, check=False)


@pytest.mark.parametrize("command", ["count", "enumerate"])
def test_a_closed_stdout_cannot_be_written(command: str, tmp_path: Path) -> None:
    (tmp_path / "lamp.lp").write_text(LAMP)
    done = _with_closed(1, command, "lamp.lp", "-n", "3", cwd=tmp_path)
    assert (done.returncode, done.stderr) == (4, "stdout: Bad file descriptor\n")


def test_closed_streams_matter_only_to_what_is_written_there(tmp_path: Path) -> None:
    (tmp_path / "lamp.lp").write_text(LAMP)
    done = _with_closed(1, "enumerate", "lamp.lp", "-n", "1", "-o", "tasks.txt", cwd=tmp_path)
    assert (done.returncode, done.stderr) == (0, "") and (tmp_path / "tasks.txt").read_text()
    for closed in (0, 2):
        done = _with_closed(closed, "count", "lamp.lp", "-n", "2", cwd=tmp_path)
        assert (done.returncode, done.stdout, done.stderr) == (0, "4\n", "")


@pytest.mark.parametrize(
    "arguments",
    [["count", "-", "-n", "1"], ["models", "count", "-"], ["models", "count", "/dev/stdin"], ["similarity", "-"]],
)
def test_a_closed_stdin_is_refused_and_not_read_as_an_empty_program(arguments: list[str], tmp_path: Path) -> None:
    done = _with_closed(0, *arguments, cwd=tmp_path)
    assert (done.returncode, done.stdout, done.stderr.count("\n")) == (2, "", 1)
    assert "standard input is closed" in done.stderr


def test_a_terminal_stops_a_command_and_lets_it_go_on(tmp_path: Path) -> None:
    """A shell with job control starts the command, Ctrl-Z stops it, fg lets it go on, Ctrl-C ends it."""
    work = """import os
    print('begun', flush=True)
    while not os.path.exists('stopped'): time.sleep(0.05)
    print('done', flush=True); time.sleep(600)"""
    (tmp_path / "command.py").write_text(DEAF.format(work=work))
    shell, terminal = pty.fork()
    if shell == 0:
        os.chdir(tmp_path)
        os.execvp("bash", ["bash", "--norc", "--noprofile", "-i"])
    try:
        _type(terminal, f"PS1='> '; {sys.executable} command.py domains; echo code $?\n", "begun\r")
        _type(terminal, "\x1a", "Stopped")
        (tmp_path / "stopped").touch()
        _type(terminal, "fg\n", "done\r")
        _type(terminal, "\x03", "interrupted")
        _type(terminal, "echo still $((6 * 7))\n", "still 42")
    finally:
        os.kill(shell, signal.SIGKILL)
        os.waitpid(shell, 0)
        os.close(terminal)


def _type(terminal: int, text: str, awaited: str) -> None:
    """Type a text, and wait until the terminal shows another."""
    os.write(terminal, text.encode())
    seen, until = "", time.monotonic() + 300
    while awaited not in seen:
        assert time.monotonic() < until, seen
        seen += os.read(terminal, 4096).decode(errors="replace")


def test_every_command_has_limits_and_states_their_defaults() -> None:
    from prag_asp.cli.registry import COMMANDS
    from prag_asp.dataset.formats.export_format import FORMS
    from tests.commands import ok

    forms = [("export", form) for form in ("dimacs", *FORMS)]
    asked = [("models", question) for question in ("count", "sample", "list", "marginals")]
    for command in [*((name,) for name in COMMANDS if name not in ("export", "models")), *forms, *asked]:
        told = " ".join(ok(*command, "--help").split())
        assert "--time TIME" in told and "[default: no limit]" in told
        assert "--memory SIZE" in told and "[default: 80 % of the machine's memory]" in told
