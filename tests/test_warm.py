"""The warm process of commands: a command ends with the one who waits for it, and all with the one who started it."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path
from time import monotonic, sleep

from tests.processes import family, gone

ROOT = Path(__file__).parents[1]
ASKS = """
import subprocess, sys
from tests.warm import warm_commands
command = subprocess.Popen(
    [warm_commands() / "prag-asp", "check", "-"], stdin=subprocess.PIPE, stdout=subprocess.DEVNULL
)
print(command.pid, flush=True)
sys.stdin.readline()
command.kill()
command.wait()
print("killed", flush=True)
sys.stdin.readline()
"""
PROCESSES = 5
"""One that asks, the warm one, the program, and two forks: one that waits for the other, which is the command.

That waits for a domain on its standard input, until it is ended.
"""


def test_commands_and_the_warm_process_end_with_those_who_ask_them_and_places_may_be_long(tmp_path: Path) -> None:
    folder = tmp_path / ("x" * 120)
    folder.mkdir()
    code = f"import os; os.environ['TMPDIR'] = {str(folder)!r}\n{ASKS}"
    with subprocess.Popen(
        [sys.executable, "-c", code], stdin=subprocess.PIPE, stdout=subprocess.PIPE, cwd=ROOT, text=True
    ) as asker:
        assert asker.stdin is not None and asker.stdout is not None
        assert asker.stdout.readline()
        latest = monotonic() + 120
        while len(started := family(asker.pid)) < PROCESSES:
            assert asker.poll() is None and monotonic() < latest
            sleep(0.01)
        forks = started[-2:]
        asker.stdin.write("\n")
        asker.stdin.flush()
        assert asker.stdout.readline() == "killed\n"
        assert gone(forks)
        asker.kill()
        assert gone(started)
