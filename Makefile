# Two commands: `make rig` simulates the paper's rig, `make test` tests everything.
# Both need git, make, Python >= 3.11 and a C compiler; the rest goes into .venv.

PYTHON ?= python3
# Small matrices: threads of the linear algebra only wait for each other.
export OPENBLAS_NUM_THREADS ?= 1
BIN := .venv/bin

.PHONY: rig paper test arithmetic torture lint regenerate docs site clean

rig: .venv/rig
	$(BIN)/ltcgear generate rig-2mw
	@$(MAKE) --no-print-directory paper

# The paper reproduced on one page, out/paper.html: printed, predicted and fitted.
paper: .venv/rig
	$(BIN)/ltcgear paper -o out

test: .venv/test
	$(BIN)/python -m pytest -q --numprocesses auto --dist loadfile

# Sensitive tests under other instructions and libraries' variants; writes the table of docs/arithmetic.md.
arithmetic: .venv/test
	$(BIN)/python -m benchmarks.arithmetic

# Thousands of seeded attacks; writes the table of docs/torture.md where none finds anything.
torture: .venv/test
	$(BIN)/python -m tests.torture

lint: .venv/test
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy
	PYTHONPATH=.links $(BIN)/lint-imports

# Rewrite the committed C after a change of the equations; the tests compare it byte for byte.
regenerate: .venv/rig
	$(BIN)/python -m tests.regenerate

# Rewrite the pages that follow from the code; the tests compare them byte for byte too.
docs: .venv/rig
	$(BIN)/python -m tests.regenerate --docs

# The pages, the gallery and what Python offers as a web site, docs/_build/html; any warning is an error.
site: .venv/docs
	rm -rf docs/examples
	LTCGEAR_CACHE=$${LTCGEAR_CACHE:-$(CURDIR)/docs/_build/store} $(BIN)/sphinx-build -W --keep-going --write-all --quiet docs docs/_build/html

.venv/bin/python:
	$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11) and "ltcgear needs Python 3.11 or newer; run make PYTHON=python3.x")'
	$(PYTHON) -m venv .venv

.venv/rig: .venv/bin/python pyproject.toml hatch_build.py
	$(BIN)/pip install --quiet --disable-pip-version-check --editable '.[report,sweep]'
	@touch $@

.venv/test: .venv/bin/python pyproject.toml hatch_build.py
	$(BIN)/pip install --quiet --disable-pip-version-check --editable '.[test,report,sweep]'
	@touch $@ .venv/rig

.venv/docs: .venv/bin/python pyproject.toml hatch_build.py
	$(BIN)/pip install --quiet --disable-pip-version-check --editable '.[docs,sweep]'
	@touch $@ .venv/rig

clean:
	rm -rf .venv .links out dist docs/_build docs/examples
