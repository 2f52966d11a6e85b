/* SPDX-License-Identifier: MIT */
/* The keys of the simulated camera, [camera NAME] sim.*, and the eye that they describe. */
#ifndef INLAY_DRIVERS_SIM_OPTIONS_H
#define INLAY_DRIVERS_SIM_OPTIONS_H

#include "drivers/sim/automatic.h"
#include "drivers/sim/eye.h"
#include "drivers/sim/mains.h"
#include "hal/base/fault.h"
#include "hal/device/camera.h"
#include "hal/ini/ini.h"
#include "hal/optics/fisheye.h"

enum sim_source { SIM_SOURCE_STUDIO, SIM_SOURCE_PANORAMA, SIM_SOURCE_FILES };
enum sim_view { SIM_VIEW_FISHEYE, SIM_VIEW_PERSPECTIVE };
enum sim_clock { SIM_CLOCK_REAL, SIM_CLOCK_FRAMES };

struct sim_options {
	int source, view, pace;
	char file[INI_PATH_MAX];
	char camera[INI_PATH_MAX];
	double eye[3], target[3], angle_deg;
	double position[3];
	struct fisheye_settings lens;
	double turn_rate_deg;
	double switch_s;
	int walkers;
	double exposure;
	int transfer;
	double read_noise, shot_noise;
	double edge_spread_px;
	struct automatic_settings automatic;
	struct mains mains;
	int black_level;
	double depth_noise_mm;
	int seed;
	bool loop;
	int stall_after, vanish_after, corrupt_every;
	int control_delay, warm_up;
};

#define SIM_EXPOSURE_MAX 1e6 /* limit of the exposure, as a key and as a control */
#define SIM_DELAY_MAX 30     /* limit of control_delay, in frames */

extern const struct ini_key sim_keys[];

/* Prepares the eye. Its size is that of the settings, else that of the camera file, else 640x480.
 * 0; -errno: the camera file cannot be read, or does not fit the size. */
int sim_eye(const struct sim_options *options, const struct camera_settings *settings,
	    struct sim_eye *eye, struct fault *fault);

#endif
