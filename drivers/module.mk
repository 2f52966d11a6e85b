drivers_PACKAGES := $(if $(filter 1,$(WITH_KMS)),libdrm) $(if $(filter 1,$(WITH_SDL)),sdl2) \
	$(if $(filter 1,$(WITH_GPIO)),libgpiod)
DRIVER_SOURCES :=
