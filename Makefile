# The commands of this house. Everything is built in target/ and .venv/, nothing outside the clone.

CARGO ?= cargo
PYTHON ?= python3
VENV := .venv/bin

# Each fuzz target runs so many seconds.
SECONDS_EACH ?= 900
SCRIPTS := crates/firsthit-cli/tests/scripts
PROGRAM := target/release/firsthit

.PHONY: fuzz attack render test test-rust test-python test-scripts check clean program

# Builds the program, renders the embedded example scene and says where the picture is.
render:
	$(CARGO) run --release --package firsthit-cli --bin firsthit -- demo --output render.png

# All there is to test.
test: test-rust test-python test-scripts

test-rust:
	$(CARGO) test --workspace

# The package, built and tested in an environment of its own.
test-python: .venv/ready
	$(VENV)/maturin develop --release --quiet
	$(VENV)/python -m pytest
	$(VENV)/python -m mypy.stubtest firsthit._firsthit
	$(VENV)/mypy python/firsthit python/examples

# Files that attack, little memory, kills: a sample of them, or (make attack) all.
test-scripts: program
	$(PYTHON) $(SCRIPTS)/hostile.py $(PROGRAM) --quick
	$(PYTHON) $(SCRIPTS)/memory.py $(PROGRAM) --quick
	$(PYTHON) $(SCRIPTS)/torn.py $(PROGRAM) --quick

attack: program
	$(PYTHON) $(SCRIPTS)/hostile.py $(PROGRAM)
	$(PYTHON) $(SCRIPTS)/memory.py $(PROGRAM)
	$(PYTHON) $(SCRIPTS)/torn.py $(PROGRAM)

program:
	$(CARGO) build --release --package firsthit-cli

# Fuzzes every loader, one after the other; see docs/robustness.md.
fuzz:
	SECONDS_EACH=$(SECONDS_EACH) fuzz/run

.venv/ready: python/requirements-dev.txt
	$(PYTHON) -m venv .venv
	$(VENV)/pip install --quiet --requirement python/requirements-dev.txt
	touch $@

# What must hold besides: formatting, lints, documentation. Warnings are errors.
check: .venv/ready
	$(CARGO) fmt --all --check
	$(CARGO) clippy --workspace --all-targets -- -D warnings
	RUSTDOCFLAGS="-D warnings" $(CARGO) doc --workspace --no-deps
	$(VENV)/ruff check python
	$(VENV)/ruff format --check python

clean:
	rm -rf target .venv render.png
