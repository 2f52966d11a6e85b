# SPDX-License-Identifier: MIT
# Support and tests are compiled with all of these, and linked with cmocka and their room's libraries.
tests_PACKAGES := $(cmocka_PACKAGES) $(drivers_PACKAGES) $(hal_PACKAGES)
cmocka_PACKAGES := cmocka libturbojpeg
SUPPORT_SOURCES := \
	tests/support/as_file.c \
	tests/support/captured_log.c \
	tests/support/chance.c \
	tests/support/expect.c \
	tests/support/guarded_screen.c \
	tests/support/own_folder.c \
	tests/support/plain_pipeline.c \
	tests/support/played_v4l2.c \
	tests/support/studio_lights.c \
	tests/support/test.c \
	tests/support/thorough.c \
	tests/support/bake/baked_rows.c \
	tests/support/bake/encode_promises.c \
	tests/support/bake/encode_rig.c \
	tests/support/bake/reseal_shard.c \
	tests/support/bake/small_scene.c \
	tests/support/basis/copied_basis.c \
	tests/support/basis/hand_block.c \
	tests/support/basis/random_frame.c \
	tests/support/basis/synthetic_basis.c \
	tests/support/basis/synthetic_block.c \
	tests/support/calibrate/drawn_board.c \
	tests/support/calibrate/drawn_lamps.c \
	tests/support/calibrate/fisheye_photographs.c \
	tests/support/calibrate/fisheye_views.c \
	tests/support/calibrate/known_camera.c \
	tests/support/calibrate/patch_chart.c
SUPPORT_LIB := $(BUILD)/tests/support.a
# Every tests/unit/FOLDER/ROOM/test_*.c, but for those that need what may be left out of the build.
UNIT_TESTS := $(sort $(wildcard tests/accuracy/test_*.c tests/unit/*/test_*.c tests/unit/*/*/test_*.c \
	tests/unit/*/*/*/test_*.c tests/unit/*/*/*/test_*.cpp))
UNIT_TESTS := $(filter-out %/test_kms_mode.c %/test_kms_card.c %/test_v4l2_h264.c %/test_libcamera_parts.c,$(UNIT_TESTS))
# Tests that try more when INLAY_THOROUGH is set; DEEP_ONLY_TESTS take long in any case.
THOROUGH_TESTS = $(shell grep -l 'thorough()' $(UNIT_TESTS))
DEEP_ONLY_TESTS := tests/accuracy/test_moving_lamp.c
# Sets each driver's keys, and the array of drivers is the app's.
$(BUILD)/tests/unit/config/test_config: $(BUILD)/app.a
UNIT_TESTS += $(if $(filter 1,$(WITH_KMS)),tests/unit/drivers/test_kms_mode.c \
	tests/unit/drivers/test_kms_card.c)
UNIT_TESTS += $(if $(filter 1,$(WITH_FFMPEG)),tests/unit/drivers/test_v4l2_h264.c)
# The test plays that the library is missing.
$(BUILD)/tests/unit/drivers/test_v4l2_h264: override LDFLAGS += -Wl,--wrap=dlopen
# Their V4L2 device is played: see support/played_v4l2.h.
$(addprefix $(BUILD)/tests/unit/drivers/test_,camera_v4l2 v4l2_digitizer v4l2_h264 v4l2_settings): \
	override LDFLAGS += -Wl,--wrap=ioctl -Wl,--wrap=epoll_ctl
# The test plays the adapter.
$(BUILD)/tests/unit/drivers/test_cec: override LDFLAGS += -Wl,--wrap=ioctl
# The test plays the graphics card.
$(BUILD)/tests/unit/drivers/test_kms_card: override LDFLAGS += -Wl,--wrap=mmap
$(BUILD)/tests/unit/bake/calibrate/camera/test_camera_photographs.o $(BUILD)/tests/unit/bake/calibrate/convert/test_convert_opencv.o: OWN_FLAGS = -isystem /usr/include/opencv4
UNIT_TESTS += $(if $(filter 1,$(WITH_LIBCAMERA)),tests/unit/drivers/test_camera_libcamera.cpp \
	tests/unit/drivers/test_libcamera_parts.c)
