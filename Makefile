# Two commands do all the set-up: `make demo` runs kinform on the bundled seeker, `make test` runs all checks but for
# the few tests that take minutes, which `make test-slow` runs, and the full products of scale, pose, order and
# tessellation, which `make test-sweep` runs every night. `make test-least` uses the oldest packages allowed.
# Tests that need other programs (GHDL, rumoca, MuJoCo, Drake, …) skip unless `make validators` has installed them.
PYTHON ?= python3
VENV ?= .venv
BIN = $(VENV)/bin
LEAST ?= $(VENV)-least
# What these need besides is not needed here: GHDL is a program, and yourdfpy's trimesh is ours.
ALONE = eitri-hdl==0.1.0 yourdfpy==0.0.60
DEMO = fixtures/seekers/seeker_2dof/seeker_2dof.toml
OUT ?= build
WORKERS ?= 2

.PHONY: demo test test-slow test-sweep test-least fuzz lint ruff validators lock fixtures docs clean
.DELETE_ON_ERROR:

demo: $(VENV)/.installed
	@mkdir -p $(OUT)
	@$(BIN)/kinform run --quiet $(DEMO) -o $(OUT)/seeker.h5
	@$(BIN)/kinform show $(OUT)/seeker.h5 joints
	@$(BIN)/kinform report --quiet $(OUT)/seeker.h5 -o $(OUT)/seeker.html
	@echo
	@echo "the page with all of it, to be opened in a browser: $(OUT)/seeker.html"

# mypy checks while tests run: it takes a minute of one processor where it has no cache, and a second where it has.
test: ruff
	@$(BIN)/mypy > $(VENV)/mypy.log 2>&1 & types=$$!; \
	$(BIN)/python -m pytest -n $(WORKERS) --dist worksteal; tests=$$?; \
	wait $$types; types=$$?; cat $(VENV)/mypy.log; [ $$tests = 0 ] && [ $$types = 0 ]

test-slow: $(VENV)/.developing
	$(BIN)/python -m pytest -n $(WORKERS) --dist worksteal -m slow

test-sweep: $(VENV)/.developing
	$(BIN)/python -m pytest -n $(WORKERS) --dist worksteal -m sweep

# The suite with the oldest version of each package that pyproject.toml allows, in an environment of its own.
test-least: $(LEAST)/.installed
	$(LEAST)/bin/python -m pytest -n $(WORKERS) --dist worksteal

$(LEAST)/.installed: pyproject.toml
	$(PYTHON) -m venv $(LEAST)
	$(LEAST)/bin/python -m pip install --quiet uv
	$(LEAST)/bin/uv pip install --quiet --python $(LEAST)/bin/python --resolution lowest-direct \
	  --editable '.[dev,step,xacro,batch]'
	@touch $@

# Mutated files for every format that is read, ten minutes in all: see fuzz/README.md.
fuzz: $(VENV)/.developing
	OPENBLAS_NUM_THREADS=1 $(BIN)/python fuzz/run.py $(TARGETS) --folder $(OUT)/fuzz

lint: ruff
	$(BIN)/mypy

ruff: $(VENV)/.developing
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .

$(VENV)/bin/python:
	$(PYTHON) -m venv $(VENV)

# The stamps are made last: an interrupted installation is done again.
$(VENV)/.installed: pyproject.toml | $(VENV)/bin/python
	$(BIN)/python -m pip install --quiet --editable .
	@touch $@

$(VENV)/.developing: pyproject.toml requirements-dev.lock | $(VENV)/bin/python
	$(BIN)/python -m pip install --quiet --no-deps --requirement requirements-dev.lock --editable .
	@touch $@ $(VENV)/.installed

validators: $(VENV)/.validators

$(VENV)/.validators: validators/requirements.lock validators/package-lock.json Makefile | $(VENV)/.developing
	$(BIN)/python -m pip install --quiet --no-deps --requirement validators/requirements.lock $(ALONE)
	@mkdir -p $(VENV)/npm
	@cp validators/package.json validators/package-lock.json $(VENV)/npm
	@if command -v npm > /dev/null; then npm ci --prefix $(VENV)/npm --ignore-scripts --no-audit --no-fund --silent; \
	else echo "npm is not installed: glTF, SARIF and the accessibility of the page are not validated"; fi
	@touch $@

COMPILE = $(BIN)/pip-compile --quiet --strip-extras --no-emit-index-url --no-emit-trusted-host --no-emit-find-links --no-header
lock:
	$(BIN)/python -m pip install --quiet pip-tools
	$(COMPILE) --extra dev --extra batch --output-file requirements-dev.lock pyproject.toml
	$(COMPILE) --constraint requirements-dev.lock --output-file validators/requirements.lock validators/requirements.in
	cd validators && npm install --package-lock-only --omit-lockfile-registry-resolved --no-audit --no-fund --silent

fixtures: $(VENV)/.developing
	$(BIN)/python fixtures/generate.py

docs: $(VENV)/.developing
	$(BIN)/python -m kinform.consistency > docs/rules.md
	$(BIN)/python docs/generate.py

clean:
	rm -rf $(VENV) $(LEAST) $(OUT) dist .pytest_cache .mypy_cache .ruff_cache .hypothesis
