/* SPDX-License-Identifier: MIT */
/* The views of the cameras' pictures, and the exposures that the fisheye's takes in turn. */
#ifndef INLAY_APP_CAMERA_EYE_H
#define INLAY_APP_CAMERA_EYE_H

#include <stdbool.h>
#include <stdint.h>

#include "app/camera/source.h"
#include "config/config.h"
#include "hal/base/fault.h"
#include "hal/frame/depth.h"
#include "hal/frame/frame_reader.h"
#include "hal/frame/view.h"
#include "hal/lights/exposure_schedule.h"

/* A view of a camera's picture: fisheye, background, scene or depth look through an eye, which says
 * which part of which camera they see upright. */

struct eye {
	const char *section;   /* name of its section, "fisheye", ..., for faults; borrowed */
	struct source *source; /* NULL: this view has no camera */
	struct view wanted;    /* as configured */
	struct view view;      /* wanted, resolved for a picture of this size: */
	int camera_width, camera_height;
	bool unfit; /* wanted does not fit the picture: the eye has none */
};

struct eyes {
	struct eye fisheye, background, scene, depth;
};

enum { EYES = 4 };

/* All of them, in the order above. */
void eyes_list(const struct eyes *eyes, const struct eye *list[EYES]);

/* The camera whose frames set the pace: the background's while it gives frames, else the first
 * other one that does, else the first one that is open; never that of depth. NULL: none is open. */
struct source *eyes_leader(const struct eyes *eyes);

bool eye_has_picture(const struct eye *eye);

/* Fits the view to the camera's picture, whose size may have changed. -EINVAL: it does not fit. 0
 * for an eye without a picture. */
int eye_fit(struct eye *eye, struct fault *fault);

/* The upright picture, in two ways, after eye_fit() and with a picture; both are valid until the
 * source takes or decodes a frame. eye_read(): in the memory that the camera filled; false where it
 * cannot be read there. eye_picture(): as a whole in memory of the source, converted by the first
 * call. */
bool eye_read(const struct eye *eye, struct frame_reader *reader);
struct picture eye_picture(const struct eye *eye);

/* The same by a reader, whichever way suits. */
struct frame_reader eye_reader(const struct eye *eye);

/* The depths of a frame that is the picture, in memory that the camera filled; valid as
 * eye_read()'s. False: there are none. */
bool eye_depth(const struct eye *eye, double unit_m, struct depth_map *map);

/* Takes a new picture: whether its light counts already, after its camera was opened. metering: as
 * for settling_take(). Frames on demand have nothing to settle. */
bool eye_has_settled(const struct eye *eye, bool metering);

/*
 * The fisheye's camera in several exposures, one after the other: which exposure it is asked for
 * next, and which one a picture has (hal/lights/exposure_schedule.h).
 *
 * All calls come from the thread that owns the camera, for each picture that is used: a frame that
 * is passed over takes no exposure's turn. Frames that the camera has captured meanwhile are
 * estimated from the picture's age. A camera that refuses, or does not show an exposure within
 * EXPOSURE_DELAY_MAX frames, stays at the longest one until it is opened again; the log warns once.
 * A camera that rounds exposures lets in other shares of the light than asked for: ratio has the
 * true ones.
 */

struct exposing {
	const struct config_fisheye *config; /* borrowed; NULL: the camera keeps its exposure */
	int count;
	struct exposure_schedule schedule;
	unsigned opening;	     /* source.opening.count when the schedule began; 0: none yet */
	int exposure;		     /* of the last picture; -1: not known */
	double used[EXPOSURES_MAX];  /* each value as the camera uses it; as asked for, at first */
	double ratio[EXPOSURES_MAX]; /* used[k] / used[0]: share of the light that each lets in */
	bool asked;		     /* the camera has obeyed since it was opened */
	bool single;		     /* it stays at one exposure */
	int64_t least_ns;	     /* shortest time from a picture's capture to its use */
	int judged, unfit;
	struct fault said; /* the trouble that was logged last */
};

/* Takes settings that have been checked and that outlive exposing. A zeroed exposing is of a camera
 * that keeps its exposure. */
void exposing_start(struct exposing *exposing, const struct config_fisheye *config);

/* To be called when the source has a new picture. Returns its exposure, -1: not known. Asks the
 * camera for the next one. */
int exposing_take(struct exposing *exposing, struct source *source, int64_t now_ns);

/* Tells how bright that picture was (pipeline_report(): level) and whether its light fits its
 * exposure. */
void exposing_judge(struct exposing *exposing, struct source *source, double level, bool fits);

#endif
