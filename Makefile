# `make help` lists the targets.
#
# The steps of every experiment: experiments/**/S.toml -> hausbench run -> results/S.h5 -> analysis/**/S.py -> results/figures, results/tables,
# results/report. No target deletes results. To resume an interrupted run, make the same target again.

SHELL := /bin/bash
.SHELLFLAGS := -euo pipefail -c
MAKEFLAGS += --no-builtin-rules
# Timings must not compete with each other; ninja and ctest run compilers and tests in parallel.
.NOTPARALLEL:

export PROFILE ?= quick
export PYTHON ?= /usr/bin/python3
export ENGINE ?= here
export RUN_ARGS ?=
export SKIP_DEPS ?=
export FETCH ?= $(PYTHON) datasets/fetch.py
export MUTANTS ?=
export CMAKE_ARGS ?=
export JOBS ?= $(shell tools/jobs)

export MPLBACKEND := Agg
export HAUSBENCH_PROGRAM := $(CURDIR)/build/release/hausbench

DEPS := $(if $(SKIP_DEPS),,.stamps/deps)
# Without tracking.toml, whose cases `make track` measures in its own way.
STEMS := $(filter-out tracking,$(sort $(basename $(notdir $(shell find experiments -name '*.toml')))))
# zhang2017_table3 belongs to the group zhang2017, like everything else in experiments/zhang2017.
GROUPS := $(filter-out $(STEMS),$(sort $(foreach stem,$(STEMS),$(firstword $(subst _, ,$(stem))))))
stems_of = $(sort $(filter $(1)_%,$(STEMS)) $(basename $(notdir $(wildcard experiments/$(1)/*.toml))))
SOURCES = $(sort $(shell find algorithms bench datasets harness library process python tests -name '*.cpp'))
HEADERS = $(sort $(shell find algorithms bench datasets harness library process python tests -name '*.h' -o -name '*.hpp'))

help:
	@sed -nE 's/^([a-z][a-z-]*):.*## (.*)/make \1\t\2/p' Makefile | expand -t 22
	@echo 'make STEM             run and draw one experiment, or a group:  $(GROUPS)'
	@echo 'Variables: PROFILE=quick|paper (now $(PROFILE))  JOBS=$(JOBS)  PYTHON=$(PYTHON)  RUN_ARGS= (for hausbench run)  ENGINE=here|slurm'
	@echo '           CMAKE_ARGS=-DHAUSBENCH_...  SKIP_DEPS=1 (on other systems, where you see to the packages yourself)'
	@printf 'Experiments:\n$(foreach stem,$(STEMS),  $(stem)\n)'

# --- packages, models, building --------------------------------------------------------------------------------------

deps: $(DEPS)  ## install the Debian packages of packages.txt that are missing (as root)
	@echo 'deps: $(if $(SKIP_DEPS),not looked at (SKIP_DEPS),all Debian packages of packages.txt are installed)'
# Checked again only if the list or the installed packages have changed.
.stamps/deps: packages.txt $(wildcard /var/lib/dpkg/status)
	@tools/deps && mkdir -p $(@D) && touch $@
build: $(DEPS)  ## build the program, build/release/hausbench, and the C library, build/release/library/libhausbench.so
	tools/build release hausbench hausbench_commit hausbench_c
datasets: $(DEPS)  ## fetch the models that experiments name; cases of a model that is missing are skipped with a message
	$(FETCH)
fetch-corpus: $(DEPS)  ## fetch and check the meshes of the corpus (150 MB), which some experiments use in profiles paper and corpus
	$(FETCH) --corpus --check

# --- experiments -----------------------------------------------------------------------------------------------------

# The corpus experiments have their own target: `make corpus`, which takes hours with PROFILE=corpus RUN_ARGS="--jobs 2".
experiments: build  ## run every experiment, then draw every table and figure
	@tools/walk --pages $(filter-out corpus_%,$(STEMS))
figures: $(DEPS)  ## draw the existing results again, without running anything
	@tools/walk --draw --pages $(STEMS)
$(STEMS): %: build
	@tools/walk $*
$(GROUPS): %: build
	@tools/walk $(call stems_of,$*)
# Drawn, in whole or in part, from the results of another experiment (RESULTS_OF).
stability_error stability_time: stability_matrix
tang2009_nearest: tang2009_similarity
python: $(DEPS)  ## install the Python package into the virtual environment build/venv, and test it there
	tools/python
documents: $(DEPS)  ## collect the figures and tables of each paper in results/tables/PAPER.tex, and with pdflatex in results/documents/PAPER.pdf
	$(PYTHON) -m analysis.document --compile
report: $(DEPS)  ## write results/report/index.html, pages about all results; fails if a reason why a claim does not hold no longer fits
	$(PYTHON) tools/bundle && $(PYTHON) -m analysis.report.pages --strict
reference-sums:  ## write the list of SHA-256 of the files in results/reference again, after one was changed on purpose
	cd results/reference && find . -type f ! -name 'SHA256SUMS*' -printf '%P\0' | LC_ALL=C sort -z | xargs -0 sha256sum > SHA256SUMS.new
	mv results/reference/SHA256SUMS.new results/reference/SHA256SUMS
check-reference: $(DEPS)  ## compare bounds and counted work in results/ with results/reference/counts; STEM=... for some
	$(PYTHON) -m analysis.check_reference $(or $(STEM),$(basename $(notdir $(wildcard results/reference/counts/*.csv))))
reference-sample: tracked  ## measure a part of results/reference/counts again (a minute), which must not differ; part of .ci/run
	$(PYTHON) -m analysis.check_reference --sample

# --- checks ----------------------------------------------------------------------------------------------------------

test: $(DEPS)  ## build everything, then run all tests and a small experiment from end to end (--fresh: even if it was run before)
	tools/build release all
	ctest --preset release -j $(JOBS)
	@RUN_ARGS="$(RUN_ARGS) --fresh" tools/walk smoke
	tools/types
	$(PYTHON) -m pytest -q -n $(JOBS) --dist loadfile tests
searches: $(DEPS)  ## run the random searches of the tests in full; make test runs a fifth of them
	tools/build release all
	HAUSBENCH_SEARCHES=all ctest --preset release -j $(JOBS) -L searches
test-slurm: build  ## run an experiment on a Slurm of one machine with two nodes, kill a task and lose a node (as root; installs slurm-wlm and munge)
	$(if $(SKIP_DEPS),,tools/deps slurm-wlm munge)
	PATH="$$PATH:/usr/sbin:/sbin" $(PYTHON) -m pytest -q -rs --insist tests/slurm
test-report: $(DEPS)  ## test the pages of make report in a browser (installs chromium)
	$(if $(SKIP_DEPS),,tools/deps chromium chromium-driver python3-selenium)
	$(PYTHON) tools/bundle && $(PYTHON) -m pytest -q -rs --insist tests/report
hostile: build  ## fetch (50 MB) and measure all files known to break programs; make test takes only those in the models' packages
	HAUSBENCH_HOSTILE=all $(PYTHON) -m pytest -q -rs --insist tests/hostile
certificates: build  ## write and check proofs for 41 pairs of real meshes (fewer for guthe and sacht); false claims must be refused
	$(FETCH)
	for of in cover 'guthe --pairs 8' 'sacht --pairs 8'; do $(PYTHON) tests/certificates.py --solver $$of; done
mutants: $(DEPS)  ## switch off each term in tests/mutants.toml in turn; its test must then fail (MUTANTS=text for some)
	$(PYTHON) tests/mutants.py --jobs $(JOBS) $${MUTANTS:+"$$MUTANTS"}
asan: $(DEPS)  ## run the C++ tests with the address and undefined behaviour sanitizers
	tools/build asan all
	ctest --preset asan -j $(JOBS)
asan-kernels: $(DEPS)  ## the same for the tests of kernels, contracts and cover only; part of .ci/run
	tools/build asan kernel_tests
	ctest --preset asan -j $(JOBS) --no-tests=error -L kernels
tsan: $(DEPS)  ## run the tests of shared sessions, without those that have no threads, with the thread sanitizer, which must find a planted race
	tools/build tsan threaded_tests
	GTEST_FILTER='-*RandomPairs*:*RandomScenes*:*ReferenceIsRight*' ctest --preset tsan -j $(JOBS) --no-tests=error -L threaded
fuzz: $(DEPS)  ## run the fuzz targets, FUZZ_SECONDS each (TARGET=... for one); inputs accumulate in build/fuzz (see tests/fuzz/report.py)
	tools/fuzz $(or $(FUZZ_SECONDS),60) $(TARGET)
fuzz-short: $(DEPS)  ## run all fuzz targets on their kept inputs, then a few seconds each; part of .ci/run
	tools/fuzz --short
same-bits: $(DEPS)  ## build the C library with clang, and for arm64 (installs packages of that architecture), whose answers must have the same bits
	tools/same_bits $(BUILDS)
other-release: $(DEPS)  ## compile everything on Debian 13, or on 12 if this is 13, without optimisation, and run the tests of kernels there (as root)
	tools/on $(if $(shell grep trixie /etc/os-release),bookworm,trixie) 'make deps' 'tools/build small all' 'ctest --preset small -j $(JOBS) --no-tests=error -L kernels'
test-container: $(DEPS)  ## run the steps of Containerfile in bare Debian roots (as root), and with podman where it is
	HAUSBENCH_CONTAINER=1 $(PYTHON) -m pytest -q -rs tests/container
types: $(DEPS)  ## run mypy
	tools/types
# With the flags of build/debug, as build/release is a unity build; without the plug-in and the recorder, which are separate projects.
tidy: $(DEPS)  ## run clang-tidy
	@command -v clang-tidy > /dev/null || { echo 'tidy: please run: sudo apt-get install clang-tidy' >&2; exit 1; }; cmake --preset debug > /dev/null
	printf '%s\n' $(filter-out tests/outside_plugin/% datasets/recorder/% $(if $(wildcard /usr/include/embree3),,bench/rival_embree.cpp),$(SOURCES)) | xargs -P $(JOBS) -n 1 clang-tidy -p build/debug --quiet
# Other versions format otherwise. These two are those of Debian 12.
FORMATTERS = clang-format --version | grep -q ' version 14\.' && black --version | grep -q 'black, 23\.1\.'
PYTHON_FILES = $(sort $(shell find analysis bench datasets docs experiments python tests tools setup.py -name '*.py')) tools/bundle tools/formats tools/wheel
format: $(DEPS)  ## run clang-format 14 on all C++ files, black 23.1 on all Python files
	@$(FORMATTERS) || { echo 'format: this needs clang-format 14 and black 23.1, which Debian 12 has' >&2; exit 1; }
	clang-format -i $(SOURCES) $(HEADERS)
	black -q $(PYTHON_FILES)
format-check: $(DEPS)  ## show the lines that make format would change, and fail if there are any; skipped where the formatters have other versions
	@if $(FORMATTERS); then clang-format --dry-run --Werror $(SOURCES) $(HEADERS) && black -q --diff --check $(PYTHON_FILES); \
	else echo "format-check: skipped: clang-format 14 and black 23.1 decide, which Debian 12 has"; fi

# --- has anything become slower? -------------------------------------------------------------------------------------

tracked: $(DEPS)
	tools/build release hausbench hausbench_commit kernel_bench counters_test
	$(FETCH) --profile $(PROFILE) --experiment experiments/tracking.toml
track: tracked  ## compare counters, instructions and times with the commit BASE (default: HEAD); the last line is the verdict; TRACK_ARGS="--tiers time ..."
	"$(HAUSBENCH_PROGRAM)" track --base "$(or $(BASE),HEAD)" $(TRACK_ARGS)
track-counts: tracked  ## only the tiers of track that need no clock; no instructions without a baseline for this compiler; part of .ci/run
	"$(HAUSBENCH_PROGRAM)" track --tiers counters,instructions
history: $(DEPS)  ## measure commits side by side: REVS="v1 HEAD"; adds them to results/history.csv, which the report draws
	$(PYTHON) -m bench.tracking.history $(REVS)
bisect: $(DEPS)  ## find the commit that changed the counters or instructions of a case; CASE="guthe on mesh to its half" GOOD=v1 BAD=v2
	$(PYTHON) -m bench.tracking.bisection --case "$(CASE)" --good "$(GOOD)" --bad "$(or $(BAD),HEAD)"
bench: $(DEPS)  ## time the kernels one by one and against Embree and CGAL; tools/bench --reference writes to results/reference
	tools/bench $(BENCH_ARGS)

clean:  ## delete all build products; keeps results and fetched models
	rm -rf build .stamps .mypy_cache .pytest_cache
	[ ! -e .git ] || git worktree prune
	find . -name __pycache__ -not -path './.git/*' -prune -exec rm -rf {} +

.PHONY: $(shell sed -nE 's/^([a-z][a-z-]*):.*/\1/p' Makefile) stability_error stability_time $(STEMS) $(GROUPS)
.DEFAULT:
	@echo "make: there is no target or experiment '$@'; \`make help\` lists them" >&2; exit 2
