# The front door: `make help` says what there is.
#
# The line every experiment walks: experiments/**/S.toml -> hausbench run -> results/S.h5 -> analysis/**/S.py -> results/figures, results/tables.
# Nothing here deletes results; a run that was interrupted goes on where it stopped when the same target is made again.

SHELL := /bin/bash
.SHELLFLAGS := -euo pipefail -c
MAKEFLAGS += --no-builtin-rules
.SUFFIXES:
# Timings must not compete with each other; compilers and tests are run in parallel by ninja and ctest.
.NOTPARALLEL:
.DEFAULT_GOAL := help

PROFILE ?= quick
PYTHON ?= /usr/bin/python3
# One job a core, but at least 2 GB of free memory each, within the limit of a container: CGAL is heavy on compilers.
JOBS ?= $(shell { cat /proc/meminfo; sed 's/^/Limit /' /sys/fs/cgroup/memory.max /sys/fs/cgroup/memory/memory.limit_in_bytes; } 2>/dev/null | awk -v cores=$$(nproc) \
    '/^MemAvailable/ {m = $$2 / 2e6} /^Limit [0-9]/ && $$2 / 2e9 < m {m = $$2 / 2e9} END {m = int(m); print m < 1 ? 1 : m < cores ? m : cores}')
CMAKE_ARGS ?=
RUN_ARGS ?=
BENCH_ARGS ?=
VERSIONS_ARGS ?=
MUTANTS ?=
FUZZ_SECONDS ?= 60
TARGET ?=
BASE ?= HEAD
TRACK_ARGS ?=
REVS ?=
CASE ?=
GOOD ?=
BAD ?= HEAD
SKIP_DEPS ?=
ENGINE ?= here

export MPLBACKEND := Agg
export MUTANTS
export HAUSBENCH_PROGRAM := $(CURDIR)/build/release/hausbench
# ccache and mold are used if they are installed; two clones share what ccache holds. What a source includes is known from the compiler's own
# list (depend mode), so nothing is preprocessed twice.
export CCACHE_BASEDIR := $(CURDIR)
export CCACHE_DEPEND := 1
export CCACHE_SLOPPINESS := pch_defines,time_macros
LAUNCHER := $(if $(shell command -v ccache),-DCMAKE_CXX_COMPILER_LAUNCHER=ccache) $(if $(shell command -v mold),-DCMAKE_EXE_LINKER_FLAGS=-fuse-ld=mold)

PACKAGES := $(filter-out $(if $(shell command -v npm),npm),$(shell sed 's/\#.*//' packages.txt))
DEPS := $(if $(SKIP_DEPS),,.stamps/deps)
# Not tracking.toml: `make track` measures its cases, and has its own ways to do that.
STEMS := $(filter-out tracking,$(sort $(basename $(notdir $(shell find experiments -name '*.toml')))))
# Every mesh of the packages is a target of its own: `make corpus`.
WALKED := $(filter-out corpus_%,$(STEMS))
# zhang2017_table3 belongs to the group zhang2017, and so does all else in experiments/zhang2017.
GROUPS := $(filter-out $(STEMS),$(sort $(foreach stem,$(STEMS),$(firstword $(subst _, ,$(stem))))))
CPP_FILES = $(sort $(shell find algorithms bench datasets harness tests -name '*.cpp'))
HEADERS = $(sort $(shell find algorithms bench datasets harness tests -name '*.h'))

.PHONY: help deps build datasets fetch-corpus fetch-kicad recordings test searches test-slurm hostile certificates mutants types experiments figures documents check-reference tidy format format-check asan asan-kernels tsan fuzz fuzz-short track track-counts history bisect bench bench-reference clean $(STEMS) $(GROUPS)

