"""Mutants of bodies: URDF files and meshes."""

from __future__ import annotations

from random import Random

from tests.fuzz.kinds.domains import NAME, files_of
from tests.fuzz.kinds.texts import CHARACTERS, NUMBERS, SEEDS, broken, changed
from tests.fuzz.mutant import Mutant

URDF = [
    "<link/>",
    "<collision/>",
    "</link>",
    '<!DOCTYPE r [<!ENTITY a SYSTEM "file:///etc/passwd">]>',
    "&a;",
    "&amp;",
    "<!--",
    "-->",
    '<!DOCTYPE r [<!ENTITY a "aaaaaaaaaa"><!ENTITY b "&a;&a;&a;&a;&a;&a;&a;&a;&a;&a;">]>',
    "../../../outside/secret.obj",
    "/etc/passwd",
    "package://../../x.obj",
    "<mesh/>",
    '<box size="0.1 0.1 0.1"/>',
    '<sphere radius="0.03"/>',
    "<capsule/>",
    '<?xml version="1.0" encoding="utf-7"?>',
    "0 0",
    "0.03 nan 0",
]
MESH = ["v", "v 1", "v 1 2 3", "v nan 0 0", "v 1e39 0 0", "solid x", "vertex 1 2 3", "f 1 2 99", "\n" * 50]


def body(chance: Random, number: int) -> Mutant:
    """Change the URDF, or the mesh, of a scene."""
    files = files_of(SEEDS / "scene")
    name, strange = chance.choice([("mug.urdf", URDF), ("mug.urdf", URDF), ("handle.obj", MESH), ("handle.stl", MESH)])
    path = f"{NAME}/bodies/{name}"
    if name == "handle.stl":
        files[f"{NAME}/bodies/mug.urdf"] = files[f"{NAME}/bodies/mug.urdf"].replace(b"handle.obj", b"handle.stl")
        files[path] = b"solid handle\n" + files[f"{NAME}/bodies/handle.obj"].replace(b"v ", b"vertex ")
    if chance.random() < 0.8:
        files[path] = changed(files[path].decode(), chance, [*strange, *strange, *CHARACTERS, *NUMBERS]).encode()
    else:
        files[path] = broken(files[path], chance)
    # What is accepted is made into a body by the simulator, whose own reader trusts what it reads.
    draw = ("sample", NAME, "-n", "1", "--count", "1", "--max-draws", "1", "--budget", "1x1", "--seed", "1")
    return Mutant("body", number, files, (("check", NAME), draw), placed=True, owes_output=False)