# The test plays libudev, and another folder for /dev.
$(BUILD)/tests/unit/drivers/test_libcamera_parts: override LDFLAGS += -Wl,--wrap=dlsym -Wl,--wrap=inotify_add_watch
FUZZ_TARGETS := \
	tests/fuzz/fuzz_angles.c \
	tests/fuzz/fuzz_basis.c \
	tests/fuzz/fuzz_config.c \
	tests/fuzz/fuzz_control.c \
	tests/fuzz/fuzz_frame.c \
	tests/fuzz/fuzz_gltf.c \
	tests/fuzz/fuzz_h264.c \
	tests/fuzz/fuzz_image.c \
	tests/fuzz/fuzz_lens.c \
	tests/fuzz/fuzz_lights.c \
	tests/fuzz/fuzz_mjpeg.c \
	tests/fuzz/fuzz_msi.c \
	tests/fuzz/fuzz_obj.c \
	tests/fuzz/fuzz_picture.c \
	tests/fuzz/fuzz_place.c \
	tests/fuzz/fuzz_ply.c \
	tests/fuzz/fuzz_points.c \
	tests/fuzz/fuzz_response.c \
	tests/fuzz/fuzz_scene.c \
	tests/fuzz/fuzz_script.c \
	tests/fuzz/fuzz_shard.c \
	tests/fuzz/fuzz_state.c \
	tests/fuzz/fuzz_timing.c \
	tests/fuzz/fuzz_video.c
# Sources of app/ and bake/ that fuzz targets reach, beside all of hal/, drivers/ and config/. One that is
# missing does not link.
FUZZ_PARTS := \
	app/control/control.c \
	app/control/control_socket.c \
	app/control/snapshot.c \
	app/records/keeper.c \
	app/records/state.c \
	app/settings.c \
	bake/base/angles.c \
	bake/base/picture_file.c \
	bake/calibrate/convert/convert.c \
	bake/calibrate/convert/convert_read.c \
	bake/calibrate/estimate/linear.c \
	bake/calibrate/observe/observations.c \
	bake/exchange/msi.c \
	bake/mesh/coat_energy.c \
	bake/mesh/formats/beside.c \
	bake/mesh/formats/ears.c \
	bake/mesh/formats/mtl.c \
	bake/mesh/formats/obj.c \
	bake/mesh/formats/ply.c \
	bake/mesh/formats/soup.c \
	bake/mesh/formats/stl.c \
	bake/mesh/formats/text.c \
	bake/mesh/formats/textures.c \
	bake/mesh/gltf/accessor.cpp \
	bake/mesh/gltf/document.cpp \
	bake/mesh/gltf/draco.cpp \
	bake/mesh/gltf/geometry.cpp \
	bake/mesh/gltf/gltf.cpp \
	bake/mesh/gltf/materials.cpp \
	bake/mesh/gltf/nodes.cpp \
	bake/mesh/left_out.c \
	bake/mesh/material.c \
	bake/mesh/mesh.c \
	bake/mesh/mesh_normals.c \
	bake/mesh/mesh_used.c \
	bake/mesh/mesh_winding.c \
	bake/scene/keyframes.c \
	bake/scene/scene_file.c \
	bake/tiles/coarse.c \
	bake/tiles/finished_tile.c \
	bake/tiles/plan.c \
	bake/tiles/shard.c
# The longest first, so that none is left alone at the end.
CLI_TESTS := tests/walk/walk.sh $(addprefix tests/cli/,faults.sh service.sh actions.sh poses.sh import.sh state.sh light.sh calibrate.sh \
	hours.sh run.sh reload.sh exposures.sh preview.sh bake.sh install.sh export.sh errors.sh still.sh check.sh devices.sh \
	control.sh grab.sh bombs.sh bench.sh pace.sh)
# These take a minute, or need packages that inlay itself does not need; with INLAY_THOROUGH, which has some that
# are quick tests too do all that they can.
CLI_DEEP_TESTS := $(addprefix tests/cli/,bake.sh demo.sh report.sh shards.sh calibrate.sh install.sh deb.sh \
	actions.sh export.sh import.sh preview.sh reload.sh state.sh) tests/walk/walk.sh tests/accuracy/quick.sh
