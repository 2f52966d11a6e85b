/* SPDX-License-Identifier: MIT */
/*
 * The configuration: one struct for each section, filled from a file and from --set.
 *
 * config_keys.c holds the keys with their ranges, defaults and help. The caller passes the keys of
 * drivers as lists of names and tables. README.md lists the sections.
 */
#ifndef INLAY_CONFIG_CONFIG_H
#define INLAY_CONFIG_CONFIG_H

#include <stdbool.h>
#include <stdio.h>

#include "hal/colour/response.h"
#include "hal/device/buttons.h"
#include "hal/device/camera.h"
#include "hal/device/display.h"
#include "hal/frame/view.h"
#include "hal/ini/ini.h"
#include "hal/lights/exposures.h"
#include "hal/lights/lamps.h"
#include "hal/optics/fisheye.h"
#include "hal/optics/tsai.h"

#define CONFIG_CAMERAS_MAX 4
#define CONFIG_DRIVERS_MAX 16 /* drivers of one class */
#define CONFIG_NAME_MAX 64    /* bytes of a camera's name, with its NUL */

enum config_show {
	SHOW_COMPOSITE,
	SHOW_BEFORE,
	SHOW_FISHEYE,
	SHOW_SCENE,
	SHOW_QUAD,
	SHOW_SPLIT, /* before | composite, with a movable line between */
	SHOW_OFF,   /* black */
	SHOW_GUIDE, /* for setting up: composite and fisheye with what is calibrated drawn in */
	SHOW_COUNT
};
enum config_timeline { TIMELINE_NONE, TIMELINE_LOOP, TIMELINE_SWING, TIMELINE_COUNT };
enum config_scale { SCALE_NONE, SCALE_FIT, SCALE_COUNT };
enum config_hours_off { HOURS_OFF_SIGNAL, HOURS_OFF_BLACK, HOURS_OFF_COUNT };

extern const char *const config_show_names[];	   /* "composite", "before", ... NULL */
extern const char *const config_timeline_names[];  /* "none", "loop", "swing", NULL */
extern const char *const config_scale_names[];	   /* "none", "fit", NULL */
extern const char *const config_hours_off_names[]; /* "signal", "black", NULL */

/* A driver as the configuration knows it: its name and, unless keys is NULL, its own keys. */
struct config_driver {
	const char *name;
	const struct ini_key *keys;
	size_t options_size; /* bytes of the struct that the keys fill */
};

enum config_class { CONFIG_CAMERA, CONFIG_DISPLAY, CONFIG_BUTTONS, CONFIG_CLASS_COUNT };

/* A list of drivers for each class. A NULL name ends it. The caller owns the lists, which must
 * outlive the configuration. */
struct config_drivers {
	const struct config_driver *list[CONFIG_CLASS_COUNT];
};

/* Memory for the lists. It holds one driver too many, so that config_create() can refuse it. */
struct config_driver_room {
	struct config_driver list[CONFIG_CLASS_COUNT][CONFIG_DRIVERS_MAX + 2];
};

/* Makes the lists from arrays of drivers that end with NULL, in the same order. The lists lie in
 * *room, which must outlive them. */
struct config_drivers config_drivers_of(struct config_driver_room *room,
					const struct camera_ops *const *cameras,
					const struct display_ops *const *displays,
					const struct buttons_ops *const *buttons);

struct config_basis {
	char file[INI_PATH_MAX];
	int pose;
};

/* In memory, the options of every driver of the class follow a [camera NAME], [screen] or
 * [buttons]: config_options() finds them. */
struct config_camera {
	char name[CONFIG_NAME_MAX];
	char driver[INI_TEXT_MAX];
	struct camera_settings settings;
	int deinterlace; /* enum deinterlace */
	int turn;	 /* enum picture_turn */
};

