"""The notebooks, run without a notebook server: the cells in order, in one namespace, with what each shows.

``python -m tests.docs.notebooks`` writes into the notebooks what their cells show now.
"""

from __future__ import annotations

import ast
import base64
import io
import json
from contextlib import redirect_stdout
from pathlib import Path
from typing import Any

from tests.docs.pages import ROOT

NOTEBOOKS = tuple(sorted((ROOT / "examples" / "notebooks").glob("*.ipynb")))
Output = dict[str, Any]


def outputs(notebook: dict[str, Any]) -> list[list[Output]]:
    """Return what each cell of code of a notebook shows."""
    names: dict[str, Any] = {"__name__": "notebook"}
    return [_run("".join(cell["source"]), names) for cell in notebook["cells"] if cell["cell_type"] == "code"]


def _run(source: str, names: dict[str, Any]) -> list[Output]:
    """Run a cell, and return what it prints and what its last expression is."""
    body = ast.parse(source).body
    last = ast.Expression(body.pop().value) if isinstance(body[-1], ast.Expr) else None
    printed = io.StringIO()
    with redirect_stdout(printed):
        exec(compile(ast.Module(body, []), "cell", "exec"), names)
        value = None if last is None else eval(compile(last, "cell", "eval"), names)
    shown: list[Output] = []
    if printed.getvalue():
        shown.append({"name": "stdout", "output_type": "stream", "text": printed.getvalue().splitlines(keepends=True)})
    if value is not None:
        shown.append({"data": _data(value), "execution_count": None, "metadata": {}, "output_type": "execute_result"})
    return shown


def _data(value: Any) -> dict[str, Any]:
    """Return a value as a notebook keeps it: a picture, or its text."""
    if hasattr(value, "_repr_png_"):
        return {"image/png": base64.b64encode(value._repr_png_()).decode(), "text/plain": ["a picture"]}
    return {"text/plain": repr(value).splitlines(keepends=True)}


def write_outputs(path: Path) -> None:
    """Write into a notebook what its cells show."""
    notebook = json.loads(path.read_text(encoding="utf-8"))
    cells = [cell for cell in notebook["cells"] if cell["cell_type"] == "code"]
    for number, (cell, shown) in enumerate(zip(cells, outputs(notebook), strict=True), 1):
        cell["execution_count"] = number
        cell["outputs"] = [
            {**output, "execution_count": number} if "execution_count" in output else output for output in shown
        ]
    path.write_text(json.dumps(notebook, indent=1, ensure_ascii=False) + "\n", encoding="utf-8")


if __name__ == "__main__":
    for each in NOTEBOOKS:
        write_outputs(each)
