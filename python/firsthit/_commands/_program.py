"""Shared parts of commands: reading arguments, messages, and exit codes.

It is what the Rust program does, so that nobody notices in which language a command is written:
every error is one line on standard error, ``firsthit: error: ...``, and with ``--json`` there is
one JSON object for the run.
"""

from __future__ import annotations

import argparse
import json
import os
import re
import sys
import unicodedata
import warnings
from contextlib import contextmanager
from difflib import get_close_matches
from typing import TYPE_CHECKING, Any, NoReturn

from firsthit import _firsthit
from firsthit._base.errors import FileError, FileWriteError
from firsthit._base.log import log_steps

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Sequence

USAGE, BAD_INPUT, NOT_WRITTEN, LIMIT, INTERNAL, INTERRUPTED = 2, 3, 4, 5, 70, 130


class UsageError(Exception):
    """The command line makes no sense."""


class Parser(argparse.ArgumentParser):
    """A parser whose errors are exceptions, and whose options cannot be shortened.

    It knows ``--version``, ``--json``, ``--quiet`` and ``--verbose``, as every command of the
    program does.
    """

    def __init__(self, command: str, about: str, examples: str) -> None:
        super().__init__(
            prog=f"firsthit {command}",
            description=about,
            epilog=examples,
            formatter_class=argparse.RawDescriptionHelpFormatter,
            allow_abbrev=False,
        )
        version = f"firsthit {_firsthit.version()}"
        self.add_argument("-V", "--version", action="version", version=version)
        self.add_argument(
            "--json",
            action="store_true",
            help="report the run and its warnings as one JSON object, on standard output",
        )
        verbosity = self.add_mutually_exclusive_group()
        verbosity.add_argument(
            "-q", "--quiet", action="store_true", help="print only results, warnings and errors"
        )
        verbosity.add_argument(
            "-v", "--verbose", action="store_true", help="print a line for each step that is done"
        )

    def error(self, message: str) -> NoReturn:
        """Raise what is wrong with the arguments, and which option was probably meant."""
        for word in re.findall(r"^unrecognized arguments: (--[a-z-]+)", message):
            for close in get_close_matches(word, self._option_string_actions, 1):
                message += f"; tip: a similar argument exists: '{close}'"
        raise UsageError(f"{message}; see {self.prog} --help")


def output_of(arguments: argparse.Namespace, command: str) -> str:
    """Return where to write, which must be given."""
    if not arguments.output:
        raise UsageError(f"--output must be given, and not empty; see firsthit {command} --help")
    return str(arguments.output)


def progress_of(arguments: argparse.Namespace) -> bool | None:
    """Tell whether a line shows how far the work is: where somebody may look, who wants to."""
    return (not (arguments.quiet or arguments.verbose) and sys.stderr.isatty()) or None


def run(
    argv: Sequence[str],
    parser: Parser,
    work: Callable[[argparse.Namespace], tuple[str | None, dict[str, Any]]],
) -> int:
    """Do the work of a command, and return its exit code.

    ``work`` gets the arguments, and returns what to say to people, if anything, and to programs.
    """
    _firsthit.begin_run()
    said = _Said(as_json="--json" in _before_dashes(argv))
    try:
        with said.hearing():
            arguments = parser.parse_args([*argv])
            if arguments.verbose:
                log_steps()
            text, report = work(arguments)
        said.done(text, report)
    except SystemExit as ended:  # argparse, after --help and --version
        return int(ended.code or 0)
    except BaseException as error:
        code, message = failure(error)
        if message:
            said.failed(message, code)
        return code
    return 0


def failure(error: BaseException) -> tuple[int, str]:
    """Return the exit code of an exception, and the line about it; the line may be empty."""
    if isinstance(error, BrokenPipeError):
        # A reader that has gone away had enough. Nothing is flushed into the pipe at the end.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return 0, ""
    if isinstance(error, KeyboardInterrupt):
        return INTERRUPTED, "interrupted"
    if isinstance(error, UsageError):
        return USAGE, str(error)
    if isinstance(error, MemoryError):
        return LIMIT, str(error) or "memory is short"
    if isinstance(error, FileWriteError):
        return NOT_WRITTEN, str(error)
    if isinstance(error, FileError | OSError | ValueError | IndexError):
        return BAD_INPUT, str(error)
    if isinstance(error, ImportError):
        return NOT_WRITTEN, str(error)
    what = f"{type(error).__name__}: {error}"
    return INTERNAL, f"a bug in firsthit, please report it: {what}"


class _Said:
    """Writes to standard output and standard error."""

    def __init__(self, *, as_json: bool) -> None:
        self._as_json = as_json
        self._warnings: list[str] = []

    @contextmanager
    def hearing(self) -> Iterator[None]:
        """Say warnings as they come, or keep them for the report."""
        with warnings.catch_warnings():
            warnings.simplefilter("always")
            warnings.showwarning = self._warned
            yield

    def _warned(self, message: Warning | str, *_: Any, **__: Any) -> None:
        text = str(message)
        if self._as_json:
            self._warnings.append(text)
        elif text not in self._warnings:
            self._warnings.append(text)
            say(f"firsthit: warning: {text}")

    def done(self, text: str | None, report: dict[str, Any]) -> None:
        """Say how it ended."""
        if self._as_json:
            self._report(report)
        elif text:
            print("\n".join(map(plain, text.splitlines())))
        sys.stdout.flush()

    def failed(self, message: str, code: int) -> None:
        """Say why it did not."""
        if self._as_json:
            try:
                self._report({"error": message, "exit_code": code})
                sys.stdout.flush()
            except OSError:
                pass  # A closed stream is no second failure.
        say(f"firsthit: error: {message}")

    def _report(self, report: dict[str, Any]) -> None:
        print(json.dumps({**report, "warnings": self._warnings}, indent=2))


def say(line: str) -> None:
    """Say a line on standard error, whether or not somebody listens."""
    try:
        sys.stderr.write(plain(line) + "\n")
        sys.stderr.flush()
    except (OSError, UnicodeError):
        pass


def plain(line: str) -> str:
    """Return a line in which names from files cannot write to the terminal."""
    return "".join(
        each if unicodedata.category(each) not in ("Cc", "Cf", "Cs", "Zl", "Zp") else _escape(each)
        for each in line
    )


def _escape(character: str) -> str:
    return f"\\u{{{ord(character):x}}}"


def _before_dashes(argv: Sequence[str]) -> Sequence[str]:
    return argv[: argv.index("--")] if "--" in argv else argv