struct config_screen {
	char driver[INI_TEXT_MAX];
	struct display_settings settings;
	int show;		  /* enum config_show */
	int scale;		  /* enum config_scale */
	double split;		  /* position of the line, as a share of the width, 0..1 */
	bool information;	  /* the line of figures is shown */
	bool trouble;		  /* faults are named on the screen */
	double blank_after_s;	  /* the screen goes black without pictures for so long; 0: never */
	char hours[INI_TEXT_MAX]; /* when it is on: config_hours_read(); empty: always */
	int hours_off;		  /* enum config_hours_off: what is done at other times */
	char cec[INI_PATH_MAX]; /* tells a television to go to standby then; empty: nothing does */
	char time_zone[INI_TEXT_MAX]; /* of hours; empty: the system's */
};

struct config_buttons {
	char driver[INI_TEXT_MAX]; /* names separated by blanks, or "none": config_buttons_used() */
};

/* Commands from other programs on this machine. */
struct config_control {
	char socket[INI_PATH_MAX]; /* empty: none */
	char group[INI_TEXT_MAX];  /* may command, besides the owner and root; empty: nobody */
};

/* Where threshold, view and pose are kept over a power cut. */
struct config_state {
	char file[INI_PATH_MAX]; /* empty: nothing is kept */
	double interval_s;	 /* least time between two writes */
};

/* Figures for Prometheus. */
struct config_metrics {
	char file[INI_PATH_MAX]; /* empty: none */
};

/* A rectangle of a camera's picture. */
struct config_view {
	char camera[INI_TEXT_MAX]; /* [camera NAME]; empty: none */
	struct view view;
};

struct config_fisheye {
	struct config_view view;
	char lens_file[INI_PATH_MAX]; /* its keys replace those of lens; empty: none */
	struct fisheye_settings lens;
	int transfer; /* enum transfer */
	int black_level;
	double gain;
	char light[INI_PATH_MAX];	 /* empty: none */
	struct response measured;	 /* contents of that file: config_read_files() */
	double exposures[EXPOSURES_MAX]; /* values of the control, longest first; 0 at the end */
	char exposure_control[INI_TEXT_MAX];
	int exposure_delay; /* frames; -1: as measured, if it was measured */
};

struct config_background {
	struct config_view view;
	int transfer; /* enum transfer */
	char light[INI_PATH_MAX];
	struct response measured;
	double patch[4];       /* x, y, width, height in px of the view; width 0: none */
	double reflectance[3]; /* of the patch, linear RGB; 0 0 0: that of the basis */
};

/* How the poses of the basis follow each other. */
struct config_poses {
	int timeline; /* enum config_timeline */
	double rate;  /* poses a second */
	bool fade;
};

struct config_scene {
	struct config_view view;
};

/* A depth camera that looks on beside the background's. */
struct config_depth {
	struct config_view view;
	double unit_mm;			/* what 1 in a depth stands for */
	char calibration[INI_PATH_MAX]; /* empty: it stands in the background camera's place */
	struct tsai_camera camera; /* contents of that file: config_read_files(); width 0: none */
};

struct config_lights {
	/* 8-bit grey level of the fisheye's picture, 0..255; or the change that is allowed in any
	 * pixel of the result, in percent of white */
	struct ini_level threshold;
	double threshold_step; /* in the threshold's unit */
	int threshold_mode;    /* enum threshold_mode */
	double follow_s;       /* time within which the light follows a change */
};

struct config_composite {
	double gain;
	int threads;		/* 0: one per processor */
	int mode;		/* enum compositor_mode */
	double neutral_percent; /* of the light that is grey */
	bool follow_exposure;	/* the object follows the background camera's exposure */
	bool grain;		/* the object gets the background camera's noise */
	char kernel[INI_TEXT_MAX];
};

struct config_people {
	bool occlude;
	char mask[INI_PATH_MAX]; /* empty: none */
};

struct config {
	struct config_basis basis;
	struct config_poses poses;
	struct config_camera *cameras[CONFIG_CAMERAS_MAX];
	int camera_count;
	struct config_fisheye fisheye;
	struct lamps lamps; /* [lamp NAME], and [fisheye] position */
	char lamp_name[LAMPS_MAX][CONFIG_NAME_MAX];
	struct config_background background;
	struct config_scene scene;
	struct config_depth depth;
	struct config_lights lights;
	struct config_composite composite;
	struct config_people people;
	struct config_screen *screen;
	struct config_buttons *buttons;
	struct config_control control;
	struct config_state state;
	struct config_metrics metrics;
	char name[INI_PATH_MAX]; /* name of the file, for faults */
	/* private */
	struct config_drivers drivers;
	struct ini_table *tables;
	size_t block_bytes[CONFIG_CLASS_COUNT];
	size_t option_offset[CONFIG_CLASS_COUNT][CONFIG_DRIVERS_MAX];
	char prefix[CONFIG_CLASS_COUNT][CONFIG_DRIVERS_MAX][CONFIG_NAME_MAX];
};