help:
	@echo 'make deps         install the Debian packages of packages.txt that are missing (as root)'
	@echo 'make build        the program, build/release/hausbench'
	@echo 'make datasets     fetch the models that experiments name'
	@echo 'make fetch-corpus fetch and check all meshes of the packages, which some experiments sweep in profiles paper and corpus'
	@echo 'make fetch-kicad  fetch and check the 6,061 parts of datasets/kicad.toml: 379 MB to download, 1.2 GB of disk; only profile kicad of make corpus needs them'
	@echo 'make corpus       every solver on every mesh: 40 of them; all with PROFILE=corpus RUN_ARGS="--jobs 2", which takes hours; on parts of circuits with PROFILE=kicad, which takes days; not part of make experiments'
	@echo 'make recordings   simulate the recorded scenes of experiments/tang2009 again (needs libbullet-dev; what it writes is committed)'
	@echo 'make test         build, then all tests and a small experiment from end to end'
	@echo 'make hostile      fetch and measure every file known to break programs; make test takes those of the models'"'"' packages'
	@echo 'make test-slurm   run an experiment on a Slurm of one machine and two nodes, kill a task and lose a node (root; installs slurm-wlm and munge)'
	@echo 'make certificates write and check the proofs of 41 pairs of real meshes, and false claims, which must be refused; fewer of guthe and sacht'
	@echo 'make experiments  run every experiment, then draw every table and figure'
	@echo 'make figures      draw again from the results that exist; runs nothing'
	@echo 'make documents    a document of all figures and tables of each paper, results/tables/PAPER.tex; with pdflatex also results/documents/PAPER.pdf'
	@echo 'make STEM         run and draw one experiment'
	@echo 'make check-reference   do the bounds and the counted work of results/ equal those in results/reference/counts? STEM=... for some'
	@echo 'make asan         the C++ tests under the address and undefined behaviour sanitizers'
	@echo 'make asan-kernels the tests of kernels, contracts and cover alone, the same way; .ci/run runs them too'
	@echo 'make tsan         the session and contract tests under the thread sanitizer, which must find a planted race'
	@echo 'make fuzz         fuzz targets, FUZZ_SECONDS each; what they find accumulates in build/fuzz (python3 tests/fuzz/report.py)'
	@echo 'make fuzz-short   the kept inputs of all fuzz targets, then a few seconds each; .ci/run runs it too'
	@echo 'make track        has anything become slower? work counters, instructions, then times beside the commit BASE (default: HEAD)'
	@echo 'make track-counts the tiers of it that need no clock; .ci/run runs them too'
	@echo 'make searches     the random searches of the tests whole, of which make test tries a fifth'
	@echo 'make history      draw how times and counts have changed (results/history.csv); REVS="v1 v2" measures these commits first'
	@echo 'make bisect       CASE="guthe on mesh to its half" GOOD=v1 BAD=v2: the commit that changed its counters or instructions'
	@echo 'make mutants      lose each term of tests/mutants.toml in turn, in a copy of the tree, and expect its test to fail'
	@echo 'make bench        time the kernels, one by one and against Embree and CGAL'
	@echo 'make bench-reference   the same against Embree, CGAL and an older guthe, into results/reference/kernels.md'
	@echo 'make tidy         clang-tidy;  make format, make format-check: clang-format, in place or only looking;  make types: mypy'
	@echo 'make clean        delete what was built; results and fetched models stay'
	@echo
	@echo 'Variables: PROFILE=quick|paper (now $(PROFILE))  JOBS=$(JOBS)  PYTHON=$(PYTHON)  RUN_ARGS= (for hausbench run)'
	@echo '           MUTANTS= (only those whose name or file contains it)'
	@echo '           ENGINE=here|slurm (where make STEM and make experiments run; slurm: on a cluster)'
	@echo '           FUZZ_SECONDS=60  TARGET= (for make fuzz: one of tests/fuzz/*.cpp, default all)'
	@echo '           BASE=HEAD  TRACK_ARGS= (for make track: --tiers time ...)  REVS= (for make history)  CASE= GOOD= BAD=HEAD (for make bisect)'
	@echo '           BENCH_ARGS= (for kernel_bench: --benchmark_filter=closest ...)  VERSIONS_ARGS= (for bench.tracking.versions)'
	@echo '           CMAKE_ARGS=-DHAUSBENCH_...  SKIP_DEPS=1 (on other systems, where you see to the packages yourself)'
	@echo
	@echo 'Groups: $(GROUPS)'
	@echo 'Experiments:'
	@printf '  %s\n' $(STEMS)

# --- what is needed --------------------------------------------------------------------------------------------------

deps: $(DEPS)
	@echo 'deps: $(if $(SKIP_DEPS),not looked at (SKIP_DEPS),all Debian packages of packages.txt are installed)'