include tests/vm/vm.mk

# TEST_PROGRAMS are what scripts of `make test` call, OTHER_PROGRAMS make tables or data on demand.
# Measures how far two pictures are apart, for the accuracy table.
TEST_PROGRAMS += $(BUILD)/tests/accuracy/compare
$(BUILD)/tests/accuracy/compare: $(BUILD)/tests/accuracy/compare.o $(BUILD)/hal.a
	$(say) LINK $@
	$(Q)$(LINK) $(SHARED_LINK) $(LDFLAGS) -o $@ $^ $(hal_LIBRARIES) $(hal_LIBS) -lm
-include $(BUILD)/tests/accuracy/compare.d

# Measures the error of light from one and several exposures: exposures.sh.
OTHER_PROGRAMS += $(BUILD)/tests/accuracy/exposures
$(BUILD)/tests/accuracy/exposures: $(BUILD)/tests/accuracy/exposures.o \
		$(BUILD)/tests/accuracy/exposures_random.o $(BUILD)/tests/accuracy/exposures_truth.o \
		$(SUPPORT_LIB) $(addprefix $(BUILD)/,app.a calibrate.a drivers.a config.a bake.a hal.a)
	$(say) LINK $@
	$(Q)$(CXX) $(SHARED_LINK) $(LDFLAGS) -o $@ $^ $(EVERY_LINK)
-include $(BUILD)/tests/accuracy/exposures.d $(BUILD)/tests/accuracy/exposures_random.d \
	$(BUILD)/tests/accuracy/exposures_truth.d

# Judge how people are found, beside OpenCV's ways: people/people.sh.
PEOPLE_OBJECTS := $(addprefix $(BUILD)/tests/people/,render.o judge.o fit.o judged.o rooms.o recording.o filmed.o subtractors.o)
OTHER_PROGRAMS += $(addprefix $(BUILD)/tests/people/,render judge fit)
$(BUILD)/tests/people/subtractors.o: OWN_FLAGS = -isystem /usr/include/opencv4
$(addprefix $(BUILD)/tests/people/,render judge fit): %: %.o \
		$(addprefix $(BUILD)/tests/people/,judged.o rooms.o recording.o filmed.o subtractors.o) \
		$(addprefix $(BUILD)/,drivers.a hal.a)
	$(say) LINK $@
	$(Q)$(CXX) $(SHARED_LINK) -Wl,--as-needed $(LDFLAGS) -o $@ $^ $(drivers_LIBRARIES) \
		-lopencv_video -lopencv_imgproc -lopencv_core $(HAL_LINK)
-include $(PEOPLE_OBJECTS:.o=.d)

# Judges the camera's look in the same studio: people/look.sh.
OTHER_PROGRAMS += $(BUILD)/tests/people/look
$(BUILD)/tests/people/look: $(addprefix $(BUILD)/tests/people/,look.o filmed.o) \
		$(addprefix $(BUILD)/,drivers.a hal.a)
	$(say) LINK $@
	$(Q)$(CXX) $(SHARED_LINK) -Wl,--as-needed $(LDFLAGS) -o $@ $^ $(drivers_LIBRARIES) $(HAL_LINK)
-include $(BUILD)/tests/people/look.d

# Measures what inlay makes of a real film: film/film.sh.
OTHER_PROGRAMS += $(BUILD)/tests/film/measure
$(BUILD)/tests/film/measure: $(BUILD)/tests/film/measure.o $(addprefix $(BUILD)/,drivers.a hal.a)
	$(say) LINK $@
	$(Q)$(CXX) $(SHARED_LINK) -Wl,--as-needed $(LDFLAGS) -o $@ $^ $(drivers_LIBRARIES) $(HAL_LINK)
-include $(BUILD)/tests/film/measure.d

