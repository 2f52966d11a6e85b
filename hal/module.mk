hal_PACKAGES := libturbojpeg libpng libxxhash inih $(if $(filter 1,$(WITH_EXR)),OpenEXR)
hal_LIBS := -lyuv
HAL_SOURCES := \
	hal/buttons.c \
	hal/camera.c \
	hal/camera_choice.c \
	hal/camera_controls.c \
	hal/camera_situation.c \
	hal/display.c \
	hal/fault.c \
	hal/frame.c \
	hal/frame_decode.c \
	hal/frame_fields.c \
	hal/frame_jpeg.c \
	hal/frame_ycbcr.c \
	hal/log.c \
	hal/output.c \
	hal/pool.c \
	hal/processor.c \
	hal/transfer.c \
	hal/view.c \
	hal/ini/ini.c \
	hal/ini/ini_names.c \
	hal/ini/ini_sample.c \
	hal/ini/ini_value.c \
	hal/basis/basis.c \
	hal/basis/basis_blocks.c \
	hal/basis/basis_chunks.c \
	hal/basis/basis_layout.c \
	hal/basis/basis_writer.c \
	hal/compositor/compositor.c \
	hal/compositor/kernel_curves.c \
	hal/compositor/kernels.c \
	hal/compositor/kernels_c.c \
	hal/compositor/reference.c \
	hal/compositor/selection.c \
	hal/compositor/tile.c \
	hal/compositor/weights.c \
	hal/image/image.c \
	hal/image/image_png.c \
	hal/image/image_jpeg.c \
	hal/image/image_hdr.c \
	hal/image/image_pfm.c \
	hal/lights/lights_file.c \
	hal/lights/sampler.c \
	hal/lights/sampler_table.c \
	hal/optics/dome.c \
	hal/optics/dome_cells.c \
	hal/optics/dome_lookup.c \
	hal/optics/dome_nodes.c \
	hal/optics/fisheye.c \
	hal/optics/panorama.c \
	hal/optics/tsai.c
HAL_SOURCES += $(if $(filter 1,$(WITH_EXR)),hal/image/image_exr.cpp)
