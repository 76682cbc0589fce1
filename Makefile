# The face of malus. `make help` lists what it can do.
# Everything real is in CMakeLists.txt; this file installs what is missing and calls CMake.

MAKEFLAGS += --no-print-directory
BUILD  := build
NEED   ?= doc/weaver/need.sh
JOBS   ?= $(shell nproc)
GENERATOR = $(if $(shell command -v ninja),-G Ninja)
CONFIGURE = $(GENERATOR) $(if $(CI),-DMALUS_WERROR=ON)

# The Debian 12 packages that we need: to build and run; to weave the book, and to test its weaver.
# The scripts name /usr/bin/python3, for which Debian's modules are installed: another Python may come first in PATH.
PROGRAM := g++ cmake ninja-build noweb python3 python3-jinja2 gnuplot-nox libeigen3-dev libfmt-dev nlohmann-json3-dev \
           libcli11-dev libboost-dev librandom123-dev libgtest-dev librapidcheck-dev libbenchmark-dev \
           libembree-dev libopenexr-dev libpng-dev zlib1g-dev libtbb-dev libtinyobjloader-dev libyaml-cpp-dev libvalijson-dev libnova-dev libnetcdf-dev libopenimageio-dev libassimp-dev libgdal-dev \
           python3-dev pybind11-dev python3-numpy python3-xarray python3-matplotlib
BOOK    := latexml universal-ctags python3-lxml python3-pybtex fonts-texgyre fonts-texgyre-math
# other people's readers of our cubes, judges of HTML and manual pages, and shells, for the tests alone
TEST    := python3-gdal python3-spectral python3-pytest python3-netcdf4 python3-zarr tidy groff-base zsh fish
# what several processes talk by: in the packages and in make cluster-test; everything else can do without
MPI     := libopenmpi-dev
# the tests look at every page in it; where it cannot be had they say so
BROWSER := chromium
# what compiles the live figures of the book; without it the static figures stay
LIVE    := emscripten

# Further packages for the book on paper: make pdf requires them, and the tests use them if they are installed.
PAPER   := texlive-luatex texlive-latex-recommended fonts-dejavu-core librsvg2-bin

.PHONY: all prose test book pdf site reproduce bench bench-build format format-check lint dist install deb wheel deb-twice ladder sanitize sanitize-core tsan mutants clang coverage fuzz soak cluster-test fresh-machine clean help
.PHONY: need-mpi need-program need-book need-test need-browser need-live look-live need-press need-paper
.DEFAULT_GOAL := all
.NOTPARALLEL:

all: need-book $(BUILD)/CMakeCache.txt look-live ## build, reproduce the thesis, weave the book, print the verdict
	@cmake --build $(BUILD) -j $(JOBS) --target everything
	@cat $(BUILD)/report/summary.txt
	@command -v em++ >/dev/null || echo "The book's figures do not move: install $(LIVE) and run make again."
	@echo "The report: $(BUILD)/report/report.html"
	@echo "The book:   $(BUILD)/book/index.html"

test: need-test need-browser need-live need-press $(BUILD)/CMakeCache.txt look-live ## build and run all tests, the weaver's and the book's as well
	@cmake --build $(BUILD) -j $(JOBS) --target all everything $(PRESS)
	@ctest --test-dir $(BUILD) -j $(JOBS) --output-on-failure --progress

book: need-book $(BUILD)/CMakeCache.txt look-live ## weave the book (HTML)
	@cmake --build $(BUILD) -j $(JOBS) --target book
	@echo "The book: $(BUILD)/book/index.html"

pdf: need-paper $(BUILD)/CMakeCache.txt ## weave the book for paper (two PDFs)
	@cmake --build $(BUILD) -j $(JOBS) --target pdf
	@echo "The book: $(BUILD)/malus-1.pdf, $(BUILD)/malus-2.pdf"

