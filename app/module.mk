app_PACKAGES := $(if $(filter 1,$(WITH_CAIRO)),cairo) $(if $(filter 1,$(WITH_SYSTEMD)),libsystemd)
APP_SOURCES := \
	app/bench.c \
	app/bench_frame.c \
	app/bench_memory.c \
	app/bench_print.c \
	app/bench_truth.c \
	app/bench_ways.c \
	app/command_bench.c \
	app/command_check.c \
	app/command_control.c \
	app/command_devices.c \
	app/command_run.c \
	app/command_still.c \
	app/control.c \
	app/control_socket.c \
	app/devices_sample.c \
	app/options.c \
	app/settings.c \
	app/driver_list.c \
	app/kiosk.c \
	app/kiosk_actions.c \
	app/kiosk_control.c \
	app/kiosk_open.c \
	app/kiosk_picture.c \
	app/kiosk_reload.c \
	app/kiosk_screen.c \
	app/kiosk_text.c \
	app/loop.c \
	app/opener.c \
	app/reload.c \
	app/service.c \
	app/state.c \
	app/stats.c \
	app/still.c \
	app/timeline.c \
	app/source.c \
	app/exposing.c \
	app/eye.c \
	app/pipeline.c \
	app/pipeline_config.c \
	app/pipeline_fade.c \
	app/pipeline_ground.c \
	app/pipeline_light.c \
	app/pipeline_pose.c \
	app/show.c \
	app/layout.c \
	app/scaler.c \
	app/marks.c \
	app/overlay.c \
	app/utf8.c \
	app/words.c
APP_SOURCES += $(if $(filter 1,$(WITH_CAIRO)),app/panel.c app/typeset.c,app/panel_none.c)
APP_MAIN := app/main.c
