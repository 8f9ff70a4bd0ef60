# The table of contents for developers: every target does its own set-up on a bare Debian machine.
#
#   make run     set up, then prove a sample job on a sample machine: verdict, and where the report lies
#   make serve   set up, then serve a sample machine (its twin) on this computer: http://127.0.0.1:8765
#   make test    set up (Debian packages included) and run every test
#   make check   format, lint, types, layers, C warnings, sanitisers, tests, docs: what CI runs
#   make bench   measure, as ratios against a reference in the same call      make soak    long seeded campaigns
#   make golden  rewrite the golden files for review in the diff              make oracle  compare with rs274
#   make docs    the documentation, into docs/_build                          make clean   remove what was built
#   make images  compile the boards' images anew, for `trochia flash` (needs gcc-avr and avr-libc)

PYTHON ?= python3
VENV   := .venv
BIN    := $(VENV)/bin
CORE   := $(wildcard core/*.py core/host/*.[ch] core/shared/*.[ch])
C_CODE := $(wildcard core/host/*.[ch] core/shared/*.[ch] firmware/*/*.[ch] tests/firmware/images/*.c)
C_FLAGS := -std=c11 -O2 -DTROCHIA_SCHEMA=0u -Wall -Wextra -Wconversion -Wswitch-enum -Werror -ffp-contract=off
JOBS   ?= 2
SOAK   ?= 1000000
PLANS  ?= 100000
FAULTS ?= 100000
STEPS  ?= 100000000
SOAK_SEED ?= 1

.DEFAULT_GOAL := help
.PHONY: help setup setup-test run serve test check format lint types layers c-format c-warnings sanitise docs bench soak golden oracle clean

help:
	@sed -n '1,/^$$/s/^# \{0,1\}//p' Makefile

setup: $(VENV)/.setup

$(VENV)/.setup: pyproject.toml setup.py constraints.txt packages.txt $(CORE)
	tools/apt-install packages.txt
	test -x $(BIN)/python || $(PYTHON) -m venv $(VENV)
	$(BIN)/python -m pip install -q --disable-pip-version-check -c constraints.txt pip setuptools wheel
	$(BIN)/python -m pip install -q --disable-pip-version-check -c constraints.txt -e .
	touch $@

setup-test: $(VENV)/.setup-test

$(VENV)/.setup-test: $(VENV)/.setup packages-test.txt
	tools/apt-install packages-test.txt
	$(BIN)/python -m pip install -q --disable-pip-version-check -c constraints.txt --group test --group lint --group docs
	touch $@

core: $(CORE)
	flock .core.lock $(BIN)/python setup.py -q build_ext --inplace
.PHONY: core

images:
	$(MAKE) -s -C firmware/avr images
.PHONY: images

run: setup
	$(BIN)/trochia simulate programs/contour.ngc -m xy-table -o out/contour

serve: setup
	$(BIN)/trochia serve -m xy-table --journal out/journal --recordings out/recordings

test: setup-test
	$(BIN)/python -m pytest -q -n $(JOBS) --dist worksteal

check: setup-test format lint types layers c-format c-warnings sanitise docs test

format: setup-test
	$(BIN)/ruff format --check .

lint: setup-test
	$(BIN)/ruff check .

types: setup-test
	$(BIN)/basedpyright

layers: setup-test
	$(BIN)/lint-imports --no-cache

c-warnings: setup-test
	for unit in core/host/*.c; do gcc $(C_FLAGS) -Icore -fsyntax-only $$unit || exit 1; done

c-format: setup-test
	$(BIN)/clang-format --dry-run --Werror $(C_CODE)

# the core's own tests once more, on a build that aborts at undefined behaviour or a bad address
sanitise: setup-test
	tools/sanitise

docs: setup-test
	$(BIN)/python -m sphinx -q -W --keep-going -b html docs docs/_build/html

bench: setup-test
	for bench in benchmarks/bench_*.py; do $(BIN)/python $$bench || exit 1; done

golden: setup-test
	$(BIN)/python tests/golden/rewrite.py

# every law and every comparison, on a hundred times as many cases, with a seed that is printed; then SOAK mutated
# G-code programs and PLANS random programs to plan, from SOAK_SEED on, and some of them against rs274; FAULTS faults on
# the line to a board, and some on its image; what is said of lost steps against the twin; STEPS steps of the image
# counted at its pins
soak: setup-test
	$(BIN)/python -m pytest -q --hypothesis-profile=soak tests/properties tests/oracle
	$(BIN)/python tests/soak/identify_axes.py --count 10 --seed 2026
	$(BIN)/python tests/soak/fuzz_gcode.py --count $(SOAK) --seed $(SOAK_SEED) --jobs $(JOBS)
	$(BIN)/python tests/soak/plans.py --count $(PLANS) --seed $(SOAK_SEED)
	$(BIN)/python tests/soak/holds.py --count 10000 --seed $(SOAK_SEED)
	$(BIN)/python tests/soak/kills.py --count 200 --seed $(SOAK_SEED)
	$(BIN)/python tests/soak/faults.py --count $(FAULTS) --seed $(SOAK_SEED) --jobs $(JOBS)
	$(BIN)/python tests/soak/faults.py --count 2000 --seed $(SOAK_SEED) --jobs $(JOBS) --image
	$(BIN)/python tests/soak/lost_steps.py --count 1000 --seed $(SOAK_SEED) --jobs $(JOBS)
	$(BIN)/python tests/soak/dead_hosts.py --count 200 --seed $(SOAK_SEED)
	$(BIN)/python tests/soak/steps_on_chip.py --steps $(STEPS) --seed $(SOAK_SEED) --jobs $(JOBS)
	$(BIN)/python tests/soak/compare_gcode.py --count 10000 --seed $(SOAK_SEED) --jobs $(JOBS)

oracle: setup-test
	$(BIN)/python -m pytest -q tests/oracle

clean:
	rm -rf build dist out docs/_build .pytest_cache .ruff_cache .hypothesis src/*.egg-info src/trochia/_core*
	rm -rf $(VENV)
