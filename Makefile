# Everything runs in .venv, which the first target makes. `make help` lists the targets.
# Where the folder lies never matters: make's own functions split paths at spaces, so recipes keep to
# relative paths, and leave it to the shell to say, in quotes, where they are.
#   make book PYTHON=python3.12    another interpreter
#   make test JOBS=4               more worker processes

PYTHON ?= python3
VENV   ?= .venv
JOBS   ?= 2

# On Linux PyPI's PyTorch is the CUDA build, some 5 GB more: TORCH=cuda takes it.
TORCH  ?= cpu

BIN    := $(VENV)/bin
READY  := $(VENV)/.ready
TESTED := $(VENV)/.tested
PIP     = $(BIN)/python -m pip install --disable-pip-version-check
LIMITS := "torch>=2.5,<2.14"
ifeq ($(shell uname -s) $(TORCH),Linux cpu)
CPU_BUILD := --index-url https://download.pytorch.org/whl/cpu --retries 1 --timeout 15
endif
STRIP  := $(BIN)/python -m nbstripout --keep-id --extra-keys "metadata.language_info.version \
	metadata.language_info.codemirror_mode metadata.language_info.file_extension \
	metadata.language_info.mimetype metadata.language_info.nbconvert_exporter \
	metadata.language_info.pygments_lexer"
