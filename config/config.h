/* SPDX-License-Identifier: MIT */
/*
 * Everything that can be configured: one struct a section, filled from a file and from --set.
 *
 * The keys, their ranges, defaults and help are in config_keys.c; the keys of drivers come from
 * whoever calls, as a list of names and tables. README.md lists the sections.
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
#include "hal/optics/fisheye.h"

#define CONFIG_CAMERAS_MAX 4
#define CONFIG_DRIVERS_MAX 16 /* of one class */
#define CONFIG_NAME_MAX 64    /* of a camera */

enum config_show {
	SHOW_COMPOSITE,
	SHOW_BEFORE,
	SHOW_FISHEYE,
	SHOW_SCENE,
	SHOW_QUAD,
	SHOW_SPLIT, /* before | composite, with a line that moves */
	SHOW_OFF,   /* black */
	SHOW_COUNT
};
enum config_timeline { TIMELINE_NONE, TIMELINE_LOOP, TIMELINE_SWING, TIMELINE_COUNT };
enum config_scale { SCALE_NONE, SCALE_FIT, SCALE_COUNT };

extern const char *const config_show_names[];	  /* "composite", "before", ... NULL */
extern const char *const config_timeline_names[]; /* "none", "loop", "swing", NULL */
extern const char *const config_scale_names[];	  /* "none", "fit", NULL */

/* What a driver brings: its name and, unless keys is NULL, the keys of its own options. */
struct config_driver {
	const char *name;
	const struct ini_key *keys;
	size_t options_size;
};

enum config_class { CONFIG_CAMERA, CONFIG_DISPLAY, CONFIG_BUTTONS, CONFIG_CLASS_COUNT };

/* One list a class, each ending with a NULL name, in the order of the program's own arrays. All of
 * it is borrowed. */
struct config_drivers {
	const struct config_driver *list[CONFIG_CLASS_COUNT];
};

/* Room for the lists of a program's arrays: one driver too many still fits, to be refused. */
struct config_driver_room {
	struct config_driver list[CONFIG_CLASS_COUNT][CONFIG_DRIVERS_MAX + 2];
};

/* What the configuration wants to know of drivers in arrays that end with NULL, in their order. The
 * lists are in the room, which has to live as long as they. */
struct config_drivers config_drivers_of(struct config_driver_room *room,
					const struct camera_ops *const *cameras,
					const struct display_ops *const *displays,
					const struct buttons_ops *const *buttons);

struct config_basis {
	char file[INI_PATH_MAX];
	int pose;
};

/* [camera NAME], [screen] and [buttons] are each followed in memory by the options of every driver
 * of their class: config_options() finds them. */
struct config_camera {
	char name[CONFIG_NAME_MAX];
	char driver[INI_TEXT_MAX];
	struct camera_settings settings;
	int deinterlace; /* enum deinterlace */
};

struct config_screen {
	char driver[INI_TEXT_MAX];
	struct display_settings settings;
	int show;	      /* enum config_show */
	int scale;	      /* enum config_scale */
	double split;	      /* where the line stands, share of the width, 0..1 */
	bool information;     /* the line of figures is shown */
	bool trouble;	      /* what is wrong is named on the screen */
	double blank_after_s; /* without a new picture it goes black then; 0: never */
};

struct config_buttons {
	char driver[INI_TEXT_MAX]; /* names separated by blanks, or "none": config_buttons_used() */
};

/* Commands from other programs on this machine. */
struct config_control {
	char socket[INI_PATH_MAX]; /* empty: none */
	char group[INI_TEXT_MAX];  /* who may, besides the owner and root; empty: nobody */
};

/* What was chosen, kept over a power cut. */
struct config_state {
	char file[INI_PATH_MAX]; /* empty: nothing is kept */
	double interval_s;	 /* it is written at most so often */
};

/* A rectangle of a camera's picture: config_view() makes a struct view of it. */
struct config_view {
	char camera[INI_TEXT_MAX]; /* [camera NAME]; empty: none */
	struct view view;
	bool rotate180;
};

struct config_fisheye {
	struct config_view view;
	char lens_file[INI_PATH_MAX]; /* its keys replace those of lens; empty: none */
	struct fisheye_settings lens;
	int estimator; /* enum light_estimator */
	int transfer;  /* enum transfer */
	int black_level;
	double gain;
	char light[INI_PATH_MAX];	 /* empty: none */
	struct response measured;	 /* what that file says: config_read_files() */
	double exposures[EXPOSURES_MAX]; /* the control's values, the longest first; then 0 */
	char exposure_control[INI_TEXT_MAX];
	int exposure_delay; /* frames; -1: as measured, if it was */
};

