/* SPDX-License-Identifier: MIT */
#include "drivers/sim/sim.h"

#include <errno.h>
#include <stddef.h>
#include <string.h>

static const char *const source_names[] = {"studio", "panorama", "files", NULL};
static const char *const view_names[] = {"fisheye", "perspective", NULL};
static const char *const clock_names[] = {"real", "frames", NULL};

#define OPTION_AT(field) offsetof(struct sim_options, field)

const struct ini_key sim_keys[] = {
	{"source", INI_CHOICE, OPTION_AT(source), .choices = source_names, .fallback = "studio",
	 .help = "What is seen: a room with moving lamps, a panorama, or pictures from files."},
	{"view", INI_CHOICE, OPTION_AT(view), .choices = view_names, .fallback = "fisheye",
	 .help = "How the studio or the panorama is seen."},
	{"clock", INI_CHOICE, OPTION_AT(pace), .choices = clock_names, .fallback = "real",
	 .help = "real: a frame when it is due; frames: at once, time advancing by one period."},
	{"file", INI_PATH, OPTION_AT(file), .fallback = "",
	 .help = "The panorama, or pictures (img%03d.png), video (clip.y4m) or a pipe of it."},
	{"loop", INI_BOOL, OPTION_AT(loop), .fallback = "yes",
	 .help = "Start again at the end of the files; otherwise the camera is gone then."},
	{"camera", INI_PATH, OPTION_AT(camera), .fallback = "",
	 .help = "Perspective: a file with a [camera] section; empty: eye, target and angle."},
	{"eye", INI_REALS, OPTION_AT(eye), 3, -1e6, 1e6, .fallback = "0 -1.7 0.95", .unit = "m",
	 .help = "Perspective without a camera file: where it stands."},
	{"target", INI_REALS, OPTION_AT(target), 3, -1e6, 1e6, .fallback = "0 0 0.12", .unit = "m",
	 .help = "Perspective without a camera file: what it looks at."},
	{"angle", INI_REAL, OPTION_AT(angle_deg), .min = 1, .max = 170, .fallback = "46",
	 .unit = "deg", .help = "Perspective without a camera file: horizontal field of view."},
	{"position", INI_REALS, OPTION_AT(position), 3, -1e6, 1e6, .fallback = "0 0 0", .unit = "m",
	 .help = "Fisheye: where it lies in the studio."},
	{"focal", INI_REALS, OPTION_AT(lens.focal_px), 2, 0, 1e6, .fallback = "0 0",
	 .unit = "px/rad",
	 .help = "Fisheye: focal lengths; 0 0: the field fills the smaller side."},
	{"centre", INI_REALS, OPTION_AT(lens.centre_px), 2, -1e6, 1e6, .fallback = "0 0",
	 .unit = "px",
	 .help = "Fisheye: centre of the image circle; 0 0: the middle of the picture."},
	{"rotation", INI_REALS, OPTION_AT(lens.rotation_deg), 3, -360, 360, .fallback = "0 0 0",
	 .unit = "deg", .help = "Fisheye: turns about X, then Y, then Z."},
	{"field", INI_REAL, OPTION_AT(lens.field_deg), .min = 1, .max = 180, .fallback = "90",
	 .unit = "deg", .help = "Fisheye: half the field of view."},
	{"model", INI_CHOICE, OPTION_AT(lens.model), .choices = fisheye_model_names,
	 .fallback = "equidistant", .help = "Fisheye: its model, as in [fisheye]."},
	{"polynomial", INI_REALS, OPTION_AT(lens.polynomial), FISHEYE_TERMS, -1e3, 1e3,
	 .fallback = "0 0 0 0", .help = "Fisheye: k1 k2 k3 k4 of the polynomial model."},
	{"turn_rate", INI_REAL, OPTION_AT(turn_rate_deg), .min = -3600, .max = 3600,
	 .fallback = "0", .unit = "deg/s",
	 .help = "Panorama: turns counter-clockwise seen from above."},
	{"switch", INI_REAL, OPTION_AT(switch_s), .min = 0, .max = 1e6, .fallback = "0",
	 .unit = "s",
	 .help = "Studio: the ceiling panels go off or on every so many seconds; 0: never."},
	{"walkers", INI_INT, OPTION_AT(walkers), .min = 0, .max = WALKER_STYLES, .fallback = "0",
	 .help = "Studio: so many people walk through it (drivers/sim/walkers.h)."},
	{"exposure", INI_REAL, OPTION_AT(exposure), .min = 0, .max = SIM_EXPOSURE_MAX,
	 .fallback = "1", .help = "Linear light is multiplied by this; 1 and more is white."},
	{"transfer", INI_CHOICE, OPTION_AT(transfer), .choices = transfer_names, .fallback = "srgb",
	 .help = "From linear light to code values, and back for 8-bit files wanted as RGBF."},
	{"read_noise", INI_REAL, OPTION_AT(read_noise), .min = 0, .max = 255, .fallback = "0",
	 .unit = "levels", .help = "Standard deviation of noise in the dark, in linear light."},
	{"shot_noise", INI_REAL, OPTION_AT(shot_noise), .min = 0, .max = 255, .fallback = "0",
	 .unit = "levels", .help = "Standard deviation added at white; grows as the square root."},
	{"edge_spread", INI_REAL, OPTION_AT(edge_spread_px), .min = 0, .max = SPREAD_MAX_PX,
	 .fallback = "0", .unit = "px", .help = "Sigma of the Gaussian that blurs linear light."},
	{"auto_exposure", INI_REAL, OPTION_AT(automatic.level), .min = 0, .max = 1, .fallback = "0",
	 .help = "Mean linear light that automatic exposure wants, white is 1; 0: none."},
	{"auto_white", INI_BOOL, OPTION_AT(automatic.white), .fallback = "no",
	 .help = "Automatic white balance: the mean of red and blue becomes that of green."},
	{"auto_time", INI_REAL, OPTION_AT(automatic.time_s), .min = 0, .max = 1e3, .fallback = "1",
	 .unit = "s", .help = "Time constant of automatic exposure and white balance."},
	{"auto_step", INI_REAL, OPTION_AT(automatic.step_stops), .min = 0, .max = 8,
	 .fallback = "0", .unit = "stops", .help = "They move in steps of this; 0: smoothly."},
	{"flicker", INI_REAL, OPTION_AT(mains.depth), .min = 0, .max = 1, .fallback = "0",
	 .help = "Studio: the ceiling panels' light swings by this share of its mean."},
	{"mains", INI_REAL, OPTION_AT(mains.hz), .min = 1, .max = 1e3, .fallback = "50",
	 .unit = "Hz", .help = "Studio: the mains; lamps flicker at twice its frequency."},
	{"shutter", INI_REAL, OPTION_AT(mains.shutter_s), .min = 0, .max = 10, .fallback = "0.002",
	 .unit = "s", .help = "Studio: how long a row is exposed, which evens flicker out."},
	{"readout", INI_REAL, OPTION_AT(mains.readout_s), .min = 0, .max = 10, .fallback = "0.02",
	 .unit = "s", .help = "Studio: the last row is exposed so much later than the first."},
	{"black_level", INI_INT, OPTION_AT(black_level), .min = 0, .max = 254, .fallback = "0",
	 .help = "Code value of no light."},
	{"depth_noise", INI_REAL, OPTION_AT(depth_noise_mm), .min = 0, .max = 1e3, .fallback = "0",
	 .unit = "mm",
	 .help = "Format Z16: standard deviation at 1 m; it grows with the square of the depth."},
	{"seed", INI_INT, OPTION_AT(seed), .min = 0, .max = 2147483647, .fallback = "1",
	 .help = "Of the noise."},
	{"stall_after", INI_INT, OPTION_AT(stall_after), .min = 0, .max = 2147483647,
	 .fallback = "0", .unit = "frames", .help = "Then no more frames come; 0: never."},
	{"vanish_after", INI_INT, OPTION_AT(vanish_after), .min = 0, .max = 2147483647,
	 .fallback = "0", .unit = "frames", .help = "Then the camera is gone; 0: never."},
	{"corrupt_every", INI_INT, OPTION_AT(corrupt_every), .min = 0, .max = 2147483647,
	 .fallback = "0", .unit = "frames", .help = "Every so many frames one is unfit; 0: none."},
	{"control_delay", INI_INT, OPTION_AT(control_delay), .min = 0, .max = SIM_DELAY_MAX,
	 .fallback = "0", .unit = "frames",
	 .help = "How many frames still show the old exposure when it is changed on the way."},
	{"warm_up", INI_INT, OPTION_AT(warm_up), .min = 0, .max = 2147483647, .fallback = "0",
	 .unit = "frames",
	 .help = "The first frames of each opening: half of them are zeros, the rest too bright."},
	INI_KEYS_END,
};

