# SPDX-License-Identifier: MIT
# The tests on simulated hardware; board/deps.sh names the Debian packages that they need.

VM_PROGRAMS := $(addprefix $(BUILD)/tests/vm/tools/,capture keys picture presses show) \
	$(if $(filter 1,$(WITH_KMS)),$(BUILD)/tests/vm/tools/scanout)

$(addprefix $(BUILD)/tests/vm/tools/,capture keys presses show): $(BUILD)/drivers.a
$(addprefix $(BUILD)/tests/vm/tools/,capture presses show): $(BUILD)/tests/vm/tools/driver_option.o
$(VM_PROGRAMS): $(BUILD)/%: $(BUILD)/%.o $(BUILD)/hal.a
	$(say) LINK $@
	$(Q)$(LINK) $(SHARED_LINK) $(LDFLAGS) -o $@ $(filter %.o,$^) \
		$(filter %/drivers.a,$^) $(BUILD)/hal.a $(APP_LINK)

-include $(addsuffix .d,$(VM_PROGRAMS)) $(BUILD)/tests/vm/tools/driver_option.d

# Has libcamera treat vimc as a webcam.
VM_LIBRARIES := $(if $(filter 1,$(WITH_LIBCAMERA)),$(BUILD)/tests/vm/tools/webcam.so)
$(VM_LIBRARIES): tests/vm/tools/webcam.c
	@mkdir -p $(@D)
	$(say) LINK $@
	$(Q)$(CC) -std=gnu17 $(WARNINGS) -D_GNU_SOURCE -O2 -fPIC -shared -o $@ $<

# What a machine needs that runs the programs just built. (Another processor skips the tests.)
VM_READY := all $(VM_PROGRAMS) $(VM_LIBRARIES) $(BUILD)/tests/cli/tools/allocations.so \
	$(if $(filter x86_64,$(MACHINE)),kernel)
VM ?= uml
.PHONY: kernel test-vm test-vm-installed test-vm-qemu test-vm-qemu-installed vm-shell
## kernel: build the simulated machine's kernel, once; it is kept in ~/.cache/inlay (some minutes)
kernel:
	$(Q)board/build-kernel.sh uml
## test-vm: the real programs on vivid, vkms and gpio-sim in user-mode Linux (FILTER=name: some)
test-vm:
	$(Q)board/deps.sh test
	$(AGAIN) test-vm-installed
test-vm-installed: $(VM_READY)
	$(Q)$(RUN_TESTS) vm "tests/vm/run.sh uml $(FILTER)"
## test-vm-qemu: those that need virtio-gpu, in QEMU (FILTER=name: some)
test-vm-qemu:
	$(Q)board/deps.sh image test
	$(AGAIN) test-vm-qemu-installed
test-vm-qemu-installed: $(VM_READY)
	$(Q)$(RUN_TESTS) vm "tests/vm/run.sh qemu $(FILTER)"
## vm-shell: a shell in the simulated machine (leave it with exit; VM=qemu: in QEMU)
vm-shell: $(VM_READY)
	$(Q)BUILD="$(BUILD)" tests/vm/bake.sh
	$(Q)BUILD="$(BUILD)" INLAY="$(abspath $(BUILD))/inlay" tests/vm/$(VM).sh --shell "$(BUILD)/tests/vm/shell" setsid --ctty --wait bash -i

# The address sanitizer needs a build of its own.
SOAK_SANITIZED := build/sanitize-address-undefined
MINUTES ?= 10
.PHONY: soak soak-installed
## soak: faults at random for MINUTES=10, as built and under the sanitizers (SEED=n repeats one)
soak:
	$(Q)tests/vm/run_soak.sh --check "$(MINUTES)" "$(SEED)"
	$(Q)board/deps.sh test
	$(AGAIN) soak-installed
soak-installed: $(VM_READY)
	$(Q)$(MAKE) --no-print-directory SANITIZE=address,undefined OPTIMIZE="-O1 -g1" \
		BUILD=$(SOAK_SANITIZED) $(SOAK_SANITIZED)/inlay
	$(Q)BUILD="$(BUILD)" tests/vm/bake.sh
	$(Q)BUILD="$(BUILD)" SANITIZED="$(SOAK_SANITIZED)" tests/vm/run_soak.sh $(MINUTES) $(SEED)

objects: $(addsuffix .o,$(VM_PROGRAMS))