PRESS = $(shell command -v lualatex >/dev/null && command -v rsvg-convert >/dev/null && echo pdf)
site: need-book $(BUILD)/CMakeCache.txt look-live ## all that can be read, for a static host: book, report, PDFs if TeX is there, packages that were made
	@cmake --build $(BUILD) -j $(JOBS) --target book reproduce $(PRESS)
	@cmake --build $(BUILD) --target site
	@echo "The site: $(BUILD)/site/index.html"

reproduce: need-program $(BUILD)/CMakeCache.txt ## reproduce the thesis, without the book
	@cmake --build $(BUILD) -j $(JOBS) --target reproduce
	@cat $(BUILD)/report/summary.txt
	@echo "The report: $(BUILD)/report/report.html"

bench: need-program $(BUILD)/CMakeCache.txt ## measure pictures and inner loops beside bare loops, print the ratios
	@cmake --build $(BUILD) -j $(JOBS) --target malus malus_image_bench malus_bench malus_sky_bench
	@$(BUILD)/malus_image_bench
	@$(BUILD)/malus_bench
	@$(BUILD)/malus_sky_bench
	@tests/bench/commands.py $(BUILD)/malus $(BUILD)/commands.csv
	@$(NEED) valgrind
	@tests/bench/instructions.py $(BUILD)/malus $(BUILD)/instructions.csv
	@! [ -d $(BUILD)/python/malus ] || PYTHONPATH=$(BUILD)/python /usr/bin/python3 tests/bench/python.py

bench-build: need-test need-browser ## build HEAD afresh in build-bench, run its tests, edit it; record the seconds of each part
	@tests/bench/build.py build-bench $(JOBS)

format: ## let clang-format format the chapters' code and the tests
	@$(NEED) clang-format noweb python3
	@doc/weaver/format.py $(shell git ls-files '*.nw')
	@clang-format -i $(shell git ls-files 'tests/*.cpp' 'tests/*.hpp')

PREFIX  ?= /usr/local
BASELINE ?= x86-64-v2
install: need-program $(BUILD)/CMakeCache.txt ## install programs, libraries, headers and data (PREFIX=/usr/local, DESTDIR=)
	@cmake --build $(BUILD) -j $(JOBS) --target programs
	@cmake/install.sh $(BUILD) "$(PREFIX)" "$(DESTDIR)" "$(BASELINE)" $(JOBS) $(GENERATOR)

