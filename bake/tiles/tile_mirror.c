/* SPDX-License-Identifier: MIT */
#include "bake/tiles/tile_mirror.h"

#include <errno.h>
#include <stdlib.h>

#include "hal/optics/sky_square.h"

/* A pixel's spots are found by this many samples; further ones count by their sums alone. */
#define SAMPLES_MOST 128
#define SAMPLES_LEAST 4
/* Rounds in which the first spot loses what lies outside of it. */
#define ROUNDS 6
/* A spot ends here, in standard deviations: a disc and a square of even light lie inside. */
#define SPOT_END 2.6
/* A spot whose variance along is this many times that across is halved. */
#define SPOT_LONG 2.0
/* Variance of what a trilinear look-up at level 0 sees, in squared texels: the tent of bilinear
 * interpolation (1/6) over a square texel (1/12). It is 4 times as large at each next level. */
#define LOOK_VARIANCE 0.25
/* A spot is shown live if a texel of its level is at most this many times as large as a cell. */
#define CELLS_MOST 1.0

struct mirror_sample {
	float u, v; /* place in the square, in texels of level 0 */
	int cell, spot;
	struct rgb light;
};

struct mirror_pixel {
	int count;
	double all[3], kept[3]; /* light of all samples; of those below */
	struct mirror_sample sample[SAMPLES_MOST];
};

struct tile_mirror {
	struct mirror_pixel pixel[TILE_PIXELS];
};

/* Samples of the same number `spot`: their light, mean place and covariance. */
struct spot {
	double weight, mean[2], uu, uv, vv;
};

int tile_mirror_create(struct tile *tile)
{
	tile->mirror = calloc(1, sizeof(*tile->mirror));
	return tile->mirror ? 0 : -ENOMEM;
}

void tile_mirror_clear(struct tile *tile)
{
	tile->result.mirror_count = 0;
	for (int at = 0; tile->mirror && at < TILE_PIXELS; at++) {
		struct mirror_pixel *p = &tile->mirror->pixel[at];

		p->count = 0;
		for (int c = 0; c < 3; c++)
			p->all[c] = p->kept[c] = 0;
	}
}

bool tile_mirror_add(struct tile *tile, const struct tile_sample *s,
		     const struct transport_rows *rows)
{
	const struct bsdf *bsdf = &s->surface.bsdf;
	struct transport *t = &tile->transport;
	struct mirror_pixel *p;
	double d[3], place[2];

	if (!tile->mirror || bsdf->kind != MATERIAL_GLOSSY || bsdf->alpha > MATERIAL_MIRROR_ALPHA ||
	    s->surface.kind != SURFACE_OBJECT)
		return false;
	if (!transport_add_apart(t, &s->surface, v3_scale(s->direction, -1), rows))
		return true;
	p = &tile->mirror->pixel[s->at];
	for (int c = 0; c < 3; c++)
		p->all[c] += (double)t->apart.light.c[c];
	if (p->count == SAMPLES_MOST)
		return true;
	d[0] = (double)t->apart.direction.x;
	d[1] = (double)t->apart.direction.y;
	d[2] = (double)t->apart.direction.z;
	sky_square_of(d, place);
	p->sample[p->count++] = (struct mirror_sample){
		.u = (float)(place[0] * BASIS_MIRROR_SIDE),
		.v = (float)(place[1] * BASIS_MIRROR_SIDE),
		.cell = t->apart.cell,
		.light = t->apart.light,
	};
	for (int c = 0; c < 3; c++)
		p->kept[c] += (double)t->apart.light.c[c];
	return true;
}

static double sample_weight(const struct mirror_sample *s)
{
	return (double)s->light.c[0] + (double)s->light.c[1] + (double)s->light.c[2];
}

static struct spot spot_of(const struct mirror_pixel *p, int number)
{
	struct spot spot = {.weight = 0};

	for (int k = 0; k < p->count; k++) {
		const struct mirror_sample *s = &p->sample[k];
		const double w = s->spot == number ? sample_weight(s) : 0;
		const double u = (double)s->u, v = (double)s->v;

		spot.weight += w;
		spot.mean[0] += w * u;
		spot.mean[1] += w * v;
		spot.uu += w * u * u;
		spot.uv += w * u * v;
		spot.vv += w * v * v;
	}
	if (spot.weight > 0) {
		const double u = spot.mean[0] /= spot.weight, v = spot.mean[1] /= spot.weight;

		spot.uu = fmax(spot.uu / spot.weight - u * u, 0);
		spot.uv = spot.uv / spot.weight - u * v;
		spot.vv = fmax(spot.vv / spot.weight - v * v, 0);
	}
	return spot;
}

/* Squared distance from the spot's middle, in its standard deviations; what a look-up sees anyway
 * does not make a spot narrow. */
static double spot_distance(const struct spot *spot, const struct mirror_sample *s)
{
	const double uu = spot->uu + LOOK_VARIANCE, vv = spot->vv + LOOK_VARIANCE;
	const double u = (double)s->u - spot->mean[0], v = (double)s->v - spot->mean[1];

	return (u * u * vv - 2 * u * v * spot->uv + v * v * uu) / (uu * vv - spot->uv * spot->uv);
}

/* Gathers most samples in spot 0; the others get -1. A rough coat mirrors some light far away, which
 * would make the spot too wide. */
