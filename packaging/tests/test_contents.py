"""What is in the wheel, the source distribution and the crates, and what an index shows of them."""

import email
import re
import sys
import tarfile
import tomllib
import zipfile
from pathlib import PurePosixPath

import pytest
from conftest import DIST, IS_RELEASE, ROOT

WORKSPACE = tomllib.loads((ROOT / "Cargo.toml").read_text())["workspace"]
VERSION = WORKSPACE["package"]["version"]


def files_of(pattern):
    """The files of the one archive of `dist/`: names below its folder, and their bytes."""
    (path,) = DIST.glob(pattern)
    if path.suffix == ".whl":
        with zipfile.ZipFile(path) as archive:
            return {name: archive.read(name) for name in archive.namelist()}
    with tarfile.open(path) as archive:
        members = [member for member in archive if not member.isdir()]
        read = {member.name: archive.extractfile(member).read() for member in members}
    return {str(PurePosixPath(*PurePosixPath(name).parts[1:])): data for name, data in read.items()}


@pytest.fixture(scope="module")
def wheel():
    return files_of("*.whl")


@pytest.fixture(scope="module")
def source():
    return files_of("*.tar.gz")


def test_the_wheel_has_the_package_the_program_and_their_types(wheel):
    info = f"firsthit-{VERSION}.dist-info"
    folders = {name.split("/")[0] for name in wheel}
    assert folders == {"firsthit", "_firsthit_program", info}
    sources = (ROOT / "python" / "firsthit").rglob("*.py*")
    wanted = {
        path.relative_to(ROOT / "python").as_posix()
        for path in sources
        if path.parent.name != "__pycache__"
    }
    wanted |= {"firsthit/py.typed", "firsthit/_firsthit.pyi", "_firsthit_program/__init__.py"}
    wanted |= {f"{info}/licenses/LICENSE", f"{info}/entry_points.txt"}
    assert wanted <= wheel.keys()
    native = [name for name in wheel if name.endswith((".so", ".pyd"))]
    assert len(native) == 1
    assert len([name for name in wheel if name.startswith("firsthit/")]) == len(wanted) - 3 + 1


def test_the_wheel_fits_any_python_and_any_linux():
    (path,) = DIST.glob("*.whl")
    assert "-cp311-abi3-" in path.name
    # Unless this is a release, it is linked for this machine's own glibc.
    assert not IS_RELEASE or sys.platform != "linux" or "manylinux_2_17_" in path.name
    # 12.4 MB, and less with the optimisation of releases: lenses, queries and shading are compiled
    # for three instruction sets, and 2.7 MB are the WebAssembly module. A picture that slips in
    # shows.
    assert path.stat().st_size < 12.8e6


def test_the_index_shows_licence_classifiers_keywords_and_a_page_without_dead_links(wheel, source):
    (name,) = [name for name in wheel if name.endswith(".dist-info/METADATA")]
    for text in [wheel[name], source["PKG-INFO"]]:
        metadata = email.message_from_bytes(text)
        assert metadata["License-Expression"] == "MIT"
        assert metadata["License-File"] == "LICENSE"
        assert "raycasting" in metadata["Keywords"]
        assert "Typing :: Typed" in metadata.get_all("Classifier")
        assert not [line for line in metadata.get_all("Classifier") if line.startswith("License")]
        assert metadata["Description-Content-Type"].startswith("text/markdown")
        check_page(metadata.get_payload())


def check_page(text):
    assert "# firsthit" in text
    assert not re.findall(r"!\[[^]]*\]\(", text)
    assert not re.findall(r"\]\((?!https?://)[^)]*\)", text)


def test_the_source_distribution_has_all_that_it_is_built_from(source):
    for member in WORKSPACE["members"]:
        assert f"{member}/Cargo.toml" in source
    assert {"Cargo.lock", "LICENSE", "README.md", "pyproject.toml"} <= source.keys()
    # 12 MB of code, tests and pages, 1 MB of them pictures, and 2.7 MB of WebAssembly. A model
    # that slips in shows.
    assert sum(map(len, source.values())) < 15e6


def test_documents_that_messages_and_docstrings_name_are_in_the_source_distribution(source):
    named = {
        document.decode().rstrip(".")
        for name, text in source.items()
        if name.endswith((".rs", ".py", ".pyi")) and "/tests/" not in name
        for document in re.findall(rb"\b(?:docs/[\w./-]+|[A-Z]{3,}\.md)", text)
    }
    assert {"docs/outputs.md", "docs/output-metadata.schema.json"} <= named
    assert named <= source.keys(), named - source.keys()


#: The crates that are published, those below the library among them.
CRATES = [
    PurePosixPath(member).name
    for member in WORKSPACE["members"]
    if member not in {"crates/firsthit-wasm", "python"}
]


@pytest.mark.parametrize("name", CRATES)
def test_a_crate_has_its_licence_its_page_and_no_tests(name):
    crate = files_of(f"{name}-{VERSION}.crate")
    assert {"LICENSE", "README.md", "src/lib.rs", "Cargo.lock"} <= crate.keys()
    assert crate["LICENSE"] == (ROOT / "LICENSE").read_bytes()
    check_page(crate["README.md"].decode())
    assert not [path for path in crate if path.startswith(("tests/", "benches/"))]
    folder = ROOT / "crates" / name
    sources = {*folder.glob("*.rs"), *(folder / "src").rglob("*.rs")}
    assert {path.relative_to(folder).as_posix() for path in sources} <= crate.keys()
    # 2 MB of viewer, and 0.9 MB of code with its unit tests in the largest of the library.
    assert sum(map(len, crate.values())) < (3.9e6 if name == "firsthit-view" else 1e6)
    package = tomllib.loads(crate["Cargo.toml"].decode())["package"]
    for key in ["description", "license", "readme", "rust-version"]:
        assert package[key]
    assert 1 <= len(package["keywords"]) <= 5
    if "internal" not in package["description"]:
        assert package["documentation"]
        assert 1 <= len(package["categories"]) <= 5


def test_no_repository_is_named_before_it_is_decided(wheel):
    (name,) = [name for name in wheel if name.endswith(".dist-info/METADATA")]
    told = email.message_from_bytes(wheel[name]).get_all("Project-URL") or []
    address = WORKSPACE["package"].get("repository")
    assert bool(told) == bool(address)
    assert all(address in line for line in told)
