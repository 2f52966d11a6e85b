hal_PACKAGES := libturbojpeg libpng libxxhash inih $(if $(filter 1,$(WITH_EXR)),OpenEXR)
hal_LIBS := -lyuv
HAL_SOURCES := \
	hal/camera.c \
	hal/fault.c \
	hal/frame.c \
	hal/frame_decode.c \
	hal/log.c \
	hal/output.c \
	hal/pool.c \
	hal/transfer.c \
	hal/view.c \
	hal/optics/fisheye.c \
	hal/optics/panorama.c \
	hal/optics/tsai.c
