# `make report` and `make test` set up everything they need in .venv.
PYTHON ?= python3
VENV   := .venv
BIN    := $(VENV)/bin
SCENE  ?= two-link-reach
STEP   := $(PYTHON) .ci/step.py
# Bytecode is written of what is imported, once, in place of all that pip would compile: half a minute less.
PIP    := $(BIN)/python -m pip install --disable-pip-version-check --no-compile --constraint constraints.txt --editable
WARM   := env PYTHONDONTWRITEBYTECODE= $(BIN)/python .ci/first_import.py

.PHONY: report test bench campaign check check-types check-types-user check-house docs architecture dist clean

$(VENV)/python:
	@$(PYTHON) -c "import sys; sys.exit(sys.version_info < (3, 11) and 'Pliant needs Python >= 3.11; set PYTHON=')"
	@echo "Setting up $(VENV): one to three minutes, once. What pip says is in build/set-up-*.log" >&2
	@$(STEP) "Python environment" build/set-up-venv.log $(PYTHON) -m venv $(VENV)
	@$(STEP) "pip and setuptools" build/set-up-pip.log $(BIN)/python -m pip install --upgrade pip "setuptools>=77"
	@touch $@

$(VENV)/ready: pyproject.toml setup.py constraints.txt | $(VENV)/python
	@$(STEP) "Pliant, NumPy, CasADi and the tools" build/set-up.log $(PIP) ".[dev]"
	@$(STEP) "First import" build/set-up-import.log $(WARM)
	@touch $@

# The tests of learning need PyTorch; constraints.txt pins it, so that it comes without gigabytes of CUDA.
$(VENV)/ready-to-learn: pyproject.toml setup.py constraints.txt | $(VENV)/python
	@$(STEP) "Pliant, NumPy, CasADi, PyTorch and the tools" build/set-up-rl.log $(PIP) ".[dev,rl]"
	@$(STEP) "First import" build/set-up-import.log $(WARM)
	@touch $(VENV)/ready $@

report: $(VENV)/ready
	@$(BIN)/pliant report $(SCENE) --out reports/$(SCENE)

test: $(VENV)/ready-to-learn
	PYTHONDONTWRITEBYTECODE= OMP_NUM_THREADS=1 $(BIN)/python -m pytest -n auto --maxprocesses 4 --dist worksteal

$(VENV)/bench: $(VENV)/ready
	@$(STEP) "The peers of the benchmarks" build/set-up-bench.log $(PIP) ".[bench]" \
	  || echo "the peers do not all install here: their rows will say so" >&2
	@touch $@

bench: $(VENV)/bench
	$(BIN)/python benchmarks/run.py $(BENCH)

# Long hunts for faults that no test has time for, each a script that exits non-zero when it finds one.
campaign: $(VENV)/ready-to-learn
	OMP_NUM_THREADS=1 $(BIN)/python -m pytest -n auto --maxprocesses 4 --dist worksteal -m campaign
	@set -e; for script in $$(grep -l __main__ tests/campaigns/*.py); do echo "$$script" >&2; $(BIN)/python $$script; done

check: $(VENV)/ready-to-learn
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	@$(MAKE) --no-print-directory check-types check-house

check-types: $(VENV)/ready-to-learn
	@rm -rf build/check build/lib
	@$(STEP) "A copy for the type checker" build/check.log $(BIN)/python -m pip install --no-deps --target build/check .
	MYPYPATH=build/check $(BIN)/python -m mypy -p pliant.plants -p pliant.envs -p pliant.controllers -p pliant.studies

# What a user's checkers say of the README's lines, with the wheel and with the editable install.
$(VENV)/types: $(VENV)/ready
	@$(STEP) "A second type checker" build/set-up-types.log $(PIP) ".[dev,types]" \
	  || echo "basedpyright does not install here: mypy alone checks" >&2
	@touch $@

check-types-user: $(VENV)/types
	$(BIN)/python .ci/typed_readme.py

check-house: $(VENV)/ready
	$(BIN)/python docs/house/check.py

architecture: $(VENV)/ready
	$(BIN)/python docs/house/drawing.py

$(VENV)/docs: $(VENV)/ready
	@$(STEP) "MkDocs and its plugins" build/set-up-docs.log $(PIP) ".[dev,docs]"
	@touch $@

docs: $(VENV)/docs
	$(BIN)/python docs/house/validation.py
	OMP_NUM_THREADS=1 $(BIN)/python -m pytest -m docs tests/test_examples.py tests/test_docstrings.py
	NO_MKDOCS_2_WARNING=1 $(BIN)/python -m mkdocs build --strict --quiet --site-dir build/site
	$(BIN)/python docs/house/browser.py build/site
	@echo "build/site/index.html" >&2

# The archive and the wheel, checked and tried in an empty environment. DIST=--contents needs no network.
$(VENV)/dist: $(VENV)/ready
	@$(STEP) "twine" build/set-up-dist.log $(PIP) ".[dev,dist]" \
	  || echo "twine does not install here: its check is left out" >&2
	@touch $@

dist: $(VENV)/dist
	$(BIN)/python .ci/dist.py $(DIST)

clean:
	rm -rf $(VENV) .editable build dist reports
