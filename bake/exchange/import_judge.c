/* SPDX-License-Identifier: MIT */
#include "bake/exchange/import_pictures.h"

#include <errno.h>
#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "hal/base/log.h"

/* The ground is flat if the means over parts of the picture differ by less than FLAT_SPREAD from
 * the mean over all of it. */
#define FLAT_PARTS 4 /* a side */
#define FLAT_SPREAD 0.03
/* How far a light's share of level ground's light may be from that of its cell's solid angle,
 * relative. */
#define SHARE_TOLERANCE 0.3
#define ALBEDO_MIN 0.01
#define ALBEDO_MAX 1.1
/* Shares of the ground's light: what pictures of objects may add to open ground (noise), and what
 * pictures of objects alone may show there. */
#define BRIGHTER_MOST 0.02
#define ALONE_MOST 0.5

/* ---- flat ground ---- */

struct ground_part {
	double sum;
	long count;
};

/* Sets p->ground to the mean over all pixels of ground. Returns how far parts of the picture are
 * from it: relative, RMS over lights and parts. */
static double ground_spread(struct import_pictures *p)
{
	const int width = p->with.width, height = p->with.height, lights = p->without.count;
	double square = 0, all_square = 0;

	for (int i = 0; i < lights; i++) {
		const float *value = picture_stack_at(&p->without, i, 0, 0);
		struct ground_part part[FLAT_PARTS * FLAT_PARTS] = {{0}};
		double sum[3] = {0};
		long count = 0;

		for (int k = 0; k < width * height; k++) {
			struct ground_part *at =
				&part[k / width * FLAT_PARTS / height * FLAT_PARTS +
				      k % width * FLAT_PARTS / width];

			if (!p->is_ground[k])
				continue;
			for (int c = 0; c < 3; c++)
				sum[c] += (double)value[3 * k + c];
			at->sum += (double)value[3 * k + 1];
			at->count++;
			count++;
		}
		for (int c = 0; c < 3; c++)
			p->ground[c * lights + i] = count ? sum[c] / (double)count : 0;
		for (int k = 0; k < FLAT_PARTS * FLAT_PARTS; k++) {
			const double mean = p->ground[lights + i];
			const double weight = (double)part[k].count;

			if (!part[k].count)
				continue;
			square += weight * pow(part[k].sum / weight - mean, 2);
			all_square += weight * mean * mean;
		}
	}
	return all_square > 0 ? sqrt(square / all_square) : HUGE_VAL;
}

/* Level ground of albedo a sends back a / pi times the projected solid angle of a cell of radiance
 * 1. Anything else shows a wrong order of the pictures, or a wrong unit. */
static int check_flat_ground(const struct import_pictures *p, const char *name, struct fault *fault)
{
	const struct dome *dome = p->dome;
	double albedo = 0, worst = 0;
	int light = 0;

	for (int i = 0; i < dome->count; i++)
		albedo += p->ground[dome->count + i];
	if (!(albedo >= ALBEDO_MIN && albedo <= ALBEDO_MAX))
		return fault_say(
			fault, -EINVAL,
			"%s: all lights together make the ground %.4g bright, expected its albedo, %g to 1, as of lights of radiance 1 (--scale multiplies all pictures)",
			name, albedo, ALBEDO_MIN);
	for (int i = 0; i < dome->count; i++) {
		const double expected = albedo / M_PI * dome->projected_sr[i];
		/* lights on the horizon send next to nothing */
		const double slack = expected + 0.1 * albedo / dome->count;
		const double off = fabs(p->ground[dome->count + i] - expected) / slack;

		if (off > worst) {
			worst = off;
			light = i;
		}
	}
	if (worst <= SHARE_TOLERANCE)
		return 0;
	return fault_say(
		fault, -EINVAL,
		"%s: the light at %.1f degrees from the zenith makes the ground %.3g bright, "
		"expected %.3g of %.3g in all, as its cell of radiance 1 does: pictures in another order than the angles, or of lights that are no cells of radiance 1, or of a polished floor (--receivers own)",
		name, acos(fmin(dome->direction[light][2], 1)) * (180 / M_PI),
		p->ground[dome->count + light], albedo / M_PI * dome->projected_sr[light], albedo);
}

/* ---- order ---- */

#define LOOK 12		 /* parts a side in which pictures are compared */
#define LIGHTS_LEAST 20	 /* of fewer lights too many are neighbours */
#define LIGHTS_TRIED 256 /* of more lights so many are tried */
#define NEIGHBOUR 1.6	 /* largest angle between neighbours, in mean distances */
#define ALIKE_LEAST 0.4	 /* least share of lights whose most similar picture is a neighbour's */
#define DIFFERENCE_LEAST 0.01f /* pictures that differ less say nothing about the order */

/* Describes a picture by the share of the light that the object leaves in each part. */
static void look_at(const struct import_pictures *p, int light, float look[LOOK * LOOK])
{
	const int width = p->with.width, height = p->with.height;
	float with[LOOK * LOOK] = {0}, without[LOOK * LOOK] = {0};

	for (int y = 0; y < height; y++)
		for (int x = 0; x < width; x++) {
			const int part = y * LOOK / height * LOOK + x * LOOK / width;

			with[part] += picture_stack_at(&p->with, light, x, y)[1];
			without[part] += picture_stack_at(&p->without, light, x, y)[1];
		}
	for (int k = 0; k < LOOK * LOOK; k++)
		look[k] = without[k] > 0 ? with[k] / without[k] : 1;
}

static float look_difference(const float *a, const float *b)
{
	float sum = 0;

	for (int k = 0; k < LOOK * LOOK; k++)
		sum += (a[k] - b[k]) * (a[k] - b[k]);
	return sqrtf(sum / (LOOK * LOOK));
}

