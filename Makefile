# `make report` and `make test` set up everything they need in .venv.
PYTHON ?= python3
VENV   := .venv
BIN    := $(VENV)/bin
SCENE  ?= two-link-reach

.PHONY: report test bench check clean

$(VENV)/ready: pyproject.toml constraints.txt Makefile
	$(PYTHON) -c "import sys; sys.exit(sys.version_info < (3, 11) and 'Pliant needs Python >= 3.11; set PYTHON=')"
	$(PYTHON) -m venv $(VENV)
	$(BIN)/python -m pip install --quiet --upgrade pip setuptools
	$(BIN)/python -m pip install --quiet --constraint constraints.txt --editable ".[dev]"
	touch $@

# The tests of learning need PyTorch; constraints.txt pins it, so that it comes without gigabytes of CUDA.
$(VENV)/ready-to-learn: $(VENV)/ready
	$(BIN)/python -m pip install --quiet --constraint constraints.txt --editable ".[dev,rl]"
	touch $@

report: $(VENV)/ready
	$(BIN)/pliant report $(SCENE) --out reports/$(SCENE)

test: $(VENV)/ready-to-learn
	OMP_NUM_THREADS=1 $(BIN)/python -m pytest -n auto --maxprocesses 4

$(VENV)/bench: $(VENV)/ready
	$(BIN)/python -m pip install --quiet --constraint constraints.txt --editable ".[bench]" \
	  || echo "the peers do not all install here: their rows will say so" >&2
	touch $@

bench: $(VENV)/bench
	$(BIN)/python benchmarks/run.py $(BENCH)

check: $(VENV)/ready-to-learn
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	rm -rf build/check && $(BIN)/python -m pip install --quiet --no-deps --target build/check .
	MYPYPATH=build/check $(BIN)/python -m mypy -p pliant.plants -p pliant.envs -p pliant.controllers -p pliant.studies

clean:
	rm -rf $(VENV) build dist reports
