# The whole developer interface. Needs Python 3.11 or newer and nothing else.
PYTHON ?= python3
BIN := .venv/bin
PYTEST := $(BIN)/pytest --numprocesses auto --dist worksteal
# each of the tests' many processes would compile all modules anew
export PYTHONDONTWRITEBYTECODE :=

.DEFAULT_GOAL := help
.PHONY: help demo test test-all campaign mutants records notebook docs derive bench lint types check clean

help:  ## list the targets
	@grep -hE '^[a-z-]+:.*##' $(MAKEFILE_LIST) | sed -E 's/:.*## /\t/' | expand -t 12

demo: .venv/base  ## set up and run the demonstration: derive, verify, generate, integrate
	$(BIN)/holonomic demo

test: .venv/ready  ## set up and run the tests, but for the long ones (five minutes on two cores)
	$(PYTEST)

test-all: .venv/ready  ## run all tests of the day (15 minutes on two cores)
	$(PYTEST) --long

campaign: .venv/ready  ## run thousands of random cases, and cases that test-all leaves out that day
	$(PYTEST) --long -o faulthandler_timeout=3600 -m campaign

mutants: .venv/ready  ## plant 200 mistakes one by one, and list those that no test notices (an hour)
	$(BIN)/python tests/mutants.py

records: .venv/ready  ## write recorded outputs anew, in tests/records; read their differences
	$(BIN)/pytest --record -k as_recorded

notebook: .venv/notebook  ## open the notebooks in JupyterLab
	$(BIN)/jupyter-lab notebooks

docs: .venv/docs  ## build the documentation site, into out/docs
	$(BIN)/sphinx-build --quiet --fail-on-warning --keep-going --conf-dir notebooks/docs \
		--doctree-dir out/docs-cache/doctrees . out/docs
	@echo out/docs/index.html

derive: .venv/base  ## write the generated modules and the tables of READMEs anew
	$(BIN)/holonomic derive

bench: .venv/bench  ## time compiled loops beside other programs (fifteen minutes), or some PARTS
	PYTHONPATH=notebooks $(BIN)/python -m benchmarks $(PARTS)

lint: .venv/ready  ## style and common mistakes
	$(BIN)/ruff check
	$(BIN)/ruff format --check

types: .venv/ready  ## strict type check of the three packages
	$(BIN)/mypy

check: lint types test-all docs  ## everything that decides whether a change lands
	$(BIN)/holonomic derive --check
	$(BIN)/holonomic verify > /dev/null

clean:  ## remove the environment and what the tools left behind
	rm -rf .venv out build dist .mypy_cache .pytest_cache .ruff_cache

# The environment, in five sizes. Versions are those that are known to work together.
# pip splits PIP_CONSTRAINT at blanks, which a path from the root may have
PIP := PIP_CONSTRAINT=.ci/constraints.txt $(BIN)/python -m pip install \
	--quiet --disable-pip-version-check --editable

.venv/base: pyproject.toml .ci/constraints.txt
	@echo "setting up .venv, which takes most of a minute"
	$(PYTHON) -m venv .venv
	$(PIP) .
	@touch $@

.venv/ready: .venv/base
	$(PIP) '.[test]'
	@touch $@

.venv/notebook: .venv/base
	$(PIP) '.[jupyter]'
	@touch $@

.venv/docs: .venv/ready
	$(PIP) '.[test,docs]'
	@touch $@

.venv/bench: .venv/ready
	$(PIP) '.[test,bench]'
	@touch $@