struct config_background {
	struct config_view view;
	int transfer; /* enum transfer */
	char light[INI_PATH_MAX];
	struct response measured;
	double patch[4];       /* x, y, width, height in the view; width 0: none */
	double reflectance[3]; /* of the patch; 0 0 0: as the basis has it */
};

/* Poses of the basis, by the clock. */
struct config_poses {
	int timeline; /* enum config_timeline */
	double rate;  /* poses a second */
	bool fade;
};

struct config_scene {
	struct config_view view;
};

struct config_lights {
	/* 8-bit grey level of the fisheye's picture, 0..255; percent: of white, what may change */
	struct ini_level threshold;
	double threshold_step; /* in the threshold's unit */
	int threshold_mode;    /* enum threshold_mode */
	double follow_s;
};

struct config_composite {
	double gain;
	int threads; /* 0: one for each processor */
	int mode;    /* enum compositor_mode */
	int reuse;   /* enum compositor_reuse */
	char kernel[INI_TEXT_MAX];
};

struct config {
	struct config_basis basis;
	struct config_poses poses;
	struct config_camera *cameras[CONFIG_CAMERAS_MAX];
	int camera_count;
	struct config_fisheye fisheye;
	struct config_background background;
	struct config_scene scene;
	struct config_lights lights;
	struct config_composite composite;
	struct config_screen *screen;
	struct config_buttons *buttons;
	struct config_control control;
	struct config_state state;
	char name[INI_PATH_MAX]; /* of the file, for faults */
	/* private */
	struct config_drivers drivers;
	struct ini_table *tables;
	size_t block_bytes[CONFIG_CLASS_COUNT];
	size_t option_offset[CONFIG_CLASS_COUNT][CONFIG_DRIVERS_MAX];
	char prefix[CONFIG_CLASS_COUNT][CONFIG_DRIVERS_MAX][CONFIG_NAME_MAX];
};

/* Every key at its default. 0 or -ENOMEM, -E2BIG (more drivers than there is room for). */
int config_create(struct config **config, const struct config_drivers *drivers);
void config_destroy(struct config *config); /* NULL is harmless */

/* As ini_read() and ini_set(). */
int config_read(struct config *config, const char *path, struct ini_report *report);
int config_read_memory(struct config *config, const char *text, size_t bytes, const char *name,
		       struct ini_report *report);
int config_set(struct config *config, const char *assignment, struct ini_report *report);

/* Reads the files that [fisheye] and [background] name, after everything else: light, and the lens,
 * over its keys. Everything wrong goes to the report, with the file's name and line; 0 or the first
 * negative errno. */
int config_read_files(struct config *config, struct ini_report *report);

/* What the views' code values stand for: as measured, or else as configured. */
struct transfer_curve config_fisheye_curve(const struct config_fisheye *fisheye);
struct transfer_curve config_background_curve(const struct config_background *background);

/* How many exposures the fisheye takes in turn; 0: it keeps one. After how many frames they are
 * seen, as configured or else as measured; -1: not known. */
int config_exposures(const struct config_fisheye *fisheye);
int config_exposure_delay(const struct config_fisheye *fisheye);

/* What no key can tell alone: cameras that views name but nobody defines, unknown drivers, files
 * that drivers are to read and that are missing, no basis. Opens nothing. 0 or -EINVAL; every fault
 * goes to the report. */
int config_check(const struct config *config, struct ini_report *report);

/* A key whose value differs. */
struct config_change {
	const char *section;
	const char *instance;	/* of [camera NAME]; NULL elsewhere */
	char key[INI_TEXT_MAX]; /* prefix included; empty: the whole section is in one of them only
				 */
};

/* Calls adopt() for each key whose value is another in fresh, which has the same drivers, and for
 * "light" where the file of that name says something else; where it says true, config takes that
 * value. Cameras that only one of them has stay as they are. */
void config_update(struct config *config, const struct config *fresh,
		   bool (*adopt)(void *context, const struct config_change *change), void *context);

/* The whole configuration as a file that reads back the same. */
void config_print(const struct config *config, FILE *stream);

/* Every key at its default, with help and range. */
void config_write_sample(const struct config *config, FILE *stream);

/* The place of a driver in its list, or -1. */
int config_driver_index(const struct config *config, enum config_class kind, const char *name);

/* The places of the drivers that [buttons] names, each once, in the file's order. Returns how many.
 */
int config_buttons_used(const struct config *config, int drivers[CONFIG_DRIVERS_MAX]);

/* The options of one driver behind a camera, the screen or the buttons: block. */
void *config_options(const struct config *config, enum config_class kind, void *block, int driver);

/* The camera called name, or NULL. */
struct config_camera *config_camera_named(const struct config *config, const char *name);

struct view config_view(const struct config_view *view);

#endif
