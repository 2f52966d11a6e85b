# SPDX-License-Identifier: MIT
# inlay-calibrate. Debian's OpenCV has no pkg-config file without the whole of it; only the C++ files
# here see its headers.
CALIBRATE_SOURCES := \
	bake/calibrate/command_board.c \
	bake/calibrate/command_camera.c \
	bake/calibrate/command_convert.c \
	bake/calibrate/command_fisheye.c \
	bake/calibrate/command_lamps.c \
	bake/calibrate/command_light.c \
	bake/calibrate/command_sky.c \
	bake/calibrate/lens_job.c \
	bake/calibrate/light_command_match.c \
	bake/calibrate/light_command_merge.c \
	bake/calibrate/light_command_pictures.c \
	bake/calibrate/light_job.c \
	bake/calibrate/bracket/light_exif.c \
	bake/calibrate/bracket/light_merge.c \
	bake/calibrate/bracket/light_rsp.c \
	bake/calibrate/camera/camera.c \
	bake/calibrate/camera/camera_edges.c \
	bake/calibrate/camera/camera_figures.c \
	bake/calibrate/camera/camera_guess.c \
	bake/calibrate/camera/camera_held.c \
	bake/calibrate/camera/camera_model.c \
	bake/calibrate/camera/camera_problem.c \
	bake/calibrate/camera/camera_radial.c \
	bake/calibrate/camera/camera_solve.c \
	bake/calibrate/camera/camera_structure.c \
	bake/calibrate/camera/camera_pose.cpp \
	bake/calibrate/camera/camera_verdict.c \
	bake/calibrate/camera/camera_verdict_points.c \
	bake/calibrate/convert/convert.c \
	bake/calibrate/convert/convert_read.c \
	bake/calibrate/convert/convert_write.c \
	bake/calibrate/estimate/by_view.c \
	bake/calibrate/estimate/estimate.c \
	bake/calibrate/estimate/finding.c \
	bake/calibrate/estimate/least_squares.c \
	bake/calibrate/estimate/lens_ini.c \
	bake/calibrate/estimate/linear.c \
	bake/calibrate/estimate/order.c \
	bake/calibrate/estimate/rotation.c \
	bake/calibrate/estimate/verdict.c \
	bake/calibrate/fisheye/fisheye_doubts.c \
	bake/calibrate/fisheye/fisheye_falloff.c \
	bake/calibrate/fisheye/fisheye_find.c \
	bake/calibrate/fisheye/fisheye_knowledge.c \
	bake/calibrate/fisheye/fisheye_models.c \
	bake/calibrate/fisheye/fisheye_optics.c \
	bake/calibrate/fisheye/fisheye_solve.c \
	bake/calibrate/fisheye/fisheye_start.c \
	bake/calibrate/fisheye/fisheye_turn.c \
	bake/calibrate/fisheye/circle/fisheye_circle.c \
	bake/calibrate/fisheye/circle/fisheye_ellipse.c \
	bake/calibrate/fisheye/circle/fisheye_rim.c \
	bake/calibrate/lamps/lamp_match.c \
	bake/calibrate/lamps/lamp_places.c \
	bake/calibrate/lamps/lamp_sight.c \
	bake/calibrate/observe/boards.c \
	bake/calibrate/observe/boards_charuco.cpp \
	bake/calibrate/observe/boards_chess.cpp \
	bake/calibrate/observe/boards_corner.cpp \
	bake/calibrate/observe/boards_find.c \
	bake/calibrate/observe/boards_look.cpp \
	bake/calibrate/observe/boards_marker.cpp \
	bake/calibrate/observe/boards_print.c \
	bake/calibrate/observe/gather.c \
	bake/calibrate/observe/live.c \
	bake/calibrate/observe/live_collect.c \
	bake/calibrate/observe/live_screen.c \
	bake/calibrate/observe/observations.c \
	bake/calibrate/report/report.c \
	bake/calibrate/report/report_sheet.c \
	bake/calibrate/report/report_shown.c \
	bake/calibrate/report/report_tables.c \
	bake/calibrate/report/report_views.c \
	bake/calibrate/response/light_black.c \
	bake/calibrate/response/light_colours.c \
	bake/calibrate/response/light_file.c \
	bake/calibrate/response/light_gain.c \
	bake/calibrate/response/light_patch.c \
	bake/calibrate/response/light_report.c \
	bake/calibrate/response/light_response.c \
	bake/calibrate/response/light_response_doubts.c \
	bake/calibrate/response/light_response_fit.c \
	bake/calibrate/response/light_response_real.c \
	bake/calibrate/response/light_samples.c \
	bake/calibrate/response/light_spline.c
CALIBRATE_MAIN := bake/calibrate/main.c
calibrate_PACKAGES := cminpack libexif yaml-0.1
calibrate_LIBS := -lopencv_aruco -lopencv_objdetect -lopencv_calib3d -lopencv_features2d -lopencv_imgproc -lopencv_core
$(call objects,$(filter %.c,$(CALIBRATE_SOURCES))): OWN_FLAGS = $(calibrate_CFLAGS)
$(call objects,$(filter %.cpp,$(CALIBRATE_SOURCES))): OWN_FLAGS = -isystem /usr/include/opencv4