# Looked at again only when the list, or what is installed, has changed.
.stamps/deps: packages.txt $(wildcard /var/lib/dpkg/status)
	@command -v dpkg-query >/dev/null || { \
	    echo 'deps: this is not a Debian system: install what packages.txt lists, then run make SKIP_DEPS=1 ...' >&2; exit 1; }
	$(call install,$(PACKAGES))
	@mkdir -p $(@D) && touch $@

# --- building --------------------------------------------------------------------------------------------------------

build/%/build.ninja: $(DEPS)
	cmake --preset $* $(LAUNCHER) $(CMAKE_ARGS)
	@touch $@

# Debian packages that are missing, as root; the others are not touched.
define install
@installed=" $$(dpkg-query -W -f='$${db:Status-Status} $${Package}\n' $(1) 2>/dev/null | sed -n 's/^installed //p' | tr '\n' ' ' || true)"; \
missing=; for package in $(1); do [[ $$installed == *" $$package "* ]] || missing+=" $$package"; done; \
if [ -n "$$missing" ] && [ "$$(id -u)" -ne 0 ]; then \
    echo "deps: Debian packages are missing, and only root may install them. Please run" >&2; \
    echo "  sudo apt-get update && sudo apt-get install --no-install-recommends$$missing" >&2; exit 1; \
elif [ -n "$$missing" ]; then \
    echo "deps: installing, which takes a minute or two:$$missing"; \
    mkdir -p .stamps; umask 022; export DEBIAN_FRONTEND=noninteractive; \
    apt-get update -qq || echo 'deps: apt-get update failed; going on with the package lists at hand' >&2; \
    apt-get install -qq -y --no-install-recommends -o DPkg::Lock::Timeout=300 -o Dpkg::Use-Pty=0 $$missing > .stamps/apt.log 2>&1 || { \
        tail -n 20 .stamps/apt.log >&2; echo 'deps: apt-get install failed; its output is in .stamps/apt.log' >&2; exit 1; }; \
fi
endef

# cmake runs again by itself when a CMakeLists.txt changes; here it runs again for options given to this make.
define compile
$(if $(CMAKE_ARGS),cmake --preset $(1) $(CMAKE_ARGS))
cmake --build --preset $(1) -j $(JOBS) --target $(2)
endef

build: build/release/build.ninja
	$(call compile,release,hausbench hausbench_commit)

# A missing package is no error: the cases that need it are skipped, and say so.
FETCH := $(PYTHON) datasets/fetch.py

datasets: $(DEPS)
	$(FETCH)

# All that each = "whole_corpus" names, hashed: some twenty packages more than those of the manifest, 150 MB.
fetch-corpus: $(DEPS)
	$(FETCH) --corpus --check

# All that each = "kicad" names, hashed, of a package of 379 MB.
fetch-kicad: $(DEPS)
	$(FETCH) --tier kicad --check

# Nothing else needs Bullet: the recordings are committed. Another compiler or processor may round otherwise, and give other poses.
RECORDED := bunny_1k $(addprefix letter_,h a u s d o r f b e n c)

recordings: build
	@[ -f /usr/include/bullet/btBulletDynamicsCommon.h ] || { echo 'recordings: please run: sudo apt-get install libbullet-dev' >&2; exit 1; }
	$(FETCH) $(RECORDED)
	cmake -G Ninja -S . -B build/recorder -DCMAKE_BUILD_TYPE=Release -DHAUSBENCH_WITH_RECORDER=ON -DHAUSBENCH_WITH_TESTS=OFF $(LAUNCHER) $(CMAKE_ARGS)
	cmake --build build/recorder -j $(JOBS) --target record_scenes
	for model in $(RECORDED); do "$(HAUSBENCH_PROGRAM)" export $$model build/recorder/$$model.off; done
	for kind in '' _soft; do \
	  build/recorder/record_scenes domino$$kind build/recorder experiments/tang2009/alphabet_domino$$kind.recording && \
	  build/recorder/record_scenes bunnies$$kind build/recorder experiments/tang2009/falling_bunnies$$kind.recording || exit 1; \
	done

# Of the corpus only what these stems ask for in this profile.
fetch_for = $(FETCH) --profile $(PROFILE) --experiment $(foreach stem,$(1),$(shell find experiments -name '$(stem).toml'))

# --- experiments -----------------------------------------------------------------------------------------------------

