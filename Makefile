# SPDX-License-Identifier: MIT
# inlay. `make help` lists the targets.
#
# Each folder's module.mk names its sources; objects live in build/<flavour>/, keyed by the flags,
# so that a sanitizer build and a release never mix. V=1 shows the commands.

MAKEFLAGS += --no-builtin-rules
.SUFFIXES:
.DELETE_ON_ERROR:
.DEFAULT_GOAL := all

VERSION := 0.1.0

# ---- choices ----
# SANITIZE=address,undefined or SANITIZE=thread; CC=clang; each WITH_X=1 or 0.
SANITIZE ?=
WITH_KMS ?= $(call found,libdrm)
WITH_SDL ?= $(call found,sdl2)
WITH_GPIO ?= $(call found,libgpiod)
WITH_EXR ?= $(call found,OpenEXR)
WITH_WEBP ?= $(call found,libwebp)
WITH_LIBCAMERA ?= $(call found,libcamera)
WITH_FFMPEG ?= $(call found,libavcodec)
WITH_CAIRO ?= $(call found,cairo)
WITH_SYSTEMD ?= $(call found,libsystemd)

ifeq ($(origin CC),default)
CC := gcc
endif
ifeq ($(origin CXX),default)
CXX := g++
endif
PKG_CONFIG ?= pkg-config
found = $(shell $(PKG_CONFIG) --exists $(1) 2>/dev/null && echo 1 || echo 0)

WITH_KMS := $(WITH_KMS)
WITH_SDL := $(WITH_SDL)
WITH_GPIO := $(WITH_GPIO)
WITH_EXR := $(WITH_EXR)
WITH_WEBP := $(WITH_WEBP)
WITH_LIBCAMERA := $(WITH_LIBCAMERA)
WITH_FFMPEG := $(WITH_FFMPEG)
WITH_CAIRO := $(WITH_CAIRO)
WITH_SYSTEMD := $(WITH_SYSTEMD)

SWITCHES := KMS SDL GPIO EXR WEBP LIBCAMERA FFMPEG CAIRO SYSTEMD
FEATURES := $(foreach x,$(SWITCHES),-DWITH_$(x)=$(WITH_$(x)))
ifeq ($(WITH_GPIO),1)
# Its calls were renamed from 1.x to 2.x, and its header does not tell which it is.
GPIOD_MAJOR := $(firstword $(subst ., ,$(shell $(PKG_CONFIG) --modversion libgpiod)))
FEATURES += -DGPIOD_MAJOR=$(GPIOD_MAJOR)
endif

# Of what the compiler builds for. A module.mk sets OWN_FLAGS for single objects: of an instruction set
# that not every such processor has (who calls them asks the processor first), or of a library of theirs.
MACHINE := $(firstword $(subst -, ,$(shell $(CC) -dumpmachine 2>/dev/null)))

# Rooms that compute pixels are worth the compiler's time; tests are compiled more often than they run.
# Who sets OPTIMIZE sets it for all.
OPTIMIZE ?= -O2 -g1
ifeq ($(origin OPTIMIZE),file)
OPTIMIZE_PIXELS ?= -O3
OPTIMIZE_TESTS ?= -O1
endif
WARNINGS := -Wall -Wextra -Wshadow -Wpointer-arith -Wstrict-prototypes -Wmissing-prototypes \
	-Wvla -Wwrite-strings -Wundef -Wformat=2 -Wimplicit-fallthrough
CXX_WARNINGS := -Wall -Wextra -Wshadow -Wpointer-arith -Wvla -Wwrite-strings -Wundef -Wformat=2
# No contraction: a fused multiply-add would make results differ between machines.
SHARED_FLAGS := $(OPTIMIZE) -ffp-contract=off -fno-math-errno -fno-strict-aliasing \
	-D_GNU_SOURCE -DINLAY_VERSION='"$(VERSION)"' $(FEATURES) -I. -MMD -MP -pthread
