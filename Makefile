# starcontour: builds, tests and installs everything. `make help` lists targets and variables.
#
# SPDX-License-Identifier: MIT
#
# What is compiled into the library stands in lib/sources.list, which CMakeLists.txt reads as well;
# version numbers stand in include/starcontour.h. Nothing is configured beforehand: libraries that
# only parts need (METIS, assimp, cJSON, zlib) are looked for on each run; one line says what is
# left out.

# The default goal, whatever comes first below.
all:

# ------------------------------------------------------------------------------------------------
# `make deps test`: what is installed can only be seen by a make that starts after it was, so the
# other goals are handed to a second make.

later := $(filter-out deps,$(MAKECMDGOALS))
ifneq ($(and $(filter deps,$(MAKECMDGOALS)),$(later)),)

.PHONY: deps after-deps $(later)
$(later): after-deps
	@:
after-deps: deps
	@$(MAKE) --no-print-directory $(later)
deps:
	@CC='$(CC)' CXX='$(CXX)' CPPFLAGS='$(CPPFLAGS)' WITH='$(with)' tools/deps.sh

else

# ------------------------------------------------------------------------------------------------
# Variables. Those that `make help` lists are the caller's.

config ?= release
BUILD ?= build
PREFIX ?= /usr/local
BINDIR ?= $(PREFIX)/bin
LIBDIR ?= $(PREFIX)/lib
INCLUDEDIR ?= $(PREFIX)/include
MANDIR ?= $(PREFIX)/share/man
DOCDIR ?= $(PREFIX)/share/doc/starcontour
WERROR ?= 0
V ?= 0
INSTALL ?= install
OBJCOPY ?= objcopy
PYTHON ?=
MINGW ?= x86_64-w64-mingw32

comma := ,
# Make's versions differ in what they take for a comment within $(shell ...).
hash := \#

Q := $(if $(filter 1,$(V)),,@)

warnings := -Wall -Wextra -Wpedantic -Wshadow -Wundef -Wvla -Wcast-qual -Wcast-align \
    -Wwrite-strings -Wmissing-prototypes -Wstrict-prototypes -Wconversion -Wdouble-promotion \
    -Wc++-compat
cxx_warnings := -Wall -Wextra -Wpedantic -Wshadow -Wundef -Wold-style-cast -Wconversion
werror := $(if $(filter 1,$(WERROR)),-Werror)

# The exact predicates and the error bounds count every rounding: no contraction of a * b + c into
# one operation with one rounding, and never -ffast-math.
exact := -ffp-contract=off

ifeq ($(config),release)
    mode := -O3 -g -DNDEBUG
    test_mode := -O2 -g
    out := $(BUILD)
else ifeq ($(config),debug)
    mode := -O0 -g -DSC_VALIDATE
    test_mode := $(mode)
    out := $(BUILD)/debug
else ifeq ($(config),sanitize)
    mode := -O1 -g -DSC_VALIDATE -fno-omit-frame-pointer -fsanitize=address,undefined -fno-sanitize-recover=all
    test_mode := $(mode)
    out := $(BUILD)/sanitize
else
    $(error config=$(config): must be release, debug or sanitize)
endif

# One set of objects serves the static and the shared library, so all are position-independent.
common := -std=c99 $(exact) -fPIC -fvisibility=hidden $(warnings) $(werror)
link_mode := $(filter -fsanitize%,$(mode))

work := $(BUILD)/$(config)
obj := $(work)/obj
bin := $(out)/bin
lib := $(out)/lib

# ------------------------------------------------------------------------------------------------
# Version and names.

number = $(shell sed -n 's/^$(hash)define SC_VERSION_$(1) \([0-9][0-9]*\)$$/\1/p' include/starcontour.h)
major := $(call number,MAJOR)
minor := $(call number,MINOR)
version := $(major).$(minor).$(call number,PATCH)
# Before 1.0 a new minor number may break the binary interface.
abi := $(if $(filter 0,$(major)),$(major).$(minor),$(major))

static := $(lib)/libstarcontour.a
ifeq ($(shell uname -s),Darwin)
    shared_name := libstarcontour.$(version).dylib
    soname := libstarcontour.$(abi).dylib
    shared_link := libstarcontour.dylib
    shared_flags = -dynamiclib -Wl,-install_name,$(LIBDIR)/$(soname)
else
    shared_name := libstarcontour.so.$(version)
    soname := libstarcontour.so.$(abi)
    shared_link := libstarcontour.so
    shared_flags = -shared -Wl,-soname,$(soname)
endif
shared := $(lib)/$(shared_name)
metis_static := $(lib)/libstarcontour_metis.a

# ------------------------------------------------------------------------------------------------
# What is there.

has = $(shell echo '$(hash)include <$(1)>' | \
    $(CC) $(CPPFLAGS) $(CFLAGS) -E -x c - >/dev/null 2>&1 && echo yes)
metis := $(call has,metis.h)
assimp := $(call has,assimp/cimport.h)
cjson := $(call has,cjson/cJSON.h)
zlib := $(call has,zlib.h)
gmp := $(call has,gmp.h)
ccd := $(call has,ccd/ccd.h)

core_sources := $(shell sed -e 's/$(hash).*//' lib/sources.list)
# Without METIS this small library is there all the same, and answers SC_ERROR_UNSUPPORTED.
metis_source := $(wildcard lib/build/partition_metis.c)
metis_library := $(if $(metis_source),$(metis_static))
with_metis := $(if $(metis),-DSC_WITH_METIS)
metis_link := $(metis_library) $(static) $(if $(metis),-lmetis)

program_sources := tools/sc_query.c tools/sc_partition.c bench/demo.c bench/sc_bench.c \
    bench/against.c bench/sc_objects.c bench/sc_dataset.c \
    meshes/make_meshes.c meshes/subdivide.c
# What writes pages carries tools/page/page.html inside, and is linked only where it is used.
page_support := tools/page_write.c tools/page_picture.c tools/page_output.c tools/trace_query.c \
    tools/page_bytes.c
