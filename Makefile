# The commands of this house. Nothing is built outside the clone.

# A command of one word.
CARGO ?= cargo
PYTHON ?= python3
# Where an environment of Python has its programs.
BIN := $(if $(filter Windows_NT,$(OS)),Scripts,bin)
VENV := .venv/$(BIN)
DIST := .venv-dist/$(BIN)
LINUX := $(filter Linux,$(shell uname))
# What is compiled outside the workspace: its dependencies are compiled once.
OUTSIDE := target/outside

# Each fuzz target runs so many seconds.
SECONDS_EACH ?= 900
SCRIPTS := crates/firsthit-cli/tests/scripts
PROGRAM := target/release/firsthit

# Programs are run from where they are built, whatever the user's own projects have.
export CARGO_TARGET_DIR := $(CURDIR)/target
unexport CARGO_BUILD_TARGET
# $(call develop,FOLDER): the package, built and installed into that environment. On its own, maturin takes the one that is active.
develop = env -u CONDA_PREFIX VIRTUAL_ENV="$(CURDIR)/$(1)" $(or $(MATURIN_OF),$(1))/$(BIN)/maturin develop --quiet --profile $(or $(2),release)

# All cases of the tests, or nothing for some of them.
export FIRSTHIT_TEST := $(strip $(FIRSTHIT_TEST))
$(if $(FIRSTHIT_TEST:full=),$(error FIRSTHIT_TEST must be full or not be set, got $(FIRSTHIT_TEST)))

# How many rays `make soak` shoots.
RAYS ?= 100000000

# Clones of the peers' repositories, if there are any: see CONTRIBUTING.md.
TRIMESH ?=
OPEN3D ?=

# Says at the end what it took.
TIMED := $(PYTHON) .ci/timed
MAKE_QUIETLY = $(MAKE) --no-print-directory

.PHONY: render gallery quick test test-full nightly soak test-rust test-python test-scripts test-installed test-compat test-light test-browser test-wasm
.PHONY: check-bench test-neon test-cluster program wasm attack fuzz bench bench-python bench-queries bench-lidar bench-light dist pages docs check check-features
.PHONY: check-targets check-oldest check-semver check-tag check-format check-clippy check-ruff miri test-release test-wheel
.PHONY: publish-crates clean

# Builds the program, renders the embedded example scene and says where the picture is.
render: program
	$(PROGRAM) demo --output render.png

# The pictures of docs/gallery.md, by the page's own commands. ONLY="chess cornell" makes two of them.
gallery: .venv/ready
	$(call develop,.venv)
	$(VENV)/python docs/gallery/make.py $(ONLY)

# The picture of the viewer in the README, by Chromium: after `make test-browser`, which brings what it needs.
viewer-picture: program
	FIRSTHIT="$(CURDIR)/$(PROGRAM)" $(BROWSER)/venv/bin/python docs/gallery/viewer.py
.PHONY: viewer-picture

# One selection of packages for all that tests compile: with another one, dependencies have other features, and all is compiled anew. Tests
# run on the library of a release, which the program and the Python package share.
TEST := $(CARGO) test --workspace --release
# With the checks for overflow and the assertions that a release is without, and compiled by parts: for edits, and test-checked.
TEST_CHECKED := $(CARGO) test --workspace

# After each edit: format, lints, and the tests whose names contain ROOM, as `make quick ROOM=lint` has it, or all unit tests.
ROOM ?=
quick:
	@exec $(TIMED) "make quick" $(MAKE_QUIETLY) quick-steps
	@echo "left out: $(if $(ROOM),other tests,integration tests), Python, scripts (make test)"
.PHONY: quick-steps
quick-steps:
	$(CARGO) fmt --all --check
	$(CARGO) clippy --quiet --workspace -- -D warnings
	$(if $(ROOM),$(TEST_CHECKED) --quiet --tests $(ROOM) -- --list | grep -c ': test$$' > /dev/null || { echo "no test has $(ROOM) in its name"; exit 1; })
	$(TEST_CHECKED) --quiet $(if $(ROOM),--tests $(ROOM),--lib --bins)

timed-%:
	@exec $(TIMED) "$*" $(MAKE_QUIETLY) $*

# Before each commit: every kind of test there is, random ones with fewer cases. FIRSTHIT_TEST=full is for all cases.
TESTS := test-programs test-rust test-python test-scripts
test:
	@exec $(TIMED) "make $(if $(filter full,$(FIRSTHIT_TEST)),test-full,test)" $(MAKE_QUIETLY) --jobs 1 $(TESTS:%=timed-%)
	@$(if $(filter full,$(FIRSTHIT_TEST)),,echo "left out: most cases of random tests, most parts of long ones, most pages of docs/ (make test-full)")

