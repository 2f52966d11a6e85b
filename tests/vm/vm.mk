# The tests on simulated hardware. Debian packages (board/deps.sh installs them): qemu-system-x86
# linux-source-6.1 busybox-static cpio kmod xz-utils flex bison bc libelf-dev v4l-utils libdrm-dev,
# and what building needs anyway (gcc, make).

VM_PROGRAMS := $(addprefix $(BUILD)/tests/vm/,capture picture presses show) \
	$(if $(filter 1,$(WITH_KMS)),$(BUILD)/tests/vm/scanout)

$(addprefix $(BUILD)/tests/vm/,capture presses show): $(BUILD)/drivers.a
$(VM_PROGRAMS): $(BUILD)/%: $(BUILD)/%.o $(BUILD)/hal.a
	$(say) LINK $@
	$(Q)$(CC) $(SHARED_LINK) $(LDFLAGS) -o $@ $< \
		$(filter %/drivers.a,$^) $(BUILD)/hal.a $(APP_LINK)

-include $(addsuffix .d,$(VM_PROGRAMS))

# What the live tests show. Baked here, because the guest's processors are emulated.
VM_BASIS := $(BUILD)/tests/vm/live/live.inlay
$(VM_BASIS): tests/vm/live.scene $(BUILD)/inlay-bake $(BUILD)/make-cow
	@mkdir -p $(@D)
	$(say) BAKE $@
	$(Q)$(BUILD)/make-cow $(@D)
	$(Q)cp $< $(@D)/live.scene
	$(Q)$(BUILD)/inlay-bake render $(@D)/live.scene -o $@ >$(@D)/bake.log 2>&1 || \
		{ cat $(@D)/bake.log >&2; exit 1; }

.PHONY: kernel test-vm vm-shell
## kernel: build the simulated machine's kernel, once; it is kept in ~/.cache/inlay (some minutes)
kernel:
	$(Q)board/qemu-x86_64/build-kernel.sh
## test-vm: the real programs on vivid, vkms, virtio-gpu and gpio-sim in QEMU (FILTER=name: some)
test-vm: all $(VM_PROGRAMS) $(VM_BASIS) kernel
	$(Q)FILTER="$(FILTER)" $(RUN_TESTS) vm tests/vm/run.sh
## vm-shell: a shell in the simulated machine (leave it with exit)
vm-shell: all $(VM_PROGRAMS) $(VM_BASIS) kernel
	$(Q)BUILD="$(BUILD)" INLAY="$(abspath $(BUILD))/inlay" tests/vm/boot.sh --shell "$(BUILD)/tests/vm/shell" bash -i

objects: $(addsuffix .o,$(VM_PROGRAMS))
