/* SPDX-License-Identifier: MIT */
#include "hal/compositor/near/near_sky.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "hal/basis/basis_places.h"
#include "hal/optics/vec.h"

bool near_sky_possible(const struct basis *basis)
{
	bool known = basis->info.grounds <= 1 && *basis->camera &&
		     /* lamps have numbers after lights and groups, of 16 bits */
		     basis->info.lights + basis->info.coarse + LAMPS_MAX <= UINT16_MAX;

	for (uint32_t p = 0; known && p < basis->info.poses; p++)
		known = basis_has_places(basis, (int)p);
	return known;
}

/* The middle of what the first pose's object covers of the ground; without it the origin. */
static void middle_of_object(const struct basis *basis, double middle[3])
{
	const struct basis_footprint *foot = basis->feet;
	const double half = foot ? 0.5 * BASIS_FOOT_SQUARES * (double)foot->side : 0;

	for (int k = 0; k < 2; k++)
		middle[k] = foot ? (double)foot->corner[k] + half : 0;
	middle[2] = 0;
}

/* u on the ground at a place. */
static void light_on_ground(const struct near_sky *sky, int lamp, const double place[3],
			    double light[3])
{
	struct near_share share[NEAR_SHARES];
	const int count = sky->basis->info.grounds ? near_sky_shares(sky, lamp, place, NULL, share)
						   : 0;

	memset(light, 0, 3 * sizeof(*light));
	for (int n = 0; n < count; n++)
		for (int c = 0; c < 3; c++)
			light[c] += basis_ground(sky->basis, 0, c)[share[n].light] *
				    share[n].amount /
				    sky->basis->lights[share[n].light].solid_angle_sr;
}

int near_sky_create(struct near_sky **out, const struct basis *basis, const struct lamps *lamps,
		    struct fault *fault)
{
	const int stride = sizeof(*basis->lights) / sizeof(double);
	double middle[3];
	struct near_sky *sky;
	int ret;

	*out = NULL;
	if (!lamps || !lamps->count || !near_sky_possible(basis))
		return 0;
	sky = calloc(1, sizeof(*sky));
	if (!sky)
		return fault_say(fault, -ENOMEM, "out of memory");
	sky->basis = basis;
	sky->lamps = *lamps;
	ret = tsai_read_text(basis->camera, &sky->camera, fault);
	if (ret == 0)
		ret = dome_create_nodes(&sky->dome, basis->lights[0].direction, stride,
					(int)basis->info.lights, (int)basis->info.dome_frequency,
					fault);
	if (ret == 0) {
		ret = dome_placed_create(&sky->placed, &sky->dome);
		if (ret < 0)
			fault_say(fault, ret, "the dome has too few lights for lamps at places");
	}
	if (ret < 0) {
		near_sky_destroy(sky);
		return ret;
	}
	middle_of_object(basis, middle);
	for (int l = 0; l < lamps->count; l++)
		light_on_ground(sky, l, middle, sky->ground[l]);
	*out = sky;
	return 0;
}

void near_sky_destroy(struct near_sky *sky)
{
	if (!sky)
		return;
	dome_placed_destroy(sky->placed);
	dome_free(&sky->dome);
	free(sky);
}

/* Shares what comes from one direction. Directions below the horizon count as on it. */
static int share_point(const struct near_sky *sky, const double dir[3], int cell, double amount,
		       int *facet, struct near_share *share)
{
	const double up[3] = {dir[0], dir[1], fmax(dir[2], 0)};
	double weight[3];
	int to[3];
	const int count = dome_placed_share(sky->placed, cell, facet, up, to, weight);

	for (int n = 0; n < count; n++)
		share[n] = (struct near_share){to[n], amount * weight[n]};
	return count;
}

int near_sky_shares(const struct near_sky *sky, int lamp, const double place[3],
		    struct near_hint *hint, struct near_share share[NEAR_SHARES])
{
	const struct lamp *l = &sky->lamps.lamp[lamp];
	const struct near_hint before = hint && hint->known ? *hint
							    : (struct near_hint){.facet = -1};
	struct near_hint now = {.known = true, .facet = before.facet};
	double to[3], from[3], across[2][3], distance, radius, reach, amount;
	int count, nearest = 0;

