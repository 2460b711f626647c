"""The commands that turn a task space into clauses."""

from __future__ import annotations

from pathlib import Path

from tests.commands import ok, ok_apart, run

CONFLICT = """\
step 3, grasp(panda,apple_2), cannot follow:
  it needs open(panda) to be true, but that has been false since step 2, grasp(panda,apple_1)
  it needs at(panda,apple_2) to be true, but that has been false since step 1, approach(panda,apple_1)
no plan of this length has all of these steps:
  step 2, grasp(panda,apple_1)
  step 3, grasp(panda,apple_2)
"""


def test_explain_tells_reasons_and_conflict_and_ends_with_code_1() -> None:
    done = run("explain", "prag", "approach(panda, apple_1)", "grasp(panda,apple_1)", "grasp(panda,apple_2)")
    assert (done.returncode, done.stdout, done.stderr) == (1, CONFLICT, "")


def test_explain_ends_with_code_0_where_it_is_a_plan() -> None:
    assert ok("explain", "prag", "approach(panda,apple_1)", "withdraw(panda,apple_1)") == "a plan of prag\n"
    assert run("explain", "prag", "approach(panda,apple_1)", "withdraw(panda,apple_1)", "--rule", "no_undo").returncode


def test_explain_refuses_what_is_no_action() -> None:
    done = run("explain", "blocks", "unstak(a,b)")
    assert (done.returncode, done.stderr) == (2, "no action 'unstak(a,b)'; did you mean unstack(a,b)?\n")
    done = run("explain", "prag", "approach")
    assert done.returncode == 2 and "such as approach(panda,apple_1)" in done.stderr


def test_explain_names_the_lines_that_leave_no_task_of_a_length(tmp_path: Path) -> None:
    domain = tmp_path / "lamp.lp"
    domain.write_text("fluent(lit). action(on). initially(lit,false).\npostcondition(on,lit,true).\ngoal(lit,false).\n")
    done = run("explain", str(domain), "--length", "1")
    told = ["lamp has no task of length 1", "the goal is not lit", "these lines together exclude every task:"]
    told += [f"  {domain}:2: postcondition(on,lit,true).", f"  {domain}:3: goal(lit,false)."]
    told += ["there is no task of any length"]
    assert (done.returncode, done.stdout.splitlines(), done.stderr) == (1, told, "")
    done = run("explain", str(domain), "--length", "1", "--fewest-changes")
    assert done.returncode == 1 and done.stdout.splitlines()[2:] == told[3:]
    assert ok("explain", str(domain), "--length", "0") == "lamp has tasks of length 0\n"
    words = ok("explain", "prag", "-n", "2", "--why-not", "grasp", "--step", "2")
    assert words == "prag has tasks of length 2 with grasp as step 2\n"


LAMPS = """\
fluent(lit(1..2)). action(on(1..2)). postcondition(on(L),lit(L),true) :- action(on(L)).
initially(lit(1),false).
initially(lit(2),false).
goal(lit(1),true).
goal(lit(2),true).
"""


def test_explain_names_a_smallest_set_of_changes_or_says_that_there_is_none(tmp_path: Path) -> None:
    lamps, pairs, stuck = (tmp_path / f"{name}.lp" for name in ("lamps", "pairs", "stuck"))
    lamps.write_text(LAMPS)
    done = run("explain", str(lamps), "--length", "0", "--fewest-changes")
    together, *lines, shortest = done.stdout.splitlines()[1:]
    assert shortest == "the shortest task has 2 actions"
    assert (done.returncode, together) == (1, "removing all of these lines leaves a task, and removing fewer does not:")
    numbers = [int(line.split(":")[1]) for line in lines]
    assert len(numbers) == 2 and sum(number in (2, 4) for number in numbers) == 1
    pairs.write_text("fluent(f). action(a). postcondition(a,f,true). composite(c). stage(c,(1;2),a).\n")
    stuck.write_text("fluent(f). action(a). initially(f,false).\n#program step(t). s(t) :- not s(t), occurs(a,t).\n")
    composed = f"  {pairs}:1: composite(c). (with all composites, as --flat lifts them)"
    two = "the shortest task has 2 actions"
    for path, option, told in (
        (pairs, [], ["these lines together exclude every task:", composed, two]),
        (pairs, ["--fewest-changes"], ["removing any one of these lines leaves a task:", composed, two]),
        (stuck, [], ["no line excludes it: the declarations of the domain alone allow none"]),
        (stuck, ["--fewest-changes"], ["there is none even without all lines that restrict plans"]),
    ):
        done = run("explain", str(path), "--length", "3", *option)
        assert (done.returncode, done.stdout.splitlines()[1:]) == (1, told)


def test_explain_does_not_blame_the_domain_for_contradictory_conditions() -> None:
    having, lacking = "has at least 2 stack", "has exactly 1 stack"
    done = run("explain", "blocks", "--length", "4", "--where", having, "--where", lacking)
    told = [f"  {having}", f"  {lacking}", "they do so without any line that restricts plans"]
    assert (done.returncode, done.stdout.splitlines()[2:5]) == (1, told)
    done = run("explain", "blocks", "--length", "4", "--where", having)
    assert (done.returncode, done.stdout) == (0, f"blocks has tasks of length 4 that satisfy '{having}'\n")


def test_explain_refuses_what_does_not_go_together() -> None:
    for words, told in (
        (["prag", "--where", "uses can_1"], "--where is about all tasks of a length; add --length"),
        (["prag", "drop(panda,can_1)", "--length", "2"], "not a sequence of actions"),
        (["prag", "--length", "2", "--step", "1"], "name the action"),
        (["prag", "--length", "2", "--why-not", "fly"], "no action 'fly'"),
        (["prag", "--length", "2", "--smallest", "--fewest-changes"], "leave one of them out"),
        (["prag", "--length", "1..2"], "several lengths"),
    ):
        done = run("explain", *words)
        assert done.returncode == 2 and told in done.stderr and done.stderr.count("\n") == 1, words


def test_export_writes_the_same_bytes_again_for_each_level(tmp_path: Path) -> None:
    shown = {}
    for level in ("plan", "task", "skeleton"):
        texts = [export("export", "blocks", "-n", "2", "--by", level) for export in (ok, ok_apart)]
        assert texts[0] == texts[1]
        assert texts[0].startswith(f"c the {level}s of blocks of length 2, by prag_asp\nc 2 ")
        lines = texts[0].splitlines()
        (names,) = ([int(word) for word in line.split()[3:-1]] for line in lines if line.startswith("c p show "))
        atoms = {int(line.split()[1]): line.split()[2] for line in lines if line.startswith("c ") and line[2].isdigit()}
        shown[level] = [atoms[name] for name in names]
    assert all(atom.startswith("occurs(") for atom in shown["plan"] + shown["task"])
    assert {atom.partition("(")[0] for atom in shown["skeleton"]} == {"_step_name"}
    assert len(shown["skeleton"]) == 8
    ok("export", "blocks", "-n", "2", "--by", "plan", "--format", "dimacs", "-o", str(tmp_path / "plans.cnf"))
    assert (tmp_path / "plans.cnf").read_text() == ok("export", "blocks", "-n", "2", "--by", "plan")


def test_export_refuses_a_folder_that_is_not_there(tmp_path: Path) -> None:
    done = run("export", "blocks", "-n", "1", "-o", str(tmp_path / "none" / "plans.cnf"))
    assert done.returncode == 4 and "cannot be written" in done.stderr
