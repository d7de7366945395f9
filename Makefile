# Every target sets up what it needs: on a fresh machine a Rust toolchain and make are enough.
.PHONY: help run web web-serve web-test test check bench experiments corpus soak licenses

help:
	@echo "make run          the window on example 1; without a display example 1 converted, with its pictures"
	@echo "make web          the window for the browser, in out/web: pages for a server, and one that needs none"
	@echo "make web-serve    the same, served on this machine"
	@echo "make web-test     the same, tested in Chromium"
	@echo "make test         all tests"
	@echo "make check        formatting, clippy and rustdoc; warnings are errors"
	@echo "make bench        timings"
	@echo "make experiments  the tables of docs/experiments.md (some minutes)"
	@echo "make corpus       the table of docs/corpus.md: meshes from public packages, converted (some minutes)"
	@echo "make soak         the long property runs"
	@echo "make licenses     licences and duplicates of the dependencies"

run:
	@tools/setup build run
	cargo build --locked --release
	@tools/run

web:
	@tools/setup web
	@tools/make-web

web-serve: web
	@tools/setup serve
	@echo "http://127.0.0.1:8080 (end with Ctrl+C)"
	@python3 -m http.server 8080 --bind 127.0.0.1 --directory out/web

web-test: web
	@tools/setup browser
	QUADFRONT_NEEDS_BROWSER=1 cargo test --locked --no-default-features --features cli --test web

# One build serves the tests, the examples and the end-to-end test; the library alone is compiled once more for its
# bytes. The window is tested in a browser too.
test: web
	@tools/setup build run test browser
	@mkdir -p out
	QUADFRONT_NEEDS_ADAPTER=1 QUADFRONT_NEEDS_READERS=1 QUADFRONT_NEEDS_BROWSER=1 \
		XDG_RUNTIME_DIR=$$(tools/runtime-dir) cargo test --locked --features uitest
	@for example in convert_case convert_stl step_events worst_quadrilateral figure; do \
		cargo run --locked --quiet --features uitest --example $$example > out/$$example.txt || exit 1; \
	done
	tools/end-to-end target/debug/quadfront
	cargo test --locked --no-default-features --test same_bytes
	cargo test --locked --manifest-path tools/web/Cargo.toml --target-dir target/web/tool

check:
	@tools/setup build check
	cargo fmt --check
	cargo clippy --locked --features uitest --all-targets -- -D warnings
	cargo clippy --locked --no-default-features --features cli --all-targets -- -D warnings
	cargo clippy --locked --no-default-features --all-targets -- -D warnings
	RUSTDOCFLAGS="-D warnings" cargo doc --locked --no-deps --features uitest
	cargo fmt --check --manifest-path tools/web/Cargo.toml
	cargo clippy --locked --manifest-path tools/web/Cargo.toml --target-dir target/web/tool --all-targets -- -D warnings

bench:
	@tools/setup build
	cargo bench --locked --no-default-features --bench background --bench conversion --bench history --bench loading

experiments:
	@tools/setup build
	@mkdir -p out
	cargo bench --locked --no-default-features --bench experiments > out/experiments.md
	@echo "tables: out/experiments.md"

corpus:
	@tools/setup build corpus
	cargo build --locked --release
	tools/corpus
	@echo "table: out/corpus.md"

# Properties run this many rounds here, and a few hundred in `make test`; loaders meet mutated files for an hour.
soak: export QUADFRONT_SOAK_ROUNDS = 10000
soak: export QUADFRONT_SOAK_SECONDS ?= 3600
soak:
	@tools/setup build
	cargo test --locked --release --no-default-features --features cli -- --include-ignored

licenses:
	@tools/setup build licenses
	PATH="$(CURDIR)/target/tools/bin:$$PATH" cargo deny --all-features check licenses bans sources
	PATH="$(CURDIR)/target/tools/bin:$$PATH" cargo deny --manifest-path tools/web/Cargo.toml --config deny.toml \
		check licenses bans sources