struct camera_file {
	struct tsai_camera camera;
	bool found;
};

static void *camera_file_place(void *root, const char *instance)
{
	struct camera_file *file = root;

	(void)instance;
	if (!file->found)
		ini_defaults(tsai_keys, &file->camera);
	file->found = true;
	return &file->camera;
}

static int read_camera(const char *path, struct tsai_camera *camera, struct fault *fault)
{
	static const struct ini_table tables[] = {
		{.section = "camera", .keys = tsai_keys, .place = camera_file_place},
		INI_TABLES_END,
	};
	struct camera_file file = {.found = false};
	struct ini_report report = {0};
	struct fault why = {0};
	int err = ini_read(path, tables, &file, &report);

	if (err)
		return fault_say(fault, err, "%s", report.first.text);
	if (!file.found)
		return fault_say(fault, -EINVAL, "%s: expected a [camera] section", path);
	err = tsai_check(&file.camera, &why);
	if (err)
		return fault_say(fault, err, "%s: %s", path, why.text);
	*camera = file.camera;
	return 0;
}

static int prepare_perspective(const struct sim_options *options,
			       const struct camera_settings *settings, struct sim_eye *eye,
			       struct fault *fault)
{
	int err;

	if (!options->camera[0])
		return tsai_look_at(&eye->camera, eye->width, eye->height, options->eye,
				    options->target, options->angle_deg, fault);
	err = read_camera(options->camera, &eye->camera, fault);
	if (err)
		return err;
	if ((settings->width && settings->width != eye->camera.width) ||
	    (settings->height && settings->height != eye->camera.height))
		return fault_say(fault, -EINVAL,
				 "%s: a camera of %dx%d, but the settings want %dx%d",
				 options->camera, eye->camera.width, eye->camera.height,
				 settings->width, settings->height);
	eye->width = eye->camera.width;
	eye->height = eye->camera.height;
	return 0;
}

int sim_eye(const struct sim_options *options, const struct camera_settings *settings,
	    struct sim_eye *eye, struct fault *fault)
{
	memset(eye, 0, sizeof(*eye));
	eye->width = settings->width ? settings->width : 640;
	eye->height = settings->height ? settings->height : 480;
	eye->fisheye = options->view == SIM_VIEW_FISHEYE;
	if (!eye->fisheye)
		return prepare_perspective(options, settings, eye, fault);
	memcpy(eye->position, options->position, sizeof(eye->position));
	return fisheye_prepare(&eye->lens, &options->lens, eye->width, eye->height, fault);
}