/* Creates a configuration with every key at its default; config_destroy() frees it. drivers NULL:
 * for a program that opens no device; it can only be read, has no camera, and screen and buttons
 * are NULL. 0, -ENOMEM, or -E2BIG: more than CONFIG_DRIVERS_MAX drivers of a class. */
int config_create(struct config **config, const struct config_drivers *drivers);
void config_destroy(struct config *config); /* NULL is harmless */

/* Read and set keys like ini_read(), ini_read_memory() and ini_set(). */
int config_read(struct config *config, const char *path, struct ini_report *report);
int config_read_memory(struct config *config, const char *text, size_t bytes, const char *name,
		       struct ini_report *report);
int config_set(struct config *config, const char *assignment, struct ini_report *report);

/* Reads the files that [fisheye], [background] and [depth] name: the light files, where the depth
 * camera stands, and the lens file, whose keys replace those of the configuration. Call it after
 * all keys are read and set. Faults go to the report, with the file's name and line. 0 or the first
 * negative errno. */
int config_read_files(struct config *config, struct ini_report *report);

/* Return the transfer function of a view's code values: as measured, else as configured. */
struct transfer_curve config_fisheye_curve(const struct config_fisheye *fisheye);
struct transfer_curve config_background_curve(const struct config_background *background);

/* Returns how many exposures the fisheye takes in turn; 0: it keeps one. */
int config_exposures(const struct config_fisheye *fisheye);

/* Returns after how many frames a new exposure is seen, as configured, else as measured; -1: not
 * known. */
int config_exposure_delay(const struct config_fisheye *fisheye);

/* Checks what no key can tell alone: cameras that views name but no section defines, unknown
 * drivers, files for drivers that cannot be read, no basis. Opens nothing. 0 or -EINVAL; every
 * fault goes to the report. */
int config_check(const struct config *config, struct ini_report *report);

/* A difference between two configurations. */
struct config_change {
	const char *section;
	const char *instance;	/* NAME of [camera NAME]; NULL elsewhere */
	char key[INI_TEXT_MAX]; /* with its prefix; empty: only one of them has this section */
};

/* Calls adopt() for each key whose value differs in fresh, which has the same drivers, and for
 * "light" if the contents of that file differ; once, without a key, if any [lamp NAME] does. Where
 * adopt() returns true, config takes over the value. Cameras that only one of the two has are
 * reported and stay as they are. */
void config_update(struct config *config, const struct config *fresh,
		   bool (*adopt)(void *context, const struct config_change *change), void *context);

/* Writes the whole configuration as a file that reads back the same. */
void config_print(const struct config *config, FILE *stream);

/* Writes the sample file: every key at its default, with help and range. */
void config_write_sample(const struct config *config, FILE *stream);

/* Returns the index of a driver in its list, or -1. */
int config_driver_index(const struct config *config, enum config_class kind, const char *name);

/* Fills in the indices of the drivers that [buttons] names, each once, in the file's order. Returns
 * how many. */
int config_buttons_used(const struct config *config, int drivers[CONFIG_DRIVERS_MAX]);

/* Returns the options of one driver. block is a camera, the screen or the buttons. */
void *config_options(const struct config *config, enum config_class kind, void *block, int driver);

/* Returns the camera of this name, or NULL. */
struct config_camera *config_camera_named(const struct config *config, const char *name);

/* Returns what a camera's driver is asked for: as configured, and depths of the camera of [depth],
 * which are read where the driver puts them. */
struct camera_settings config_camera_settings(const struct config *config,
					      const struct config_camera *camera);

#endif
