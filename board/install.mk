# SPDX-License-Identifier: MIT
# `make install`, `make uninstall`, `make deb`: board/README.md, "Installing".

PREFIX ?= /usr/local

# The date of manual pages and packages: the last commit's, so that what is built twice is the same.
ifeq ($(origin SOURCE_DATE_EPOCH),undefined)
SOURCE_DATE_EPOCH = $(shell git log -1 --format=%ct 2>/dev/null || stat -c %Y Makefile)
endif

# Put before a program that was built for another machine, so that it can say its own --help.
RUNNER ?=

# ---- what is made from the programs' own words: manual pages, completions, the configuration ----
SHARE := $(BUILD)/share
SHARED := $(addprefix $(SHARE)/,inlay.1 inlay-bake.1 inlay-calibrate.1 inlay.conf.5 \
	inlay-scene.5 kiosk.conf \
	inlay.bash _inlay inlay-bake.bash _inlay-bake inlay-calibrate.bash _inlay-calibrate)
ABOUT_PAGE = -v version=$(VERSION) -v date=$$(cat $(SHARE)/date) \
	-v about=board/manual/$(basename $(@F)).about -f board/manual/roff.awk

.SECONDARY: $(addprefix $(SHARE)/,inlay.facts inlay-bake.facts inlay-calibrate.facts)
$(SHARE)/%.facts: $(BUILD)/% board/manual/facts.sh board/manual/facts.awk
	@mkdir -p $(@D)
	$(Q)board/manual/facts.sh $< $* "$(RUNNER)" >$@

# Written when it changes: pages that were made on another day are made again.
.PHONY: look-at-date
$(SHARE)/date: look-at-date
	@mkdir -p $(@D)
	@date -u -d @$(SOURCE_DATE_EPOCH) +%Y-%m-%d | cmp -s - $@ || \
		date -u -d @$(SOURCE_DATE_EPOCH) +%Y-%m-%d >$@

$(SHARE)/sample: $(BUILD)/inlay
	@mkdir -p $(@D)
	$(Q)$(RUNNER) $< check --sample >$@

$(SHARE)/scene: $(BUILD)/inlay-bake
	@mkdir -p $(@D)
	$(Q)$(RUNNER) $< render --print-scene >$@

$(SHARE)/%.1: $(SHARE)/%.facts board/manual/command.awk board/manual/roff.awk board/manual/%.about \
		$(SHARE)/date
	$(say) MAN $@
	$(Q)awk -v name=$* $(ABOUT_PAGE) -f board/manual/command.awk $< >$@

$(SHARE)/inlay.conf.5: $(SHARE)/sample board/manual/settings.awk board/manual/roff.awk \
		board/manual/inlay.conf.about $(SHARE)/date
	$(say) MAN $@
	$(Q)awk -v title=inlay.conf -v names="inlay.conf, kiosk.conf" -v from="inlay check --sample" \
		$(ABOUT_PAGE) -f board/manual/settings.awk $< >$@

$(SHARE)/inlay-scene.5: $(SHARE)/scene board/manual/settings.awk board/manual/roff.awk \
		board/manual/inlay-scene.about $(SHARE)/date
	$(say) MAN $@
	$(Q)awk -v title=inlay-scene -v from="inlay-bake render --print-scene" \
		$(ABOUT_PAGE) -f board/manual/settings.awk $< >$@

$(SHARE)/kiosk.conf: $(SHARE)/sample board/appliance.conf board/appliance.awk
	$(Q)awk -f board/appliance.awk board/appliance.conf $< >$@

SETTINGS_NAMES = $$(awk -f board/completion/keys.awk $(SHARE)/sample | tr '\n' ' ')

$(SHARE)/%.bash: $(SHARE)/%.facts $(SHARE)/sample $(addprefix board/completion/,options.awk bash.awk \
		keys.awk)
	$(Q)awk -f board/completion/options.awk $< | \
		awk -v name=$* -v keys="$(SETTINGS_NAMES)" -f board/completion/bash.awk >$@