# $(1): stems; $(2): a command to begin with. What fails does not stop the rest, but make fails in the end and names it; Ctrl-C
# stops at once. Exit code 1 of a run: it is whole, and some rows are unsound, so its tables and figures are drawn all the same. Everything
# is measured before anything is drawn, as some scripts read the results of another stem.
define walk
@trap 'exit 130' INT TERM; failed=; \
$(if $(2),$(2) || failed+=" datasets";) \
drawn=; \
for stem in $(1); do \
    echo "== $$stem"; \
    code=0; "$(HAUSBENCH_PROGRAM)" run "$$(find experiments -name "$$stem.toml")" --profile $(PROFILE) $(if $(filter slurm,$(ENGINE)),--engine slurm --wait) $(RUN_ARGS) || code=$$?; \
    case $$code in 0) ;; 1) failed+=" $$stem (unsound rows)";; *) failed+=" $$stem (run)"; continue;; esac; \
    drawn+=" $$stem"; \
done; \
for stem in $$drawn; do \
    [ -z "$$(find analysis -name "$$stem.py")" ] || $(PYTHON) -m analysis "$$stem" || failed+=" $$stem (analysis)"; \
    [ ! -f "results/reference/counts/$$stem.csv" ] || $(PYTHON) -m analysis.check_reference "$$stem" || true; \
done; \
[ -z "$$failed" ] || { echo "failed:$$failed" >&2; exit 1; }
endef

experiments: build
	$(call walk,$(WALKED),$(call fetch_for,$(WALKED)))
	@[ ! -f analysis/paper_page.py ] || $(PYTHON) -m analysis.paper_page
	@[ ! -f analysis/which_solver.py ] || $(PYTHON) -m analysis.which_solver
	@[ ! -f analysis/ledger.py ] || $(PYTHON) -m analysis.ledger
	@[ ! -f analysis/opposite.py ] || $(PYTHON) -m analysis.opposite