SHARED_LINK := -pthread
# OpenEXR and libcamera speak C++, so what holds them is linked as C++.
LINK := $(if $(filter 1,$(WITH_EXR) $(WITH_LIBCAMERA)),$(CXX),$(CC))
ifneq ($(SANITIZE),)
SHARED_FLAGS += -fsanitize=$(SANITIZE) -fno-omit-frame-pointer -fno-sanitize-recover=undefined
SHARED_LINK += -fsanitize=$(SANITIZE)
endif
CFLAGS_ALL = -std=gnu17 $(WARNINGS) $(SHARED_FLAGS) $(CFLAGS)
CXXFLAGS_ALL = -std=c++17 $(CXX_WARNINGS) $(SHARED_FLAGS) $(CXXFLAGS)

empty :=
space := $(empty) $(empty)
comma := ,
FLAVOUR := $(notdir $(lastword $(CC)))$(if $(SANITIZE),-$(subst $(comma),-,$(SANITIZE)))$(shell \
	printf '%s' "$(OPTIMIZE)$(OPTIMIZE_PIXELS)$(OPTIMIZE_TESTS)$(CFLAGS)$(foreach x,$(SWITCHES),$(WITH_$(x)))$(GPIOD_MAJOR)" \
	| cksum | cut -d' ' -f1 | sed 's/^/-/')
BUILD ?= build/$(FLAVOUR)

ifeq ($(V),1)
Q :=
say = @:
else
Q := @
say = @printf '  %-7s %s\n'
endif

objects = $(patsubst %,$(BUILD)/%.o,$(basename $(1)))

$(addprefix $(BUILD)/,$(addsuffix /%.o,hal drivers/sim bake/encode bake/judge bake/tiles bake/trace)): \
	ROOM_FLAGS := $(OPTIMIZE_PIXELS)
$(BUILD)/tests/%.o: ROOM_FLAGS := $(OPTIMIZE_TESTS)

# ---- modules: each appends to *_SOURCES, and to PROGRAMS and TESTS ----
include hal/module.mk
include drivers/module.mk
include config/module.mk
include app/module.mk
include bake/module.mk
include bake/calibrate/module.mk
include tests/module.mk
include board/module.mk

# Warnings are for our own headers.
pkg_cflags = $(if $(strip $(1)),$(patsubst -I%,-isystem%,$(shell $(PKG_CONFIG) --cflags $(1))))
pkg_libs = $(if $(strip $(1)),$(shell $(PKG_CONFIG) --libs $(1)))
# FOLDER_CFLAGS and FOLDER_LIBRARIES: of FOLDER_PACKAGES. pkg-config is asked when the first recipe needs
# them (the packages may not be there before), and only then.
define packages
$(1)_CFLAGS = $$(eval $(1)_CFLAGS := $$(call pkg_cflags,$$($(1)_PACKAGES)))$$($(1)_CFLAGS)
$(1)_LIBRARIES = $$(eval $(1)_LIBRARIES := $$(call pkg_libs,$$($(1)_PACKAGES)))$$($(1)_LIBRARIES)
endef
$(foreach folder,hal drivers config app bake calibrate tests cmocka,$(eval $(call packages,$(folder))))

ALL_SOURCES := $(HAL_SOURCES) $(DRIVER_SOURCES) $(CONFIG_SOURCES) $(APP_SOURCES) $(BAKE_SOURCES) \
	$(CALIBRATE_SOURCES) $(BAKE_MAIN) $(APP_MAIN) $(CALIBRATE_MAIN)
PROGRAMS := $(addprefix $(BUILD)/,inlay inlay-bake inlay-calibrate)

.PHONY: all
## all: build inlay, inlay-bake and inlay-calibrate (links to them appear in build/)
all: $(PROGRAMS)
	$(Q)for program in inlay inlay-bake inlay-calibrate; do \
		ln -sfn $(patsubst build/%,%,$(BUILD))/$$program build/$$program; done