static double node_angle(const struct dome *dome, int a, int b)
{
	const double *u = dome->direction[a], *v = dome->direction[b];

	return acos(fmin(u[0] * v[0] + u[1] * v[1] + u[2] * v[2], 1));
}

/* Shadows of neighbouring lights fall alike, so pictures resemble their neighbours' most. */
static int check_order(const struct import_pictures *p, const char *name, struct fault *fault)
{
	const int n = p->dome->count, step = (n + LIGHTS_TRIED - 1) / LIGHTS_TRIED;
	const double near = NEIGHBOUR * sqrt(2 * M_PI / n);
	float(*look)[LOOK * LOOK] = malloc((size_t)n * sizeof(*look));
	int tried = 0, alike = 0;
	float most = 0;

	if (!look)
		return fault_say(fault, -ENOMEM, "out of memory");
	for (int i = 0; i < n; i++)
		look_at(p, i, look[i]);
	for (int i = 0; i < n; i += step) {
		float least = INFINITY;
		int nearest = i;

		/* pictures of lights on the horizon show more noise than shadow */
		if (p->dome->direction[i][2] < 0.1)
			continue;
		for (int j = 0; j < n; j++) {
			const float d = j == i ? INFINITY : look_difference(look[i], look[j]);

			if (d < least) {
				least = d;
				nearest = j;
			}
			most = j == i ? most : fmaxf(most, d);
		}
		tried++;
		alike += node_angle(p->dome, i, nearest) < near;
	}
	free(look);
	if (most < DIFFERENCE_LEAST || alike >= ALIKE_LEAST * tried)
		return 0;
	return fault_say(
		fault, -EINVAL,
		"%s: of %d pictures only %d are most like one of a neighbouring light: expected them in the order of the angles",
		name, tried, alike);
}

/* ---- which picture is which ---- */

/* Whether a pixel shows ground that objects neither cover nor touch, whatever filter drew their
 * edge. */
static bool is_open_ground(const struct import_pictures *p, int x, int y)
{
	const int width = p->with.width, height = p->with.height;

	for (int v = y - 1; v <= y + 1; v++)
		for (int u = x - 1; u <= x + 1; u++)
			if (u >= 0 && v >= 0 && u < width && v < height &&
			    p->coverage[v * width + u] > 0)
				return false;
	return p->is_ground[y * width + x];
}

/* Sums over open ground and all lights. */
struct balance {
	double without, gained, lost, alone;
};

static struct balance weigh_open_ground(const struct import_pictures *p)
{
	struct balance b = {0};

	for (int y = 0; y < p->with.height; y++)
		for (int x = 0; x < p->with.width; x++) {
			if (!is_open_ground(p, x, y))
				continue;
			for (int i = 0; i < p->with.count; i++)
				for (int c = 0; c < 3; c++) {
					const double before = (double)picture_stack_at(&p->without,
										       i, x, y)[c];
					const double more = (double)picture_stack_at(&p->with, i, x,
										     y)[c] -
							    before;

					b.without += before;
					b.gained += fmax(more, 0);
					b.lost += fmax(-more, 0);
					if (p->alone.value)
						b.alone += (double)picture_stack_at(&p->alone, i, x,
										    y)[c];
				}
		}
	return b;
}

/* All lights together are an even sky, under which no object can make ground brighter: what it
 * sends is no brighter than the sky that it hides. */
static int check_roles(const struct import_pictures *p,
		       const struct import_pictures_settings *settings, struct fault *fault)
{
	const size_t values = 3 * (size_t)p->with.width * (size_t)p->with.height;
	const struct balance b = weigh_open_ground(p);

	if (!memcmp(p->with.value, p->without.value,
		    values * (size_t)p->with.count * sizeof(*p->with.value)))
		return fault_say(fault, -EINVAL,
				 "%s: the same pictures as %s, expected objects in one of them",
				 settings->object, settings->ground);
	if (b.gained > 2 * b.lost && b.gained - b.lost > BRIGHTER_MOST * b.without)
		return fault_say(
			fault, -EINVAL,
			"%s: %.3g times as bright as %s where objects cover nothing, expected it darker: interchanged, or a coverage that is inverted",
			settings->object, 1 + (b.gained - b.lost) / b.without, settings->ground);
	if (b.alone > ALONE_MOST * b.without)
		return fault_say(
			fault, -EINVAL,
			"%s: light where objects cover nothing, expected what is seen of them, over black",
			settings->alone);
	return 0;
}

/* Warns if no pixel is of an object. It may be outside and throw its shadow in, but that is seldom
 * meant. */
static void warn_no_object(const struct import_pictures *p,
			   const struct import_pictures_settings *settings)
{
	const int pixels = p->with.width * p->with.height;
	int k = 0;

	while (k < pixels && !(p->coverage[k] > 0))
		k++;
	if (k == pixels)
		log_warning(
			"%s: no pixel is of an object; expected some that are not black (alpha is not looked at)",
			settings->coverage ? settings->coverage : settings->mask);
}

int import_judge(struct import_pictures *p, const struct import_pictures_settings *settings,
		 struct fault *fault)
{
	const double spread = ground_spread(p);
	int err = 0;

	p->flat = settings->receivers == RECEIVERS_FLAT ||
		  (settings->receivers == RECEIVERS_AUTO && spread < FLAT_SPREAD);
	err = check_roles(p, settings, fault);
	if (!err && p->flat)
		err = check_flat_ground(p, settings->ground, fault);
	if (!err && p->dome->count >= LIGHTS_LEAST)
		err = check_order(p, settings->object, fault);
	if (!err)
		warn_no_object(p, settings);
	return err;
}