# Measures the time of a camera's calibration; run by hand.
OTHER_PROGRAMS += $(BUILD)/tests/bench/bench_camera
$(BUILD)/tests/bench/bench_camera: $(BUILD)/tests/bench/bench_camera.o $(SUPPORT_LIB) \
		$(addprefix $(BUILD)/,calibrate.a bake.a drivers.a config.a hal.a)
	$(say) LINK $@
	$(Q)$(CXX) $(SHARED_LINK) -Wl,--as-needed $(LDFLAGS) -o $@ $^ $(CALIBRATE_LINK)
-include $(BUILD)/tests/bench/bench_camera.d

# Times other ways to make a frame: bench/peers.sh.
OTHER_PROGRAMS += $(BUILD)/tests/bench/peers
$(BUILD)/tests/bench/peers_sums.o: OWN_FLAGS = -isystem /usr/include/opencv4
$(BUILD)/tests/bench/peers.o: OWN_FLAGS = $(shell pkg-config --cflags lapacke openblas pixman-1)
$(BUILD)/tests/bench/peers: $(addprefix $(BUILD)/tests/bench/,peers.o peers_sums.o) $(BUILD)/hal.a
	$(say) LINK $@
	$(Q)$(CXX) $(SHARED_LINK) $(LDFLAGS) -o $@ $^ -lopencv_core -llapacke -lopenblas -lpixman-1 $(HAL_LINK)
-include $(BUILD)/tests/bench/peers.d $(BUILD)/tests/bench/peers_sums.d

# Writes the seeds of fuzz_basis anew when the format has changed.
OTHER_PROGRAMS += $(BUILD)/tests/fuzz/corpus/basis_seeds
$(BUILD)/tests/fuzz/corpus/basis_seeds: $(BUILD)/tests/fuzz/corpus/basis_seeds.o $(SUPPORT_LIB) $(BUILD)/hal.a
	$(say) LINK $@
	$(Q)$(LINK) $(SHARED_LINK) $(LDFLAGS) -o $@ $^ $(hal_LIBRARIES) $(hal_LIBS) -lm
-include $(BUILD)/tests/fuzz/corpus/basis_seeds.d

# Loaded into a program: one counts its heap allocations, one plays the clock on the wall, one a file that
# takes long to read.
LOADED_TOOLS := $(addprefix $(BUILD)/tests/cli/tools/,allocations.so wall_clock.so held_file.so)
TEST_PROGRAMS += $(LOADED_TOOLS)
$(LOADED_TOOLS): $(BUILD)/%.so: %.c
	@mkdir -p $(@D)
	$(say) LINK $@
	$(Q)$(CC) -std=gnu17 $(WARNINGS) -D_GNU_SOURCE -O2 -fPIC -shared -o $@ $<

# Draw what the cameras of a calibration see: boards; a room and boards in it.
PAINTERS := $(addprefix $(BUILD)/tests/,cli/tools/photographs walk/room)
TEST_PROGRAMS += $(PAINTERS)
$(PAINTERS): %: %.o $(SUPPORT_LIB) $(addprefix $(BUILD)/,calibrate.a bake.a drivers.a config.a hal.a)
	$(say) LINK $@
	$(Q)$(CXX) $(SHARED_LINK) -Wl,--as-needed $(LDFLAGS) -o $@ $^ $(CALIBRATE_LINK)
-include $(addsuffix .d,$(PAINTERS))

# The kernels' test stands alone, without libraries, so that it can be built for another processor
# and run by an emulator.
KERNELS_TEST := $(addprefix $(BUILD)/,tests/kernels/test_kernels.o tests/kernels/compare.o \
	tests/kernels/compare_sums.o tests/kernels/compare_pixels.o \
	tests/kernels/faults.o tests/kernels/guarded.o tests/support/chance.o hal/base/fault.o hal/base/processor.o hal/colour/transfer.o) \
	$(addsuffix .o,$(addprefix $(BUILD)/,$(basename $(filter hal/compositor/kernels/kernel%,$(HAL_SOURCES)))))
$(BUILD)/tests/kernels/test_kernels: $(KERNELS_TEST)
	$(say) LINK $@
	$(Q)$(CC) $(SHARED_LINK) $(if $(SANITIZE),,-static) $(LDFLAGS) -o $@ $^ -lm
-include $(KERNELS_TEST:.o=.d)
