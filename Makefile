# Two commands do all the set-up: `make demo` runs kinform on the bundled seeker, `make test` runs all checks.
PYTHON ?= python3
VENV ?= .venv
BIN = $(VENV)/bin
DEMO = fixtures/seekers/seeker_2dof/seeker_2dof.toml
OUT ?= build

.PHONY: demo test lint lock fixtures docs clean
.DELETE_ON_ERROR:

demo: $(VENV)/.installed
	@mkdir -p $(OUT)
	@$(BIN)/kinform run --quiet $(DEMO) -o $(OUT)/seeker.h5
	@$(BIN)/kinform show $(OUT)/seeker.h5 joints
	@$(BIN)/kinform show $(OUT)/seeker.h5 mobility
	@$(BIN)/kinform show $(OUT)/seeker.h5 mass
	@$(BIN)/kinform show $(OUT)/seeker.h5 simulation

test: lint
	$(BIN)/python -m pytest -n 2

lint: $(VENV)/.developing
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy

$(VENV)/bin/python:
	$(PYTHON) -m venv $(VENV)

# The stamps are made last: an interrupted installation is done again.
$(VENV)/.installed: pyproject.toml | $(VENV)/bin/python
	$(BIN)/python -m pip install --quiet --editable .
	@touch $@

$(VENV)/.developing: pyproject.toml requirements-dev.lock | $(VENV)/bin/python
	$(BIN)/python -m pip install --quiet --requirement requirements-dev.lock
	$(BIN)/python -m pip install --quiet --no-deps --editable .
	@touch $@ $(VENV)/.installed

lock:
	$(BIN)/python -m pip install --quiet pip-tools
	$(BIN)/pip-compile --quiet --extra dev --strip-extras --no-emit-index-url --no-emit-trusted-host \
	  --no-emit-find-links --no-header --output-file requirements-dev.lock pyproject.toml

fixtures: $(VENV)/.developing
	$(BIN)/python fixtures/generate.py

docs: $(VENV)/.developing
	$(BIN)/python -m kinform.consistency > docs/rules.md
	$(BIN)/python docs/generate.py

clean:
	rm -rf $(VENV) $(OUT) dist .pytest_cache .mypy_cache .ruff_cache .hypothesis
