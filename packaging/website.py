"""What MkDocs asks of us while it makes the site (mkdocs.yml, `make docs`).

Pages are written for readers of the repository, where a link to a file beside docs/ is right. On
the site, README.md is the first page, and the other documents of the root are pages too. Links to
files that the site has not become links to the repository if Cargo.toml has its address, and plain
text otherwise.

The Rust reference joins the site if `cargo doc` has made it. The program, if it is built, adds what
it says of itself, and the viewer with the chapter alive. `llms.txt` lists all pages for programs.

The site asks no other host for anything: a script, style, font or picture from elsewhere is an
error.
"""

from __future__ import annotations

import os
import posixpath
import re
import subprocess
import tempfile
import tomllib
from pathlib import Path
from typing import TYPE_CHECKING

from mkdocs.exceptions import PluginError
from mkdocs.structure.files import File

if TYPE_CHECKING:
    from mkdocs.config.defaults import MkDocsConfig
    from mkdocs.structure.files import Files
    from mkdocs.structure.nav import Navigation
    from mkdocs.structure.pages import Page

ROOT = Path(__file__).parents[1]
RUSTDOC = ROOT / "target" / "doc"
PROGRAM = ROOT / "target" / "release" / "firsthit"

#: Documents of the root, and the pages they are.
ROOT_PAGES = {
    "README.md": "index.md",
    "ARCHITECTURE.md": "architecture.md",
    "CONTRIBUTING.md": "contributing.md",
    "CHANGELOG.md": "changelog.md",
}
FROM_PAGES = {page: document for document, page in ROOT_PAGES.items()}

#: Where a page wants the link to the Rust reference.
RUST = "<!-- the Rust reference -->"

#: Where a page wants the viewer with the chapter alive, which is this file of the site.
CHAPTER = "<!-- the chapter alive -->"
CHAPTER_FILE = "chapter.html"

#: What the program says of itself; options of these commands are with the Python package.
HELP = "reference/program.md"
OF_THE_PACKAGE = {
    "dataset": "datasets.md",
    "parts": "cluster.md",
    "pack": "datasets.md",
}

#: All pages, in the order of the contents.
PAGES: list[Page] = []

LINK = re.compile(r"\[((?:[^][]|\[[^]]*\])*)\]\(([^()\s]+)\)")
#: A picture as HTML, up to its source and that.
PICTURE = re.compile(r'(<img [^>]*?\bsrc=")([^":]+)')
FENCE = re.compile(r"^(```.*?^```$)", re.MULTILINE | re.DOTALL)
#: A name in a docstring; `ray` and `parts` are attributes more often than what the package has.
NAMED = re.compile(
    r"(?:(?<=<td>)|(?<=<p>)|(?<=<li>)|(?<!>))"
    r"(<code>(?!ray<|parts<)([A-Za-z][A-Za-z0-9]*(?:[._][A-Za-z0-9]+)*)</code>)(?!</a>)"
)
LOADED = re.compile(
    r"""<(?:script|img|iframe|source)\b[^>]*?\bsrc=["']?(?:https?:)?//[^"'>\s]*"""
    r"""|<link\b(?![^>]*\brel=["']?canonical)[^>]*?\bhref=["']?(?:https?:)?//[^"'>\s]*"""
    r"""|(?:@import\s+["']|url\(["']?)(?:https?:)?//[^"')\s]*"""
)


def on_files(files: Files, config: MkDocsConfig) -> Files:
    """Add the documents of the root and what `cargo doc` has made."""
    for document, page in ROOT_PAGES.items():
        files.append(File.generated(config, page, abs_src_path=str(ROOT / document)))
    if (RUSTDOC / "firsthit" / "index.html").is_file():
        for path in RUSTDOC.rglob("*"):
            # A licence of its fonts is Markdown, which would be a page.
            if path.is_file() and path.name != ".lock" and path.suffix != ".md":
                name = f"rust/{path.relative_to(RUSTDOC).as_posix()}"
                files.append(File.generated(config, name, abs_src_path=str(path)))
    files.append(File.generated(config, HELP, content=_help()))
    chapter = _chapter()
    if chapter is not None:
        files.append(File.generated(config, CHAPTER_FILE, content=chapter))
    return files


def _has_program() -> bool:
    # An old one may be there that nobody asked for.
    return not os.environ.get("WITHOUT_PROGRAM") and PROGRAM.is_file()


def _help() -> str:
    """Return what `--help` says for each command; without the program, that it says it."""
    page = "# The program\n\nThe program's own words: `firsthit --help` for each command.\n"
    if not _has_program():
        return page

    def said(*words: str) -> str:
        command, wide = [PROGRAM, *words, "--help"], os.environ | {"COLUMNS": "100"}
        done = subprocess.run(command, env=wide, check=True, capture_output=True, text=True)
        return done.stdout

    overview = said()
    commands = re.findall(r"^  ([a-z]+)  ", overview.split("\nOptions:")[0], re.MULTILINE)
    parts = {"firsthit": f"```text\n{overview}```"}
    for name in commands:
        if name in OF_THE_PACKAGE:
            there = f"../{OF_THE_PACKAGE[name]}"
            parts[f"firsthit {name}"] = f"With the Python package: [its page]({there})."
        elif name != "help":
            parts[f"firsthit {name}"] = f"```text\n{said(name)}```"
    return page + "".join(f"\n## {name}\n\n{part}\n" for name, part in parts.items())


