/* SPDX-License-Identifier: MIT */
/* A view of a camera's picture: fisheye, background, scene or depth look through an eye, which says
 * which part of which camera they see upright. */
#ifndef INLAY_APP_CAMERA_EYE_H
#define INLAY_APP_CAMERA_EYE_H

#include <stdbool.h>

#include "app/camera/source.h"
#include "hal/base/fault.h"
#include "hal/frame/depth.h"
#include "hal/frame/frame_reader.h"
#include "hal/frame/view.h"

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

#endif