# ---- rules ----
# A bare machine is told what to do, once, before the first object.
missing_tool := $(firstword $(foreach tool,$(CC) $(CXX) $(PKG_CONFIG),$(if $(shell command -v $(tool) 2>/dev/null),,$(tool))))
with_tools = $(if $(missing_tool),$(error There is no $(missing_tool) here: "make deps" installs what building needs))

$(BUILD)/%.o: %.c
	$(with_tools)@mkdir -p $(@D)
	$(say) CC $<
	$(Q)$(CC) $(CFLAGS_ALL) $(ROOM_FLAGS) $(OWN_FLAGS) $($(firstword $(subst /, ,$<))_CFLAGS) -c $< -o $@

$(BUILD)/%.o: %.cpp
	$(with_tools)@mkdir -p $(@D)
	$(say) CXX $<
	$(Q)$(CXX) $(CXXFLAGS_ALL) $(ROOM_FLAGS) $(OWN_FLAGS) $($(firstword $(subst /, ,$<))_CFLAGS) -c $< -o $@

define archive
$(BUILD)/$(1).a: $(call objects,$(2))
	$$(say) AR $$@
	$$(Q)rm -f $$@ && $$(AR) rcs $$@ $$^
endef
$(eval $(call archive,hal,$(HAL_SOURCES)))
$(eval $(call archive,drivers,$(DRIVER_SOURCES)))
$(eval $(call archive,config,$(CONFIG_SOURCES)))
$(eval $(call archive,app,$(APP_SOURCES)))
$(eval $(call archive,bake,$(BAKE_SOURCES)))
$(eval $(call archive,calibrate,$(CALIBRATE_SOURCES)))

APP_LIBS := $(addprefix $(BUILD)/,app.a drivers.a config.a hal.a)
BAKE_LIBS := $(addprefix $(BUILD)/,bake.a config.a hal.a)
APP_LINK = $(drivers_LIBRARIES) $(app_LIBRARIES) $(hal_LIBRARIES) $(hal_LIBS) -lm
BAKE_LINK = $(bake_LIBRARIES) $(hal_LIBRARIES) $(bake_LIBS) $(hal_LIBS) -lm
CALIBRATE_LIBS := $(addprefix $(BUILD)/,calibrate.a bake.a drivers.a config.a hal.a)
CALIBRATE_LINK = $(calibrate_LIBRARIES) $(drivers_LIBRARIES) $(calibrate_LIBS) $(BAKE_LINK)

$(BUILD)/inlay: $(call objects,$(APP_MAIN)) $(APP_LIBS)
	$(say) LINK $@
	$(Q)$(LINK) $(SHARED_LINK) $(LDFLAGS) -o $@ $^ $(APP_LINK)

$(BUILD)/inlay-bake: $(call objects,$(BAKE_MAIN)) $(BAKE_LIBS)
	$(say) LINK $@
	$(Q)$(CXX) $(SHARED_LINK) $(LDFLAGS) -o $@ $^ $(BAKE_LINK)

$(BUILD)/inlay-calibrate: $(call objects,$(CALIBRATE_MAIN)) $(CALIBRATE_LIBS)
	$(say) LINK $@
	$(Q)$(CXX) $(SHARED_LINK) -Wl,--as-needed $(LDFLAGS) -o $@ $^ $(CALIBRATE_LINK)

