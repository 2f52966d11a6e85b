/* SPDX-License-Identifier: MIT */
/*
 * What is on the screen: the picture with the object, the background before it, both beside each
 * other, the fisheye with its lights marked, the scene camera, or four of them as in the thesis
 * (section 4.2.1):
 *
 *     scene   fisheye
 *     before  after
 *
 * guide is for setting up: composite and fisheye in halves, with ground and directions drawn in
 * (guide.h). A view that has no picture is black.
 *
 * Pictures are made elsewhere and only placed here. For each picture of the screen: take the
 * pictures that show_needs() names, ask show_room() where the composite goes, make it there, then
 * call show_draw().
 */
#ifndef INLAY_APP_VIEW_SHOW_H
#define INLAY_APP_VIEW_SHOW_H

#include <stdbool.h>

#include "app/camera/eye.h"
#include "app/view/guide.h"
#include "app/view/overlay.h"
#include "app/view/scaler.h"
#include "config/config.h"
#include "hal/base/pool.h"
#include "hal/basis/basis.h"
#include "hal/device/display.h"
#include "hal/frame/frame.h"
#include "hal/frame/view.h"
#include "hal/optics/dome.h"
#include "hal/optics/fisheye.h"

struct show {
	struct canvas after, marked;
	/* For the whole screen or its first quarter, and for the other three. */
	struct scaler scalers[4];
};

/* How one picture of the screen is shown. */
struct show_request {
	enum config_show view;
	enum config_scale scale;
	double split;  /* SHOW_SPLIT: place of the line, share of the picture's width, 0..1 */
	double squash; /* height of the screen's pixels over their width: what display_fit() has
			  taken over (struct show_fit), else 1 */
	struct overlay *overlay; /* drawn last; NULL: no text */
	struct pool *pool;	 /* threads that scale pictures */
};

/* The pictures that a view shows. */
struct show_needs {
	bool fisheye, background, scene, composite;
};

const struct show_needs *show_needs(enum config_show view);

struct show_picture {
	struct picture picture; /* width 0: there is none, and its place is black */
	double squash;		/* height of its pixels over their width */
};

struct show_composite {
	int width, height; /* width 0: there is none, and its place is black */
	double squash;
	uint8_t *pixels; /* BGRX, from show_room(); NULL: the view does not show it */
	size_t stride;
};

/* The lights that are marked in the fisheye's picture. Everything is borrowed. */
struct show_marks {
	const struct dome *dome; /* NULL: nothing is marked */
	const struct fisheye *lens;
	const bool *used;	    /* [dome->count] */
	const float (*radiance)[3]; /* [dome->count] */
};

/* What SHOW_GUIDE draws into the composite, and the lamps into the fisheye's picture, too. Borrowed. */
struct show_guide {
	const struct tsai_camera *camera; /* NULL: not known, and nothing is drawn */
	const uint16_t *coverage;	  /* of the object, of the camera's size; NULL: not known */
	struct guide_lamps lamps;
};

struct show_pictures {
	struct show_picture fisheye, background, scene;
	struct show_composite composite;
	struct show_marks marks;
	struct show_guide guide;
};

/* What to ask display_fit() for: then the processor has to scale only quarters of SHOW_QUAD. */
struct show_fit {
	int width, height;
	double squash;
};

void show_free(struct show *show); /* idempotent; zeroed is fine */

struct show_fit show_fit(enum config_show view, const struct eyes *eyes, const struct basis *basis);

/* The size at which a view is shown pixel by pixel, for screens without a size of their own. */
void show_size(enum config_show view, const struct eyes *eyes, const struct basis *basis,
	       int *width, int *height);

/* Finds room for the composite, whose width, height and squash are set: in the screen where it is
 * shown there pixel by pixel and uncut, else in memory of show's own. Sets pixels and stride, which
 * are valid until show_draw(). 0 or -ENOMEM. */
int show_room(struct show *show, const struct show_request *request,
	      struct show_composite *composite, const struct display_buffer *screen,
	      struct fault *fault);

/* Draws the whole screen, of any size, around a composite that is in it already. The request is the
 * one that show_room() got. 0 or -ENOMEM. */
int show_draw(struct show *show, const struct show_request *request,
	      const struct show_pictures *pictures, const struct display_buffer *screen,
	      struct fault *fault);

#endif
