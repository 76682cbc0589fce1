# The face of malus. `make help` lists what it can do.
# Everything real is in CMakeLists.txt; this file installs what is missing and calls CMake.

MAKEFLAGS += --no-print-directory
BUILD  := build
NEED   ?= doc/loom/need.sh
JOBS   ?= $(shell nproc)

# What Debian 12 calls the things we stand on. PROGRAM: to build and test; BOOK: to weave the book.
PROGRAM := g++ cmake ninja-build noweb python3 gnuplot-nox libeigen3-dev libfmt-dev nlohmann-json3-dev \
           libcli11-dev libboost-dev librandom123-dev libgtest-dev librapidcheck-dev libbenchmark-dev
BOOK    := latexml fonts-lmodern

.PHONY: all test book bench format dist clean help install sanitize clang coverage fresh-machine need-program need-book
.DEFAULT_GOAL := all

all: need-book $(BUILD)/build.ninja  ## build, reproduce the thesis, weave the book, print the verdict
	@cmake --build $(BUILD) -j $(JOBS) --target everything

test: need-program $(BUILD)/build.ninja  ## build and run all tests
	@cmake --build $(BUILD) -j $(JOBS)
	@ctest --test-dir $(BUILD) -j $(JOBS) --output-on-failure

$(BUILD)/build.ninja:
	@cmake --preset release -G Ninja >$(BUILD).configure.log 2>&1 || { cat $(BUILD).configure.log; exit 1; }
	@rm -f $(BUILD).configure.log

need-program:
	@$(NEED) $(PROGRAM)

need-book:
	@$(NEED) $(PROGRAM) $(BOOK)

clean:  ## remove everything that was made
	rm -rf $(BUILD) $(BUILD)-* dist
	find generated -mindepth 1 ! -name README.md -delete

help:  ## this list
	@echo 'malus: polarimetric image simulation as an executable book'; echo
	@awk -F ':.*## ' '/^[a-z-]+:.*## / {printf "  make %-14s %s\n", $$1, $$2}' $(MAKEFILE_LIST)
