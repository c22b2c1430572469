"""No dead link: what documents link to is there, files, pictures and headings."""

import re
import unicodedata

import pytest
from pages import ROOT

FOLDERS = ("docs", "crates", "python", "packaging", "benches", "testdata", "fuzz")
DOCUMENTS = sorted(
    [*ROOT.glob("*.md"), *(path for name in FOLDERS for path in (ROOT / name).rglob("*.md"))]
)


def prose(path):
    """A document without its blocks of code, and without code in its lines."""
    text = re.sub(r"^```.*?^```$", "", path.read_text(encoding="utf-8"), flags=re.M | re.S)
    return re.sub(r"`[^`\n]*`", lambda code: code[0].replace("](", "] ("), text)


def anchors(path):
    """The anchors of a document's headings, as GitHub makes them."""
    found = set()
    for heading in re.findall(r"^#{1,6} +(.+?) *#*$", prose(path), re.MULTILINE):
        text = re.sub(r"\[([^]]*)\]\([^)]*\)", r"\1", heading).lower()
        kept = (
            letter for letter in text if letter in " -_" or unicodedata.category(letter)[0] in "LN"
        )
        slug = "".join(kept).replace(" ", "-")
        again = sum(
            each == slug or re.fullmatch(re.escape(slug) + r"-\d+", each) is not None
            for each in found
        )
        found.add(f"{slug}-{again}" if again else slug)
    return found


def links(path):
    """Return the targets of a document's links, but for other hosts."""
    text = prose(path)
    found = re.findall(r"\]\(<?([^()\s<>]+)>?(?: \"[^\"]*\")?\)", text)
    found += re.findall(r"^\[[^]]+\]: +(\S+)", text, re.MULTILINE)
    found += re.findall(r"<(?:a|img)\b[^>]*?\b(?:href|src)=\"([^\"]+)\"", text)
    return [each for each in found if not re.match(r"[a-z]+:", each)]


@pytest.mark.parametrize("path", DOCUMENTS, ids=lambda path: str(path.relative_to(ROOT)))
def test_links_lead_somewhere(path):
    for link in links(path):
        name, _, anchor = link.partition("#")
        there = (path.parent / name).resolve() if name else path
        if there.parent.name == "gallery" and not any(there.parent.glob("*.png")):
            continue  # A source distribution has no pictures of the gallery.
        assert there.exists(), link
        assert there.is_relative_to(ROOT), link
        if anchor and there.suffix == ".md":
            assert anchor in anchors(there), link


def test_there_are_documents_and_links():
    assert ROOT / "README.md" in DOCUMENTS
    assert len(links(ROOT / "docs" / "outputs.md")) > 10
    assert "what-identifiers-stand-for" in anchors(ROOT / "docs" / "outputs.md")


def test_anchors_are_those_of_github(tmp_path):
    page = tmp_path / "page.md"
    page.write_text("# A `b_c`, d\n## Say [it](x.md): now\n## Say it now\n```sh\n# no\n```\n")
    assert anchors(page) == {"a-b_c-d", "say-it-now", "say-it-now-1"}
