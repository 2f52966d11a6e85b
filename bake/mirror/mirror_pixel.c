/* SPDX-License-Identifier: MIT */
#include "bake/mirror/mirror_pixel.h"

#include <math.h>

#include "hal/optics/sky_square.h"

#define SAMPLES_LEAST 4
#define STEP_RAD 1e-2F /* of a derivative; single precision has 1e-7 */
/* A spot is halved if its variance along is this many times that across: with 3, metal was no
 * nearer to truth, for a fourth more look-ups ... */
#define SPOT_LONG 6.0
/* ... or if it is above this, rad^2: 1.8 degrees wide. A pixel is a square, whose edge the tent of
 * a look-up blurs. Of large pictures, whose pixels are smaller, that would cost too many. */
#define SPOT_WIDE 8e-5
/* Solid angle of a texel of mean size; those of a place are up to twice as large, or half of it. */
#define TEXEL_RAD2 (8.0 / BASIS_MIRROR_SIDE / BASIS_MIRROR_SIDE)
/* Variance of what a trilinear look-up at level 0 sees, in squared texels: the tent of bilinear
 * interpolation (1/6) over a square texel (1/12). It is 4 times as large at each next level. */
#define LOOK_VARIANCE 0.25
/* A spot is shown live if the texel that its samples ask for is no larger than a cell, and its lobe
 * no wider than this, rad^2: a standard deviation of 11.5 degrees. In T a lobe of a few samples is
 * noise wherever a lamp is near. */
#define BLUR_MOST 0.04

/*
 * A rough coat's lobe as a sum of Gaussians. Of the microfacets of GGX the share 1 / (1 + x^2) is
 * steeper than x, in units of alpha, and
 *     1 / (1 + x^2) = integral of exp(-t) exp(-t x^2) dt
 * so a part of the range of t is about a Gaussian of variance 1 / (2 t) in each direction.
 */
#define LOBES 2
static const struct lobe {
	double t, share; /* 1 / mean of 1 / t, and integral of exp(-t): t above 0.1, and below */
	int spots_most;	 /* 16: thin parts and edges mirror much of the sky in a pixel */
} lobes[LOBES] = {{0.5, 0.905, 16}, {0.021, 0.095, 2}}; /* the second's mean is from 1e-3 on */

/* Samples of the same number `spot`: their light, mean place and covariance. */
struct spot {
	double weight, mean[2], uu, uv, vv;
};

void mirror_pixel_clear(struct mirror_pixel *p)
{
	p->count = 0;
	p->along = p->across = 0;
	for (int c = 0; c < 3; c++)
		p->all[c] = p->kept[c] = 0;
}

/* Tells how steep the microfacet is that mirrors wi towards wo, in units of alpha, squared. */
static float steepness(const struct surface *s, struct v3 wo, struct v3 wi)
{
	const struct v3 h = v3_unit(v3_add(wo, wi)), across = v3_cross(s->normal, h);
	const float along = v3_dot(s->normal, h);

	return v3_dot(across, across) /
	       fmaxf(along * along * s->bsdf.alpha * s->bsdf.alpha, 1e-30f);
}

/* Finds a direction's place, in texels. A lobe's tail may be above the horizon where its middle is
 * not: that counts as the horizon. */
static void find_place(struct v3 direction, double place[2])
{
	const double d[3] = {(double)direction.x, (double)direction.y,
			     fmax((double)direction.z, 0)};

	sky_square_of(d, place);
	for (int k = 0; k < 2; k++)
		place[k] *= BASIS_MIRROR_SIDE;
}

/* A microfacet turns what it mirrors by twice its slope in the plane of incidence, and by the
 * cosine of that across. */
static void keep_sample(struct mirror_pixel *p, const struct surface *s, struct v3 wo,
			const struct transport_apart *apart)
{
	struct mirror_sample *sample = &p->sample[p->count];
	const float cosine = fmaxf(v3_dot(s->normal, wo), 0), wide = 2 * s->bsdf.alpha;
	const struct v3 ideal = v3_sub(v3_scale(s->normal, 2 * cosine), wo);
	const struct v3 along = v3_sub(s->normal,
				       v3_scale(ideal, cosine)); /* as long as the sine */
	/* evenly spread, of variance 1 */
	const double place = sqrt(3) *
			     (2 * (double)random_unit(sobol_first((uint32_t)p->count)) - 1);
	double turned[2];

	*sample = (struct mirror_sample){.steep = steepness(s, wo, apart->direction),
					 .cell = apart->cell,
					 .light = apart->light};
	find_place(ideal, sample->ideal);
	find_place(v3_mad(ideal, STEP_RAD, along), turned);
	for (int k = 0; k < 2; k++)
		sample->moved[k] = place * (double)wide * (turned[k] - sample->ideal[k]) /
				   (double)STEP_RAD;
	p->along += (double)(wide * wide);
	p->across += (double)(wide * wide * cosine * cosine);
	for (int c = 0; c < 3; c++)
		p->kept[c] += (double)apart->light.c[c];
	p->count++;
}

