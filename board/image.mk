# SPDX-License-Identifier: MIT
# `make image BOARD=...`, `make boot BOARD=...`: board/image/README.md.

BOARD ?= qemu-x86_64
BOARDS := qemu-x86_64 pc-x86_64 raspberrypi qemu-arm64
# Said before anything is installed or built.
known_board = $(if $(filter $(BOARD),$(BOARDS)),,$(error BOARD is "$(BOARD)", expected one of $(BOARDS)))
TEST_BOARDS ?= qemu-arm64 pc-x86_64 raspberrypi
BOARD_ARCH := $(if $(filter raspberrypi qemu-arm64,$(BOARD)),arm64,amd64)
IMAGE_BUILD := build/image/$(BOARD_ARCH)
# A kiosk has no desktop and reads no OpenEXR or WebP.
IMAGE_SWITCHES := WITH_SDL=0 WITH_EXR=0 WITH_WEBP=0

.PHONY: image image-built image-programs boot
## image: build/image/BOARD/inlay.img, for BOARD=qemu-x86_64, pc-x86_64, raspberrypi, qemu-arm64
image:
	$(known_board)
	$(Q)board/deps.sh image
	$(AGAIN) image-built BOARD=$(BOARD)
image-built: all
	$(Q)BUILD="$(BUILD)" board/image/demo.sh
	$(Q)board/image/programs.sh $(BOARD_ARCH) $(IMAGE_BUILD) $(IMAGE_SWITCHES)
	$(Q)BUILD=$(IMAGE_BUILD) board/image/image.sh $(BOARD)

# What the image holds of ours, without the offline programs (board/image/programs.sh chooses the
# compiler).
image-programs: $(filter-out %.bash $(foreach x,inlay-bake inlay-calibrate,%/$(x) %/$(x).1 %/_$(x)),$(INSTALLED)) \
	$(SHARE)/inlay.bash

## boot: start an image in QEMU, in a window where there is one (BOARD=qemu-x86_64)
boot: $(if $(wildcard build/image/$(BOARD)/inlay.img),,image)
	$(known_board)
	$(Q)board/image/boot.sh $(BOARD)

.PHONY: test-boot test-boot-installed test-boards test-boards-installed
## test-boot: boot the image of qemu-x86_64: time to the picture, hangs, power cuts (CUTS=10)
test-boot:
	$(Q)board/deps.sh image test
	$(AGAIN) test-boot-installed
test-boot-installed: $(VM_PROGRAMS)
	$(Q)$(MAKE) --no-print-directory image-built BOARD=qemu-x86_64
	$(Q)$(RUN_TESTS) boot tests/boot/run.sh
## test-boards: the same for the other boards, as far as QEMU can be them (half an hour)
test-boards:
	$(Q)board/deps.sh deep
	$(AGAIN) test-boards-installed
test-boards-installed: $(VM_PROGRAMS)
	$(Q)for board in $(TEST_BOARDS); do \
		$(MAKE) --no-print-directory image-built BOARD=$$board || exit; done
	$(Q)BOARDS="$(TEST_BOARDS)" $(RUN_TESTS) boards tests/boot/run.sh
