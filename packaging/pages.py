"""Make what a package index shows of firsthit: its page, and the address of its repository.

The page, ``packaging/README.md``, is README.md without its pictures and with its relative links as
plain text: an index shows a page far from the files beside it. The repository's address stands in
the workspace's Cargo.toml, and packages inherit it by a line of their own. Cargo refuses that line
while the workspace has no address, so this script adds it once there is one.

With ``--check`` nothing is written: the exit code says whether anything would be.
"""

import re
import sys
import tomllib
from pathlib import Path

ROOT = Path(__file__).parents[1]
WORKSPACE = tomllib.loads((ROOT / "Cargo.toml").read_text(encoding="utf-8"))["workspace"]
PACKAGES = [member for member in WORKSPACE["members"] if member != "crates/firsthit-wasm"]
NOTE = "<!-- Made from README.md by packaging/pages.py: `make pages`. -->\n\n"
INHERITED = "repository.workspace = true\n"


def page(readme: str) -> str:
    """Return README.md's text as it can be read away from the repository."""
    without_pictures = re.sub(
        r"^(?:!\[[^]]*\]\([^)]*\)|<(?:img|br) [^>]*>)\n+", "", readme, flags=re.MULTILINE
    )
    return NOTE + re.sub(r"\[([^]]+)\]\((?!https?:)[^)]*\)", r"\1", without_pictures)


def manifest(text: str, has_address: bool) -> str:  # noqa: FBT001
    """Return a package's Cargo.toml with or without the address."""
    text = text.replace(INHERITED, "")
    after = "license.workspace = true\n"
    return text.replace(after, after + INHERITED, 1) if has_address else text


def main() -> int:
    """Write, or check, all of it."""
    workspace = tomllib.loads((ROOT / "Cargo.toml").read_text())["workspace"]["package"]
    wanted = {"packaging/README.md": page((ROOT / "README.md").read_text())}
    for package in PACKAGES:
        name = f"{package}/Cargo.toml"
        wanted[name] = manifest((ROOT / name).read_text(), "repository" in workspace)
    stale = [
        name
        for name, text in wanted.items()
        if not (ROOT / name).is_file() or (ROOT / name).read_text() != text
    ]
    if "--check" in sys.argv[1:]:
        for name in stale:
            print(f"{name} is not what packaging/pages.py makes: run `make pages`")
        return int(bool(stale))
    for name in stale:
        (ROOT / name).write_text(wanted[name])
    return 0


if __name__ == "__main__":
    sys.exit(main())