stems_of = $(sort $(filter $(1)_%,$(STEMS)) $(basename $(notdir $(wildcard experiments/$(1)/*.toml))))

$(GROUPS): %: build
	$(call walk,$(call stems_of,$*),$(call fetch_for,$(call stems_of,$*)))

$(STEMS): %: build
	$(call walk,$*,$(call fetch_for,$*))

# Drawn from the results of another experiment, whose scripts draw all of them.
.PHONY: stability_error stability_time
stability_error stability_time: stability_matrix
# Drawn from the results of another experiment beside its own (RESULTS_OF in its script).
tang2009_nearest: tang2009_similarity

figures: $(DEPS)
	@trap 'exit 130' INT TERM; failed=; none=yes; \
	for stem in $(STEMS); do \
	    [ -f "results/$$stem.h5" ] && [ -n "$$(find analysis -name "$$stem.py")" ] || continue; \
	    none=; echo "== $$stem"; $(PYTHON) -m analysis "$$stem" || failed+=" $$stem"; \
	done; \
	[ -z "$$none" ] || echo 'figures: there are no results yet; `make experiments` makes them'; \
	[ -n "$$none" ] || $(PYTHON) -m analysis.paper_page || failed+=" the pages of the papers"; \
	[ -n "$$none" ] || $(PYTHON) -m analysis.which_solver || failed+=" which_solver"; \
	[ -n "$$none" ] || $(PYTHON) -m analysis.ledger || failed+=" the ledger"; \
	[ -z "$$failed" ] || { echo "failed:$$failed" >&2; exit 1; }

# Without pdflatex it writes the documents, and says that it compiled none.
documents: $(DEPS)
	$(PYTHON) -m analysis.document --compile

# A run says it too; here a difference is an error.
check-reference: $(DEPS)
	$(PYTHON) -m analysis.check_reference $(or $(STEM),$(basename $(notdir $(wildcard results/reference/counts/*.csv))))

# --- checks ----------------------------------------------------------------------------------------------------------

# Otherwise the second time would find the results of the first, and run nothing.
test: RUN_ARGS += --fresh
test: build/release/build.ninja
	$(call compile,release,all)
	ctest --preset release -j $(JOBS)
	$(call walk,smoke)
	@$(MAKE) --no-print-directory types
	$(PYTHON) -m pytest -q -n $(JOBS) --dist loadfile tests

# The programs that search at random, a fifth of which is in `make test`.
searches: build/release/build.ninja
	$(call compile,release,all)
	HAUSBENCH_SEARCHES=all ctest --preset release -j $(JOBS) -R '^($(shell grep -l '"searches.h"' tests/*_test.cpp | xargs -n1 basename -s .cpp | paste -sd '|'))$$'

# A Slurm of one machine with two nodes; what it needs is installed for it alone. A test that is skipped has failed.
test-slurm: build
	$(if $(SKIP_DEPS),,$(call install,slurm-wlm munge))
	PATH="$$PATH:/usr/sbin:/sbin" $(PYTHON) -m pytest -q -rs --insist tests/slurm

# All of tests/hostile/files.toml, some of which are in packages that nothing else needs (50 MB).
hostile: build
	HAUSBENCH_HOSTILE=all $(PYTHON) -m pytest -q -rs --insist tests/hostile

certificates: build
	$(FETCH)
	$(PYTHON) tests/certificates.py
	$(PYTHON) tests/certificates.py --solver guthe --pairs 8
	$(PYTHON) tests/certificates.py --solver sacht --pairs 8

# Each with a cache of its own: with other options, mypy throws away what it knew.
types: $(DEPS)
	MYPYPATH=datasets $(PYTHON) -m mypy --cache-dir .mypy_cache/analysis --config-file analysis/mypy.ini analysis bench datasets/fetch.py datasets/packages.py datasets/letters.py datasets/list_tier.py tests/analysis tests/datasets_py tests/hostile tests/tracking
	MYPYPATH=tests/program $(PYTHON) -m mypy --cache-dir .mypy_cache/program --strict --explicit-package-bases --ignore-missing-imports tests/program
	MYPYPATH=tests $(PYTHON) -m mypy --cache-dir .mypy_cache/tests --strict --explicit-package-bases tests/conftest.py tests/test_insist.py tests/certificates.py tests/mutants.py tests/test_mutants.py tests/rooms.py tests/test_rooms.py
	MYPYPATH=tests/fuzz $(PYTHON) -m mypy --cache-dir .mypy_cache/fuzz --strict --explicit-package-bases tests/fuzz/fuzz.py tests/fuzz/report.py
	MYPYPATH=tests/slurm $(PYTHON) -m mypy --cache-dir .mypy_cache/slurm --strict --explicit-package-bases --ignore-missing-imports tests/slurm

mutants: $(DEPS)
	$(PYTHON) tests/mutants.py --jobs $(JOBS) $${MUTANTS:+"$$MUTANTS"}

asan: build/asan/build.ninja
	$(call compile,asan,all)
	ctest --preset asan -j $(JOBS)

# What reads memory by index, on every instruction set, and every solver once: a few minutes to build.
KERNEL_TESTS = $(shell sed -nE 's/^hausbench_test.((kernel|solver_contract|cover)_[a-z_]*).*/\1/p' tests/CMakeLists.txt)

asan-kernels: build/asan/build.ninja
	$(call compile,asan,$(KERNEL_TESTS))
	ctest --preset asan -j $(JOBS) --no-tests=error -R '^(kernel_.*|solver_contract|cover)_test$$'

# Sessions that several threads share. `planted_race` is a race, and passes only where the sanitizer reports it. What is left out by
# --gtest_filter has no threads, and would take minutes.
TSAN_TESTS = cover_test mesh_motion_test kernel_blocks_test session_quantities_test session_directions_test session_test lanes_test kernel_structures_test kernel_parallel_test solver_contract_test planted_race

tsan: build/tsan/build.ninja
	$(call compile,tsan,$(TSAN_TESTS))
	GTEST_FILTER='-*RandomPairs*:*RandomScenes*:*ReferenceIsRight*' \
	    ctest --preset tsan -j $(JOBS) --no-tests=error -R '^($(subst $(eval ) ,|,$(TSAN_TESTS)))$$'

# On Debian `make deps` installs clang; with SKIP_DEPS, on other systems, its absence is no failure.
define fuzzing
@if echo 'extern "C" int LLVMFuzzerTestOneInput(const char*, decltype(sizeof 0)) { return 0; }' \
    | clang++ -x c++ -fsanitize=fuzzer,address -o /dev/null - 2>/dev/null; \
then $(MAKE) --no-print-directory build/fuzz/build.ninja && \
    cmake --build --preset fuzz -j $(JOBS) --target $(1) && $(PYTHON) tests/fuzz/fuzz.py $(2); \
else echo '$@: $(if $(SKIP_DEPS),skipped: )there is no clang++ with libFuzzer (on Debian: clang and libclang-rt-14-dev)' >&2; $(if $(SKIP_DEPS),,exit 1;) fi
endef

fuzz: $(DEPS)
	$(call fuzzing,$(if $(TARGET),$(addprefix fuzz_,$(TARGET)),fuzz_targets),--seconds $(FUZZ_SECONDS) $(TARGET))

fuzz-short: $(DEPS)
	$(call fuzzing,fuzz_targets,--short)

# --- has anything become slower? -------------------------------------------------------------------------------------

# make can only say 2 where the program says 3, 4 or 5: what it printed last is the verdict.
track: build/release/build.ninja
	$(call compile,release,hausbench hausbench_commit kernel_bench)
	$(call fetch_for,tracking)
	"$(HAUSBENCH_PROGRAM)" track --base "$(BASE)" $(TRACK_ARGS)

# The tiers that need no clock. Where the baseline does not know this compiler and these libraries, instructions are not measured.
track-counts: build/release/build.ninja
	$(call compile,release,hausbench hausbench_commit kernel_bench)
	$(call fetch_for,tracking)
	"$(HAUSBENCH_PROGRAM)" track --tiers counters,instructions

# REVS: commits that are measured first, in turn.
history: $(DEPS)
	$(PYTHON) -m bench.tracking.history $(if $(REVS),--measure $(REVS))

bisect: $(DEPS)
	$(PYTHON) -m bench.tracking.bisection --case "$(CASE)" --good "$(GOOD)" --bad "$(BAD)"

# clang-tidy reads the flags of each file from build/debug/compile_commands.json (build/release compiles several files at once); the plug-in of the
# tests is a project of its own, and the recorder is not a part of that build.
tidy: build/debug/build.ninja
	@command -v clang-tidy >/dev/null || { echo 'tidy: please run: sudo apt-get install clang-tidy' >&2; exit 1; }
	printf '%s\n' $(filter-out tests/outside_plugin/% datasets/recorder/% $(if $(wildcard /usr/include/embree3),,bench/rival_embree.cpp),$(CPP_FILES)) | xargs -P $(JOBS) -n 1 clang-tidy -p build/debug --quiet

format: $(DEPS)
	clang-format -i $(CPP_FILES) $(HEADERS)

# Changes nothing; fails and shows the lines where `make format` would change something.
format-check: $(DEPS)
	@clang-format --dry-run --Werror $(CPP_FILES) $(HEADERS)

# --- benchmarks of the kernels ------------------------------------------------------------------------------------------

# cmake looks again whether Embree is there. Without it, or without a model, the rest is measured, and kernel_compare says
# what is missing.
define build_bench
@cmake --preset release > /dev/null
$(call compile,release,hausbench hausbench_commit kernel_bench kernel_compare)
-$(FETCH)
endef

bench: build/release/build.ninja
	$(build_bench)
	build/release/kernel_bench --meshes=torus:187,bunny,dragon,bunny+1,bunny+1e3,bunny+1e6,bunny+1e9,bunny+1e12 $(BENCH_ARGS)
	build/release/kernel_compare > build/release/kernels.csv
	$(PYTHON) -m bench.report build/release/kernels.csv

# Takes a quarter of an hour: the older version is built too. Files are replaced only when all is measured.
bench-reference: build/release/build.ninja
	$(build_bench)
	build/release/kernel_compare > build/release/kernels.csv
	$(PYTHON) -m bench.tracking.versions $(VERSIONS_ARGS) > build/release/kernels_versions.csv
	$(PYTHON) -m bench.report build/release/kernels.csv build/release/kernels_versions.csv > build/release/kernels.md
	cp build/release/kernels.csv build/release/kernels_versions.csv build/release/kernels.md results/reference/

clean:
	rm -rf build .stamps .mypy_cache .pytest_cache
	[ ! -e .git ] || git worktree prune
	find . -name __pycache__ -not -path './.git/*' -prune -exec rm -rf {} +

.DEFAULT:
	@echo "make: there is no target or experiment '$@'; \`make help\` lists them" >&2; exit 2