static void gather_spot(struct mirror_pixel *p)
{
	for (int k = 0; k < p->count; k++)
		p->sample[k].spot = 0;
	for (int round = 0; round < ROUNDS; round++) {
		const struct spot spot = spot_of(p, 0);

		for (int k = 0; k < p->count; k++)
			p->sample[k].spot = spot_distance(&spot, &p->sample[k]) <
							    SPOT_END * SPOT_END
						    ? 0
						    : -1;
	}
}

/* Halves a spot across its longer axis if it is long; the farther half gets the number `next`.
 * Returns whether it did. */
static bool halve_spot(struct mirror_pixel *p, int number, int next)
{
	const struct spot spot = spot_of(p, number);
	const double half = (spot.uu - spot.vv) / 2, mean = (spot.uu + spot.vv) / 2;
	const double root = hypot(half, spot.uv);
	/* the axis of the larger variance */
	const double turn = atan2(spot.uv, half) / 2, u = cos(turn), v = sin(turn);

	if (mean + root < SPOT_LONG * fmax(mean - root, LOOK_VARIANCE))
		return false;
	for (int k = 0; k < p->count; k++) {
		struct mirror_sample *s = &p->sample[k];

		if (s->spot == number && u * ((double)s->u - spot.mean[0]) +
							 v * ((double)s->v - spot.mean[1]) >
						 0)
			s->spot = next;
	}
	return true;
}

/* Level whose look-up sees this variance: 4^l LOOK_VARIANCE, and between levels a mean of both. */
static double spot_level(double variance)
{
	const double wide = variance / LOOK_VARIANCE;
	const double level = wide > 1 ? floor(log2(wide) / 2) : 0, part = wide / pow(4, level);

	return fmin(level + fmax(part - 1, 0) / 3, BASIS_MIRROR_LEVELS - 1);
}

static uint16_t in_steps(double value, double most)
{
	return (uint16_t)lround(fmin(fmax(value, 0), most));
}

/* Writes a spot of a pixel. Returns false where cells show it better. */
static bool write_spot(struct tile *tile, int at, int number, const double scale[3])
{
	const struct mirror_pixel *p = &tile->mirror->pixel[at];
	const struct spot spot = spot_of(p, number);
	struct basis_mirror *m = &tile->result.mirror[tile->result.mirror_count];
	const double place[2] = {spot.mean[0] / BASIS_MIRROR_SIDE, spot.mean[1] / BASIS_MIRROR_SIDE};
	const double variance = (spot.uu + spot.vv) / 2;
	double light[3] = {0, 0, 0}, d[3], texel_sr;
	int cell = -1;

	if (!(spot.weight > 0))
		return false;
	texel_sr = sky_square_direction(place, d) / BASIS_MIRROR_SIDE / BASIS_MIRROR_SIDE;
	cell = cells_of(tile->cells, v3_make((float)d[0], (float)d[1], (float)d[2]));
	if (cell < 0 || variance / LOOK_VARIANCE * texel_sr >
				CELLS_MOST * (double)tile->cells->sr[cell])
		return false;
	for (int k = 0; k < p->count; k++)
		for (int c = 0; c < 3 && p->sample[k].spot == number; c++)
			light[c] += (double)p->sample[k].light.c[c];
	*m = (struct basis_mirror){
		.x = (uint16_t)(tile->x + at % BASIS_TILE),
		.y = (uint16_t)(tile->y + at / BASIS_TILE),
		.u = in_steps(65536 * place[0], 65535),
		.v = in_steps(65536 * place[1], 65535),
		.level = in_steps(BASIS_MIRROR_STEP * spot_level(variance),
				  (BASIS_MIRROR_LEVELS - 1) * BASIS_MIRROR_STEP),
	};
	for (int c = 0; c < 3; c++)
		m->throughput[c] = in_steps(65535 * light[c] * scale[c] / tile->samples, 65535);
	tile->result.mirror_count++;
	return true;
}

/* Returns a sample to T. */
static void return_sample(struct tile *tile, int at, const struct mirror_sample *s,
			  const double scale[3])
{
	const size_t count = (size_t)tile->cells->count;
	float *row = tile->rows[TILE_OBJECT].direct +
		     (size_t)at * tile_direct_size(tile, TILE_OBJECT) + s->cell;

	for (size_t c = 0; c < 3; c++)
		row[c * count] += s->light.c[c] * (float)scale[c];
}

static void finish_pixel(struct tile *tile, int at)
{
	struct mirror_pixel *p = &tile->mirror->pixel[at];
	bool live[BASIS_MIRROR_MOST] = {false};
	double scale[3];
	int spots = 0;

	for (int c = 0; c < 3; c++)
		scale[c] = p->kept[c] > 0 ? p->all[c] / p->kept[c] : 0;
	if (p->count >= SAMPLES_LEAST) {
		gather_spot(p);
		spots = 1;
		for (int pass = 1; pass < BASIS_MIRROR_MOST; pass *= 2)
			for (int k = 0, before = spots; k < before; k++)
				spots += halve_spot(p, k, spots);
		for (int k = 0; k < spots; k++)
			live[k] = write_spot(tile, at, k, scale);
	}
	for (int k = 0; k < p->count; k++)
		if (!spots || p->sample[k].spot < 0 || !live[p->sample[k].spot])
			return_sample(tile, at, &p->sample[k], scale);
}

void tile_mirror_finish(struct tile *tile)
{
	for (int at = 0; tile->mirror && at < TILE_PIXELS; at++)
		if (tile->mirror->pixel[at].count)
			finish_pixel(tile, at);
}