# All cases; .ci/run does this. What people install is tested by `test-installed`.
test-full:
	@FIRSTHIT_TEST=full $(MAKE_QUIETLY) test

# What .ci/run leaves out: releases compiled as their users would, each feature alone, other targets and compilers, other programs, and
# attacks for as long as they take; NIGHTLY_RAYS is the length of its soak. Some of it is skipped, with a line that says so, where this machine cannot do it.
NIGHTLY_RAYS ?= 10000000
NIGHTLY := test-release test-checked check-bench check-features check-targets check-oldest check-semver miri test-neon attack test-cluster
NIGHTLY += test-browser test-compat test-light soak
nightly:
	@exec $(TIMED) "make nightly" $(MAKE_QUIETLY) --jobs 1 --keep-going $(NIGHTLY:%=timed-%) RAYS=$(NIGHTLY_RAYS)
	@echo "left out: fuzz, bench"

# All that tests compile, and beside it the environment that the package is built and tested in.
test-programs:
	@$(MAKE_QUIETLY) --jobs 2 .venv/ready test-programs-rust
	$(call develop,.venv)
.PHONY: test-programs test-programs-rust test-checked
test-programs-rust:
	$(TEST) --quiet --no-run

# Some tests read files that are not ours to copy. They are ignored, with the reason, unless those are beside the clone.
REFDATA := $(wildcard ../shared/refdata)
IGNORED_TOO := $(if $(REFDATA),-- --include-ignored --skip soak)
test-rust:
	$(TEST) $(IGNORED_TOO)

test-checked:
	FIRSTHIT_TEST=full $(TEST_CHECKED) $(IGNORED_TOO)

# Where ../shared/refdata is beside the clone, rays from inside closed meshes at their corners and edges. A hundredth as many on random
# soups, every kernel against brute force, which takes a millisecond for a ray. A tenth as many that cross closed meshes in pairs, and as
# many again that cross and leave closed meshes of real files.
SOAK := $(TEST) --test it -- --ignored --nocapture
soak:
	$(if $(REFDATA),FIRSTHIT_SOAK=$(RAYS) $(SOAK) kernels::leaks::soak)
	FIRSTHIT_SOAK=$$(($(RAYS) / 100)) $(SOAK) --exact kernels::soak
	FIRSTHIT_SOAK=$$(($(RAYS) / 10)) $(SOAK) measure::soak
	$(if $(REFDATA),FIRSTHIT_SOAK=$$(($(RAYS) / 10)) $(SOAK) closed::)

# The package, built and tested in an environment of its own.
test-python: .venv/ready
	$(call develop,.venv)
	$(VENV)/python -m pytest -n auto --maxprocesses 4 --dist loadfile
	$(VENV)/python -m mypy.stubtest --allowlist python/stubtest.txt firsthit._firsthit