# Unit tests, one program a file: tests/unit/hal/optics/test_x.c -> $(BUILD)/tests/unit/hal/optics/test_x.
# Each is linked with the archives of its room only; what else one needs is named in tests/module.mk.
UNIT_PROGRAMS := $(addprefix $(BUILD)/,$(basename $(UNIT_TESTS)))
$(eval $(call archive,tests/support,$(SUPPORT_SOURCES)))
HAL_LINK = $(hal_LIBRARIES) $(hal_LIBS) -lm
EVERY_LIB := $(addprefix $(BUILD)/,app.a calibrate.a drivers.a config.a bake.a hal.a)
EVERY_LINK = -Wl,--as-needed $(APP_LINK) $(CALIBRATE_LINK)
UNIT_CALIBRATE := $(filter $(BUILD)/tests/unit/bake/calibrate/%,$(UNIT_PROGRAMS))
# unit PROGRAMS, ARCHIVES, LIBRARIES
define unit
$(1): $(BUILD)/%: $(BUILD)/%.o $(SUPPORT_LIB) $(addprefix $(BUILD)/,$(2))
	$$(say) LINK $$@
	$$(Q)$$(CXX) $$(SHARED_LINK) -Wl,--as-needed $$(LDFLAGS) -o $$@ $$(filter %.o,$$^) \
		-Wl,--start-group $$(filter %.a,$$^) -Wl,--end-group $$(cmocka_LIBRARIES) $(3)
endef
unit_in = $(filter $(BUILD)/tests/$(1)/%,$(UNIT_PROGRAMS))
$(eval $(call unit,$(call unit_in,unit/hal),hal.a,$$(HAL_LINK)))
$(eval $(call unit,$(call unit_in,unit/drivers),drivers.a hal.a,$$(drivers_LIBRARIES) $$(HAL_LINK)))
$(eval $(call unit,$(call unit_in,unit/config),config.a drivers.a hal.a,$$(drivers_LIBRARIES) $$(HAL_LINK)))
$(eval $(call unit,$(call unit_in,unit/app),app.a drivers.a config.a hal.a,$$(APP_LINK)))
$(eval $(call unit,$(filter-out $(UNIT_CALIBRATE),$(call unit_in,unit/bake)),bake.a config.a hal.a,$$(BAKE_LINK)))
$(eval $(call unit,$(UNIT_CALIBRATE),calibrate.a bake.a drivers.a config.a hal.a,$$(CALIBRATE_LINK)))
$(eval $(call unit,$(call unit_in,accuracy),$(notdir $(EVERY_LIB)),$$(EVERY_LINK)))

# Fuzz targets replay their corpus under any compiler, and are real fuzzers under clang.
FUZZ_PROGRAMS := $(addprefix $(BUILD)/,$(basename $(FUZZ_TARGETS)))
FUZZ_LIB := $(call objects,$(FUZZ_PARTS)) $(SUPPORT_LIB) \
	$(addprefix $(BUILD)/,drivers.a config.a hal.a)
ifeq ($(FUZZER),1)
# What no target is linked with is compiled for its warnings alone: sanitizers and optimiser take two
# thirds of the time that it takes.
$(filter-out $(call objects,$(FUZZ_PARTS)),$(call objects,$(APP_SOURCES) $(BAKE_SOURCES) $(CALIBRATE_SOURCES) \
	$(BAKE_MAIN) $(APP_MAIN) $(CALIBRATE_MAIN) $(UNIT_TESTS))): \
	SHARED_FLAGS := $(filter-out $(OPTIMIZE) -fsanitize=%,$(SHARED_FLAGS)) -O0
SHARED_FLAGS += -fsanitize=fuzzer-no-link
FUZZ_LINK := -fsanitize=fuzzer
FUZZ_MAIN :=
else
FUZZ_LINK :=
FUZZ_MAIN := $(BUILD)/tests/fuzz/replay.o
endif
$(FUZZ_PROGRAMS): $(BUILD)/%: $(BUILD)/%.o $(FUZZ_MAIN) $(FUZZ_LIB)
	$(say) LINK $@
	$(Q)$(CXX) $(SHARED_LINK) $(FUZZ_LINK) $(LDFLAGS) -o $@ $< $(FUZZ_MAIN) \
		-Wl,--start-group $(FUZZ_LIB) -Wl,--end-group $(EVERY_LINK)

TEST_SOURCES := $(SUPPORT_SOURCES) $(UNIT_TESTS) $(FUZZ_TARGETS) tests/fuzz/replay.c
-include $(patsubst %.o,%.d,$(call objects,$(ALL_SOURCES) $(TEST_SOURCES)))