$(SHARE)/_%: $(SHARE)/%.facts $(SHARE)/sample $(addprefix board/completion/,options.awk zsh.awk \
		keys.awk)
	$(Q)awk -f board/completion/options.awk $< | \
		awk -v name=$* -v keys="$(SETTINGS_NAMES)" -f board/completion/zsh.awk >$@

INSTALLED := $(BUILD)/inlay $(BUILD)/inlay-bake $(BUILD)/inlay-calibrate $(SHARED)

.PHONY: install uninstall
## install: programs, unit, udev rules, manual pages to PREFIX (/usr/local), below DESTDIR if given
install: $(INSTALLED)
	$(Q)DESTDIR="$(DESTDIR)" PREFIX="$(PREFIX)" board/install.sh install $(BUILD)

## uninstall: take away what install put there; a changed configuration and the state stay
uninstall: $(SHARE)/kiosk.conf
	$(Q)DESTDIR="$(DESTDIR)" PREFIX="$(PREFIX)" board/install.sh uninstall $(BUILD)

# ---- the Debian packages ----
# DEB_MAINTAINER="Name <address>": of whoever gives them to others.
# For another machine: make deb DEB_ARCH=arm64 CC=aarch64-linux-gnu-gcc CXX=aarch64-linux-gnu-g++
# PKG_CONFIG=aarch64-linux-gnu-pkg-config
DEB_ARCH ?= $(shell dpkg --print-architecture)
DEB_BUILD ?= build/deb
DEB_RUNNER ?= $(if $(filter-out $(shell dpkg --print-architecture),$(DEB_ARCH)),qemu-$(shell \
	dpkg-architecture -a$(DEB_ARCH) -qDEB_HOST_GNU_CPU 2>/dev/null))
# Debian's hardening, at our own level of optimisation; what a debugger reads would be stripped anyway.
deb_flags = $(shell DEB_HOST_ARCH=$(DEB_ARCH) DEB_BUILD_MAINT_OPTIONS=hardening=+bindnow \
	DEB_CFLAGS_MAINT_STRIP="-g -O2" DEB_CXXFLAGS_MAINT_STRIP="-g -O2" dpkg-buildflags --get $(1))

# A package in which a part is missing because its library was not found would be no kiosk.
DEB_PARTS := KMS GPIO EXR LIBCAMERA CAIRO SYSTEMD
DEB_MISSING = $(foreach x,$(DEB_PARTS),$(if $(filter 1,$(WITH_$(x))),,WITH_$(x)))

.PHONY: deb deb-built deb-whole deb-packed
## deb: the Debian packages inlay (the kiosk, without windows) and inlay-bake, in build/deb
deb:
	$(Q)board/deps.sh build package
	$(AGAIN) deb-built
deb-built:
	$(Q)$(MAKE) --no-print-directory BUILD=$(DEB_BUILD)/$(DEB_ARCH) RUNNER="$(DEB_RUNNER)" WITH_SDL=0 \
		OPTIMIZE="$(filter-out -g%,$(OPTIMIZE))" OPTIMIZE_PIXELS="$(OPTIMIZE_PIXELS)" \
		CFLAGS="$(call deb_flags,CPPFLAGS) $(call deb_flags,CFLAGS)" \
		CXXFLAGS="$(call deb_flags,CPPFLAGS) $(call deb_flags,CXXFLAGS)" \
		LDFLAGS="$(call deb_flags,LDFLAGS)" deb-packed
deb-whole:
	$(Q)[ -z "$(strip $(DEB_MISSING))" ] || { echo "deb: $(PKG_CONFIG) finds no library for \
	$(strip $(DEB_MISSING)): expected those of $(DEB_ARCH)" >&2; exit 1; }
deb-packed: deb-whole $(INSTALLED)
	$(Q)SOURCE_DATE_EPOCH=$(SOURCE_DATE_EPOCH) DEB_MAINTAINER="$(DEB_MAINTAINER)" \
		board/debian/build.sh $(BUILD) $(VERSION) $(DEB_ARCH) $(DEB_BUILD)
