"""Preparation of each test for pytest."""

import signal
from pathlib import Path

import firsthit
import numpy
import pytest

# A shell lets what it starts in the background ignore Ctrl-C, and so would all that tests start. A
# handler is not handed on.
if signal.getsignal(signal.SIGINT) is signal.SIG_IGN:
    signal.signal(signal.SIGINT, signal.default_int_handler)


@pytest.fixture(autouse=True)
def _examples_write_elsewhere(
    request: pytest.FixtureRequest,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    doctest_namespace: dict[str, object],
) -> None:
    """Give docstrings' examples ``fh`` and ``np``; keep what they write out of the clone."""
    if isinstance(request.node, pytest.DoctestItem):
        monkeypatch.chdir(tmp_path)
        doctest_namespace.update(fh=firsthit, np=numpy)