.PHONY: programs-unit programs-fuzz objects
programs-unit: $(UNIT_PROGRAMS)
programs-fuzz: $(FUZZ_PROGRAMS)
objects: $(call objects,$(ALL_SOURCES) $(TEST_SOURCES))

# ---- what a person calls ----
# deps.sh may install what the WITH_ choices above looked for, so the work is done by a second make.
.PHONY: deps
## deps: install the Debian packages that building, the demo and make test need
deps:
	$(Q)board/deps.sh demo test

AGAIN = $(Q)$(MAKE) --no-print-directory $(if $(filter -j%,$(MAKEFLAGS)),,-j$(shell nproc))
# $(call with_packages,TARGET,PURPOSE): TARGET installs what PURPOSE needs, then makes TARGET-installed.
define with_packages
.PHONY: $(1) $(1)-installed
$(1):
	$$(Q)board/deps.sh $(2)
	$$(AGAIN) $(1)-installed
endef

## demo: install, build, bake the cow, run it in the simulated studio; pictures are left in demo/
$(eval $(call with_packages,demo,demo))
demo-installed: all
	$(Q)BUILD="$(BUILD)" bake/demo/demo.sh demo

## walk: from two simulated cameras to a lit object, as the README tells; pictures are left in walk/
$(eval $(call with_packages,walk,test))
walk-installed: all $(TEST_PROGRAMS)
	$(Q)WALK=walk $(RUN_TESTS) cli tests/walk/walk.sh

## picture: make the README's pictures anew, board/kiosk.png and board/walk.jpg
$(eval $(call with_packages,picture,test))
picture-installed: walk-installed
	$(Q)BUILD="$(BUILD)" board/picture.sh board/kiosk.png
	$(Q)cp walk/walk.jpg board/walk.jpg

## test: install, build, test: everything quick, the whole way on simulated hardware included
$(eval $(call with_packages,test,test))

RUN_TESTS = INLAY="$(abspath $(BUILD))/inlay" INLAY_BAKE="$(abspath $(BUILD))/inlay-bake" \
	INLAY_CALIBRATE="$(abspath $(BUILD))/inlay-calibrate" BUILD="$(BUILD)" tests/run.sh

# One queue for all: what lasts longest begins.
UNIT_QUICK := $(filter-out $(addprefix $(BUILD)/,$(basename $(DEEP_ONLY_TESTS))),$(UNIT_PROGRAMS))
test-installed: all programs-unit programs-fuzz $(TEST_PROGRAMS) $(VM_READY) $(BUILD)/tests/kernels/test_kernels
	$(Q)tests/run.sh --begin
	-+$(Q)MAKE="$(MAKE)" $(RUN_TESTS) vm "tests/vm/run.sh quick" \
		-- accuracy tests/accuracy/quick.sh tests/accuracy/doubts.sh -- cli $(CLI_TESTS) -- kernels tests/kernels/kernels.sh \
		-- unit $(UNIT_QUICK) -- lint "tests/lint/lint.sh --quick" tests/lint/test_rules.sh -- fuzz tests/fuzz/replay.sh
	$(Q)tests/run.sh --end

## test-stress: make test beside eight busy loops, on one processor, and from TIMES=10 new seeds (hours)
test-stress-installed: TIMES = 10
$(eval $(call with_packages,test-stress,test))
test-stress-installed:
	$(Q)MAKE="$(MAKE)" tests/stress.sh $(TIMES)

## test-deep: what make test leaves out: sanitizers, fuzzing, other processors, every fault (hours)
$(eval $(call with_packages,test-deep,deep))

DEEP_GROUPS := test-lint test-thorough test-emulated test-cli-deep test-registration test-blender test-fuzz \
	test-sanitize test-vm-installed test-vm-qemu-installed test-boot-installed