# The wheel of dist/, in an environment of its own.
define INSTALL_WHEEL
$(PYTHON) -m venv --clear $(OUTSIDE)/venv
$(OUTSIDE)/venv/$(BIN)/pip install --quiet --constraint python/requirements-dev.txt dist/*.whl anywidget pytest mypy
endef

# What a user of the wheel in dist/ does first, wherever that was built: for the machines of .github/workflows/wheels.yml.
test-wheel:
	$(INSTALL_WHEEL)
	$(OUTSIDE)/venv/$(BIN)/python -m pytest packaging/tests/test_package.py

$(if $(and $(filter test-installed,$(MAKECMDGOALS)),$(filter test-release,$(MAKECMDGOALS))),$(error both have their wheel in dist/: one after the other))
# What people install, in an environment of its own: the wheel of dist/, its source distribution, a new Cargo project. Nothing is compiled
# twice; `test-release` compiles each as its user would (packaging/tests/conftest.py).
test-installed: WHEEL_PROFILE = release
test-release: WHEEL_PROFILE = dist
test-installed test-release: dist
	$(INSTALL_WHEEL)
	WHEEL_PROFILE=$(WHEEL_PROFILE) $(OUTSIDE)/venv/bin/pytest --durations 8 packaging/tests
	cd $(OUTSIDE) && venv/bin/pytest -q -c /dev/null --rootdir . -p no:cacheprovider --confcutdir "$(CURDIR)/python/tests" "$(CURDIR)/python/tests/test_notebook.py"

# What stands in for trimesh and Open3D (docs/compat.md), by the peers' own tests and beside the peers.
COMPAT = $(OUTSIDE)/compat
COMPAT_TESTS = python/compat_tests
test-compat: .venv/ready
	rm -rf $(COMPAT)
	$(PYTHON) -m venv $(COMPAT)/venv
	$(COMPAT)/venv/bin/pip install --quiet --constraint python/requirements-dev.txt --requirement $(COMPAT_TESTS)/requirements.txt
	$(VENV)/maturin build --quiet --release --out $(COMPAT)/dist
	$(COMPAT)/venv/bin/pip install --quiet $(COMPAT)/dist/*.whl
	PYTHONPATH=$(COMPAT_TESTS) $(COMPAT)/venv/bin/pytest -q -rs -c /dev/null --rootdir . -p no:cacheprovider -p open3d_here \
	    python/tests/test_compat.py python/tests/test_compat_open3d.py
	$(COMPAT)/venv/bin/python $(COMPAT_TESTS)/run.py $(COMPAT)/peers \
	    $(if $(TRIMESH),--trimesh "$(TRIMESH)") $(if $(OPEN3D),--open3d "$(OPEN3D)")

# Pictures beside those of Mitsuba 3: ten scenes, sixteen runs of each, a z-test.
LIGHT_PEER = $(OUTSIDE)/light
test-light test-browser: MATURIN_OF = .venv
test-light: .venv/ready
	$(PYTHON) -m venv $(LIGHT_PEER)
	$(LIGHT_PEER)/bin/pip install --quiet --requirement python/light_tests/requirements.txt
	$(call develop,$(LIGHT_PEER))
	$(LIGHT_PEER)/bin/python python/light_tests/mitsuba_z.py --pictures $(LIGHT_PEER)

# The viewer's page in Chromium, a report and a notebook; its scripts by the types in their comments, where npm is. What cannot be had is
# skipped.
BROWSER := $(OUTSIDE)/browser
test-browser: .venv/ready
	$(MAKE) program
	if command -v npm > /dev/null; then \
	    npm install --silent --no-save --prefix $(BROWSER) typescript@7.0.2 && \
	    $(BROWSER)/node_modules/.bin/tsc --project crates/firsthit-view/web; \
	else echo "types of the page: skipped: npm is not there"; fi
	if command -v chromedriver > /dev/null; then \
	    $(PYTHON) -m venv $(BROWSER)/venv && \
	    $(BROWSER)/venv/bin/pip install --quiet --requirement python/browser_tests/requirements.txt && \
	    $(call develop,$(BROWSER)/venv) && \
	    FIRSTHIT="$(CURDIR)/$(PROGRAM)" $(BROWSER)/venv/bin/python -m pytest python/browser_tests; \
	else echo "the viewer in a browser: skipped: chromium and chromedriver are not there"; fi

# Jobs in parts on Dask and Ray, in a network of their own where one can be had; kills and damage at random.
KILLS ?= 20
DAMAGES ?= 1000
CLUSTER = PYTHONPATH=python $(OUTSIDE)/cluster/bin/python
test-cluster: .venv/ready
	$(PYTHON) -m venv $(OUTSIDE)/cluster
	$(OUTSIDE)/cluster/bin/pip install --quiet --requirement python/cluster_tests/requirements.txt
	$(call develop,.venv)
	$(CLUSTER) -m pytest -rs python/cluster_tests
	$(CLUSTER) python/cluster_tests/kills.py workers $(KILLS)
	$(CLUSTER) python/cluster_tests/kills.py drivers $(KILLS)
	$(CLUSTER) python/cluster_tests/mutations.py $(DAMAGES)

# The wheel, the source distribution and the crates, in dist/, each with the WebAssembly module and checked as an index would. The wheels of
# releases run on any Linux with glibc 2.17, for which zig links them. WHEEL_PROFILE=release is built soonest: from what is compiled already,
# for this machine's glibc, and the crates are packed without compiling them.
WHEEL_PROFILE ?= dist
IS_RELEASE = $(filter dist,$(WHEEL_PROFILE))
MATURIN = PATH="$(CURDIR)/$(DIST):$$PATH" $(DIST)/maturin
# The library's crates, which stand below `firsthit` and promise nothing, the library, the viewer and the program.
FLOORS := geometry simd camera accel scene shoot image shade render inspect io scene-file
CRATES := $(FLOORS:%=--package firsthit-%) --package firsthit --package firsthit-view --package firsthit-cli
# What cargo unpacked of ours when it last verified crates: it goes by the version and would verify that again.
UNPACKED = "$${CARGO_HOME:-$$HOME/.cargo}"/registry/*/-*/firsthit-*
dist: .venv-dist/ready
	$(PYTHON) packaging/pages.py --check
	rm -rf dist $(OUTSIDE)/package
	$(MATURIN) sdist --out dist
	$(MATURIN) build --quiet --profile $(WHEEL_PROFILE) $(and $(LINUX),$(IS_RELEASE),--zig) --out dist
	$(if $(IS_RELEASE),rm -rf $(UNPACKED))
	$(CARGO) package --quiet --allow-dirty $(if $(IS_RELEASE),,--no-verify) $(CRATES) --target-dir $(OUTSIDE)
	cp $(OUTSIDE)/package/*.crate dist
	$(DIST)/twine check --strict dist/*.whl dist/*.tar.gz
	$(DIST)/abi3audit --strict --verbose dist/*.whl
	$(and $(LINUX),$(IS_RELEASE),$(DIST)/auditwheel show dist/*.whl | grep '"manylinux_2_17_')
	ls -l dist

# The crates, to their index, each after those that it depends on: for .github/workflows/release.yml. `make dist` has compiled them.
publish-crates:
	$(CARGO) publish --locked --no-verify $(CRATES)

# What indexes show: see packaging/pages.py.
pages:
	$(PYTHON) packaging/pages.py

DOC := RUSTDOCFLAGS="-D warnings" $(CARGO) doc --workspace --no-deps

# The site, in target/docs: see mkdocs.yml. Once .venv-docs is there, it asks no other host for anything. RUST= leaves out
# the Rust reference, the program's help and the viewer, which take cargo a while the first time.
RUST ?= yes
docs: .venv-docs/ready
	$(if $(RUST),$(DOC) --quiet)
	$(if $(RUST),$(MAKE) --silent program)
	NO_MKDOCS_2_WARNING=1 $(if $(RUST),,WITHOUT_PROGRAM=1) .venv-docs/bin/python -B -m mkdocs build --strict
	@echo "made target/docs; to read it: $(PYTHON) -m http.server --directory target/docs"

.venv-docs/ready: docs/requirements.txt
	$(PYTHON) -m venv .venv-docs
	.venv-docs/bin/pip install --quiet --requirement docs/requirements.txt
	touch $@

.venv-dist/ready: packaging/requirements.txt
	$(PYTHON) -m venv .venv-dist
	$(DIST)/pip install --quiet --requirement packaging/requirements.txt
	touch $@

# firsthit beside Embree in one table, see docs/performance.md. For every day:
# make bench SCENES=bunny ROWS=primary ROUNDS=3. ISA=avx2 measures both sides as on a machine without AVX-512. With
# RECORD=1 the table is kept in benches/record/. With TINYBVH=PATH/tiny_bvh.h, from github.com/jbikker/tinybvh, it is measured beside, too.
BENCHES := benches/Cargo.toml
BENCH_MACHINE = $(shell lscpu | sed -n 's/^Model name: *//p' | tr 'A-Z' 'a-z' | tr -cs 'a-z0-9\n' '-')
TINYBVH_LIBRARY := target/release/libtinybvh.so
bench: .venv-bench/ready target/scenes/ready
	$(CARGO) build --release --manifest-path $(BENCHES)
	$(if $(TINYBVH),$(CXX) -O3 -march=haswell -std=c++20 -shared -fPIC -w -I$(dir $(TINYBVH)) -o $(TINYBVH_LIBRARY) benches/tinybvh.cpp)
	embree=$$(find .venv-bench -name 'libembree4*' | head -n 1); scenes=$(SCENES); \
	[ -f target/scenes/ready ] || [ ! -f target/scenes/terrain.cam ] || scenes=$${scenes:-boulder,room,terrain,tiles,assembly}; \
	target/release/firsthit-bench $${embree:+--embree "$$embree"} $(if $(TINYBVH),--tinybvh $(TINYBVH_LIBRARY)) $${scenes:+--scenes "$$scenes"} \
	    $(if $(ROWS),--rows $(ROWS)) $(if $(ROUNDS),--rounds $(ROUNDS)) $(if $(JUDGE),--judge $(JUDGE)) \
	    $(if $(ISA),--isa $(ISA)) $(if $(RECORD),--record benches/record/$$(date +%F)-$(BENCH_MACHINE)$(if $(ISA),-$(ISA)).md)