empty :=
comma := ,
deb: need-book need-mpi ## Debian packages of programs, library, Python module and book, in build/deb
	@$(NEED) debhelper dh-python dpkg-dev
	@rm -rf $(BUILD)/deb && mkdir -p $(BUILD)/deb/malus && cp -r debian $(BUILD)/deb/malus/
	@sed 's/@BUILD@/$(subst $(empty) ,$(comma) ,$(strip $(PROGRAM) $(MPI) $(BOOK)))/' debian/control.in >$(BUILD)/deb/malus/debian/control
	@cd $(BUILD)/deb/malus && TOP=$(CURDIR) JOBS=$(JOBS) dpkg-buildpackage -b -d -us -uc >../build.log 2>&1 || { tail -n 30 ../build.log; exit 1; }
	@ls $(BUILD)/deb/*.deb

wheel: need-program $(BUILD)/CMakeCache.txt ## the Python module as a wheel, with the libraries and data that it needs, in build/wheel
	@rm -rf $(BUILD)/wheel
	@$(MAKE) install NEED=true PREFIX=/usr DESTDIR=$(CURDIR)/$(BUILD)/wheel/root >/dev/null
	@python/backend.py $(BUILD)/wheel/root $(BUILD)/wheel

deb-twice: need-book need-mpi ## build HEAD in two places: packages, wheel and source archive are the same bytes
	@$(NEED) debhelper dh-python dpkg-dev
	@tests/twice.sh $(CURDIR) "BASELINE=$(BASELINE)"

ladder: need-program $(BUILD)/CMakeCache.txt ## link each floor with those below it and no others
	@cmake --build $(BUILD) -j $(JOBS) --target ladder
	@echo "No floor needs one above it."

format-check: ## whether the chapters' code and the tests are formatted so
	@$(NEED) clang-format noweb python3
	@doc/weaver/format.py --check $(shell git ls-files '*.nw')
	@clang-format --dry-run -Werror $(shell git ls-files 'tests/*.cpp' 'tests/*.hpp')

LIST ?=
prose: ## count the mannerisms of English in chapters, messages, comments and README files (LIST=PATTERN lists one)
	@doc/weaver/prose.py $(if $(LIST),--list "$(LIST)") $(shell git ls-files '*.nw' '*.md' 'doc/book/*.tex' '*.py' | grep -v prose)

lint: ## check types, names and style of the Python (module, weaver, tests, scenes)
	@$(NEED) mypy pylint pycodestyle python3-jinja2 python3-lxml python3-pybtex python3-numpy python3-xarray python3-matplotlib python3-pytest
	@mypy --config-file doc/weaver/setup.cfg $(shell git ls-files '*.py')
	@pycodestyle --config doc/weaver/setup.cfg $(shell git ls-files '*.py')
	@pylint --rcfile=doc/weaver/setup.cfg --score=no $(shell git ls-files '*.py')

# SITE=no: without the site, as pip needs it
dist: $(if $(filter no,$(SITE)),need-program,site) $(BUILD)/CMakeCache.txt ## a source archive with the tangled C++ and the site inside (SITE=no: the sources alone)
	@SITE=$(if $(filter no,$(SITE)),,$(CURDIR)/$(BUILD)) cmake --build $(BUILD) -j $(JOBS) --target dist

# what clang++ needs besides for its sanitizers
CLANG := clang libclang-rt-14-dev

sanitize: need-test ## all tests but the book's under the address and undefined-behaviour sanitizers (by clang++)
	@$(NEED) $(CLANG)
	@cmake --preset sanitize $(CONFIGURE) >/dev/null
	@began=$$(date +%s) && cmake --build build-sanitize -j $(JOBS) && \
	ctest --test-dir build-sanitize -LE book -j $(JOBS) --output-on-failure --progress && \
	tests/clean-run.sh "make sanitize" build-sanitize $$began

sanitize-core: need-test ## the same for the tests that reach most code for their time (tests/core.txt)
	@$(NEED) $(CLANG)
	@cmake --preset sanitize-core $(CONFIGURE) >/dev/null
	@cmake --build build-sanitize-core -j $(JOBS)
	@ctest --test-dir build-sanitize-core -j $(JOBS) --output-on-failure --progress

tsan: need-test ## the tests that run in several threads (tests/threads.txt) under the thread sanitizer
	@cmake --preset tsan $(CONFIGURE) >/dev/null
	@began=$$(date +%s) && cmake --build build-tsan -j $(JOBS) && \
	ctest --test-dir build-tsan -j $(JOBS) --output-on-failure --progress && \
	tests/clean-run.sh "make tsan" build-tsan $$began

MUTANTS ?= 400
mutants: need-test $(BUILD)/CMakeCache.txt ## plant small faults in the chapters (MUTANTS=400; AGAIN=1: survivors only), and count those noticed
	@cmake --build $(BUILD) -j $(JOBS) --target all
	@tests/mutants.py $(BUILD) --count $(MUTANTS) --jobs $(JOBS) --report $(BUILD)/mutants.csv $(if $(AGAIN),--again)

clang: need-test ## all tests as compiled by clang++
	@$(NEED) clang
	@cmake --preset clang $(CONFIGURE) >/dev/null
	@cmake --build build-clang -j $(JOBS)
	@ctest --test-dir build-clang -LE book -j $(JOBS) --output-on-failure --progress

coverage: need-test ## which lines of nw/ the tests reach
	@cmake --preset coverage $(CONFIGURE) >/dev/null
	@cmake --build build-coverage -j $(JOBS)
	@find build-coverage -name '*.gcda' -delete
	@ctest --test-dir build-coverage -LE book -j $(JOBS) --output-on-failure --progress
	@doc/weaver/coverage.py build-coverage

FUZZ_SECONDS ?= 600
fuzz: need-program ## throw mutilated scenes, meshes, tables and measured files at the readers (FUZZ_SECONDS=600 in all)
	@$(NEED) $(CLANG)
	@cmake --preset fuzz $(CONFIGURE) >/dev/null
	@cmake --build build-fuzz -j $(JOBS)
	@tests/fuzz/run.sh build-fuzz $(FUZZ_SECONDS)

SOAK_SECONDS ?= 600
soak: need-program $(BUILD)/CMakeCache.txt ## kill, resume, fill the disk and race writers, and compare bits (SOAK_SECONDS=600)
	@cmake --build $(BUILD) -j $(JOBS) --target malus
	@tests/soak.py $(BUILD)/malus $(SOAK_SECONDS)

cluster-test: need-program need-mpi $(BUILD)/CMakeCache.txt ## run the recipes of examples/cluster on a Slurm of this machine alone, and mpirun (as root), and compare bits
	@$(NEED) slurmctld slurmd slurm-client munge openmpi-bin
	@cmake --build $(BUILD) -j $(JOBS) --target malus
	@tests/cluster.py $(BUILD)/malus . $(BUILD)/ranks.csv
	@echo "The record is $(BUILD)/ranks.csv. If the machine did nothing else: cp $(BUILD)/ranks.csv validation/"

# both prove it; the packages take minutes where they are built already, the source an hour
fresh-machine: $(if $(filter source,$(STEP)),,deb wheel) ## prove packages, wheel and source in minimal Debian roots (as root; STEP=packages or source: one)
	@$(if $(filter source,$(STEP)),,tests/fresh-machine.sh --packages)
	@$(if $(filter packages,$(STEP)),,tests/fresh-machine.sh)

clean: ## remove everything that was made
	rm -rf $(BUILD) $(BUILD)-* dist
	find generated -mindepth 1 ! -name README.md -delete

help: ## this list
	@echo 'malus: polarimetric image simulation as an executable book'
	@echo
	@awk -F ':.*## ' '/^[a-z-]+:.*## / {printf "  make %-14s %s\n", $$1, $$2}' $(MAKEFILE_LIST)

$(BUILD)/CMakeCache.txt:
	@cmake --preset release $(CONFIGURE) >$(BUILD).configure.log 2>&1 || { cat $(BUILD).configure.log; exit 1; }
	@rm -f $(BUILD).configure.log

need-program:
	@$(NEED) $(PROGRAM)

# (a build that was configured without it looks again)
need-mpi:
	@$(NEED) $(MPI)
	@test ! -e $(BUILD)/CMakeCache.txt || cmake $(BUILD) >/dev/null 2>&1

need-book:
	@$(NEED) $(PROGRAM) $(BOOK)

need-test:
	@$(NEED) $(PROGRAM) $(BOOK) $(TEST)

need-browser:
	@$(NEED) $(BROWSER) || echo "The book's pages are not looked at in a browser."

need-live:
	@$(NEED) $(LIVE) || echo "The book's figures do not move."

# (a build that was configured without it looks again)
look-live:
	@! command -v em++ >/dev/null || ! grep -q 'MALUS_EMSCRIPTEN:.*NOTFOUND' $(BUILD)/CMakeCache.txt || cmake $(BUILD) >/dev/null

need-press:
	@$(NEED) $(PAPER) || echo "The book is not printed, and so what LaTeX says of it is not heard."

need-paper:
	@$(NEED) $(PROGRAM) $(BOOK) $(PAPER)