	for (int k = 0; k < 3; k++) {
		to[k] = l->position[k] - place[k];
		from[k] = l->position[k] - sky->lamps.fisheye[k];
	}
	distance = fmax(vec_normalize(to), l->radius);
	amount = vec_dot(from, from) / (distance * distance);
	count = to[2] >= 0 ? share_point(sky, to, before.cell, amount, &now.facet, share) : 0;
	if (!count)
		return 0;
	for (int n = 1; n < count; n++)
		nearest = share[n].amount > share[nearest].amount ? n : nearest;
	now.cell = share[nearest].light;
	if (hint)
		*hint = now;
	/* The cells themselves spread light as far as they reach, and variances add up. */
	reach = dome_cell_reach_rad(&sky->dome, now.cell);
	radius = l->radius / distance;
	if (radius <= reach)
		return count;
	radius = sqrt(2.0 / 3 * (radius * radius - reach * reach));
	for (int n = 0; n < count; n++)
		share[n].amount /= 4;
	vec_across(to, across);
	for (int n = 0; n < NEAR_POINTS - 1; n++) {
		/* of a hexagon */
		static const double x[] = {1, 0.5, -0.5, -1, -0.5, 0.5};
		static const double y[] = {0, 1, 1, 0, -1, -1};
		double dir[3];

		for (int k = 0; k < 3; k++)
			dir[k] = to[k] +
				 radius * (x[n] * across[0][k] + sqrt(0.75) * y[n] * across[1][k]);
		count += share_point(sky, dir, now.cell, amount / 8, &now.facet, share + count);
	}
	return count;
}

/* E at a place for P = 1. */
static double level_irradiance(const struct near_sky *sky, int lamp, const double place[3])
{
	const struct lamp *l = &sky->lamps.lamp[lamp];
	double to[3], from[3], distance;

	for (int k = 0; k < 3; k++) {
		to[k] = l->position[k] - place[k];
		from[k] = l->position[k] - sky->lamps.fisheye[k];
	}
	distance = fmax(vec_normalize(to), l->radius);
	return fmax(to[2], 0) * vec_dot(from, from) / (distance * distance);
}

double near_sky_radiance(int sky, const double direction[3])
{
	return sky ? direction[sky - 1] : 1;
}

double near_sky_bounced(const struct near_sky *sky, int lamp, const double place[3],
			const struct near_object *object, int channel, double value)
{
	static const double q[] = {0.663, 1.732, 5.916};
	const double here = level_irradiance(sky, lamp, place);
	const double bounced = fmin(object->share * object->t[0][channel] * here / M_PI, value);
	double sum[NEAR_SKIES] = {0}, less = 0;

	if (!(here > 0 && bounced > 0))
		return 0;
	for (int k = 0; k < NEAR_SKIES; k++)
		for (int c = 0; c < 3; c++)
			sum[k] += object->t[k][c];
	for (int k = 0; k < 3; k++) {
		const double far = sum[0] > 0 ? q[k] * place[2] * 1.5 / sum[0] : 0;
		const double at[3] = {place[0] + far * sum[1], place[1] + far * sum[2], 0};

		less += (1 - fmin(level_irradiance(sky, lamp, at) / here, 1)) / 3;
	}
	return bounced * less;
}

bool near_sky_surface(const struct near_sky *sky, double x, double y, double distance,
		      double place[3])
{
	double eye[3], dir[3];

	if (tsai_ray(&sky->camera, (const double[]){x, y}, eye, dir) < 0)
		return false;
	for (int k = 0; k < 3; k++)
		place[k] = eye[k] + distance * dir[k];
	return true;
}

bool near_sky_ground(const struct near_sky *sky, double x, double y, double place[3])
{
	double eye[3], dir[3];

	if (tsai_ray(&sky->camera, (const double[]){x, y}, eye, dir) < 0 || !(eye[2] > 0) ||
	    !(dir[2] < 0))
		return false;
	for (int k = 0; k < 3; k++)
		place[k] = k < 2 ? eye[k] - eye[2] / dir[2] * dir[k] : 0;
	return true;
}
