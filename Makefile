# The table of contents for developers.  Every target does its own set-up on a bare Debian machine.
PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin
SETUP := $(VENV)/.setup-stamp
CORE := $(wildcard core/*.py core/host/*.[ch] core/shared/*.[ch])

.PHONY: setup run test check core

setup: $(SETUP)

$(SETUP): pyproject.toml setup.py constraints.txt packages.txt $(CORE)
	tools/apt-install packages.txt
	test -d $(VENV)/bin || $(PYTHON) -m venv $(VENV)
	$(BIN)/pip install --quiet --disable-pip-version-check -c constraints.txt -e . --group test --group lint --group docs
	touch $@

core: $(CORE)  ## rebuild the C core in place
	flock .core.lock $(BIN)/python setup.py -q build_ext --inplace
