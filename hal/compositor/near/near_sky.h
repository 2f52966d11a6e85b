/* SPDX-License-Identifier: MIT */
/*
 * Lamps at places: the light of lamp l that arrives at place x, as light of the cells around its
 * direction. The fisheye at p_f measures P_l, the sum of L_i w_i of the lamp alone. Seen from x the
 * lamp has the same radiance and another solid angle, so it sends
 *
 *     w_i L_i = P_l b_i(direction from x to p_l) |p_l - p_f|^2 / |p_l - x|^2
 *
 * where b_i are the shares of dome_placed_share(), averaged over the lamp's disc. Positions never
 * change while a basis is shown, so all but P_l is computed once. hal/compositor/README.md, Lamps.
 */
#ifndef INLAY_HAL_COMPOSITOR_NEAR_NEAR_SKY_H
#define INLAY_HAL_COMPOSITOR_NEAR_NEAR_SKY_H

#include <stdbool.h>

#include "hal/basis/basis.h"
#include "hal/lights/lamps.h"
#include "hal/optics/dome.h"
#include "hal/optics/dome_placed.h"
#include "hal/optics/tsai.h"

/* Points of a disc: its middle, of weight 1/4, and six of 1/8 at sqrt(2/3) of its radius, which
 * integrate polynomials of degree 5 exactly. */
enum { NEAR_POINTS = 7, NEAR_SHARES = 3 * NEAR_POINTS };

struct near_share {
	int light;
	double amount; /* w_i L_i for P_l = 1 */
};

struct near_sky {
	const struct basis *basis; /* borrowed */
	struct lamps lamps;
	struct dome dome;
	struct dome_placed *placed;
	struct tsai_camera camera;
	/* u of the ground at the middle of the object's footprint, for P_l = 1: the unit in which
	 * the light on the ground is measured. 0: the lamp does not light the ground there. */
	double ground[LAMPS_MAX][3];
};

/*
 * *sky is NULL where there is nothing to do: no lamps, or a basis that does not know its places or
 * has several grounds; then all light is taken as coming from afar. -ENOMEM; -EINVAL: the lights
 * are no dome's, or the camera is none.
 */
int near_sky_create(struct near_sky **sky, const struct basis *basis, const struct lamps *lamps,
		    struct fault *fault);
void near_sky_destroy(struct near_sky *sky); /* NULL is harmless */

/* Whether lamps at places can be used with a basis. */
bool near_sky_possible(const struct basis *basis);

/* What is found in one direction, which is tried first in the next. Zeroed: nothing yet. */
struct near_hint {
	bool known;
	int cell, facet;
};

/* The light of a lamp at a place. A light may be listed several times. Returns the number of
 * shares; 0: the lamp is below the horizon of the place. The result does not depend on the hint;
 * NULL: none. */
int near_sky_shares(const struct near_sky *sky, int lamp, const double place[3],
		    struct near_hint *hint, struct near_share share[NEAR_SHARES]);

/* The object at a pixel under skies of the radiances 1, x, y, of a direction (x, y, z). */
enum { NEAR_SKIES = 3 };
double near_sky_radiance(int sky, const double direction[3]);

/*
 * What of a lamp's light at a place of the object, `value` as near_sky_shares() gives it for
 * P_l = 1, is too much because it bounces. It comes from the ground, with the irradiance of the
 * ground there, though the lights of a dome have that of the place:
 *
 *     min(share T_1 E / pi, value) (1 - mean of min(E_k / E, 1))     E = P cos(zenith angle) / d^2
 *
 * share is that of T_1 which bounces; where a lamp does not reach a side of the object, all of its
 * light does. The object's side faces the way a = 3/2 (T_x, T_y) / T_1, of length 1 for a wall.
 * What a wall sees of the ground within x of its foot, from height z, is the share
 * 1 - z / sqrt(x^2 + z^2), so that E_k are at q_k z a from below the place with
 * q = 0.663, 1.732, 5.916, where that is 1/6, 1/2, 5/6.
 */
struct near_object {
	double share, t[NEAR_SKIES][3]; /* [3]: channels */
};
double near_sky_bounced(const struct near_sky *sky, int lamp, const double place[3],
			const struct near_object *object, int channel, double value);

/* The place of the ground that a point of the picture shows. False: it shows none. */
bool near_sky_ground(const struct near_sky *sky, double x, double y, double place[3]);

/* The place at this distance from the camera that a point of the picture shows. */
bool near_sky_surface(const struct near_sky *sky, double x, double y, double distance,
		      double place[3]);

#endif
