/* SPDX-License-Identifier: MIT */
/* The frames that people are judged in: the simulated studio through its two cameras, with the
 * truth about who is where. */
#ifndef INLAY_TESTS_PEOPLE_FILMED_H
#define INLAY_TESTS_PEOPLE_FILMED_H

#include <stdbool.h>
#include <stdint.h>

#include "drivers/sim/sim.h"
#include "hal/optics/dome.h"
#include "hal/optics/tsai.h"

/* What happens in a frame. */
struct filmed_moment {
	double time_s;
	double switch_s;		  /* of the panels */
	const struct studio_lamps *lamps; /* NULL: the studio's own, switched by switch_s */
	double exposure[3];		  /* the background camera's, R, G, B */
	int number;			  /* of the frame: seeds the noise */
	struct walker walker[WALKER_STYLES];
	int walkers;
	double edge_spread_px; /* of the background camera */
	struct mains mains;    /* the panels flicker in its picture; */
	bool all_flicker;      /* or all lamps do */
};

struct filmed {
	int width, height;
	/* The last frame, linear light, exposure applied, no noise. */
	float *ground;		     /* [h][w][3]: without bodies, but with their shadows */
	struct studio_layer *people; /* [h][w] */
	uint8_t *bgrx;		     /* [h][w][4]: what the background camera gives */
	float (*light)[3];	     /* [dome->count]: measured by the fisheye */
	struct filmed_cameras *cameras;
};

/* Both cameras are sRGB. -errno. */
int filmed_open(struct filmed *filmed, const struct tsai_camera *camera, const struct dome *dome);
/* The background camera's noise in levels, 0.5 and 2 until it is set. */
void filmed_set_noise(struct filmed *filmed, double read_noise, double shot_noise, int seed);
/* Gives each surface another colour: paint() replaces the albedo that it gets. */
void filmed_paint(struct filmed *filmed, void (*paint)(const void *room, struct studio_hit *hit),
		  const void *room);

/* What a row sees of lamps that flicker, over their mean. */
double filmed_row(const struct filmed_moment *moment, int y, int height);
int filmed_take(struct filmed *filmed, const struct filmed_moment *moment);

/* What the background camera gives of other light, rgb[h][w][3], exposure applied: through the same
 * lens and sensor, with noise of its own. */
void filmed_take_other(struct filmed *filmed, const struct filmed_moment *moment, const float *rgb,
		       uint8_t *bgrx);
void filmed_close(struct filmed *filmed);

#endif