tools_support := $(filter-out $(program_sources) $(page_support),$(wildcard tools/*.c))
bench_support := $(filter-out $(program_sources),$(wildcard bench/*.c bench/scenes/*.c))
tests := $(sort $(wildcard tests/test_*.c))
# These hold kernels, and take the longest to compile: each is linked only with what asks for it.
lanes_support := $(wildcard tests/lanes_*.c)
rounding_support := $(wildcard tests/rounding_*.c)
tests_support := $(filter-out $(tests) $(lanes_support) $(rounding_support),$(wildcard tests/*.c))
test_scripts := $(sort $(wildcard tests/test_*.sh))

# A program is built if its source is there and what it needs is: those that read meshes share
# tools/, which reads by assimp, unpacks by zlib and writes JSON by cJSON.
missing_for_programs := $(if $(assimp),,assimp) $(if $(cjson),,cJSON) $(if $(zlib),,zlib)
offered = $(if $(wildcard $(2)),$(bin)/$(1))
mesh_readers := $(call offered,sc-query,tools/sc_query.c) \
    $(call offered,sc-partition,tools/sc_partition.c) $(call offered,sc-demo,bench/demo.c) \
    $(call offered,sc-bench,bench/sc_bench.c) $(call offered,sc-against,bench/against.c) \
    $(call offered,sc-objects,bench/sc_objects.c) $(call offered,sc-dataset,bench/sc_dataset.c) \
    $(call offered,subdivide,meshes/subdivide.c)
programs := $(call offered,make-meshes,meshes/make_meshes.c) \
    $(if $(strip $(missing_for_programs)),,$(mesh_readers))
installed := $(filter %/sc-query %/sc-partition,$(programs))

objects = $(patsubst %.c,$(obj)/%.o,$(1))

# ------------------------------------------------------------------------------------------------
# The library and the programs.

.PHONY: all
all: $(static) $(lib)/$(shared_link) $(metis_library) $(programs) ## libraries, programs (default)
ifeq ($(metis),)
	@echo "not found: METIS; libstarcontour_metis.a can only say so ('make deps')"
endif
ifneq ($(strip $(missing_for_programs)),)
	@echo "not found: $(strip $(missing_for_programs)); left out: $(notdir $(mesh_readers)) ('make deps')"
endif

# Objects are made again when compiler or flags change.
.PHONY: FORCE
$(obj)/flags: FORCE
	@mkdir -p $(@D)
	@echo '$(subst ','\'',$(CC) $(CXX) $(CPPFLAGS) $(CFLAGS) $(common) $(mode) $(with_metis))' > $@.new
	@cmp -s $@.new $@ && rm -f $@.new || mv -f $@.new $@

$(obj)/lib/%.o: own = -Iinclude -Ilib $(mode)
$(obj)/lib/build/partition_metis.o: own = -Iinclude -Ilib $(mode) $(with_metis)
$(obj)/tools/%.o: own = -Iinclude -Itools $(mode)
$(obj)/bench/%.o: own = -Iinclude -Itools -Ibench $(mode)
$(obj)/meshes/%.o: own = -Iinclude -Itools -Imeshes $(mode)
$(obj)/tests/%.o: own = -Iinclude -Ilib -Itests $(test_mode) $(with_metis)
$(obj)/tests/bench/%.o: own = -Iinclude -Itools -Ibench -Itests $(test_mode)

# What measurements name: commit (+: with changes), compiler and flags.
quoted = $(subst ",\",$(subst \,\\,$(1)))
$(work)/build_info.h: FORCE
	@mkdir -p $(@D)
	@{ printf '#define BUILD_COMMIT "%s"\n' "$$(git describe --always --abbrev=12 --dirty=+ --exclude='*' 2>/dev/null || echo unknown)"; \
	    printf '#define BUILD_COMPILER "%s"\n' "$$($(CC) --version | head -n 1 | tr -d '"\\')"; \
	    printf '#define BUILD_FLAGS "%s"\n' \
	    '$(subst ','\'',$(call quoted,$(strip $(exact) $(mode) $(CPPFLAGS) $(CFLAGS))))'; } > $@.new
	@cmp -s $@.new $@ && rm -f $@.new || mv -f $@.new $@
$(obj)/bench/report.o: $(work)/build_info.h
$(obj)/bench/report.o: own += -I$(work)

$(obj)/%.o: %.c $(obj)/flags
	@mkdir -p $(@D)
	$(if $(Q),@echo "  cc   $<")
	$(Q)$(CC) $(common) $(own) $(CPPFLAGS) $(CFLAGS) -MMD -MP -c -o $@ $<

# A page of HTML as an array: C99 promises no strings as long as that.
$(work)/page_bytes.c: tools/page/page.html
	@mkdir -p $(@D)
	@{ echo '#include "page_bytes.h"'; echo 'const unsigned char page_bytes[] = {'; \
	    od -An -v -tu1 $< | sed 's/\([0-9]\)\( \|$$\)/\1,\2/g'; echo '};'; \
	    echo 'const size_t page_bytes_size = sizeof page_bytes;'; } > $@.new
	@mv -f $@.new $@
$(obj)/tools/page_bytes.o: $(work)/page_bytes.c $(obj)/flags
	@mkdir -p $(@D)
	$(if $(Q),@echo "  cc   $<")
	$(Q)$(CC) $(common) -Itools $(mode) $(CPPFLAGS) $(CFLAGS) -MMD -MP -c -o $@ $<

$(static): $(call objects,$(core_sources)) lib/sources.list
	@mkdir -p $(@D)
	$(if $(Q),@echo "  ar   $@")
	$(Q)rm -f $@ && $(AR) rcs $@ $(filter %.o,$^)

$(shared): $(call objects,$(core_sources)) lib/sources.list
	@mkdir -p $(@D)
	$(if $(Q),@echo "  ld   $@")
	$(Q)$(CC) $(shared_flags) $(link_mode) $(CFLAGS) $(LDFLAGS) -o $@ $(filter %.o,$^) $(LDLIBS) -lm

$(lib)/$(shared_link): $(shared)
	@ln -sf $(shared_name) $(lib)/$(soname)
	@ln -sf $(soname) $@

$(metis_static): $(call objects,$(metis_source))
	@mkdir -p $(@D)
	$(if $(Q),@echo "  ar   $@")
	$(Q)rm -f $@ && $(AR) rcs $@ $^

# $(call link,libraries): links the objects among the prerequisites.
define link
	@mkdir -p $(@D)
	$(if $(Q),@echo "  ld   $@")
	$(Q)$(CC) $(link_mode) $(CFLAGS) $(LDFLAGS) -o $@ $(filter %.o,$^) $(1) $(LDLIBS) -lm
endef

mesh_libs := $(metis_link) -lassimp -lcjson -lz -lpthread
# dlopen is in libc, or in a libdl of its own where that is old.
$(bin)/sc-against: mesh_libs += $(if $(filter Linux,$(shell uname -s)),-ldl)
$(bin)/sc-query: $(call objects,tools/sc_query.c $(tools_support) $(page_support))
$(bin)/sc-partition: $(call objects,tools/sc_partition.c $(tools_support))
$(bin)/sc-demo: $(call objects,bench/demo.c $(bench_support) $(tools_support) $(page_support))
$(bin)/sc-bench: $(call objects,bench/sc_bench.c $(bench_support) $(tools_support))
$(bin)/sc-against: $(call objects,bench/against.c bench/scene_folder.c $(tools_support))
$(bin)/sc-objects: $(call objects,bench/sc_objects.c bench/scene_folder.c $(tools_support))
$(bin)/sc-dataset: $(call objects,bench/sc_dataset.c bench/scene_folder.c bench/scenes/character.c \
    $(tools_support))
$(bin)/subdivide: $(call objects,meshes/subdivide.c $(tools_support))
$(bin)/make-meshes: $(call objects,meshes/make_meshes.c)
$(mesh_readers): $(static) $(metis_library)
	$(call link,$(mesh_libs))
$(bin)/make-meshes:
	$(call link)

# ------------------------------------------------------------------------------------------------
# Dependencies, demo, meshes.

.PHONY: deps
deps: ## install what is missing to build and test everything (says first what that is)
	@CC='$(CC)' CXX='$(CXX)' CPPFLAGS='$(CPPFLAGS)' WITH='$(with)' tools/deps.sh

.PHONY: demo
ifneq ($(strip $(missing_for_programs)),)
demo: ## collisions of deforming cloth and bunny, frame by frame, and pages to look at them
	@echo "make demo needs $(strip $(missing_for_programs)): run 'make deps' first" >&2; exit 1
else
demo: $(programs)
	@meshes/fetch.sh build/meshes $(bin)/subdivide || echo "no downloaded meshes: the demo goes on with what is there" >&2
	$(bin)/sc-demo
endif

.PHONY: bench-report
bench-report: ## make that report anew from its CSV files and build/peers/peers.csv
	@PYTHON='$(PYTHON)' bench/run_bench.sh report

.PHONY: bench bench-quick
ifneq ($(strip $(missing_for_programs)),)
bench: ## measure all methods on all scenes; report and plots in bench/results/<machine>; half an hour
bench-quick: ## a small version of bench, in build/bench-quick; two minutes
bench bench-quick:
	@echo "make $@ needs $(strip $(missing_for_programs)): run 'make deps with=bench' first" >&2; exit 1
else
bench bench-quick: $(programs)
	@meshes/fetch.sh build/meshes $(bin)/subdivide >/dev/null 2>&1 || echo "not all real meshes could be fetched: scenes made of them are skipped" >&2
	@SC_BIN='$(bin)' PYTHON='$(PYTHON)' bench/run_bench.sh $(if $(filter bench,$@),full,quick)
endif

REV ?=
AGAINST ?=

.PHONY: bench-against
ifneq ($(strip $(missing_for_programs)),)
bench-against: ## time another commit, REV, and this tree on the same frames, in turns; about ten minutes
	@echo "make $@ needs $(strip $(missing_for_programs)): run 'make deps' first" >&2; exit 1
else
bench-against: $(programs) $(lib)/$(shared_link)
	@meshes/fetch.sh build/meshes $(bin)/subdivide >/dev/null 2>&1 || echo "not all real meshes could be fetched: scenes made of them are skipped"
	@CC='$(CC)' CFLAGS='$(CFLAGS)' MAKE='$(MAKE)' SCENE_DIRS='$(SCENE_DIRS)' \
	    bench/against.sh '$(REV)' '$(bin)/sc-against' '$(bin)/sc-bench' '$(lib)/$(shared_link)' $(AGAINST)
endif

.PHONY: page
page: ## build tools/page/page.html, which sc-query --html writes, anew from its sources (node, npm)
	$(call need,npm,npm)
	@BUILD='$(BUILD)' tools/page/build.sh && ls -l tools/page/page.html

.PHONY: meshes
meshes: $(programs) ## fetch real meshes into build/meshes (Debian packages, no root needed)
	@meshes/fetch.sh build/meshes $(bin)/subdivide

# ------------------------------------------------------------------------------------------------
# Tests: each tests/test_*.c is a program, linked with the other tests/*.c; tests/test_*.sh are
# scripts; header_cxx.cpp uses the header from C++.

missing_for_tests := $(if $(gmp),,gmp) $(if $(ccd),,libccd)
# Those of bench/ see what it sees, and not the library's inside.
bench_tests := $(patsubst tests/%.c,$(work)/tests/%,$(wildcard tests/bench/test_*.c))
test_programs := $(patsubst tests/%.c,$(work)/tests/%,$(tests)) \
    $(patsubst tests/%.cpp,$(work)/tests/%,$(wildcard tests/header_cxx.cpp)) \
    $(if $(strip $(missing_for_programs)),,$(bench_tests))
test_libs := $(metis_link) -lgmp -lccd -lpthread

.PHONY: test
ifneq ($(strip $(missing_for_tests)),)
test: ## build and run all tests; five to ten minutes
	@echo "make test needs $(strip $(missing_for_tests)): run 'make deps' first" >&2; exit 1
else
test: all $(test_programs)
	@meshes/fetch.sh build/meshes $(bin)/subdivide >$(work)/fetch.log 2>&1 || \
	    echo "not all real meshes could be fetched (see $(work)/fetch.log): tests with them are skipped"
	@$(if $(strip $(missing_for_programs)),echo "skipped: $(notdir $(bench_tests)): needs $(strip $(missing_for_programs)) ('make deps')")
	@SKIPPED='$(if $(strip $(missing_for_programs)),$(words $(bench_tests)),0)' CC='$(CC)' SC_CONFIG='$(config)' SC_BIN='$(bin)' SC_LIB='$(lib)' \
	    SC_METIS='$(metis)' SC_FLAGS='$(link_mode) $(CPPFLAGS) $(CFLAGS) $(LDFLAGS)' \
	    tests/run.sh $(test_scripts) $(test_programs)
endif

$(patsubst tests/%.c,$(work)/tests/%,$(tests)): $(work)/tests/%: $(obj)/tests/%.o \
    $(call objects,$(tests_support)) $(static) $(metis_library)
	$(call link,$(test_libs))

# What these take of the others' support: contours and their oracle.
bench_tests_support := $(patsubst %,tests/%.c,bench/scratch harness inputs oracle_weld soups \
    trace_oracle trace_scene traced_pose)
$(bench_tests): $(work)/tests/%: $(obj)/tests/%.o $(call objects,$(bench_tests_support) \
    $(bench_support) $(tools_support)) $(static) $(metis_library)
	$(call link,$(mesh_libs) -lgmp)

$(work)/tests/header_cxx: tests/header_cxx.cpp include/starcontour.h $(obj)/flags $(static)
	@mkdir -p $(@D)
	$(if $(Q),@echo "  c++  $<")
	$(Q)$(CXX) $(cxx_warnings) $(werror) $(exact) $(test_mode) -Iinclude $(CPPFLAGS) $(CXXFLAGS) \
	    $(LDFLAGS) -o $@ $< $(static) $(LDLIBS) -lm

# Comparison with CGAL; by hand, as it takes libraries and meshes that nothing else needs.
missing_for_cgal := $(if $(call has,CGAL/version.h),,CGAL) $(if $(gmp),,gmp) \
    $(if $(assimp),,assimp) $(if $(cjson),,cJSON) $(if $(zlib),,zlib)
cgal_objects := $(call objects,tools/mesh_file.c tools/file_bytes.c tools/ply_read.c \
    tools/polygon_mesh.c tools/scene_read.c tools/stl_read.c tools/text_mesh.c tests/oracle.c \
    tests/harness.c)

.PHONY: test-cgal
ifneq ($(strip $(missing_for_cgal)),)
test-cgal: ## compare pairs with CGAL's on hundreds of real meshes (make deps with=cgal test-cgal); a minute, and the time to fetch them
	@echo "make test-cgal needs $(strip $(missing_for_cgal)): run 'make deps with=cgal' first" >&2; exit 1
else
test-cgal: $(work)/tests/cgal/compare $(programs)
	@meshes/fetch.sh --models build/meshes $(bin)/subdivide
	@tests/cgal/compare_all.sh $< build/meshes $(work)/tests/cgal/not_read.log
endif

$(work)/tests/cgal/compare: tests/cgal/compare.cpp include/starcontour.h tools/mesh_file.h \
    tests/oracle.h $(obj)/flags $(cgal_objects) $(static)
	@mkdir -p $(@D)
	$(if $(Q),@echo "  c++  $<")
	$(Q)$(CXX) -std=c++17 $(cxx_warnings) $(werror) $(exact) -frounding-math $(mode) -Iinclude \
	    -Itools -Itests $(CPPFLAGS) $(CXXFLAGS) $(LDFLAGS) -o $@ $< $(cgal_objects) $(static) \
	    -lassimp -lz -lmpfr -lgmp $(LDLIBS) -lm

# Comparison of steps and of what is near with ipc-toolkit, from PyPI; by hand, too.
.PHONY: test-ipctk
ifneq ($(strip $(missing_for_programs)),)
test-ipctk: ## compare steps and what is near with ipc-toolkit's (PyPI) on all scenes; some minutes
	@echo "make test-ipctk needs $(strip $(missing_for_programs)): run 'make deps' first" >&2; exit 1
else
test-ipctk: $(lib)/$(shared_link) $(programs)
	@meshes/fetch.sh build/meshes $(bin)/subdivide >/dev/null 2>&1 || echo "not all real meshes could be fetched: scenes made of them are skipped"
	@tests/ipctk/ipctk.sh '$(bin)/sc-bench' '$(lib)/$(shared_link)' '$(BUILD)'
endif

# Programs that people already use, from PyPI and Debian, with the library inside.
addon := $(BUILD)/clients/starcontour-blender-$(version).zip

.PHONY: test-clients blender-addon
test-clients: $(lib)/$(shared_link) $(addon) $(programs) ## run programs that use the library inside (PyPI, Bullet; what is there); a few minutes
	@CXX='$(CXX)' SC_QUERY='$(bin)/sc-query' ADDON='$(addon)' tools/clients/clients.sh '$(lib)/$(shared_link)' '$(BUILD)'

blender-addon: $(addon) ## pack the add-on for Blender, for this platform: build/clients/starcontour-blender-VERSION.zip

$(addon): tools/clients/blender/pack.py $(wildcard tools/clients/blender/starcontour_checks/*) \
    $(wildcard tools/python/starcontour/*.py) $(shared)
	@OBJCOPY='$(OBJCOPY)' python3 $< '$(shared)' '$(version)' '$@'

# ------------------------------------------------------------------------------------------------
# Other languages, and one engine, on the shared library.

.PHONY: deps-ffi
deps-ffi: ## install toolchains and modules that test-ffi needs (as deps with=ffi)
	@CC='$(CC)' CXX='$(CXX)' CPPFLAGS='$(CPPFLAGS)' WITH=ffi tools/deps.sh

.PHONY: test-ffi
test-ffi: all ## call the library from C++, Python, LuaJIT, LÖVE, C#, Rust, Go, Java (what is there); some minutes
ifeq ($(config),sanitize)
	@echo "make test-ffi: these programs cannot load a library with sanitizers" >&2; exit 1
else
	@CC='$(CC)' CXX='$(CXX)' tests/ffi/ffi.sh '$(lib)' '$(work)/ffi'
endif

# ------------------------------------------------------------------------------------------------
# Beyond `make test`: fuzzing, soak, other sanitizers, analysis. What is compiled with other flags
# goes into a folder of its own; programs are in tests/fuzz/ and tests/runs/.

CLANG ?= clang
SECONDS ?= 60
SOAK ?= 100000
TRIALS ?= 100000000

fuzz_targets := fuzz_build fuzz_query fuzz_near fuzz_options fuzz_load fuzz_trace
fuzz_sources := tests/fuzz/fuzz_support.c tests/fuzz/trace_checks.c \
    $(patsubst %,tests/fuzz/%.c,$(fuzz_targets))
fuzz_programs := $(patsubst %,$(work)/fuzz/%,$(fuzz_targets))
run_programs := $(patsubst tests/runs/%.c,$(work)/runs/%,$(wildcard tests/runs/*.c))

# $(call variant,FOLDER,VARIABLES,PROGRAMS): builds programs in that folder.
variant = +$(Q)$(MAKE) --no-print-directory config=debug BUILD='$(BUILD)/$(1)' $(2) \
    $(patsubst %,'$(BUILD)/$(1)/debug/%',$(3))

# $(call need,PROGRAM,PACKAGE): says so if it is not there.
need = @command -v $(1) >/dev/null 2>&1 || \
    { echo "make $@ needs $(1) (Debian: apt-get install $(2))" >&2; exit 1; }

# libFuzzer calls LLVMFuzzerTestOneInput, which becomes another name of the target.
$(fuzz_programs): fuzz_entry = -fsanitize=fuzzer -Wl,--defsym=LLVMFuzzerTestOneInput=$(@F)
$(fuzz_programs) $(work)/fuzz/make_seeds: $(call objects,$(fuzz_sources) $(tests_support)) \
    $(static) $(metis_library)
	$(call link,$(fuzz_entry) $(test_libs))
$(work)/fuzz/make_seeds: $(call objects,tests/fuzz/make_seeds.c)
$(work)/tests/test_reproducers: $(call objects,$(fuzz_sources))
$(work)/tests/test_lanes: $(call objects,$(lanes_support))
$(work)/tests/test_rounding $(work)/runs/search_rounding: $(call objects,$(rounding_support))

$(run_programs): $(work)/runs/%: $(obj)/tests/runs/%.o $(call objects,$(tests_support)) \
    $(static) $(metis_library)
	$(call link,$(test_libs))

.PHONY: fuzz
fuzz: ## fuzz each target for SECONDS (clang); findings go to tests/fuzz/reproducers
	$(call need,$(CLANG),clang)
	$(call variant,fuzz,CC='$(CLANG)' CFLAGS='-O2 -fno-omit-frame-pointer \
	    -fsanitize=address$(comma)undefined$(comma)fuzzer-no-link -fno-sanitize-recover=all \
	    -fno-sanitize-coverage=trace-cmp',\
	    fuzz/make_seeds $(patsubst %,fuzz/%,$(fuzz_targets)))
	@tests/fuzz/fuzz.sh '$(BUILD)/fuzz/debug/fuzz' '$(SECONDS)'

.PHONY: soak
soak: $(work)/runs/soak ## SOAK queries on changing poses of one model, in bounded memory; half a minute
	$< $(SOAK)

thread_tests := test_tasks test_task_steps test_near_tasks test_build_tasks test_objects_many test_rooms
.PHONY: search-rounding
search-rounding: $(work)/runs/search_rounding ## which share of each error bound rounding reaches, by TRIALS a bound
	nice -n 10 $< $(TRIALS)

.PHONY: test-thread
test-thread: ## many threads on one model, and in one query, under ThreadSanitizer; two minutes
	+$(Q)$(MAKE) --no-print-directory config=release BUILD='$(BUILD)/thread' CFLAGS='-O1 -fsanitize=thread' \
	    '$(BUILD)/thread/release/runs/thread' $(patsubst %,'$(BUILD)/thread/release/tests/%',$(thread_tests))
	'$(BUILD)/thread/release/runs/thread'
	SC_TEST_SCALE=10 tests/run.sh $(patsubst %,'$(BUILD)/thread/release/tests/%',$(thread_tests))

# Files that take results from libraries without MemorySanitizer are left out, see
# tests/runs/memory_ignore.txt, and so is test_ccd, which is about such a library.
memory_tests := $(patsubst tests/%.c,tests/%,$(filter-out tests/test_ccd.c,$(tests)))

.PHONY: test-memory-clang
test-memory-clang: ## tests, shortened, under MemorySanitizer (clang); all but test_ccd; some minutes
	$(call need,$(CLANG),clang)
	$(call variant,memory,CC='$(CLANG)' CFLAGS='-O1 -fno-omit-frame-pointer -fsanitize=memory \
	    -fno-sanitize-recover=all -fsanitize-ignorelist=tests/runs/memory_ignore.txt',$(memory_tests) runs/soak)
	'$(BUILD)/memory/debug/runs/soak' 3000
	@SC_TEST_SCALE=20 tests/run.sh $(patsubst %,'$(BUILD)/memory/debug/%',$(memory_tests))

valgrind_tests := $(patsubst %,$(work)/tests/test_%,memory input structures reproducers)

.PHONY: test-valgrind
test-valgrind: $(valgrind_tests) ## small tests under valgrind; leaks are errors; two minutes
	$(call need,valgrind,valgrind)
	@for test in $(valgrind_tests); do echo "valgrind $$test"; SC_TEST_SCALE=2 valgrind -q \
	    --leak-check=full --error-exitcode=9 "$$test" >'$(work)/valgrind.log' 2>&1 || \
	    { cat '$(work)/valgrind.log'; exit 1; }; tail -n 1 '$(work)/valgrind.log'; done

determinism := $(call objects,tests/runs/determinism.c $(tests_support))

.PHONY: test-determinism
test-determinism: $(determinism) ## the same pairs by gcc and clang, -O0 to -O3, with and without SIMD; some minutes
	@tests/runs/determinism.sh '$(work)/determinism' $(determinism)

# lib/ without optimization, so that each line is one; conditions that no test can bring about are
# constants, see lib/base/assume.h.
coverage := $(BUILD)/coverage
coverage_tests := $(patsubst tests/%.c,$(coverage)/release/tests/%,$(tests))

.PHONY: coverage
coverage: ## lines and branches of lib/ that the tests run (gcc, AVX-512); fails if any is left out; three quarters of an hour
	$(call need,gcov,gcc)
	+$(Q)$(MAKE) --no-print-directory config=release BUILD='$(coverage)' CC=gcc \
	    mode='-O0 -g -DSC_COVERAGE --coverage -fprofile-update=atomic' test_mode='-O2 -g' \
	    LDFLAGS='$(LDFLAGS) --coverage -Wl$(comma)--exclude-libs$(comma)ALL' \
	    '$(coverage)/lib/$(shared_link)' $(patsubst %,'%',$(coverage_tests))
	@find '$(coverage)/release/obj' -name '*.gcda' -exec rm -f {} +
	@SC_LIB='$(coverage)/lib' tests/run.sh $(coverage_tests)
	@tests/coverage.sh '$(coverage)/release/obj/lib'

.PHONY: mutants
mutants: $(programs) ## plant faults in a copy of lib/ one by one: a test has to fail each time; about an hour
	@meshes/fetch.sh build/meshes $(bin)/subdivide >/dev/null 2>&1 || echo "not all real meshes could be fetched: tests with them are skipped"
	@CC='$(CC)' MAKE='$(MAKE)' tests/mutants/mutants.sh

core_check = $(core_sources) $(metis_source)
bare_flags := -std=c99 $(exact) -Iinclude -Ilib

# gcc 12 warns wrongly in some files: it loses count of loops over three coordinates, and does not
# see that a loop's condition asks for NULL.
analyzer_wrong = $(if $(filter %/bisection.c %/sharing.c %/decide.c %/contacts.c %/kernels_base.c %/kernels_avx2.c %/kernels_avx512.c,$(1)),-Wno-analyzer-use-of-uninitialized-value) \
    $(if $(filter %/partition_metis.c,$(1)),-Wno-analyzer-possible-null-dereference)

.PHONY: analyze-gcc
analyze-gcc: ## gcc -fanalyzer over lib/
	$(call need,gcc,gcc)
	@$(foreach file,$(core_check),gcc $(bare_flags) $(with_metis) $(warnings) -Werror -O1 -fanalyzer \
	    $(call analyzer_wrong,$(file)) -c -o /dev/null $(file) &&) echo "gcc -fanalyzer: nothing found"

# What is left out, and why, stands in lib/.clang-tidy and tools/cppcheck_suppressions.txt.
.PHONY: analyze-tidy
analyze-tidy: ## clang-tidy over lib/
	$(call need,clang-tidy,clang-tidy)
	@clang-tidy --quiet $(core_check) -- $(bare_flags) $(with_metis) 2>/dev/null
	@echo "clang-tidy: nothing found"

.PHONY: analyze-cppcheck
analyze-cppcheck: ## cppcheck over lib/
	$(call need,cppcheck,cppcheck)
	@cppcheck --quiet --std=c99 --platform=unix64 --enable=warning,style,performance,portability \
	    --inconclusive --error-exitcode=1 --suppressions-list=tools/cppcheck_suppressions.txt \
	    -Iinclude -Ilib $(core_check)
	@echo "cppcheck: nothing found"

.PHONY: check-layering
check-layering: ## who may include whom, file names, source list
	@tools/check_layering.sh

.PHONY: docs
docs: ## API pages and guides in build/docs/html, by Doxygen; warnings are errors
	$(call need,doxygen,doxygen)
	@rm -rf '$(BUILD)/docs' && mkdir -p '$(BUILD)/docs'
	@SC_VERSION='$(version)' SC_DOCS='$(BUILD)/docs' doxygen tools/Doxyfile || \
	    { cat '$(BUILD)/docs/warnings.log' >&2; exit 1; }
	@echo '$(BUILD)/docs/html/index.html'

.PHONY: abi-update
abi-update: $(lib)/$(shared_link) ## write the golden files of the binary interface: review the diff
	@CC='$(CC)' tests/abi/goldens.sh tests/abi '$(shared)'

.PHONY: abi-check
abi-check: $(lib)/$(shared_link) ## would programs linked with the last release run with this library?
	@CC='$(CC)' MAKE='$(MAKE)' tests/abi/compare.sh '$(shared)'

.PHONY: format
format: ## clang-format on all C and C++ files, in place
	clang-format -i $(wildcard include/*.h lib/*.[ch] lib/*/*.[ch] tools/*.[ch] tests/*.[ch] \
	    tests/*.cpp tests/*/*.[ch] tests/*/*.cpp tests/*/*/*.cpp bench/*.[ch] bench/*/*.[ch] \
	    bench/*/*.cpp meshes/*.[ch])

# ------------------------------------------------------------------------------------------------
# Peers: other libraries on the same frames, each left out with a message where it is not installed;
# see bench/peers/README.md. They are measured one after the other, whatever -j says. Where no
# SCENES are named, sc-bench writes some into build/.

SCENES ?=
CSV ?= $(BUILD)/peers/peers.csv
LIMIT ?= 30
POSES ?= 200
MEMORY ?= 8

peer_scenes := $(filter %/sc-bench,$(programs))
peer_programs := $(patsubst %,$(work)/peers/%,cgal embree fcl)

$(obj)/bench/peers/cgal.o: peer_flags = -frounding-math
$(obj)/bench/peers/fcl.o: peer_flags = $(patsubst -I%,-isystem %,$(shell pkg-config --cflags-only-I fcl))
$(obj)/bench/peers/objects_driver.o: peer_flags = -Itools
$(obj)/bench/peers/%.o: bench/peers/%.cpp $(obj)/flags
	@mkdir -p $(@D)
	$(if $(Q),@echo "  c++  $<")
	$(Q)$(CXX) -std=c++17 $(cxx_warnings) $(werror) $(exact) $(mode) -Iinclude $(peer_flags) $(CPPFLAGS) \
	    $(CXXFLAGS) -MMD -MP -c -o $@ $<

$(work)/peers/cgal: peer_libs = -ltbb -ltbbmalloc -lmpfr -lgmp
$(work)/peers/embree: peer_libs = -lembree3
$(work)/peers/fcl: peer_libs = $(shell pkg-config --libs fcl)
$(peer_programs) $(work)/peers/brute: $(work)/peers/%: $(obj)/bench/peers/%.o \
    $(obj)/bench/peers/driver.o $(obj)/bench/peers/objects_driver.o $(obj)/bench/peers/triangle_test.o \
    $(obj)/tools/thread_pool.o $(static)
	@mkdir -p $(@D)
	$(if $(Q),@echo "  ld   $@")
	$(Q)$(CXX) $(link_mode) $(CXXFLAGS) $(LDFLAGS) -o $@ $(filter %.o,$^) $(static) $(peer_libs) \
	    $(LDLIBS) -lpthread -lm

# $(call compiled_peer,NAME,HEADERS): measured if its headers are there.
compiled_peer = +@$(if $(filter-out yes,$(foreach header,$(2),$(or $(call has,$(header)),$(header)))), \
    bench/peers/skip.sh '$(CSV)' $(1) "$(2) not found ('make deps with=peers')", \
    $(MAKE) --no-print-directory '$(work)/peers/$(1)' && \
    LIMIT='$(LIMIT)' MEMORY='$(MEMORY)' bench/peers/measure_peer.sh $(1) '$(CSV)' '$(SCENES)' '$(bin)/sc-bench' '$(work)/peers/$(1)')

# $(call python_peer,PACKAGE,SCRIPT): measured if it can be installed into a virtual environment in build/.
python_peer = @bench/peers/venv.sh '$(BUILD)/peers/venv' $(1) '$(CSV)' || { test $$? -eq 3 && exit 0; exit 1; }; \
    LIMIT='$(LIMIT)' MEMORY='$(MEMORY)' bench/peers/measure_peer.sh $(1) '$(CSV)' '$(SCENES)' '$(bin)/sc-bench' \
    '$(BUILD)/peers/venv/bin/python' $(or $(2),bench/peers/peers.py --peer $(1)) --lib '$(lib)/$(shared_link)'

.PHONY: peer-cgal peer-embree peer-fcl
peer-cgal: $(peer_scenes) ## time CGAL's self_intersections beside ours on SCENES, into CSV
	$(call compiled_peer,cgal,CGAL/version.h tbb/scalable_allocator.h gmp.h)
peer-embree: $(peer_scenes) ## the same for Embree's rtcCollide
	$(call compiled_peer,embree,embree3/rtcore.h)
peer-fcl: $(peer_scenes) ## the same for FCL (Flexible Collision Library)
	$(call compiled_peer,fcl,fcl/config.h)

.PHONY: peer-ipctk peer-libigl peer-meshlib peer-open3d peer-pymeshlab peer-python-fcl peer-trueform
peer-ipctk: $(lib)/$(shared_link) $(peer_scenes) ## the same for ipc-toolkit (PyPI)
	$(call python_peer,ipctk)
peer-libigl: $(lib)/$(shared_link) $(peer_scenes) ## the same for libigl (PyPI)
	$(call python_peer,libigl)
peer-meshlib: $(lib)/$(shared_link) $(peer_scenes) ## the same for MeshLib (PyPI; for non-commercial use)
	$(call python_peer,meshlib)
peer-open3d: $(lib)/$(shared_link) $(peer_scenes) ## the same for Open3D (PyPI), on small meshes
	$(call python_peer,open3d)
peer-pymeshlab: $(lib)/$(shared_link) $(peer_scenes) ## the same for PyMeshLab (PyPI)
	$(call python_peer,pymeshlab)
peer-python-fcl: $(lib)/$(shared_link) $(peer_scenes) ## the same for FCL from Python, as trimesh has it (PyPI), on small meshes
	$(call python_peer,python-fcl)
peer-trueform: $(lib)/$(shared_link) $(peer_scenes) ## the same for trueform (PyPI; for non-commercial use)
	$(call python_peer,trueform)

.PHONY: objects-peer-ipctk
objects-peer-ipctk: $(lib)/$(shared_link) $(peer_scenes) ## time ipc-toolkit (PyPI) on SCENES of several objects, as objects-peers does
	$(call python_peer,ipctk,bench/peers/objects.py)

.PHONY: near-peers
near-peers: $(lib)/$(shared_link) $(peer_scenes) ## time ipc-toolkit (PyPI) beside what is near, into build/peers/near.csv; some minutes
	@bench/peers/measure_near.sh '$(BUILD)/peers/near.csv' '$(SCENES)' '$(bin)/sc-bench' '$(lib)/$(shared_link)' '$(BUILD)'

# CGAL's side is a shared library, which the same process loads.
trace_cgal := $(work)/peers/trace_cgal.so
$(obj)/bench/peers/trace_cgal.o: peer_flags = -frounding-math -fPIC -fvisibility=hidden
$(trace_cgal): $(obj)/bench/peers/trace_cgal.o
	@mkdir -p $(@D)
	$(if $(Q),@echo "  ld   $@")
	$(Q)$(CXX) -shared $(link_mode) $(CXXFLAGS) $(LDFLAGS) -o $@ $(filter %.o,$^) -lmpfr -lgmp $(LDLIBS)

.PHONY: trace-peers
trace-peers: $(lib)/$(shared_link) $(peer_scenes) ## compare and time contours: libigl, MeshLib (PyPI) and CGAL beside sc_trace, into build/peers/trace.csv
	+@has_cgal=$(and $(call has,CGAL/version.h),$(call has,gmp.h)); \
	    [ -z "$$has_cgal" ] || $(MAKE) --no-print-directory '$(trace_cgal)' || exit; \
	    $(if $(filter-out file,$(origin LIMIT)),LIMIT='$(LIMIT)') bench/peers/measure_trace.sh '$(BUILD)/peers/trace.csv' \
	    '$(SCENES)' '$(bin)/sc-bench' '$(lib)/$(shared_link)' "$${has_cgal:+$(trace_cgal)}" '$(BUILD)'

.PHONY: dataset-peers
dataset-peers: $(lib)/$(shared_link) $(filter %/sc-dataset,$(programs)) ## time those from PyPI on poses of a character, into build/peers/dataset.csv; some minutes
ifneq ($(filter %/sc-dataset,$(programs)),)
	@POSES='$(POSES)' bench/peers/measure_dataset.sh '$(BUILD)/peers/dataset.csv' '$(bin)/sc-dataset' '$(lib)/$(shared_link)' '$(BUILD)'
else
	@echo "skipped: dataset-peers: needs $(strip $(missing_for_programs)) ('make deps')"
endif

# The longest takes two minutes a scene, at one thread.
.PHONY: objects-peers
objects-peers: $(filter %/sc-objects,$(programs)) ## time Embree, FCL and ipc-toolkit on several objects, into build/peers/objects.csv; some minutes
ifneq ($(filter %/sc-objects,$(programs)),)
	@mkdir -p '$(BUILD)/peers' && echo "# commit: $$(git describe --always --abbrev=12 --dirty=+ \
	    --exclude='*' 2>/dev/null || echo unknown)" >'$(BUILD)/peers/objects.csv'
	@cd '$(BUILD)/peers' && { [ -d objects ] || { rm -rf objects.new && \
	    '$(abspath $(bin))/sc-objects' --frames 3 --export objects.new && mv objects.new objects; }; }
	+@status=0; for target in peer-embree peer-fcl objects-peer-ipctk; do \
	    $(MAKE) --no-print-directory $$target CSV='$(BUILD)/peers/objects.csv' LIMIT=300 \
	        SCENES="$(patsubst %,$(BUILD)/peers/objects/%,body crowd layers)" || status=1; done; exit $$status
else
	@echo "skipped: objects-peers: needs $(strip $(missing_for_programs)) ('make deps')"
endif

.PHONY: peers
peers: ## all peers that are there, into a new CSV; a minute or two for each
	@mkdir -p '$(dir $(CSV))' && echo "# commit: $$(git describe --always --abbrev=12 --dirty=+ \
	    --exclude='*' 2>/dev/null || echo unknown)" >'$(CSV)'
	+@status=0; for peer in cgal embree fcl ipctk libigl meshlib open3d pymeshlab python-fcl trueform; do \
	    $(MAKE) --no-print-directory peer-$$peer || status=1; done; exit $$status

# ------------------------------------------------------------------------------------------------
# WebAssembly, by emscripten: with 128-bit vectors (SIMD128), which is what is shipped, and without,
# for test-wasm. tools/npm/make_package.sh makes the package and the page.

EMCC ?= emcc
EMAR ?= emar
wasm := $(BUILD)/wasm
# clang tells of each loop that it does not unroll.
wasm_flags := -std=c99 -O3 -DNDEBUG $(exact) -fvisibility=hidden $(warnings) -Wno-pass-failed $(werror)
wasm_parts := $(wildcard tools/npm/*.* tools/npm/page/*)

.PHONY: wasm wasm-pack wasm-page bench-wasm test-wasm $(wasm)/compiler
wasm: $(wasm)/simd/libstarcontour.a $(wasm)/package/package.json ## for browsers and Node: static library and ES module, in build/wasm (make deps with=wasm wasm)
wasm-pack: $(wasm)/package/package.json ## pack that module for npm: build/wasm/starcontour-VERSION.tgz
	@BUILD='$(BUILD)' tools/npm/make_package.sh pack
wasm-page: $(wasm)/package/package.json ## build/wasm/page.html: cloth and meshes in the browser, in one file (node, npm)
	@BUILD='$(BUILD)' tools/npm/make_package.sh page
bench-wasm: $(wasm)/package/package.json $(filter %/sc-bench,$(programs)) ## time that module in Node beside the library, into build/peers/wasm.csv; some minutes
	@bench/wasm_times.sh '$(BUILD)/peers/wasm.csv' '$(bin)/sc-bench' '$(wasm)/package/index.js' '$(wasm)/scenes'
$(wasm)/compiler:
	@command -v '$(EMCC)' >/dev/null 2>&1 || { echo "make wasm needs $(EMCC): run 'make deps with=wasm' first" >&2; exit 1; }

# $(call compile_wasm,FLAGS)
define compile_wasm
	@mkdir -p $(@D)
	$(if $(Q),@echo "  emcc $<")
	$(Q)$(EMCC) $(wasm_flags) $(1) -Iinclude -Ilib -MMD -MP -c -o $@ $<
endef
$(wasm)/simd/%.o: %.c | $(wasm)/compiler
	$(call compile_wasm,-msimd128)
$(wasm)/plain/%.o: %.c | $(wasm)/compiler
	$(call compile_wasm)
$(wasm)/simd/libstarcontour.a $(wasm)/plain/libstarcontour.a: $(wasm)/%/libstarcontour.a: \
    $(addprefix $(wasm)/%/,$(core_sources:.c=.o))
	@rm -f $@ && $(EMAR) rcs $@ $^
$(wasm)/starcontour.wasm: $(wasm)/simd/tools/npm/layouts.o $(wasm)/simd/libstarcontour.a tools/npm/exports.txt
	$(Q)$(EMCC) -O3 -msimd128 -sSTANDALONE_WASM -sWASM_BIGINT -sALLOW_MEMORY_GROWTH --no-entry \
	    -sEXPORTED_FUNCTIONS=@tools/npm/exports.txt -o $@ $(filter %.o %.a,$^)
$(wasm)/package/package.json: $(wasm)/starcontour.wasm $(wasm_parts)
	@BUILD='$(BUILD)' tools/npm/make_package.sh package '$(version)'

test-wasm: all $(wasm)/simd/libstarcontour.a $(wasm)/plain/libstarcontour.a $(wasm)/package/package.json ## the same answers in Node and Chromium as here, and the page; two minutes
	@CC='$(CC)' SC_BIN='$(bin)' SC_LIB='$(lib)' BUILD='$(BUILD)' EMCC='$(EMCC)' tests/run.sh tests/wasm/*.sh

# ------------------------------------------------------------------------------------------------
# Installing.

headers := include/starcontour.h $(if $(metis),include/starcontour_metis.h) \
    tests/ffi/cxx/starcontour.hpp
# Written from tools/NAME.in; by folders below LIBDIR.
pkgconfigs := starcontour.pc $(if $(metis),starcontour_metis.pc)
cmakes := starcontour-config.cmake starcontour-config-version.cmake
# Below DOCDIR: these; the programs that the documents are, as NAME.c of FILE; bindings, in their
# folders.
documents := LICENSE CHANGELOG.md include/EMBEDDING.md tools/starcontour.schema.json
examples := first_query:README.md engine:include/EMBEDDING.md
bindings := $(patsubst tests/ffi/%,%,$(wildcard tests/ffi/README.md \
    $(addprefix tests/ffi/,*/*.* */src/*.rs)))
pointer_bytes = $(shell echo __SIZEOF_POINTER__ | $(CC) $(CPPFLAGS) $(CFLAGS) -E -P -x c -)

.PHONY: install
install: all ## install headers, stripped libraries and programs, pkg-config and CMake files, documents
	$(INSTALL) -d '$(DESTDIR)$(INCLUDEDIR)' '$(DESTDIR)$(LIBDIR)/pkgconfig' \
	    '$(DESTDIR)$(LIBDIR)/cmake/starcontour' '$(DESTDIR)$(BINDIR)' \
	    '$(DESTDIR)$(DOCDIR)/examples'
	$(INSTALL) -m 644 $(headers) '$(DESTDIR)$(INCLUDEDIR)'
	$(INSTALL) -m 644 $(static) $(if $(metis),$(metis_library)) '$(DESTDIR)$(LIBDIR)'
	$(INSTALL) -m 755 $(shared) '$(DESTDIR)$(LIBDIR)'
	ln -sf $(shared_name) '$(DESTDIR)$(LIBDIR)/$(soname)'
	ln -sf $(soname) '$(DESTDIR)$(LIBDIR)/$(shared_link)'
	for file in $(pkgconfigs:%=pkgconfig/%) $(cmakes:%=cmake/starcontour/%); do \
	    sed -e 's|@prefix@|$(PREFIX)|' -e 's|@libdir@|$(LIBDIR)|' -e 's|@version@|$(version)|' \
	        -e 's|@includedir@|$(INCLUDEDIR)|' -e 's|@abi@|$(abi)|' -e 's|@soname@|$(soname)|' \
	        -e 's|@shared_name@|$(shared_name)|' -e 's|@pointer_bytes@|$(pointer_bytes)|' \
	        "tools/$${file##*/}.in" > '$(DESTDIR)$(LIBDIR)/'"$$file" || exit 1; \
	done
ifneq ($(installed),)
	$(INSTALL) -m 755 $(installed) '$(DESTDIR)$(BINDIR)'
	$(INSTALL) -d '$(DESTDIR)$(MANDIR)/man1'
	$(INSTALL) -m 644 $(patsubst %,tools/man/%.1,$(notdir $(installed))) '$(DESTDIR)$(MANDIR)/man1'
endif
	for file in $(patsubst %,'$(DESTDIR)$(LIBDIR)/%',$(notdir $(static) $(shared) \
	    $(if $(metis),$(metis_library)))) $(patsubst %,'$(DESTDIR)$(BINDIR)/%',$(notdir $(installed))); do \
	    OBJCOPY='$(OBJCOPY)' tools/install_binary.sh "$$file" || exit 1; done
	$(INSTALL) -m 644 $(documents) '$(DESTDIR)$(DOCDIR)'
	for example in $(examples); do \
	    awk -f tools/example.awk "$${example#*:}" >'$(DESTDIR)$(DOCDIR)/examples/'"$${example%%:*}.c" || exit 1; done
	for file in $(bindings); do \
	    $(INSTALL) -d '$(DESTDIR)$(DOCDIR)/bindings/'"$$(dirname "$$file")" && \
	    $(INSTALL) -m 644 "tests/ffi/$$file" '$(DESTDIR)$(DOCDIR)/bindings/'"$$file" || exit 1; done

.PHONY: uninstall
uninstall: ## remove what install installs
	for name in starcontour.h starcontour_metis.h starcontour.hpp; do \
	    rm -f '$(DESTDIR)$(INCLUDEDIR)/'$$name || exit 1; done
	for name in libstarcontour.a libstarcontour_metis.a $(shared_name) $(soname) $(shared_link) \
	    .debug/$(shared_name).debug pkgconfig/starcontour.pc pkgconfig/starcontour_metis.pc $(cmakes:%=cmake/starcontour/%); do \
	    rm -f '$(DESTDIR)$(LIBDIR)/'$$name || exit 1; done
	for name in sc-query sc-partition; do rm -f '$(DESTDIR)$(BINDIR)/'$$name \
	    '$(DESTDIR)$(BINDIR)/.debug/'$$name.debug '$(DESTDIR)$(MANDIR)/man1/'$$name.1 || exit 1; done
	for name in $(notdir $(documents)) $(patsubst %,examples/%.c,first_query engine) \
	    $(bindings:%=bindings/%); do rm -f '$(DESTDIR)$(DOCDIR)/'"$$name" || exit 1; done
	[ ! -d '$(DESTDIR)$(DOCDIR)' ] || find '$(DESTDIR)$(DOCDIR)' -depth -type d -exec rmdir {} \; 2>/dev/null || true
	rmdir '$(DESTDIR)$(LIBDIR)/cmake/starcontour' '$(DESTDIR)$(LIBDIR)/.debug' \
	    '$(DESTDIR)$(BINDIR)/.debug' 2>/dev/null || true

# ------------------------------------------------------------------------------------------------
# Other ways to take the library along.

.PHONY: amalgamation
amalgamation: ## build/amalgamation/starcontour.c and .h: the library as one file
	@mkdir -p '$(BUILD)/amalgamation'
	@awk -f tools/amalgamate.awk lib/sources.list > '$(BUILD)/amalgamation/starcontour.c'
	@cp include/starcontour.h '$(BUILD)/amalgamation/starcontour.h'
	@ls '$(BUILD)'/amalgamation/starcontour.[ch]

.PHONY: dist
dist: ## build/starcontour-VERSION.tar.gz: the tracked files, the same bytes each time
	@tools/dist.sh '$(version)' '$(BUILD)'

.PHONY: wheels
wheels: ## build/wheels: the Python package as source distribution and wheel (manylinux); two minutes
	@PYTHON='$(or $(PYTHON),python3)' tools/python/make_wheels.sh '$(BUILD)/wheels'

.PHONY: mingw
mingw: ## build for Windows by mingw-w64; run its tests under wine, if that is there
	$(call need,$(MINGW)-gcc,gcc-mingw-w64-x86-64)
	@MAKE='$(MAKE)' tests/packages/mingw.sh '$(MINGW)' '$(BUILD)/mingw'

.PHONY: test-batch
test-batch: all ## many meshes and poses by a Slurm array, Dask and Ray Data (make deps with=batch test-batch); two minutes
	@SC_BIN='$(bin)' SC_LIB='$(lib)' tests/run.sh tests/batch/*.sh

.PHONY: test-packages
test-packages: ## as users build it: archive, wheels, crates, Debian, NuGet, Conan, vcpkg, mingw, clang-cl, macOS's ABI, ARM and s390x by QEMU; some minutes for each
	@MAKE='$(MAKE)' SC_FLAGS='$(CPPFLAGS) $(CFLAGS) $(LDFLAGS)' tests/run.sh tests/packages/*.sh

.PHONY: release-check
release-check: all ## what a release needs (versions, tests, interface, all packages, WebAssembly), and a table of it; an hour
	@MAKE='$(MAKE)' CC='$(CC)' EMCC='$(EMCC)' SC_BIN='$(bin)' SC_LIB='$(lib)' tools/release_check.sh '$(BUILD)/release-check' $(steps)

.PHONY: clean
clean: ## remove everything built; downloaded meshes stay
	@if [ -d '$(BUILD)' ]; then \
	    find '$(BUILD)' -mindepth 1 -maxdepth 1 ! -name meshes -exec rm -rf {} +; fi

# The list is made of the ## comments at the targets and the #: comments here.
.PHONY: help
help: ## this list
	@echo "starcontour $(version)"; echo
	@echo "Targets:"
	@awk -F ':.*## ' '/^[a-z][a-z0-9-]*:.*## / { printf "  %-16s %s\n", $$1, $$2 }' Makefile | sort -u
	@echo; echo "Variables:"
	@sed -n 's/^#: \([A-Za-z_]*\) *\(.*\)$$/\1#\2/p' Makefile | \
	    awk -F'#' '{ printf "  %-16s %s\n", $$1, $$2 }'

#: config      release (the default), debug, or sanitize (address and undefined behaviour)
#: with        groups of packages that make deps adds: analysis batch bench cgal docs ffi packages page peers wasm
#: CC          C compiler [cc]
#: CLANG       clang, for fuzz and test-memory-clang [clang]
#: CXX         C++ compiler, for test-cgal and one test of the header [g++]
#: PYTHON      Python with matplotlib, for the plots of bench [python3, the system's]
#: CPPFLAGS    added when preprocessing, such as -I of a library in an unusual place
#: EMCC        emscripten's compiler, for wasm; EMAR its archiver [emcc, emar]
#: CFLAGS      added after our own flags when compiling and linking C
#: CXXFLAGS    the same for C++
#: LDFLAGS     added when linking
#: LDLIBS      libraries added when linking
#: MINGW       what the names of the cross compiler's programs begin with [x86_64-w64-mingw32]
#: SECONDS     how long fuzz runs each target [60]
#: SOAK        how many queries soak asks [100000]
#: TRIALS      how many trials search-rounding makes of a bound [100000000]
#: WERROR      1: warnings are errors
#: TEST_JOBS   how many tests run at a time; an environment variable too [the processors]
#: SC_TEST_SCALE random trials in tests, in percent; the same [100]
#: REV         commit that bench-against compares with
#: AGAINST     options of sc-against for it, such as --ways exact,step
#: SCENE_DIRS  folders with more scenes for it [../shared/scenes]
#: SCENES      folders of scenes that peer-... and peers measure [build/peers/scenes/*]
#: CSV         where they add lines [build/peers/peers.csv]
#: POSES       at most so many poses a peer for dataset-peers [200]
#: LIMIT       seconds after which they give up on a scene [30]
#: MEMORY      GB of memory a peer may take for it, or unlimited [8]
#: steps       which steps release-check runs, such as "version abi debian" [all]
#: V           1: show commands
#: BUILD       where everything goes [build]
#: DESTDIR     put before every path of install and uninstall
#: PREFIX      where install installs [/usr/local]; also BINDIR, LIBDIR, INCLUDEDIR, MANDIR, DOCDIR
#: BINDIR      [PREFIX/bin]
#: LIBDIR      [PREFIX/lib]
#: INCLUDEDIR  [PREFIX/include]
#: MANDIR      [PREFIX/share/man]
#: DOCDIR      [PREFIX/share/doc/starcontour]
#: OBJCOPY     strips what is installed; empty: it is installed as it was built [objcopy]

-include $(shell find $(obj) $(wasm)/simd $(wasm)/plain -name '*.d' 2>/dev/null)

endif
