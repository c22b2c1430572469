# The commands of this house. Everything is built in target/ and .venv/, nothing outside the clone.

CARGO ?= cargo

.PHONY: render test check bench clean

# Builds the program, renders the embedded example scene and says where the picture is.
render:
	$(CARGO) run --release --package firsthit-cli --bin firsthit -- demo --output render.png

# All there is to test.
test:
	$(CARGO) test --workspace

# What must hold besides: formatting, lints, documentation. Warnings are errors.
check:
	$(CARGO) fmt --all --check
	$(CARGO) clippy --workspace --all-targets -- -D warnings
	RUSTDOCFLAGS="-D warnings" $(CARGO) doc --workspace --no-deps

clean:
	rm -rf target .venv render.png