test-deep-installed: $(OTHER_PROGRAMS)
	$(Q)tests/run.sh --begin
	+$(Q)MAKE="$(MAKE)" tests/run.sh --make $(DEEP_GROUPS)
	$(Q)tests/run.sh --end

.PHONY: release-check
## release-check: test, test-deep, the images of the other boards, ten minutes of soak (hours)
release-check:
	$(Q)$(MAKE) --no-print-directory test
	$(Q)$(MAKE) --no-print-directory test-deep
	$(Q)$(MAKE) --no-print-directory test-boards
	$(Q)$(MAKE) --no-print-directory soak MINUTES=10

.PHONY: size
## size: lines of each folder beside what it may hold, and words of the documentation
size:
	$(Q)tests/lint/size.sh --table

# Groups of tests alone; what each counts is added to the results of this run.
.PHONY: test-lint test-unit test-thorough test-kernels test-emulated test-cli test-cli-deep \
	test-accuracy test-registration test-blender test-fuzz test-sanitize
## test-lint: the same as lint, counted as tests
test-lint:
	$(Q)$(RUN_TESTS) lint tests/lint/lint.sh
## test-unit: unit tests alone (TEST=dome: those whose name contains dome)
UNIT_CHOSEN = $(strip $(if $(TEST),$(foreach t,$(UNIT_PROGRAMS),$(if $(findstring $(TEST),$(notdir $t)),$t)),\
	$(UNIT_PROGRAMS)))
test-unit: $(UNIT_CHOSEN)
	$(Q)$(RUN_TESTS) unit $(or $(UNIT_CHOSEN),$(error no unit test has "$(TEST)" in its name))
## test-thorough: the unit tests that draw statistics, with their whole samples
test-thorough: $(addprefix $(BUILD)/,$(basename $(THOROUGH_TESTS)))
	$(Q)INLAY_THOROUGH=1 $(RUN_TESTS) thorough $^
## test-kernels: the kernels of this processor against the C ones
test-kernels: $(BUILD)/tests/kernels/test_kernels
	$(Q)$(RUN_TESTS) kernels tests/kernels/kernels.sh
## test-emulated: the kernels of other processors, Arm's included, under emulation
test-emulated: $(BUILD)/tests/kernels/test_kernels
	$(Q)$(RUN_TESTS) kernels "tests/kernels/kernels.sh --emulated"
## test-cli: the programs as a person calls them (TEST=still: one script)
test-cli: all $(TEST_PROGRAMS)
	$(Q)$(RUN_TESTS) cli $(if $(TEST),$(or $(wildcard tests/cli/$(TEST).sh),$(error there is no tests/cli/$(TEST).sh)),\
		$(CLI_TESTS))
test-cli-deep: all $(TEST_PROGRAMS)
	$(Q)INLAY_THOROUGH=1 $(RUN_TESTS) cli $(CLI_DEEP_TESTS)
## test-accuracy: the composite against path-traced truth, quick form
test-accuracy: all $(TEST_PROGRAMS)
	$(Q)$(RUN_TESTS) accuracy tests/accuracy/quick.sh tests/accuracy/doubts.sh
test-registration: all $(TEST_PROGRAMS)
	$(Q)$(RUN_TESTS) accuracy tests/accuracy/registration.sh
test-blender: all $(TEST_PROGRAMS)
	$(Q)$(RUN_TESTS) accuracy "tests/accuracy/blender.sh --test"
## test-fuzz: fuzz each reader for some seconds (clang)
test-fuzz: programs-fuzz
	$(Q)$(RUN_TESTS) fuzz tests/fuzz/run.sh
## test-sanitize: unit tests and a real run under address, undefined, thread sanitizers and valgrind
test-sanitize: all
	$(Q)tests/sanitize/run.sh

.PHONY: same-output
## same-output: does the demo come out the same as REVISION=HEAD made it, byte by byte? (minutes)
REVISION = HEAD
same-output: all
	$(Q)BUILD="$(BUILD)" tests/same_output.sh $(REVISION)

