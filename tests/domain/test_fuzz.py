"""Whatever is done to a domain's files, loading it either succeeds or tells every problem with its place."""

from __future__ import annotations

import random
import re
import tempfile
from pathlib import Path

from hypothesis import given, settings
from hypothesis import strategies as st

from prag_asp.domain.load import load_domain
from prag_asp.errors import DomainError
from prag_asp.program.paths import shipped_domains
from tests.chance import examples

FILES = ("domain.lp", "domain.toml")
TOKEN = re.compile(r"\w+|\s+|.")
LINE = re.compile(r".+\.(lp|toml):\d+: .+; .+")
STRANGE = [
    *"().,:-%*\"'#@&|;{}[]~!?$<>=+/\\^_ \n\tXa0é\0♥", "not ", "%*", "*%", "#program step(t).",
    "#program check(t).", "#show ", "#const ", "#include ", "#external ", "#minimize", "#inf", "#sum{",
    "#false", "..", '"a"', "t", "-1", "true", "unknown", "occurs(A,t)", "holds(F,V,t-1)", "&a{}",
    "[scene]", "[[weights]]", "= nan", "'''",
]  # fmt: skip


def mutated(text: str, chance: random.Random) -> str:
    """Return a text with a few tokens deleted, moved, doubled, misspelt or replaced by strange ones."""
    tokens = TOKEN.findall(text)
    for _ in range(chance.randint(1, 4)):
        at, other = chance.randrange(len(tokens)), chance.randrange(len(tokens))
        length = chance.choice([1, 1, 5, 30])
        match chance.randrange(6):
            case 0:
                tokens[at : at + length] = [" "]
            case 1:
                tokens[at] = tokens[other]
            case 2:
                tokens[at], tokens[other] = tokens[other], tokens[at]
            case 3:
                tokens[other:other] = tokens[at : at + length]
            case 4:
                tokens.insert(at, chance.choice(STRANGE))
            case _:
                cut = chance.randrange(len(tokens[at]) + 1)
                tokens[at] = tokens[at][:cut] + chance.choice("abX1_") + tokens[at][cut + 1 :]
    return "".join(tokens)


@settings(max_examples=examples(100))
@given(st.sampled_from(sorted(shipped_domains())), st.sampled_from(FILES), st.integers(0, 2**32))
def test_a_damaged_domain_loads_or_is_reported_what_is_wrong(name: str, damaged: str, seed: int) -> None:
    with tempfile.TemporaryDirectory() as folder:
        for file in FILES:
            path = shipped_domains()[name] / file
            text = path.read_text(encoding="utf-8") if path.exists() else 'title = "None"\n'
            if file == damaged:
                text = mutated(text, random.Random(seed))
            (Path(folder) / file).write_text(text, encoding="utf-8")
        try:
            load_domain(folder)
        except DomainError as error:
            assert all(LINE.fullmatch(line) for line in str(error).split("\n")), str(error)
