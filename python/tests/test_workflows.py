"""The workflows of .github and the hooks call targets of the Makefile, with our versions."""

import re
import shlex

import pytest
import yaml
from pages import ROOT

WORKFLOWS = sorted((ROOT / ".github" / "workflows").glob("*.yml"))


def steps(path):
    """All steps of a workflow's jobs."""
    jobs = yaml.safe_load(path.read_text())["jobs"].values()
    return [step for job in jobs for step in job.get("steps", [])]


def targets():
    """The targets of the Makefile."""
    rules = re.findall(r"^([a-z][a-z -]*):(?!=)", (ROOT / "Makefile").read_text(), re.MULTILINE)
    return {target for rule in rules for target in rule.split()}


def made(command):
    """The targets that a line of a shell makes."""
    program, *words = shlex.split(command)
    assert program == "make", command
    return {word for word in words if "=" not in word and not word.startswith("--")}


def test_the_hooks_run_targets_of_make_check():
    (local,) = yaml.safe_load((ROOT / ".pre-commit-config.yaml").read_text())["repos"]
    run = set().union(*(made(hook["entry"]) for hook in local["hooks"]))
    (needed,) = re.findall(r"^check: (.*)$", (ROOT / "Makefile").read_text(), re.MULTILINE)
    assert run == set(needed.split()) - {".venv/ready"}
    assert run < targets()


@pytest.mark.parametrize("path", WORKFLOWS, ids=lambda path: path.name)
def test_workflows_run_targets_of_the_makefile(path):
    commands = [step["run"] for step in steps(path) if "run" in step]
    ours = [command for command in commands if not command.startswith("rustup ")]
    assert ours
    assert set().union(*map(made, ours)) < targets()


@pytest.mark.parametrize("path", WORKFLOWS, ids=lambda path: path.name)
def test_actions_are_pinned_by_a_version(path):
    for step in steps(path):
        assert re.search(r"@v\d+(\.\d+)*$", step.get("uses", "@v0")), step


def test_wheels_are_built_by_the_maturin_that_tests_them():
    (build,) = (
        step["with"]
        for step in steps(ROOT / ".github" / "workflows" / "wheels.yml")
        if step.get("uses", "").startswith("PyO3/maturin-action@")
    )
    version = build["maturin-version"].removeprefix("v")
    for name in ("packaging/requirements.txt", "python/requirements-dev.txt"):
        assert f"\nmaturin=={version}\n" in (ROOT / name).read_text(), name
