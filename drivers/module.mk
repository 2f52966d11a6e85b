# SPDX-License-Identifier: MIT
drivers_PACKAGES := $(if $(filter 1,$(WITH_KMS)),libdrm) $(if $(filter 1,$(WITH_SDL)),sdl2) \
	$(if $(filter 1,$(WITH_GPIO)),libgpiod) $(if $(filter 1,$(WITH_LIBCAMERA)),libcamera)
DRIVER_SOURCES := \
	drivers/buttons_keyboard.c \
	drivers/buttons_script.c \
	drivers/camera_sim.c \
	drivers/camera_v4l2.c \
	drivers/cec.c \
	drivers/display_file.c \
	drivers/display_null.c \
	drivers/drivers.c \
	drivers/gpio/button.c \
	drivers/gpio/edge_order.c \
	drivers/gpio/quadrature.c \
	drivers/keyboard/keymap.c \
	drivers/keyboard/keys.c \
	drivers/sim/automatic.c \
	drivers/sim/eye.c \
	drivers/sim/options.c \
	drivers/sim/panorama_view.c \
	drivers/sim/player.c \
	drivers/sim/sensor.c \
	drivers/sim/spread.c \
	drivers/sim/studio.c \
	drivers/sim/studio_people.c \
	drivers/sim/studio_view.c \
	drivers/sim/walker_body.c \
	drivers/sim/walkers.c \
	drivers/sim/y4m.c \
	drivers/v4l2/buffers.c \
	drivers/v4l2/capture.c \
	drivers/v4l2/controls.c \
	drivers/v4l2/device.c \
	drivers/v4l2/find.c \
	drivers/v4l2/fields.c \
	drivers/v4l2/formats.c \
	drivers/v4l2/h264.c \
	drivers/v4l2/h264_unit.c \
	drivers/v4l2/input.c \
	drivers/v4l2/listing.c \
	drivers/v4l2/offers.c \
	drivers/v4l2/setup.c
DRIVER_SOURCES += $(if $(filter 1,$(WITH_KMS)),drivers/display_kms.c \
	drivers/kms/connector.c drivers/kms/console.c drivers/kms/find.c drivers/kms/list.c \
	drivers/kms/mode.c drivers/kms/screen.c drivers/kms/second.c drivers/kms/state.c drivers/kms/watch.c)
DRIVER_SOURCES += $(if $(filter 1,$(WITH_SDL)),drivers/display_window.c)
DRIVER_SOURCES += $(if $(filter 1,$(WITH_GPIO)),drivers/buttons_gpio.c drivers/buttons_gpio_encoder.c \
	drivers/gpio/lines.c)
DRIVER_SOURCES += $(if $(filter 1,$(WITH_LIBCAMERA)),drivers/camera_libcamera.cpp \
	drivers/libcamera/configuration.cpp drivers/libcamera/controls.c drivers/libcamera/events.c \
	drivers/libcamera/find.c drivers/libcamera/hotplug.c drivers/libcamera/library_controls.cpp \
	drivers/libcamera/listing.cpp drivers/libcamera/log_stream.cpp drivers/libcamera/manager.cpp \
	drivers/libcamera/messages.c drivers/libcamera/picture.c drivers/libcamera/session.cpp \
	drivers/libcamera/slots.cpp)
