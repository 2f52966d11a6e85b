# SPDX-License-Identifier: MIT
app_PACKAGES := $(if $(filter 1,$(WITH_CAIRO)),cairo) $(if $(filter 1,$(WITH_SYSTEMD)),libsystemd)
APP_SOURCES := \
	app/command_check.c \
	app/command_control.c \
	app/command_devices.c \
	app/command_grab.c \
	app/command_run.c \
	app/command_still.c \
	app/devices_sample.c \
	app/grab.c \
	app/settings.c \
	app/bench/bench.c \
	app/bench/bench_frame.c \
	app/bench/bench_print.c \
	app/bench/bench_truth.c \
	app/bench/bench_ways.c \
	app/bench/command_bench.c \
	app/camera/exposing.c \
	app/camera/eye.c \
	app/camera/opener.c \
	app/camera/settling.c \
	app/camera/source.c \
	app/control/control.c \
	app/control/control_socket.c \
	app/control/snapshot.c \
	app/kiosk/kiosk.c \
	app/kiosk/kiosk_actions.c \
	app/kiosk/kiosk_control.c \
	app/kiosk/kiosk_doubt.c \
	app/kiosk/kiosk_light.c \
	app/kiosk/kiosk_open.c \
	app/kiosk/kiosk_parts.c \
	app/kiosk/kiosk_picture.c \
	app/kiosk/kiosk_reload.c \
	app/kiosk/kiosk_rest.c \
	app/kiosk/kiosk_rest.c \
	app/kiosk/kiosk_screen.c \
	app/kiosk/kiosk_snapshot.c \
	app/kiosk/kiosk_text.c \
	app/kiosk/loop.c \
	app/kiosk/reload.c \
	app/kiosk/rest.c \
	app/kiosk/rest.c \
	app/kiosk/service.c \
	app/kiosk/timeline.c \
	app/pipeline/coarse_lamp.c \
	app/pipeline/lamps_told.c \
	app/pipeline/pipeline.c \
	app/pipeline/pipeline_config.c \
	app/pipeline/pipeline_exposure.c \
	app/pipeline/pipeline_fade.c \
	app/pipeline/pipeline_grain.c \
	app/pipeline/pipeline_ground.c \
	app/pipeline/pipeline_light.c \
	app/pipeline/pipeline_mirror.c \
	app/pipeline/pipeline_people.c \
	app/pipeline/pipeline_pose.c \
	app/records/keeper.c \
	app/records/learned.c \
	app/records/metrics.c \
	app/records/state.c \
	app/records/supply.c \
	app/records/stats.c \
	app/view/guide.c \
	app/view/layout.c \
	app/view/marks.c \
	app/view/overlay.c \
	app/view/scaler.c \
	app/view/show.c \
	app/view/words.c
APP_SOURCES += $(if $(filter 1,$(WITH_CAIRO)),app/view/panel.c app/view/pen.c app/view/typeset.c,\
	app/view/panel_none.c)
APP_MAIN := app/main.c

# A clock that shows a time before this one has not been set, so that hours of the screen do not count yet.
$(BUILD)/app/kiosk/kiosk_rest.o: OWN_FLAGS = -DINLAY_BUILT=$(SOURCE_DATE_EPOCH)