# The same for the Python package and for whole processes.
bench-python: .venv-bench/ready target/scenes/ready
	$(CARGO) build --release --package firsthit-cli
	$(call develop,.venv-bench)
	.venv-bench/bin/python benches/python.py $(if $(SCENES),--scenes $(SCENES)) $(if $(ROUNDS),--rounds $(ROUNDS))
	.venv-bench/bin/python benches/process.py $(if $(SCENES),--scenes $(SCENES)) $(if $(ROUNDS),--rounds $(ROUNDS))

# All hits, nearest points and lines of sight beside Open3D, FCPW, trimesh and embreex. Open3D is 400 MB; what is not there is left out.
bench-queries: .venv-bench/ready target/scenes/ready
	.venv-bench/bin/pip install --quiet open3d==0.20.0 fcpw==1.2.0 libusb-package scipy rtree || echo "bench: open3d or fcpw cannot be installed here"
	$(call develop,.venv-bench)
	.venv-bench/bin/python benches/queries.py $(if $(SCENES),--scenes $(SCENES)) $(if $(ROUNDS),--rounds $(ROUNDS))

# A driving lidar beside Open3D and embreex, on one core. It makes its terrain where target/scenes has none.
bench-lidar: .venv-bench/ready
	.venv-bench/bin/pip install --quiet open3d==0.20.0 libusb-package || echo "bench: open3d cannot be installed here"
	$(call develop,.venv-bench)
	.venv-bench/bin/python benches/lidar.py $(if $(TURNS),--turns $(TURNS)) $(if $(ROUNDS),--rounds $(ROUNDS))

