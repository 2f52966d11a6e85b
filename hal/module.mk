# SPDX-License-Identifier: MIT
hal_PACKAGES := libjpeg libpng libxxhash libzstd inih $(if $(filter 1,$(WITH_EXR)),OpenEXR) \
	$(if $(filter 1,$(WITH_WEBP)),libwebp)
hal_LIBS := -lyuv
HAL_SOURCES := \
	hal/base/budget.c \
	hal/base/fault.c \
	hal/base/input.c \
	hal/base/json.c \
	hal/base/log.c \
	hal/base/number.c \
	hal/base/output.c \
	hal/base/plain_text.c \
	hal/base/pool.c \
	hal/base/processor.c \
	hal/base/table.c \
	hal/base/text_file.c \
	hal/base/utf8.c \
	hal/basis/basis.c \
	hal/basis/basis_blocks.c \
	hal/basis/basis_chunks.c \
	hal/basis/basis_file.c \
	hal/basis/basis_glass.c \
	hal/basis/basis_groups.c \
	hal/basis/basis_layout.c \
	hal/basis/basis_names.c \
	hal/basis/basis_places.c \
	hal/basis/basis_reader.c \
	hal/basis/basis_store.c \
	hal/basis/basis_writer.c \
	hal/basis/pack.c \
	hal/colour/crossfade.c \
	hal/colour/response.c \
	hal/colour/transfer.c \
	hal/compositor/backdrop.c \
	hal/compositor/block_sums.c \
	hal/compositor/column_choice.c \
	hal/compositor/compositor.c \
	hal/compositor/division.c \
	hal/compositor/fetch.c \
	hal/compositor/frame.c \
	hal/compositor/glass.c \
	hal/compositor/lines.c \
	hal/compositor/mirror.c \
	hal/compositor/plan.c \
	hal/compositor/reference.c \
	hal/compositor/tile.c \
	hal/compositor/steady.c \
	hal/compositor/kernels/kernel_curves.c \
	hal/compositor/kernels/kernels.c \
	hal/compositor/kernels/kernels_c.c \
	hal/compositor/kernels/kernels_isa.c \
	hal/compositor/light/light_budget.c \
	hal/compositor/light/light_terms.c \
	hal/compositor/light/light_vector.c \
	hal/compositor/light/selection.c \
	hal/compositor/live/grain.c \
	hal/compositor/live/lit_rows.c \
	hal/compositor/live/veiled_tile.c \
	hal/compositor/near/near_layer.c \
	hal/compositor/near/near_sky.c \
	hal/device/buttons.c \
	hal/device/camera.c \
	hal/device/display.c \
	hal/device/node_link.c \
	hal/frame/frame.c \
	hal/frame/frame_decode.c \
	hal/frame/frame_fields.c \
	hal/frame/frame_jpeg.c \
	hal/frame/frame_reader.c \
	hal/frame/frame_rows.c \
	hal/frame/frame_ycbcr.c \
	hal/frame/view.c \
	hal/image/image.c \
	hal/image/image_foreign.c \
	hal/image/image_hdr.c \
	hal/image/image_jpeg.c \
	hal/image/image_pfm.c \
	hal/image/image_pixels.c \
	hal/image/image_png.c \
	hal/ini/ini.c \
	hal/ini/ini_names.c \
	hal/ini/ini_sample.c \
	hal/ini/ini_value.c \
	hal/jpeg/jpeg_decoder.c \
	hal/lights/exposure_schedule.c \
	hal/lights/exposures.c \
	hal/lights/lamp/lamp_find.c \
	hal/lights/lamp/lamp_light.c \
	hal/lights/light_filter.c \
	hal/lights/lights_file.c \
	hal/lights/pixel_noise.c \
	hal/lights/recovery.c \
	hal/lights/sampler.c \
	hal/lights/sampler_c.c \
	hal/lights/sampler_frame.c \
	hal/lights/sampler_kernels.c \
	hal/lights/sampler_shares.c \
	hal/lights/sampler_table.c \
	hal/look/exposure.c \
	hal/look/flicker.c \
	hal/look/grain_tables.c \
	hal/look/median.c \
	hal/look/sensor_noise.c \
	hal/measure/error.c \
	hal/measure/lightings.c \
	hal/measure/thesis.c \
	hal/measure/turns.c \
	hal/measure/unpacked.c \
	hal/options/options.c \
	hal/mirror/mirror_eye.c \
	hal/mirror/mirror_look.c \
	hal/mirror/mirror_map.c \
	hal/optics/distortion.c \
	hal/optics/dome.c \
	hal/optics/dome_cells.c \
	hal/optics/dome_lookup.c \
	hal/optics/dome_nodes.c \
	hal/optics/dome_placed.c \
	hal/optics/dome_facets.c \
	hal/optics/dome_triangles.c \
	hal/optics/fisheye.c \
	hal/optics/fisheye_curve.c \
	hal/optics/panorama.c \
	hal/people/cells.c \
	hal/people/depths.c \
	hal/people/drift.c \
	hal/people/edges.c \
	hal/people/footprint.c \
	hal/people/gain.c \
	hal/people/groups.c \
	hal/people/nudge.c \
	hal/people/outline.c \
	hal/people/people.c \
	hal/people/persons.c \
	hal/people/place.c \
	hal/people/saved.c \
	hal/people/verdict.c \
	hal/optics/tsai.c
# The compositor's inner loops: only these files are built for more than every processor has.
HAL_SOURCES += $(addprefix hal/compositor/kernels/kernels_,$(if $(filter x86_64,$(MACHINE)),\
	sse41.c avx2.c avx512.c)$(if $(filter aarch64,$(MACHINE)),neon.c neon_dotprod.c))
$(BUILD)/hal/compositor/kernels/kernels_sse41.o: OWN_FLAGS := -msse4.1
$(BUILD)/hal/compositor/kernels/kernels_avx2.o: OWN_FLAGS := -mavx2
$(BUILD)/hal/compositor/kernels/kernels_avx512.o: OWN_FLAGS := -mavx512f -mavx512bw -mavx512dq -mavx512vl \
	-mavx512vnni
$(BUILD)/hal/compositor/kernels/kernels_neon_dotprod.o: OWN_FLAGS := -march=armv8.2-a+dotprod
HAL_SOURCES += $(if $(filter 1,$(WITH_EXR)),hal/image/image_exr.cpp) \
	$(if $(filter 1,$(WITH_WEBP)),hal/image/image_webp.c)
# Without this gcc makes branches of choices between floats, and no vectors. It changes no result.
$(addprefix $(BUILD)/hal/people/,cells.o drift.o gain.o place.o verdict.o): OWN_FLAGS := -fno-trapping-math

# Rows of video and light sampling; as above.
ifeq ($(MACHINE),x86_64)
HAL_SOURCES += hal/frame/frame_rows_avx2.c hal/lights/sampler_avx2.c
$(BUILD)/hal/frame/frame_rows_avx2.o $(BUILD)/hal/lights/sampler_avx2.o: OWN_FLAGS := -mavx2
else ifeq ($(MACHINE),aarch64)
HAL_SOURCES += hal/frame/frame_rows_neon.c hal/lights/sampler_neon.c
endif
