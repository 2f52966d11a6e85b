# inlay-calibrate. Debian's OpenCV has no pkg-config file without the whole of it; only the C++ files
# here see its headers.
CALIBRATE_SOURCES := \
	bake/calibrate/boards.c \
	bake/calibrate/boards_charuco.cpp \
	bake/calibrate/boards_chess.cpp \
	bake/calibrate/boards_circles.cpp \
	bake/calibrate/boards_corner.cpp \
	bake/calibrate/boards_look.cpp \
	bake/calibrate/boards_print.c \
	bake/calibrate/camera.c \
	bake/calibrate/camera_figures.c \
	bake/calibrate/camera_file.c \
	bake/calibrate/camera_guess.c \
	bake/calibrate/camera_guess_closed.c \
	bake/calibrate/camera_held.c \
	bake/calibrate/camera_model.c \
	bake/calibrate/camera_problem.c \
	bake/calibrate/camera_solve.c \
	bake/calibrate/camera_tsai.c \
	bake/calibrate/camera_verdict.c \
	bake/calibrate/camera_verdict_points.c \
	bake/calibrate/command_board.c \
	bake/calibrate/command_camera.c \
	bake/calibrate/command_convert.c \
	bake/calibrate/command_fisheye.c \
	bake/calibrate/command_light.c \
	bake/calibrate/convert_ini.c \
	bake/calibrate/convert_lens.c \
	bake/calibrate/convert_tsai.c \
	bake/calibrate/convert_write.c \
	bake/calibrate/convert_yaml.c \
	bake/calibrate/covariance.c \
	bake/calibrate/estimate.c \
	bake/calibrate/finding.c \
	bake/calibrate/fisheye_circle.c \
	bake/calibrate/fisheye_doubts.c \
	bake/calibrate/fisheye_edge.c \
	bake/calibrate/fisheye_ellipse.c \
	bake/calibrate/fisheye_falloff.c \
	bake/calibrate/fisheye_file.c \
	bake/calibrate/fisheye_find.c \
	bake/calibrate/fisheye_knowledge.c \
	bake/calibrate/fisheye_lamps.c \
	bake/calibrate/fisheye_models.c \
	bake/calibrate/fisheye_optics.c \
	bake/calibrate/fisheye_rim.c \
	bake/calibrate/fisheye_solve.c \
	bake/calibrate/fisheye_start.c \
	bake/calibrate/fisheye_turn.c \
	bake/calibrate/gather.c \
	bake/calibrate/json.c \
	bake/calibrate/lamps_file.c \
	bake/calibrate/lamps_match.c \
	bake/calibrate/lamps_spots.c \
	bake/calibrate/lamps_trace.c \
	bake/calibrate/least_squares.c \
	bake/calibrate/lens_job.c \
	bake/calibrate/light_black.c \
	bake/calibrate/light_colours.c \
	bake/calibrate/light_command_delay.c \
	bake/calibrate/light_command_match.c \
	bake/calibrate/light_command_pictures.c \
	bake/calibrate/light_delay.c \
	bake/calibrate/light_file.c \
	bake/calibrate/light_gain.c \
	bake/calibrate/light_patch.c \
	bake/calibrate/light_report.c \
	bake/calibrate/light_response.c \
	bake/calibrate/light_response_doubts.c \
	bake/calibrate/light_response_fit.c \
	bake/calibrate/light_samples.c \
	bake/calibrate/light_spline.c \
	bake/calibrate/linear.c \
	bake/calibrate/live.c \
	bake/calibrate/live_collect.c \
	bake/calibrate/live_screen.c \
	bake/calibrate/observations.c \
	bake/calibrate/plain_light.c \
	bake/calibrate/report.c \
	bake/calibrate/report_directions.c \
	bake/calibrate/report_json.c \
	bake/calibrate/report_maps.c \
	bake/calibrate/report_matrix.c \
	bake/calibrate/report_sheet.c \
	bake/calibrate/report_shown.c \
	bake/calibrate/report_tables.c \
	bake/calibrate/report_views.c \
	bake/calibrate/verdict.c
CALIBRATE_MAIN := bake/calibrate/main.c
calibrate_PACKAGES := cminpack
calibrate_LIBS := -lopencv_aruco -lopencv_objdetect -lopencv_calib3d -lopencv_features2d -lopencv_imgproc -lopencv_core
$(call objects,$(filter %.c,$(CALIBRATE_SOURCES))): OWN_FLAGS = $(call pkg_cflags,$(calibrate_PACKAGES))
$(call objects,$(filter %.cpp,$(CALIBRATE_SOURCES))): OWN_FLAGS = -isystem /usr/include/opencv4