# Pictures beside Mitsuba 3 and Blender's Cycles, on two cores: half an hour. For every day:
# make bench-light ONLY=shaded ROUNDS=1 LIGHT="--size 320x180 --samples 16". Mitsuba's fast variant needs LLVM from 16 on
# (apt-get install libllvm22). With ISA=avx2 firsthit alone is limited. PNGs of all are in target/light.
bench-light: .venv-bench-light/ready target/scenes/ready
	$(call develop,.venv-bench-light,dist)
	.venv-bench-light/bin/python benches/light.py $(if $(ONLY),--only $(ONLY)) $(if $(ROUNDS),--rounds $(ROUNDS)) \
	    $(if $(ISA),--isa $(ISA)) $(LIGHT) \
	    $(if $(RECORD),--record benches/record/$$(date +%F)-$(BENCH_MACHINE)-light$(if $(ISA),-$(ISA)).md)

# A gigabyte, of which bpy is most. It has wheels for one version of Python each; which of its versions fits, pip knows.
.venv-bench-light/ready: benches/requirements-light.txt
	$(PYTHON) -m venv .venv-bench-light
	echo '*' > .venv-bench-light/.gitignore
	.venv-bench-light/bin/pip install --quiet --requirement benches/requirements-light.txt
	.venv-bench-light/bin/pip install --quiet bpy || echo "bench: bpy cannot be installed here"
	touch $@

# Where Embree is not to be had, the bench goes on without it.
.venv-bench/ready: benches/requirements.txt
	$(PYTHON) -m venv .venv-bench
	.venv-bench/bin/pip install --quiet --requirement benches/requirements.txt && touch $@ || \
	    echo "bench: embreex cannot be installed here; firsthit is measured alone"

# The scenes that are measured. The models are not ours to copy: without them only three are made, and two small ones of
# the bench's own join them.
MODELS ?= ../shared/scenes/models
target/scenes/ready: benches/scenes.py benches/glb.py | .venv-bench/ready
	.venv-bench/bin/python benches/scenes.py target/scenes --models $(MODELS) && touch $@ || \
	    echo "bench: not all scenes could be made; see benches/scenes.py"

# Files that attack, little memory, kills: a sample of them, or (make attack) all.
ATTACKS := hostile memory torn
test-scripts: program
	.ci/inlined $(PROGRAM)
	@$(MAKE_QUIETLY) --jobs 2 $(ATTACKS:%=attack-%) SAMPLE=--quick

SAMPLE ?=
attack: $(ATTACKS:%=attack-%)
attack-%: program
	$(PYTHON) $(SCRIPTS)/$*.py $(PROGRAM) $(SAMPLE)

# With the Python package selected, the library's dependencies have the features that they have there, and all is compiled once.
program:
	$(CARGO) build --release --package firsthit-cli --package firsthit-python --bin firsthit