def _chapter() -> bytes | None:
    """Return the viewer of a small scene as a report; nothing without the program."""
    if not _has_program():
        return None
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / CHAPTER_FILE
        command = [PROGRAM, "view", ROOT / "docs" / "chapter.toml", "-o", path]
        told = subprocess.run(command, check=False, capture_output=True, text=True)
        if told.returncode != 0:
            raise PluginError(told.stderr)
        return path.read_bytes()


def on_nav(nav: Navigation, config: MkDocsConfig, files: Files) -> None:
    """Keep the pages in the order of the contents."""
    PAGES[:] = nav.pages


def on_page_markdown(markdown: str, page: Page, config: MkDocsConfig, files: Files) -> str:
    """Let links lead to pages of the site."""
    here = page.file.src_uri
    document = FROM_PAGES.get(here, f"docs/{here}")

    def on_site(target: str) -> str | None:
        """Return where a link to a file leads here; nothing if the file is nowhere to be seen."""
        name, hash_sign, anchor = target.partition("#")
        path = posixpath.normpath(posixpath.join(posixpath.dirname(document), name))
        if not (ROOT / path).exists():
            raise PluginError(f"{document}: there is no {path}")
        there = ROOT_PAGES.get(path, path.removeprefix("docs/"))
        if (ROOT / path).is_dir():
            within = (each.file.src_uri for each in PAGES)
            there = next((each for each in within if each.startswith(f"{there}/")), there)
        if (path in ROOT_PAGES or path.startswith("docs/")) and files.get_file_from_path(there):
            relative = posixpath.relpath(there, posixpath.dirname(here) or ".")
            return f"{relative}{hash_sign}{anchor}"
        address = _address()
        return f"{address}/blob/HEAD/{path}" if address else None

    def link(found: re.Match[str]) -> str:
        text, target = found.groups()
        if re.match(r"[a-z]+:|#", target):
            return found[0]
        there = on_site(target)
        return f"[{text}]({there})" if there else text

    def picture(found: re.Match[str]) -> str:
        return f"{found[1]}{on_site(found[2])}"

    parts = FENCE.split(markdown)
    parts[::2] = [LINK.sub(link, part) for part in parts[::2]]
    parts[::2] = [PICTURE.sub(picture, part) for part in parts[::2]]
    reference = posixpath.relpath("rust/firsthit/index.html", posixpath.dirname(here) or ".")
    told = (
        f"[Open the reference]({reference})."
        if files.get_file_from_path("rust/firsthit/index.html")
        else ""
    )
    chapter = ""
    if files.get_file_from_path(CHAPTER_FILE):
        folder = posixpath.dirname(page.url) or "."
        address = f"{posixpath.relpath(CHAPTER_FILE, folder)}#chapter"
        style = "width:100%;height:46rem;border:1px solid gray"
        # In a sandbox it cannot scroll this page to its section.
        may = 'sandbox="allow-scripts allow-downloads" allow="clipboard-write" loading="lazy"'
        chapter = f'<iframe src="{address}" title="The viewer" {may} style="{style}"></iframe>'
    return "".join(parts).replace(RUST, told).replace(CHAPTER, chapter)


def on_page_content(html: str, page: Page, config: MkDocsConfig, files: Files) -> str:
    """Let the names in docstrings lead to what they name."""
    if not page.file.src_uri.startswith("reference/python/"):
        return html
    return NAMED.sub(r'<autoref optional identifier="firsthit.\2">\1</autoref>', html)


def on_post_build(config: MkDocsConfig) -> None:
    """Write a list of all pages, and refuse a site that loads anything from elsewhere."""
    site = Path(config.site_dir)
    (site / "llms.txt").write_text(_for_programs(config), encoding="utf-8")
    foreign = [
        f"{path.relative_to(site)}: {found}"
        for path in site.rglob("*")
        if path.suffix in {".html", ".css"}
        for found in LOADED.findall(path.read_text(encoding="utf-8"))
    ]
    if foreign:
        raise PluginError("\n".join(["the site asks other hosts:", *foreign]))


def _for_programs(config: MkDocsConfig) -> str:
    """Return all pages, each with its beginning, as https://llmstxt.org has it."""
    lines, part = [f"# {config.site_name}", "", f"> {config.site_description}"], ""
    for page in PAGES:
        section = page.ancestors[-1].title if page.ancestors else "Home"
        if section != part:
            part = section
            lines += ["", f"## {part}", ""]
        paragraphs = re.split(r"\n{2,}", FENCE.sub("", page.markdown or ""))
        begins = next((each for each in paragraphs if re.match(r"[A-Z`*[]", each.strip())), "")
        plain = re.sub(r"\[([^]]*)\]\([^)]*\)", r"\1", " ".join(begins.split()))
        lines.append(f"- [{page.title}]({page.url})" + (f": {plain}" if plain else ""))
    return "\n".join(lines) + "\n"


def _address() -> str:
    workspace = tomllib.loads((ROOT / "Cargo.toml").read_text(encoding="utf-8"))["workspace"]
    return str(workspace["package"].get("repository", ""))
