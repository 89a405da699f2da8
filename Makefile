# Every daily command. Each one first sets up .venv when that is needed; see .ci/setup.

.DEFAULT_GOAL := help
.PHONY: help demo test test-all test-long nightly durations check docs proof golden installed benchmark gallery setup clean distclean

# Folders that another workspace put on Python's path must not reach into .venv.
# Python may keep what it compiled: the tests' own modules take longest to compile, see clean.
unexport PYTHONPATH PYTHONHOME PYTHONDONTWRITEBYTECODE
# The type checker is the version installed in .venv; it need not look for a newer one.
export PYRIGHT_PYTHON_IGNORE_WARNINGS := 1

# Further arguments for pytest or the proof, for example: make test ARGS="-k backbone"
ARGS ?=
# Tests run on all cores: those of a file on one, for they share what is made once, and the files that cost most first.
PYTEST := .venv/bin/pytest --numprocesses auto --dist loadfile --no-loadscope-reorder

help: ## list these commands
	@sed -n 's/^\([a-z-]*\):.*## \(.*\)/make \1|\2/p' Makefile | awk -F'|' '{printf "%-16s %s\n", $$1, $$2}'

demo: ## set up, then run the whole story on the built-in rig; results in demo/
	@sh .ci/setup run
	@.venv/bin/dashpot demo -o demo

test: ## set up, then run the tests of the fast lane, five minutes on two cores
	@sh .ci/setup dev
	@$(PYTEST) $(ARGS)

test-all: ## set up, then run these and the long ones
	@sh .ci/setup dev
	@$(PYTEST) -m "not nightly" $(ARGS)

test-long: ## set up, then run the long ones alone (ARGS="--within 600": begin none after ten minutes)
	@sh .ci/setup dev
	@$(PYTEST) -m long $(ARGS)

nightly: ## set up, then run what continuous integration leaves out: every law everywhere, a longer proof, all recordings
	@sh .ci/setup dev
	@status=0; \
	$(PYTEST) -m nightly $(ARGS) || status=1; \
	.venv/bin/python -P -m dashpot.examples.concealed.proof -o proof --short 20 --seed 404 || status=1; \
	if [ -d "$${DASHPOT_DATA:-../shared/data}" ]; then \
		.venv/bin/python -P benchmarks/recorded.py -o recorded --check || status=1; \
	fi; \
	exit $$status

durations: ## set up, then measure what each test costs, for the lanes; into tests/durations.json (ARGS="tests/model")
	@sh .ci/setup dev
	@$(PYTEST) -m "" --write-durations $(ARGS)

check: ## set up, then check style, types and structure
	@sh .ci/setup dev
	@status=0; \
	.venv/bin/ruff check || status=1; \
	.venv/bin/ruff format --check || status=1; \
	.venv/bin/pyright || status=1; \
	.venv/bin/pytest -m "" tests/test_structure.py tests/test_circles.py || status=1; \
	exit $$status

docs: ## set up, then build the site of docs/ into site/, with nothing from the network
	@sh .ci/setup docs
	@# without --quiet, with which --strict counts no warning
	@NO_MKDOCS_2_WARNING=1 .venv/bin/mkdocs build --strict
	@echo "site/index.html"

proof: ## set up, then the blind proof of the diagnosis (an hour or two; ARGS="--short 8" for a taste); results in proof/
	@sh .ci/setup dev
	@.venv/bin/python -P -m dashpot.examples.concealed.proof -o proof $(ARGS)

golden: ## set up, then compare identify and diagnose with the last commit, number by number (ARGS="--base REV --exact")
	@sh .ci/setup dev
	@.venv/bin/python -P benchmarks/golden.py $(ARGS)

installed: ## build, install into a fresh environment (PYTHON=python3.13), and test what was installed (ARGS="tests/face")
	@sh .ci/installed $(ARGS)

benchmark: ## set up, then print accuracy and speed
	@sh .ci/setup dev
	@.venv/bin/python benchmarks/run.py

gallery: ## set up, then try the recordings of other people where they are there (ARGS="--quick"); results in recorded/
	@sh .ci/setup dev
	@.venv/bin/python -P benchmarks/recorded.py -o recorded $(ARGS)

setup: ## set up .venv for development, nothing else
	@sh .ci/setup dev

clean: ## remove what the commands made, but for .venv
	@rm -rf build dist demo proof recorded site .worked dashpot.egg-info .pytest_cache .ruff_cache
	@find . -name .venv -prune -o -name __pycache__ -type d -prune -exec rm -rf {} +

distclean: clean ## remove .venv as well
	@rm -rf .venv
