/* SPDX-License-Identifier: MIT */
/* What is on the screen: the views, and the text, marks and guide that are drawn into them. */
#ifndef INLAY_APP_VIEW_SHOW_H
#define INLAY_APP_VIEW_SHOW_H

#include <stdbool.h>

#include "app/camera/eye.h"
#include "app/view/layout.h"
#include "config/config.h"
#include "hal/base/pool.h"
#include "hal/basis/basis.h"
#include "hal/device/display.h"
#include "hal/frame/frame.h"
#include "hal/frame/view.h"
#include "hal/lights/lamps.h"
#include "hal/optics/dome.h"
#include "hal/optics/fisheye.h"
#include "hal/optics/tsai.h"

/*
 * Text over the picture: troubles in a box at the upper edge, a line of figures along the lower
 * one. Each takes at most a third of the height, so that the middle stays free. cairo draws them
 * into memory of its own, only when the text or the screen's size changes; each frame then copies
 * the boxes over the screen's pixels, which are never read. Without cairo in the build nothing is
 * drawn, and the log says so once.
 */

#define OVERLAY_TEXT_MAX                                                                           \
	256 /* bytes, terminator included; longer texts are cut between characters */
#define OVERLAY_TROUBLES_MAX 7

struct overlay_drawn;

struct overlay {
	char information[OVERLAY_TEXT_MAX]; /* empty: not shown */
	char trouble[OVERLAY_TROUBLES_MAX][OVERLAY_TEXT_MAX];
	int trouble_count;
	/* Private: */
	bool information_drawn, troubles_drawn; /* the panels hold the present texts */
	struct overlay_drawn *drawn; /* panels and the screen's size that they are drawn for */
};

/* UTF-8. The same text again changes nothing. */
void overlay_information(struct overlay *overlay, const char *text); /* NULL: not shown */
/* Present troubles, the most important one first; those that do not fit are left out. */
void overlay_troubles(struct overlay *overlay, const char (*texts)[OVERLAY_TEXT_MAX], int count);

/* Copies the text over the picture in the buffer. Nothing is allocated while text and size stay the
 * same. 0 or -ENOMEM. */
int overlay_draw(struct overlay *overlay, const struct display_buffer *screen);

void overlay_free(struct overlay *overlay); /* idempotent; zeroed is fine */

/*
 * What helps to set a kiosk up by eye: the calibrated ground drawn into the background's picture,
 * and the directions of the world into the fisheye's.
 */

#define GUIDE_LIGHTS 3 /* brightest lights that are named */

/* Distance of the grid's lines, in the scene's units: 1, 2 or 5 times a power of ten, of which
 * about eight cross the middle of the picture. 0: the ground is not in the picture. */
double guide_spacing(const struct tsai_camera *camera);

/* The lamps at places, borrowed. */
struct guide_lamps {
	const struct lamps *lamps; /* NULL: there are none */
	const char (*name)[CONFIG_NAME_MAX];
	const bool *missing; /* those that show no light */
};

/*
 * Draws the ground's grid, the axes X, Y, Z from the origin, the horizon, the object's outline, and
 * from each lamp's foot on the ground a line up to the lamp, as far as that is in the picture.
 * The canvas has the camera's size. coverage[height][width], 65535 is 1; NULL: there is no outline.
 */
void guide_draw_ground(struct canvas *canvas, const struct tsai_camera *camera,
		       const uint16_t *coverage, const struct guide_lamps *lamps, double letter_px);

/* A light that stands out, by its number in the dome. */
struct guide_light {
	int light;
	double azimuth_deg; /* from +X towards +Y, 0..360 */
	double height_deg;
};

/* The brightest lights: at least three times as bright as the mean, and 20 degrees apart. Returns
 * their number, at most GUIDE_LIGHTS; 0 under an even sky. radiance[dome->count]. */
int guide_find_lights(const struct dome *dome, const float (*radiance)[3],
		      struct guide_light found[GUIDE_LIGHTS]);

/* Draws the edge of the lens's field, the horizon, the directions +X and +Y, the brightest lights
 * with azimuth and height, and a ring as large as each lamp where it has to be seen. lens is
 * prepared for the canvas's size; radiance NULL: no lights. */
void guide_draw_sky(struct canvas *canvas, const struct fisheye *lens, const struct dome *dome,
		    const float (*radiance)[3], const struct guide_lamps *lamps, double letter_px);

/* Marks the lights in the fisheye's picture, as in the thesis's figures: red lights are in use,
 * blue ones left out. */

#define MARK_USED_BGR                                                                              \
	{                                                                                          \
		32, 32, 255                                                                        \
	}
#define MARK_UNUSED_BGR                                                                            \
	{                                                                                          \
		255, 96, 32                                                                        \
	}

/* Side of a mark, px, in a picture of this height that is shown shown_height pixels high: 2 in the
 * thesis's 243 rows and in smaller pictures; at least 3 pixels of the screen, to be seen where the
 * picture is shrunk. */
int mark_side_px(int picture_height, int shown_height);

/* used[dome->count]; lens is prepared for the canvas's size. Lights that it does not see are not
 * drawn. */
void marks_draw(struct canvas *canvas, const struct dome *dome, const struct fisheye *lens,
		const bool *used, int side_px);

/*
 * What is on the screen: the picture with the object, the background before it, both beside each
 * other, the fisheye with its lights marked, the scene camera, or four of them as in the thesis
 * (section 4.2.1):
 *
 *     scene   fisheye
 *     before  after
 *
 * guide is for setting up: composite and fisheye in halves, with ground and directions drawn in
 * (above). A view that has no picture is black.
 *
 * Pictures are made elsewhere and only placed here. For each picture of the screen: take the
 * pictures that show_needs() names, ask show_room() where the composite goes, make it there, then
 * call show_draw().
 */

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

/* What SHOW_GUIDE draws into the composite, and the lamps into the fisheye's picture, too.
 * Borrowed. */
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