.PHONY: test-seeds
## test-seeds: unit and kernel tests, each from TIMES=20 new seeds (an hour); make test keeps to one
TIMES = 20
test-seeds: programs-unit $(BUILD)/tests/kernels/test_kernels
	$(Q)tests/seeds.sh $(TIMES) $(UNIT_PROGRAMS) $(BUILD)/tests/kernels/test_kernels

.PHONY: lint
## lint: format, include rules, warnings as errors (gcc, clang), cppcheck, shellcheck
lint:
	$(Q)tests/lint/lint.sh

## accuracy: spot in real panoramas against path-traced truth: the table of errors (minutes)
$(eval $(call with_packages,accuracy,test))
accuracy-installed: all $(TEST_PROGRAMS)
	$(Q)BUILD="$(BUILD)" tests/accuracy/panoramas.sh

## near: what it costs that all light is taken as coming from afar: lamps at 1 m to 4 m: the table (minutes)
$(eval $(call with_packages,near,test))
near-installed: all $(TEST_PROGRAMS)
	$(Q)BUILD="$(BUILD)" tests/accuracy/near.sh

## shine: metal, and a box on a polished floor, against path-traced truth: the tables (half an hour)
$(eval $(call with_packages,shine,test))
shine-installed: all $(TEST_PROGRAMS)
	$(Q)BUILD="$(BUILD)" tests/accuracy/shine.sh

## exposures: how right the light of an 8-bit fisheye is, of one exposure and of three (minutes)
$(eval $(call with_packages,exposures,test))
exposures-installed: all $(BUILD)/tests/accuracy/exposures
	$(Q)BUILD="$(BUILD)" tests/accuracy/exposures.sh

## blender: mesh files and their materials against Blender's own pictures of them: the table (minutes)
$(eval $(call with_packages,blender,deep))
blender-installed: all $(TEST_PROGRAMS)
	$(Q)BUILD="$(BUILD)" tests/accuracy/blender.sh

## people: wrong pixels and orders of people before the object, beside OpenCV's ways (minutes)
$(eval $(call with_packages,people,test))
people-installed: all $(BUILD)/tests/people/judge $(BUILD)/tests/people/render
	$(Q)BUILD="$(BUILD)" tests/people/people.sh

## film: the cow among the people of a real film: film/film.mp4, its crossings, and a page (minutes)
$(eval $(call with_packages,film,film))
film-installed: all $(BUILD)/tests/film/measure
	$(Q)BUILD="$(BUILD)" tests/film/film.sh film

## look: does the object look taken by the same camera, in noise, edges, colour and flicker: the table (two minutes)
$(eval $(call with_packages,look,test))
look-installed: all $(BUILD)/tests/people/look
	$(Q)BUILD="$(BUILD)" tests/people/look.sh

## peers: the same frame by inlay and by other ways, in turns: the table of tests/bench/README.md (minutes)
$(eval $(call with_packages,peers,demo))
peers-installed: all $(BUILD)/tests/bench/peers
	$(Q)BUILD="$(BUILD)" tests/bench/peers.sh --record

## bench: time a frame by stage, memory, bake time, for the cow and spot (minutes)
$(eval $(call with_packages,bench,demo))
bench-installed: all
	$(Q)BUILD="$(BUILD)" tests/bench/bench.sh

## report: speed against error of spot in real panoramas, or of the cow: build/report (minutes)
$(eval $(call with_packages,report,demo))
report-installed: all
	$(Q)BUILD="$(BUILD)" tests/accuracy/report.sh build/report

.PHONY: help
## help: this list
help:
	@sed -n 's/^## \([a-z-]*\): \(.*\)/  \1|\2/p' $(filter Makefile %.mk,$(MAKEFILE_LIST)) | awk -F'|' '{printf "%-16s %s\n", $$1, $$2}'

.PHONY: clean
## clean: remove build/
clean:
	$(Q)rm -rf build
