# What to type: `make help`. The environment is made once, in .venv.
VENV ?= .venv
BIN := $(VENV)/bin
UV ?= uv

# The Python that makes the environment: PYTHON if given (3.11 or later), else the newest for which PyBullet, the spatial
# engine, has wheels; else uv fetches one; else a later one, without that engine. All of it: docs/install.md.
SERVED = import sys, venv, ensurepip; sys.exit(not (3, 11) <= sys.version_info[:2] <= (3, 13))
USABLE = import sys, venv, ensurepip; sys.exit(sys.version_info[:2] < (3, 11))
FIND_PYTHON = \
  for python in $(or $(PYTHON),python3.13 python3.12 python3.11 python3 python); do \
    if "$$python" -c '$(SERVED)' >/dev/null 2>&1; then echo "$$python"; exit; fi; done; \
  if test -z "$(PYTHON)" && command -v "$(UV)" >/dev/null; then echo uv; exit; fi; \
  for python in $(or $(PYTHON),python3 python); do \
    if "$$python" -c '$(USABLE)' >/dev/null 2>&1; then echo "$$python"; exit; fi; done
define NO_PYTHON
cdprlab needs Python 3.11 to 3.13 with its venv module (a later one lacks PyBullet, the spatial engine). \
Get it by `python3 -m pip install uv` and `make run` again, or `conda env create -f environment.yml`, \
or `docker run --rm -v "$$PWD":/lab -w /lab python:3.13 make run` (podman alike), on Debian `apt install python3-venv`
endef

ifneq ($(and $(PYTHON),$(wildcard $(BIN)/python)),)
  ifneq ($(shell $(BIN)/python -V),$(shell $(PYTHON) -V 2>/dev/null))
    $(error $(VENV) holds $(shell $(BIN)/python -V), not PYTHON=$(PYTHON): `make clean` first, or take another folder, VENV=.venv-other)
  endif
endif

.DEFAULT_GOAL := help
.PHONY: help run test long mutants lab designer lessons student-zip grade docs book bench requirements clean
run test long mutants bench: export OMP_NUM_THREADS = 1

help:  ## this list
	@grep -hE '^[a-z-]+:.*##' Makefile | sed -E 's/^([a-z-]+):.*## */  make \1\t/' | expand -t 24

run: $(VENV)/.students  ## the CAROCA along its trajectory; table on the screen, pictures and log in out/caroca/
	@if $(BIN)/python -c 'import pybullet' >/dev/null 2>&1; then $(BIN)/python -m cdprlab run caroca; else \
	  echo "$$($(BIN)/python -V) has no spatial engine here (docs/install.md): a planar robot flies instead."; \
	  $(BIN)/python -m cdprlab run planar_rigid; fi

test: $(VENV)/.tests  ## style, types, tests and doctests
	$(BIN)/ruff check .
	@# Else who asks first is told that there is compiling to do, and tests that read what a program says hear it too.
	$(BIN)/python -m cdprlab.compiled
	@# Later Pythons get a later numpy, whose annotations differ: types are checked where the pins are the students'.
	if $(BIN)/python -c 'import sys; sys.exit(sys.version_info[:2] != (3, 11))'; then $(BIN)/mypy; \
	  else echo "types: checked on Python 3.11 only"; fi
	@$(BIN)/python -c 'import pybullet' >/dev/null 2>&1 || echo "no spatial engine here (docs/install.md): its tests are skipped"
	@# A file is one worker's, for what its tests share; the browser's, the longest, come first in the order of collection.
	$(BIN)/python -m pytest --numprocesses logical --dist loadfile --no-loadscope-reorder

long: $(VENV)/.tests  ## the tests that take more than a minute
	$(BIN)/python -m cdprlab.compiled
	$(BIN)/python -m pytest -m long --timeout 3600 --numprocesses logical --dist loadfile --no-loadscope-reorder

mutants: $(VENV)/.tests  ## for authors: mistakes planted by machine in every exercise, and what its check says
	$(BIN)/python tests/mutants.py

lab: $(VENV)/.students  ## JupyterLab with your own copies of the lessons, in my_lessons/
	$(BIN)/python -m cdprlab lessons my_lessons
	cd my_lessons && "$(abspath $(BIN))/jupyter" lab $(if $(filter 0,$(shell id -u)),--allow-root)

designer: $(VENV)/.students  ## the robot designer as a page in your browser; robots are saved in my_robots/
	mkdir -p my_robots && cp cdprlab/course/designer/page.ipynb my_robots/designer.ipynb
	$(BIN)/voila my_robots/designer.ipynb

lessons: $(VENV)/.tests  ## for instructors: the lessons without their solutions, from lessons/source/
	$(BIN)/python lessons/source/release.py

student-zip: lessons  ## for instructors: what students get, dist/cdprlab-students.zip
	$(BIN)/python lessons/source/student_zip.py

grade: $(VENV)/.students  ## for instructors: what students handed in, FOLDER=submissions OPTIONS="--roster names.csv"
	$(BIN)/python -m cdprlab grade "$(or $(FOLDER),submissions)" $(OPTIONS)

docs: $(VENV)/.students  ## figures and tables of the pages in docs/, made anew
	set -e; for page in docs/*.md; do script="$${page%.md}.py"; if test -f "$$script"; then $(BIN)/python "$$script"; fi; done

book: $(VENV)/.tests  ## executed lessons, pages and the public face as a web site, in build/book/
	$(BIN)/python docs/book/build.py

bench: $(VENV)/.tests  ## speed, as ratios to what it stands on
	$(BIN)/python -m pytest tests/benchmarks --benchmark-enable

requirements:  ## pin again what is installed (needs uv)
	$(UV) pip compile --universal --python-version 3.11 --upgrade --no-annotate --quiet --no-emit-index-url --no-emit-package pip \
	  --custom-compile-command "make requirements" --extra lab --extra designer --extra solvers pyproject.toml --output-file requirements.txt
	$(UV) pip compile --universal --python-version 3.11 --upgrade --no-annotate --quiet --no-emit-index-url --no-emit-package pip \
	  --custom-compile-command "make requirements" --constraint requirements.txt --group tests \
	  --output-file tests/requirements.txt
	echo "-e ." >> requirements.txt

clean:  ## remove the environment and what was built; out/ stays
	rm -rf $(VENV) build dist .pytest_cache .ruff_cache .mypy_cache .hypothesis .benchmarks

$(VENV)/.students: requirements.txt pyproject.toml
	$(if $(wildcard $(BIN)/pip),,$(eval FOUND := $(shell $(FIND_PYTHON)))$(if $(FOUND),,$(error $(NO_PYTHON))))
	@echo "Making the Python environment in $(VENV), once; this takes a minute or two."
	@test -x $(BIN)/pip || $(if $(filter uv,$(FOUND)),"$(UV)" venv --quiet --clear --python 3.13 --seed,"$(FOUND)" -m venv --clear) $(VENV)
	@$(BIN)/python -m pip install --quiet --disable-pip-version-check -r requirements.txt
	@$(BIN)/python -m cdprlab.compiled
	@touch $@

$(VENV)/.tests: $(VENV)/.students tests/requirements.txt
	@$(BIN)/python -m pip install --quiet --disable-pip-version-check -r tests/requirements.txt
	@touch $@