bool mirror_pixel_add(struct mirror_pixel *p, const struct surface *s, struct v3 wo,
		      const struct transport_apart *apart)
{
	for (int c = 0; c < 3; c++)
		p->all[c] += (double)apart->light.c[c];
	if (p->count == MIRROR_SAMPLES_MOST)
		return false;
	keep_sample(p, s, wo, apart);
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
		const double u = s->at[0], v = s->at[1];

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

/* Halves a spot across its longer axis if it is long, and does not become round by `blur` of its
 * variance; the farther half gets the number `next`. Returns whether it did. */
static bool halve_spot(struct mirror_pixel *p, int number, int next, double blur)
{
	const struct spot spot = spot_of(p, number);
	const double wide = SPOT_WIDE / TEXEL_RAD2;
	const double half = (spot.uu - spot.vv) / 2, mean = (spot.uu + spot.vv) / 2;
	const double root = hypot(half, spot.uv);
	/* the axis of the larger variance */
	const double turn = atan2(spot.uv, half) / 2, u = cos(turn), v = sin(turn);

	if (mean + root + blur < SPOT_LONG * fmax(mean - root + blur, LOOK_VARIANCE) &&
	    mean + root < wide + blur)
		return false;
	if (mean + root < LOOK_VARIANCE)
		return false;
	for (int k = 0; k < p->count; k++) {
		struct mirror_sample *s = &p->sample[k];

		if (s->spot == number &&
		    u * (s->at[0] - spot.mean[0]) + v * (s->at[1] - spot.mean[1]) > 0)
			s->spot = next;
	}
	return true;
}

/* Divides the samples, in a lobe of this variance where it is 1 at t = 1/2, into at most so many
 * spots. Returns their number. */
static int divide_spots(struct mirror_pixel *p, double variance, int most, double blur)
{
	int spots = 1;

	for (int k = 0; k < p->count; k++) {
		struct mirror_sample *s = &p->sample[k];

		s->spot = 0;
		for (int axis = 0; axis < 2; axis++)
			s->at[axis] = s->ideal[axis] + sqrt(variance) * s->moved[axis];
	}
	for (int pass = 1; pass < most; pass *= 2)
		for (int k = 0, before = spots; k < before; k++)
			spots += halve_spot(p, k, spots, blur);
	return spots;
}

/* Share of a sample that the lobes first..end - 1 have. */
static double lobe_share(const struct mirror_sample *s, int first, int end)
{
	double all = 0, own = 0;

	for (int k = 0; k < LOBES; k++) {
		const double part = lobes[k].share * lobes[k].t *
				    exp(-lobes[k].t * (double)s->steep);

		all += part;
		own += k >= first && k < end ? part : 0;
	}
	/* far out everything is the widest one's */
	return all > 1e-200 ? own / all : end == LOBES;
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

/* Writes a spot in lobes first..end - 1, and returns true, unless cells show it better. blur_rad2:
 * variance of these lobes. */
static bool write_spot(struct mirror_pixel *p, int number, int first, int end, double blur_rad2,
		       const struct cells *cells, const double scale[3], struct basis_mirror *m)
{
	const struct spot spot = spot_of(p, number);
	const double place[2] = {spot.mean[0] / BASIS_MIRROR_SIDE,
				 spot.mean[1] / BASIS_MIRROR_SIDE};
	double light[3] = {0, 0, 0}, d[3];
	const double texel_sr = sky_square_direction(place, d) / BASIS_MIRROR_SIDE /
				BASIS_MIRROR_SIDE;
	const double wide = (spot.uu + spot.vv) / 2;
	const int cell = cells_of(cells, v3_make((float)d[0], (float)d[1], (float)d[2]));
	const bool live = cell >= 0 && texel_sr > 0 && blur_rad2 <= BLUR_MOST &&
			  wide / LOOK_VARIANCE * texel_sr <= (double)cells->sr[cell];

	for (int k = 0; k < p->count; k++) {
		struct mirror_sample *s = &p->sample[k];
		const double share = s->spot == number ? lobe_share(s, first, end) : 0;

		for (int c = 0; c < 3; c++)
			light[c] += share * (double)s->light.c[c];
		s->rest += live ? 0 : (float)share;
	}
	if (!live)
		return false;
	*m = (struct basis_mirror){
		.u = in_steps(65536 * place[0], 65535),
		.v = in_steps(65536 * place[1], 65535),
		.level = in_steps(BASIS_MIRROR_STEP * spot_level(wide + blur_rad2 / texel_sr),
				  (BASIS_MIRROR_LEVELS - 1) * BASIS_MIRROR_STEP),
	};
	for (int c = 0; c < 3; c++)
		m->throughput[c] = in_steps(65535 * light[c] * scale[c], 65535);
	return m->throughput[0] || m->throughput[1] || m->throughput[2];
}

int mirror_pixel_divide(struct mirror_pixel *p, const struct cells *cells, int rays,
			struct basis_mirror *mirror, double scale[3])
{
	const double along = p->along / p->count, across = p->across / p->count;
	double each[3];
	int count = 0;

	for (int c = 0; c < 3; c++) {
		scale[c] = p->kept[c] > 0 ? p->all[c] / p->kept[c] : 0;
		each[c] = scale[c] / rays;
	}
	for (int k = 0; k < p->count; k++)
		p->sample[k].rest = p->count < SAMPLES_LEAST;
	for (int first = 0, end; first < LOBES && p->count >= SAMPLES_LEAST; first = end) {
		double variance, blur;
		int spots;
		double share = lobes[first].share;

		/* Lobes that no look-up tells apart are one; texels are up to twice the mean. */
		variance = share / (2 * lobes[first].t);
		for (end = first + 1; end < LOBES && along * lobes[end].share / (2 * lobes[end].t) <
							     2 * LOOK_VARIANCE * TEXEL_RAD2;
		     end++) {
			share += lobes[end].share;
			variance += lobes[end].share / (2 * lobes[end].t);
		}
		variance /= share;
		blur = across * variance;
		spots = divide_spots(p, variance, lobes[first].spots_most, blur / TEXEL_RAD2);
		for (int k = 0; k < spots; k++)
			count += write_spot(p, k, first, end, blur, cells, each, mirror + count);
	}
	return count;
}
