"""The files for the PDDL extension of VS Code have its format, and the script shows exactly the true fluents."""

from __future__ import annotations

import json
import re
import shutil
import subprocess
from pathlib import Path

import pytest

from prag_asp import TaskSpace, load_domain
from prag_asp.planners import write
from prag_asp.planners.state_view import view_script
from tests.commands import ok

NODE = shutil.which("node")


def test_the_settings_beside_a_domain_name_a_script_of_the_folder(tmp_path: Path) -> None:
    ok("export", "pddl", "blocks", "-n", "4", "--index", "3..4", "-o", "out", cwd=tmp_path)
    ok("export", "pddl", "blocks", "-o", "domain", cwd=tmp_path)
    for folder, suffix in (("out", "_3"), ("out", "_4"), ("domain", "")):
        files = {path.name for path in (tmp_path / folder).iterdir()}
        settings = json.loads((tmp_path / folder / f"domain{suffix}.planviz.json").read_text())
        assert settings == {"customVisualization": f"state_view{suffix}.js"}
        assert {f"domain{suffix}.pddl", settings["customVisualization"]} <= files


def test_every_atom_of_a_fluent_is_one_of_the_pddl_domain() -> None:
    export = write(load_domain("kitchen"))
    assert len(export.fluents) == len(set(export.fluents.values())) > 20
    arities = {
        name: len(variables.split())
        for name, variables in re.findall(r"^    \((\S+?)((?: \?\w+)*)\)$", export.domain, re.M)
    }
    for atom, fluent in export.fluents.items():
        name, *terms = atom.split()
        assert arities[name] == len(terms) == len(fluent.arguments)
    assert any(name.startswith("carried-") for name in arities)
    assert not any(atom.startswith("carried-") for atom in export.fluents)


@pytest.mark.skipif(NODE is None, reason="needs Node")
def test_the_script_shows_the_true_fluents_of_the_final_state() -> None:
    domain = load_domain("blocks")
    task = TaskSpace(domain, 5).sample(1, seed=3)[0]
    export = write(domain, task)
    true = {str(fluent) for fluent, value in task.states[-1].items() if value}
    atoms = {str(fluent): atom for atom, fluent in export.fluents.items()}
    state = [{"variableName": atom, "value": name in true} for name, atom in atoms.items()]
    state += [{"variableName": "carried-ahead n", "value": True}, {"variableName": "total-cost", "value": 3}]
    text = view_script(export.fluents)
    program = (
        f"globalThis.module = {{}}; const view = (0, eval)({json.dumps(text)});"
        f"console.log(view.visualizeStateHtml(null, {json.dumps(state)}, 400));"
    )
    done = subprocess.run([NODE, "-e", program], capture_output=True, text=True, check=True, timeout=60)
    rows = re.findall(r"<th[^>]*>(.*?)</th><td>(.*?)</td>", done.stdout)
    shown = {text: about for about, cell in rows for text in cell.split("<br>")}
    assert shown.keys() == true
    assert all(about in text for text, about in shown.items())
    assert done.stdout.startswith('<table style="max-width:400px">')