NOTEBOOKS = book/*.ipynb book/evidence/*.ipynb
# Small matrices: a second thread would only wait, and so would the other process.
PYTEST := OMP_NUM_THREADS=1 $(BIN)/python -m pytest
# The end of a long run lists the tests that took longest.
SLOWEST := --durations=30 --durations-min=5
# Python that finds the workshop, wherever it goes from here.
WORKSHOP := PYTHONPATH="$$PWD/book$${PYTHONPATH:+:$$PYTHONPATH}" $(BIN)/python

# Matrices of some megabytes come and go by the thousand. glibc gives their memory back to the
# system each time, unless told to keep it: a fifth of the time of Levenberg-Marquardt went there.
export MALLOC_MMAP_THRESHOLD_ = 33554432
export MALLOC_TRIM_THRESHOLD_ = 268435456

comma := ,

.DELETE_ON_ERROR:
.NOTPARALLEL:
.DEFAULT_GOAL := help
.PHONY: help env lock book page test unmeasured lint stripped unit notebooks foreign foreign-ci pages lab live colab firefox pdf epub release assignment collect gains reproduce bench check mutants strip clean

help:  ## this list
	@awk -F ':.*## ' '/^[a-z]+:.*## / {printf "  make %-10s %s\n", $$1, $$2}' Makefile

env: $(READY)  ## the Python environment alone, in .venv

$(READY): requirements.txt pyproject.toml
	@$(PYTHON) -c 'import sys; v = sys.version_info; sys.exit(None if v >= (3, 11) else \
	  f"Python 3.11 or newer is needed, this is {v[0]}.{v[1]}; try: make PYTHON=python3.12")'
	$(PYTHON) -m venv $(VENV)
	@echo "==> 1 of 3: what the book needs, into $(VENV)"
	$(PIP) --require-hashes -r requirements.txt
	@echo "==> 2 of 3: PyTorch$(if $(CPU_BUILD),$(comma) the CPU build (make TORCH=cuda takes the other))"
	$(PIP) $(CPU_BUILD) $(LIMITS) || $(PIP) $(LIMITS)
	@echo "==> 3 of 3: ddlib, from this folder"
	$(PIP) --no-deps -e .
	@touch $@

$(TESTED): $(READY) requirements-test.txt
	@echo "==> What only the tests need, into $(VENV)"
	$(PIP) --require-hashes -r requirements-test.txt
	@touch $@

LOCK = $(BIN)/uv pip compile --quiet --upgrade --universal --python-version 3.11 --generate-hashes \
	--custom-compile-command "make lock"
lock: $(READY)  ## requirements.txt and requirements-test.txt anew, from pyproject.toml
	$(PIP) --quiet uv==0.13.9
	$(LOCK) --group book -o requirements.txt
	$(LOCK) --group test -o requirements-test.txt

book: $(READY)  ## execute the notebooks and build the pages
	@$(BIN)/python book/_ext/build.py

page: $(READY)  ## one page alone: LESSON=feedback, LESSON=evidence/feedback
	@$(BIN)/python book/_ext/build.py --lesson "$(LESSON)"

# What the tests of this machine have measured for claims, the book's pages need not measure anew.
test: export DDLIB_MEASURED = $(CURDIR)/_build/measured
test: unmeasured lint stripped unit foreign-ci pages  ## everything that CI checks

# What is quick, of the package, of the house and of what pages say.
CORE  = $(wildcard tests/test_*.py) $(addprefix tests/,dynamics effects control simulation \
	identification learning analysis figures widgets)
FACTS = $(addprefix tests/book/test_,prose.py notebooks.py lessons.py)
FRESH = $(addprefix tests/report/test_,code_hash.py results.py judging.py claims.py cards.py \
	refutations.py)

check: lint stripped  ## for every day: style, core tests, house rules, facts, fresh results; sizes
	@echo "==> Core tests, house rules, facts, fresh results"
	$(PYTEST) -n $(JOBS) --dist worksteal -m "not slow and not built and not browser" \
	  $(CORE) tests/house $(FACTS) $(FRESH)
	@$(BIN)/python tests/support/sizes.py

unmeasured:
	@rm -rf _build/measured

lint: $(TESTED)
	@echo "==> Style"
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	@echo "==> Workflows, Dependabot, citation"
	$(BIN)/zizmor --offline --quiet .github
	$(BIN)/check-jsonschema --builtin-schema vendor.github-workflows .github/workflows/*.yml
	$(BIN)/check-jsonschema --builtin-schema vendor.github-issue-forms .github/ISSUE_TEMPLATE/*.yml
	$(BIN)/check-jsonschema --builtin-schema vendor.dependabot .github/dependabot.yml
	$(BIN)/check-jsonschema --builtin-schema vendor.citation-file-format CITATION.cff

stripped: $(TESTED)
	@echo "==> Notebooks are stored without outputs"
	$(STRIP) --verify $(NOTEBOOKS)

# The notebooks' cells, as they stand, run on the foreign machine.
unit: $(TESTED)
	@echo "==> Unit and property tests"
	$(PYTEST) -n $(JOBS) --dist worksteal $(SLOWEST) -m "not built and not browser" \
	  -k "not (test_walk and cells_run)"

notebooks: $(TESTED)  ## all cells of every notebook, warnings are errors
	PYTHONWARNINGS="error:::__main__" $(PYTEST) -n $(JOBS) -k all_cells_run tests/book/test_walk.py

FOREIGN ?=
foreign: $(TESTED)  ## notebooks and claims on machines that round otherwise
	$(BIN)/python tests/support/foreign_machines.py --jobs $(JOBS) $(FOREIGN)

foreign-ci: $(TESTED)
	@echo "==> Notebooks and claims on a foreign machine"
	$(BIN)/python tests/support/foreign_machines.py --jobs $(JOBS) --ci

PAGE_TESTS = $(shell grep -rlE "mark\.(browser|built)\b" tests --include="test_*.py")

pages: $(TESTED)
	@$(BIN)/python book/_ext/build.py --strict
	@echo "==> The built pages"
	$(PYTEST) -n $(JOBS) --dist worksteal $(SLOWEST) -m "built or browser" $(PAGE_TESTS) || { \
	  echo "==> What failed, once more and alone: a busy machine can delay a browser" && \
	  $(PYTEST) --last-failed --last-failed-no-failures none $(PAGE_TESTS); }

SOURCES ?=
# No question about news, whole names in the list, widgets saved with the notebook.
OURS = --LabApp.app_settings_dir=book/_ext/lab-settings \
	$(if $(filter 0,$(shell id -u)),--allow-root)
lab: $(READY)  ## JupyterLab on the readers' notebooks; SOURCES=1: on the book's own
ifeq ($(SOURCES),)
	@$(BIN)/python book/_ext/build.py
	@$(WORKSHOP) book/_ext/lab.py $(OURS) --ServerApp.root_dir=_build/lab \
	  --FileContentsManager.pre_save_hook=lab.keep_widgets \
	  --LabApp.default_url=/lab/tree/00-index.ipynb
else
	$(WORKSHOP) -m jupyterlab $(OURS) --LabApp.default_url=/lab/tree/book
endif

LESSON ?=
COURSE ?= _build/course
ROSTER ?=
assignment: $(TESTED)  ## for nbgrader, with keys: LESSON=feedback (or all), ROSTER=students.csv
	@$(WORKSHOP) book/_ext/assignment.py "$(LESSON)" "$(COURSE)" "$(ROSTER)"

FOLDER ?=
collect: $(TESTED)  ## notebooks of the assignments from pages' work files: FOLDER=returned
	@$(WORKSHOP) book/_ext/handed_in.py "$(FOLDER)" "$(COURSE)"

gains: $(READY)  ## what a class answered to the twelve questions, before and after: FOLDER=returned
	@$(BIN)/python book/_ext/gains.py "$(FOLDER)"

MIRROR ?=
LIVE = PYTHONPATH="$$PWD/book/_ext" $(BIN)/python -m live --mirror "$(MIRROR)"
live: $(READY)  ## pages that run in the browser, in _build/live; MIRROR=: whence packages come
	@$(LIVE) --packages
	@$(BIN)/python book/_ext/build.py
	@$(LIVE)

pdf: book $(TESTED)  ## the walk and the evidence as PDFs, in _build/pdf (needs Chromium)
	@$(BIN)/python book/_ext/pdf.py

epub: book $(TESTED)  ## the walk as an EPUB, in _build/epub (needs Chromium)
	@$(BIN)/python book/_ext/epub.py

release: $(READY)  ## wheel, sites, PDFs, EPUB and notebooks in dist/, if tag, citation and changelog agree
	@$(BIN)/python book/_ext/release.py --check
	@$(LIVE) --packages
	@$(MAKE) --no-print-directory pdf epub live
	@$(BIN)/python book/_ext/release.py

COLAB = _build/colab
colab: book  ## readers' notebooks beside Colab's pins, out of the repository (PYTHON=python3.13)
	test -x $(COLAB)/bin/python || $(PYTHON) -m venv $(COLAB)
	$(COLAB)/bin/python -m pip install --quiet --disable-pip-version-check \
	  -r tests/support/colab.txt
	OMP_NUM_THREADS=1 $(BIN)/python tests/support/colab.py $(COLAB)/bin/python $(LESSON)

firefox: $(TESTED)  ## the page tests in Firefox, on the pages as they were built
	BROWSER=firefox $(PYTEST) -n $(JOBS) --dist worksteal -m "browser and not chromium" $(PAGE_TESTS)

reproduce: $(READY)  ## measure the paper's claims anew (slow), into book/results/
	$(WORKSHOP) -m workshop.report.reproduce
	$(WORKSHOP) -m workshop.chapters.widgets.hero

ONLY ?= ddlib.dynamics.*
mutants: $(TESTED)  ## which mistakes would the tests notice? ONLY=ddlib.control.* names modules
	$(BIN)/python -m pip install --quiet --disable-pip-version-check -e ".[mutants]"
	OMP_NUM_THREADS=1 $(BIN)/mutmut run --max-children $(JOBS) "$(ONLY)"
	$(BIN)/mutmut results

bench: $(READY)  ## speed, as ratios measured in one run
	$(BIN)/python benchmarks/run.py

strip: $(TESTED)  ## remove outputs from the notebooks before a commit
	$(STRIP) $(NOTEBOOKS)

clean:  ## remove what was built; .venv stays, and so does a course with its marks
	test ! -d _build || find _build -mindepth 1 -maxdepth 1 ! -name course -exec rm -rf {} +
	rm -rf build dist mutants .pytest_cache .ruff_cache .hypothesis
	find book ddlib tests benchmarks -name __pycache__ -type d -prune -exec rm -rf {} +
