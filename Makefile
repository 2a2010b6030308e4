# make demo: sets up, runs the main job.  make test: sets up, passes the tests.  Everything works in .venv/.
SHELL := /bin/bash
PYTHON ?= $(shell for p in python3.12 python3.11 python3; do $$p -c 'import sys; sys.exit(not (3,11)<=sys.version_info[:2]<=(3,12))' 2>/dev/null && echo $$p && break; done)
VENV := .venv
BIN := $(VENV)/bin
READY := $(VENV)/.ready
export ROS_AUTOMATIC_DISCOVERY_RANGE ?= LOCALHOST
# one thread per process: the arrays are small, and the machine's cores belong to the nodes
export OMP_NUM_THREADS ?= 1
export OPENBLAS_NUM_THREADS ?= 1
# every process that a test starts would compile the package anew, and every worker all tests
unexport PYTHONDONTWRITEBYTECODE

CAMPAIGNS := loop identification gap gap-hard thresholds rates fleet faults soak real own-simulation second third

.PHONY: docs demo test test-nodes test-computing test-long test-ubuntu24.04 lint bench setup browser colcon mutants clean campaign campaign-import $(addprefix campaign-,$(CAMPAIGNS))

setup: $(READY)

$(READY): setup.py constraints.txt
	@test -n "$(PYTHON)" || { echo "Python 3.11 or 3.12 is needed (the ROS 2 Jazzy wheels exist for these); set PYTHON=/path/to/python3.12"; exit 2; }
	$(PYTHON) -m venv $(VENV)
	$(BIN)/python -m pip install --quiet --disable-pip-version-check "pip>=24" "setuptools>=65,<80" wheel
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --no-build-isolation --no-compile -c constraints.txt -e '.[all]'
	@# pip compiles one file after the other, on one core
	$(BIN)/python -m compileall -q -j 0 $(VENV)/lib winch_friction campaign bench >/dev/null & $(BIN)/python -m winch_friction.cli.warming && wait
	@touch $(READY)

demo: $(READY)
	$(BIN)/winch-friction demo --out out/demo

# tests that start nodes mostly wait; whatever only computes fills the time that they leave and gives way
# The two whole loops over DDS wait for each other's answers; what is judged by the clock then runs two files at a time,
# each with domains of its own
test:
	$(MAKE) --no-print-directory -j 3 --output-sync=recurse lint test-nodes test-computing

# where tests start nodes; to look through all the others takes each worker ten seconds
ROS_TESTS := test/ros test/nodes test/campaign_faults test/bench/test_benchmarks.py test/docs/test_reference.py

test-nodes: $(READY)
	$(BIN)/python -m pytest $(ROS_TESTS) -m "ros and slow" -n 2 --dist loadfile
	$(BIN)/python -m pytest $(ROS_TESTS) -m "ros and not slow" -n 2 --dist loadfile

# one more than two cores keep busy, for some of them wait; without the variable above, which `nproc` takes for the cores
WORKERS = $(shell cores=$$(env -u OMP_NUM_THREADS nproc); echo $$(( cores < 3 ? cores + 1 : 4 )))

# the first look at the tests compiles them for all workers
test-computing: $(READY) browser
	$(BIN)/python -m pytest --collect-only -q >/dev/null || true
	nice -n 5 $(BIN)/python -m pytest -m "not ros and not long" -n $(WORKERS) --dist loadfile --no-loadscope-reorder

# more whole data sets of the kinds that `make test` holds one or some of, nine minutes on two cores: before a change of
# the gap workflow lands, and in the campaign of faults
test-long: $(READY)
	$(BIN)/python -m pytest -m long -n logical --maxprocesses 4

lint: $(READY)
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy winch_friction
	$(BIN)/lint-imports --no-cache

# the same tests with the library versions of Ubuntu 24.04, ROS 2 Jazzy's own platform
test-ubuntu24.04:
	@test -n "$(PYTHON)" || { echo "Python 3.11 or 3.12 is needed; set PYTHON=/path/to/python3.12"; exit 2; }
	$(PYTHON) -m venv .venv-ubuntu24.04
	.venv-ubuntu24.04/bin/python -m pip install --quiet -c constraints-ubuntu24.04.txt -e '.[all]'
	.venv-ubuntu24.04/bin/python -m pytest $(ARGS)

# the report pages are opened in a real browser; without one and without the right to install it those tests skip and say so
browser:
	@command -v chromium >/dev/null || command -v chromium-browser >/dev/null || command -v google-chrome >/dev/null || \
	  { [ "$$(id -u)" = 0 ] && command -v apt-get >/dev/null && { apt-get update -qq && apt-get install -y -qq --no-install-recommends chromium; } >/dev/null 2>&1; } || \
	  echo "no Chromium and no right to install it: the browser tests will skip"

# the site: reference from the code, tutorials executed, no warnings; open out/site/index.html
docs: $(READY)
	$(BIN)/sphinx-build -W --keep-going -q -b html docs out/site

bench: $(READY)
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --no-build-isolation -c constraints.txt -e '.[bench]'
	$(BIN)/winch-friction bench --page docs/benchmarks.md $(ARGS)

colcon: $(READY)
	$(BIN)/python -m pytest test/test_colcon.py

campaign: $(addprefix campaign-,$(CAMPAIGNS)) campaign-import

$(addprefix campaign-,$(CAMPAIGNS)): $(READY)
	$(BIN)/python -m campaign.$(subst -,_,$(subst campaign-,,$@)) $(ARGS)

campaign-import: $(READY)
	$(BIN)/python -m campaign.import_logs $(ARGS)

# small semantic faults in a copy of the package, drawn from a long list: do the tests notice?
mutants: $(READY)
	$(BIN)/python -m campaign.mutants $(ARGS)

clean:
	rm -rf out build install log