# Fuzzes every loader, one after the other; see docs/robustness.md.
fuzz:
	env -u CARGO_TARGET_DIR SECONDS_EACH=$(SECONDS_EACH) fuzz/run

.venv/ready: python/requirements-dev.txt
	$(PYTHON) -m venv .venv
	$(VENV)/pip install --quiet --requirement python/requirements-dev.txt
	touch $@

# What must hold besides: formatting, lints, documentation, dependencies (deny.toml). Warnings are errors.
check: .venv/ready check-format check-clippy check-ruff
	CARGO=$(CARGO) PYTHON=$(PYTHON) .ci/features none
	$(DOC)
	$(VENV)/mypy python/firsthit python/_firsthit_program python/examples
	$(PYTHON) packaging/pages.py --check
	$(PYTHON) -m doctest packaging/dependencies.py
	CARGO=$(CARGO) $(PYTHON) packaging/dependencies.py

# The parts of `check` that .pre-commit-config.yaml runs, too.
check-format:
	$(CARGO) fmt --all --check
	$(CARGO) fmt --manifest-path $(BENCHES) --check
check-clippy:
	$(CARGO) clippy --workspace --all-targets -- -D warnings
check-ruff: .venv/ready
	$(VENV)/ruff check
	$(VENV)/ruff format --check

# The bench is a workspace of its own, which nothing else compiles.
check-bench:
	$(CARGO) clippy --locked --all-targets --manifest-path $(BENCHES) -- -D warnings
	$(CARGO) test --quiet --locked --release --manifest-path $(BENCHES)

# Whether the interface of the library fits its version, by the last release: from the first tag on. It is asked of each crate, since what one
# re-exports of another is not looked at; and what is hidden from users is not.
LAST_TAG = $(shell git describe --tags --abbrev=0 --match 'v[0-9]*' 2> /dev/null)
check-semver:
	if [ -z "$(LAST_TAG)" ]; then echo "the interface's version: skipped: nothing is released"; \
	elif $(CARGO) semver-checks --version 2> /dev/null; then \
	    $(CARGO) semver-checks $(FLOORS:%=--package firsthit-%) --package firsthit --baseline-rev "$(LAST_TAG)"; \
	else echo "the interface's version: skipped: cargo install cargo-semver-checks"; fi

# Whether TAG is that of this version: a release is made by it.
VERSION := $(shell sed -n 's/^version = "\(.*\)"/\1/p' Cargo.toml)
check-tag:
	[ "$(TAG)" = "v$(VERSION)" ] || { echo "TAG must be v$(VERSION), the version in Cargo.toml, got $(TAG)"; exit 1; }

# Whether the library compiles with each feature alone; `check` does without any.
check-features:
	CARGO=$(CARGO) PYTHON=$(PYTHON) .ci/features

# Whether other targets compile: 32-bit x86 and 64-bit ARM.
check-targets:
	CARGO=$(CARGO) .ci/targets

# The viewer as a WebAssembly module: the one in git, which is compiled into the program and the package, anew.
wasm:
	CARGO=$(CARGO) .ci/wasm module

# Whether the module in git, and one that is compiled now, answer in Node as the sources do on this machine, to the byte.
test-wasm:
	CARGO=$(CARGO) .ci/wasm test

# The lanes of NEON on this machine, or on an emulator.
test-neon:
	CARGO=$(CARGO) .ci/neon

# The oldest compiler that Cargo.toml names. Where it cannot be had, a line says so, and clippy's incompatible_msrv refuses
# newer functions all the same (`make check`).
OLDEST := $(shell sed -n 's/^rust-version = "\(.*\)"/\1/p' Cargo.toml)
check-oldest:
	if rustup run $(OLDEST) cargo --version 2> /dev/null; then \
	    rustup run $(OLDEST) cargo check --workspace --locked --target-dir $(OUTSIDE); \
	else echo "Rust $(OLDEST): skipped: rustup toolchain install $(OLDEST)"; fi

# Miri interprets the tests of the only crate with unsafe code: the portable lanes, for it has no AVX of its own.
miri:
	if rustup run nightly cargo miri --version 2> /dev/null; then \
	    MIRIFLAGS=-Zmiri-disable-isolation rustup run nightly cargo miri test --package firsthit-simd --lib --target-dir $(OUTSIDE); \
	else echo "Miri: skipped: rustup toolchain install nightly --component miri,rust-src"; fi

clean:
	rm -rf target dist .venv .venv-bench .venv-bench-light .venv-dist .venv-docs render.png
