"""Check the crates of the lock files against deny.toml: licences, bans, duplicates, sources.

cargo-deny does it where it is installed. It takes longer to build than all of firsthit, so this
script stands in for it elsewhere; it knows the rules that our deny.toml has. Advisories, which are
known weaknesses, need cargo-deny and a network. Where they are not looked for, a line says so.
"""

import json
import os
import re
import shutil
import subprocess
import sys
import tomllib
from collections import Counter, defaultdict
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
CARGO = os.environ.get("CARGO", "cargo")
#: The workspaces that deny.toml is for. fuzz is none: libFuzzer is C++.
MANIFESTS = ("Cargo.toml", "benches/Cargo.toml")


def is_allowed(expression: str, allowed: set[str]) -> bool:
    """Return whether an SPDX expression can be met with the allowed licences.

    >>> allowed = {"MIT", "Zlib", "Apache-2.0 WITH LLVM-exception"}
    >>> for text in ("MIT", "MIT/GPL-3.0", "GPL-3.0 OR Zlib", "(GPL-3.0 OR MIT) AND Zlib"):
    ...     assert is_allowed(text, allowed), text
    >>> for text in ("GPL-3.0", "MIT AND GPL-3.0", "Zlib AND (GPL-3.0 OR ISC)", "", "MIT OR"):
    ...     assert not is_allowed(text, allowed), text
    >>> is_allowed("Apache-2.0 WITH LLVM-exception", allowed), is_allowed("Apache-2.0", allowed)
    (True, False)
    """
    words = re.findall(r"[()]|[^\s()]+", expression.replace("/", " OR "))

    def term() -> bool:
        word = words.pop(0) if words else ""
        if word == "(":
            is_met = either()
            return bool(words) and words.pop(0) == ")" and is_met
        if words[:1] == ["WITH"]:
            word = " ".join([word, *words[:2]])
            del words[:2]
        return word in allowed

    def both() -> bool:
        is_met = term()
        while words[:1] == ["AND"]:
            del words[0]
            is_met = term() and is_met
        return is_met

    def either() -> bool:
        is_met = both()
        while words[:1] == ["OR"]:
            del words[0]
            is_met = both() or is_met
        return is_met

    is_cut = expression.rstrip().endswith((" OR", " AND"))
    return either() and not words and not is_cut


def matches(entry: dict[str, str], package: dict) -> bool:
    """Return whether an entry names a package, by its name and the beginning of its version.

    >>> package = {"name": "syn", "version": "2.0.119"}
    >>> [matches({"name": "syn", "version": start}, package) for start in ("2", "2.0", "20", "1")]
    [True, True, False, False]
    >>> matches({"name": "syn"}, package), matches({"name": "quote"}, package)
    (True, False)
    """
    start = entry.get("version")
    is_version = start is None or f"{package['version']}.".startswith(f"{start}.")
    return entry["name"] == package["name"] and is_version


def faults(rules: dict, packages: list[dict], dependents: dict[str, set[str]]) -> list[str]:
    """Return what is against the rules, a line each.

    >>> rules = {
    ...     "licenses": {"allow": ["MIT"]},
    ...     "bans": {"skip": [], "deny": [{"name": "cc", "wrappers": ["a"]}]},
    ... }
    >>> def package(name, version="1.0", source="registry+A", **other):
    ...     return {"name": name, "version": version, "source": source, "license": "MIT"} | other
    >>> faults(rules, [package("a"), package("cc"), package("own", source=None)], {"cc": {"a"}})
    []
    >>> faults(rules, [package("b"), package("cc")], {"cc": {"b"}})
    ['cc 1.0: banned, needed by b']
    >>> faults(rules, [package("a"), package("a", "2.0"), package("b", license=None)], {})
    ['b 1.0: the licence None is not allowed', 'a: several versions, 1.0 and 2.0']
    >>> faults(rules, [package("a"), package("b"), package("c", source="git+B")], {})
    ['c 1.0: from git+B, not from the registry of the others']
    """
    allowed = set(rules["licenses"]["allow"])
    found = []
    versions = defaultdict(list)
    sources = Counter(package["source"] for package in packages if package["source"])
    registry = sources.most_common(1)[0][0]
    for package in packages:
        label = f"{package['name']} {package['version']}"
        if not is_allowed(package["license"] or "", allowed):
            found.append(f"{label}: the licence {package['license']} is not allowed")
        for ban in rules["bans"]["deny"]:
            others = dependents.get(package["name"], set()) - set(ban.get("wrappers", []))
            if matches(ban, package) and (others or "wrappers" not in ban):
                found.append(f"{label}: banned, needed by {', '.join(sorted(others))}")
        if package["source"] not in {None, registry}:
            found.append(f"{label}: from {package['source']}, not from the registry of the others")
        if not any(matches(skip, package) for skip in rules["bans"]["skip"]):
            versions[package["name"]].append(package["version"])
    for name, there in versions.items():
        if len(there) > 1:
            found.append(f"{name}: several versions, {' and '.join(sorted(there))}")
    return found


def check(manifest: str) -> int:
    """Check a workspace without cargo-deny."""
    rules = tomllib.loads((ROOT / "deny.toml").read_text())
    command = [CARGO, "metadata", "--locked", "--format-version", "1", "--manifest-path", manifest]
    metadata = subprocess.run(command, cwd=ROOT, stdout=subprocess.PIPE, check=True).stdout
    metadata = json.loads(metadata)
    names = {package["id"]: package["name"] for package in metadata["packages"]}
    dependents = defaultdict(set)
    for node in metadata["resolve"]["nodes"]:
        for dependency in node["dependencies"]:
            dependents[names[dependency]].add(names[node["id"]])
    found = faults(rules, metadata["packages"], dependents)
    for line in found:
        print(f"dependencies: {manifest}: {line}", file=sys.stderr)
    if not found:
        kept = f"{len(metadata['packages'])} crates; licences, bans, versions, sources"
        print(f"dependencies: {manifest}: {kept} as in deny.toml")
    return 1 if found else 0


def main() -> int:
    """Check by cargo-deny, or without."""
    if shutil.which("cargo-deny") is None:
        found = [check(manifest) for manifest in MANIFESTS]
        print("dependencies: advisories SKIPPED: cargo-deny, which knows them, is not installed")
        return max(found)

    def deny(*arguments: str) -> int:
        commands = [[CARGO, "deny", "--manifest-path", each, *arguments] for each in MANIFESTS]
        return int(any(subprocess.run(each, cwd=ROOT, check=False).returncode for each in commands))

    if deny("check", "licenses", "bans", "sources") != 0:
        return 1
    if deny("fetch") != 0:
        print("dependencies: advisories SKIPPED: their database cannot be reached")
        return 0
    return deny("check", "--disable-fetch", "advisories")


if __name__ == "__main__":
    sys.exit(main())
