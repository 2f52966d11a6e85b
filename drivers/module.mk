drivers_PACKAGES := $(if $(filter 1,$(WITH_KMS)),libdrm) $(if $(filter 1,$(WITH_SDL)),sdl2) \
	$(if $(filter 1,$(WITH_GPIO)),libgpiod)
DRIVER_SOURCES := \
	drivers/drivers.c \
	drivers/buttons_script.c \
	drivers/display_file.c \
	drivers/display_null.c
