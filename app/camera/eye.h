/* SPDX-License-Identifier: MIT */
/* One of the three views: which part of which camera, seen upright. */
#ifndef INLAY_APP_CAMERA_EYE_H
#define INLAY_APP_CAMERA_EYE_H

#include <stdbool.h>

#include "app/camera/source.h"
#include "hal/base/fault.h"
#include "hal/frame/frame_reader.h"
#include "hal/frame/view.h"

struct eye {
	const char *section;   /* "fisheye", ...: for faults; borrowed */
	struct source *source; /* NULL: this view has no camera */
	struct view wanted;    /* as configured */
	struct view view;      /* resolved for a picture of this size: */
	int camera_width, camera_height;
	bool unfit; /* it does not fit the picture: as if there were none */
};

struct eyes {
	struct eye fisheye, background, scene;
};

/* The camera whose frames set the pace: the background's while it gives frames, else the first
 * other one that does, else the first one that is open. NULL: none is open. */
struct source *eyes_leader(const struct eyes *eyes);

bool eye_has_picture(const struct eye *eye);

/* Fits the view to the camera's picture, whose size may have changed. -EINVAL: it does not fit. An
 * eye without a picture is fine. */
int eye_fit(struct eye *eye, struct fault *fault);

/* Both only after eye_fit(), and valid until the source takes or decodes again: the upright picture
 * where the camera left it, false where that is not to be had; and as a whole in memory, which is
 * made then. */
bool eye_read(const struct eye *eye, struct frame_reader *reader);
struct picture eye_picture(const struct eye *eye);

#endif
