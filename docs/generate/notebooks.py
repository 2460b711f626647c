"""Show the notebooks of examples/ as pages, with the outputs of their cells."""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

from mkdocs.structure.files import File

if TYPE_CHECKING:
    from mkdocs.config.defaults import MkDocsConfig
    from mkdocs.structure.files import Files

NOTEBOOKS = Path(__file__).parent.parent.parent / "examples" / "notebooks"


def on_files(files: Files, config: MkDocsConfig) -> None:
    """Add a page for each notebook."""
    for path in sorted(NOTEBOOKS.glob("*.ipynb")):
        text = "\n".join(notebook_lines(path))
        files.append(File.generated(config, f"notebooks/{path.stem}.md", content=text))


def notebook_lines(path: Path) -> Iterator[str]:
    """Yield the parts of a notebook as Markdown."""
    cells = json.loads(path.read_text(encoding="utf-8"))["cells"]
    for number, cell in enumerate(cells):
        text = "".join(cell["source"])
        yield f"{text}\n" if cell["cell_type"] == "markdown" else f"```python\n{text}\n```\n"
        if number == 0:
            yield f"*This page is the notebook `examples/notebooks/{path.name}`.*\n"
        for output in cell.get("outputs", ()):
            yield _output(output)


def _output(output: dict[str, Any]) -> str:
    """Return an output of a cell as Markdown."""
    data = output.get("data", {})
    if "image/png" in data:
        return f"![Output of the cell](data:image/png;base64,{data['image/png'].strip()})\n"
    text = "".join(output.get("text") or data["text/plain"])
    return f"```text\n{text.rstrip()}\n```\n"
