/* SPDX-License-Identifier: MIT */
#include "hal/lights/sampler.h"

#include <errno.h>
#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "hal/lights/sampler_parts.h"

static int sampler_check_settings(const struct light_sampler_settings *s, int width, int height,
				  struct fault *fault)
{
	struct fault what = {.text = ""};

	if (width < 1 || height < 1 || width > IMAGE_SIDE_MAX || height > IMAGE_SIDE_MAX)
		return fault_say(fault, -EINVAL,
				 "fisheye: the picture is %d x %d, expected sides of 1 to %d",
				 width, height, IMAGE_SIDE_MAX);
	if (transfer_curve_check(&s->curve, &what) < 0)
		return fault_say(fault, -EINVAL, "fisheye: %s", what.text);
	if (!(s->gain >= 0) || !isfinite(s->gain))
		return fault_say(fault, -EINVAL,
				 "fisheye: gain is %g, expected a finite number of at least 0",
				 s->gain);
	for (int k = 0; k < 9; k++)
		if (!isfinite(s->colours[k]))
			return fault_say(
				fault, -EINVAL,
				"fisheye: number %d of colours is %g, expected a finite number",
				k + 1, s->colours[k]);
	return 0;
}

/* Multiplies gain and colours into one matrix. */
static void fill_colours(struct light_sampler *s, const struct light_sampler_settings *settings)
{
	bool none = true;

	for (int k = 0; k < 9; k++)
		none = none && settings->colours[k] == 0;
	for (int k = 0; k < 9; k++)
		s->colours[k / 3][k % 3] = settings->gain *
					   (none ? k % 4 == 0 : settings->colours[k]);
}

static void sampler_colour(const struct light_sampler *s, const double linear[3], float out[3])
{
	for (int c = 0; c < 3; c++)
		out[c] = (float)fmax(s->colours[c][0] * linear[0] + s->colours[c][1] * linear[1] +
					     s->colours[c][2] * linear[2],
				     0);
}

static void set_decode(struct sampler_decode *decode, int code, double light)
{
	const long value = lrint(SAMPLER_VALUE_MAX * light);

	decode->value[code] = (int16_t)(value - SAMPLER_VALUE_BIAS);
	decode->wide[code] = decode->value[code];
}

static void fill_decode(struct light_sampler *s, const struct transfer_curve *curve)
{
	pixel_white_fill(&s->white, curve);
	s->decode.white = 255;
	s->exposure.soft.white = (uint8_t)s->white.code;
	for (int c = 0; c < 256; c++) {
		set_decode(&s->decode, c, s->white.light[c]);
		set_decode(&s->exposure.soft, c, s->white.soft[c]);
	}
}

void light_sampler_exposure(struct light_sampler *s, double longer, bool shorter)
{
	if (longer != s->exposure.longer)
		for (int c = 0; c < 256; c++) {
			const double light = s->white.light[c];

			set_decode(&s->exposure.above, c,
				   light - longer * pixel_white_soft(&s->white, light / longer));
		}
	s->exposure.above.white = 255;
	s->exposure.longer = longer;
	s->exposure.shorter = shorter;
}

const float (*light_sampler_excess(const struct light_sampler *s))[3]
{
	return (const float(*)[3])s->exposure.excess;
}

static int make_table(struct light_sampler *s, const struct dome *dome, const struct fisheye *lens,
		      const struct light_sampler_settings *settings)
{
	struct sampler_shares shares;
	int ret;

	ret = sampler_shares_create(&shares, dome, lens, s->width, s->height,
				    settings->placed ? &s->placed : NULL);
	if (ret < 0)
		return ret;
	ret = sampler_table_create(&s->table, &shares,
				   s->placed ? DOME_PLACED_THIRDS * dome->count : dome->count,
				   s->width, s->height);
	sampler_shares_free(&shares);
	return ret;
}

static int fill_sampler(struct light_sampler *s, const struct dome *dome,
			const struct fisheye *lens, const struct light_sampler_settings *settings)
{
	const int ret = make_table(s, dome, lens, settings);

	if (ret < 0)
		return ret;
	s->lights = dome->count;
	s->measured = calloc((size_t)s->table.lights, sizeof(*s->measured));
	s->third = calloc((size_t)s->table.lights, sizeof(*s->third));
	s->folded = calloc((size_t)s->lights, sizeof(*s->folded));
	s->sky_share = calloc((size_t)dome->count, sizeof(*s->sky_share));
	s->clipped = calloc((size_t)s->table.lights, sizeof(*s->clipped));
	s->exposure.excess = calloc((size_t)s->table.lights, sizeof(*s->exposure.excess));
	s->exposure.above_parts = calloc((size_t)s->table.parts + 1,
					 sizeof(*s->exposure.above_parts));
	s->exposure.above_all = calloc((size_t)s->table.sums + 1, sizeof(*s->exposure.above_all));
	s->exposure.longer = 1;
	s->of_parts = calloc((size_t)s->table.parts + 1, sizeof(*s->of_parts));
	s->of_all = calloc((size_t)s->table.sums + 1, sizeof(*s->of_all));
	s->linear = calloc((size_t)s->table.sums + 1, sizeof(*s->linear));
	if (!s->measured || !s->third || !s->folded || !s->exposure.excess ||
	    !s->exposure.above_parts || !s->exposure.above_all || !s->sky_share || !s->clipped ||
	    !s->of_parts || !s->of_all || !s->linear)
		return -ENOMEM;
	for (int i = 0; i < dome->count; i++)
		s->sky_share[i] = dome->solid_angle_sr[i] / (2 * M_PI) / light_sampler_parts(s);
	return sampler_scratch_grow(s, 1);
}

int light_sampler_create(struct light_sampler **out, const struct dome *dome,
			 const struct fisheye *lens, int width, int height,
			 const struct light_sampler_settings *settings, struct fault *fault)
{
	struct light_sampler *s;
	int ret;

	*out = NULL;
	ret = sampler_check_settings(settings, width, height, fault);
	if (ret < 0)
		return ret;
	s = calloc(1, sizeof(*s));
	if (!s)
		return fault_say(fault, -ENOMEM, "fisheye: out of memory");
	s->width = width;
	s->height = height;
	fill_colours(s, settings);
	s->kernels = sampler_kernels_choose();
	fill_decode(s, &settings->curve);
	ret = fill_sampler(s, dome, lens, settings);
	if (ret < 0) {
		light_sampler_destroy(s);
		return fault_say(fault, ret, "fisheye: cannot make the light sampler: %s",
				 strerror(-ret));
	}
	*out = s;
	return 0;
}

/* ---- lights of what is measured ---- */

int light_sampler_parts(const struct light_sampler *s)
{
	return s->placed ? DOME_PLACED_THIRDS : 1;
}

const float (*light_sampler_measured(const struct light_sampler *s))[3]
{
	return (const float(*)[3])s->measured;
}

void light_sampler_place(struct light_sampler *s, const float (*measured)[3], float (*lights)[3])
{
	if (!s->placed) {
		memcpy(lights, measured, (size_t)s->lights * sizeof(*lights));
		return;
	}
	for (int i = 0; i < s->table.lights; i++)
		for (int c = 0; c < 3; c++)
			s->third[i][c] = (double)measured[i][c];
	dome_placed_run(s->placed, (const double(*)[3])s->third, 3, s->folded);
	for (int i = 0; i < s->lights; i++)
		for (int c = 0; c < 3; c++)
			lights[i][c] = (float)s->folded[i][c];
}

void light_sampler_place_shares(struct light_sampler *s, const float *share, float *lights)
{
	if (!s->placed) {
		memcpy(lights, share, (size_t)s->lights * sizeof(*lights));
		return;
	}
	for (int i = 0; i < s->table.lights; i++)
		s->third[i][0] = (double)share[i];
	dome_placed_run(s->placed, (const double(*)[3])s->third, 1, s->folded);
	for (int i = 0; i < s->lights; i++)
		lights[i] = (float)fmin(s->folded[i][0], 1);
}

/* ---- frames ---- */

/* The mean of a plane over a light. bias is added to each value, which is stored without it. */
static double light_mean(const struct sampler_sums *all, const struct sampler_light *light, int c,
			 double bias)
{
	const double fine = ldexp(1, -SAMPLER_FINE_BITS);
	double sum, whole;

	if (light->sum < 0)
		return 0;
	whole = light->whole[0];
	sum = (double)all[light->sum].plane[c] + bias * whole;
	if (light->fine >= 0) {
		sum += fine * ((double)all[light->fine].plane[c] + bias * light->whole[1]);
		whole += fine * light->whole[1];
	}
	return sum / whole;
}

static void light_linear(const struct sampler_sums *all, const struct sampler_light *light,
			 double linear[3])
{
	for (int c = 0; c < 3; c++)
		linear[c] = light->brighter * light_mean(all, light, c, SAMPLER_VALUE_BIAS) /
			    SAMPLER_VALUE_MAX;
}

/* Sets colours of all parts from the sums of a frame. */
static void read_sums(struct light_sampler *s, const struct sampler_sums *all, float (*out)[3])
{
	for (int i = 0; i < s->table.lights; i++) {
		double linear[3];

		light_linear(all, &s->table.light[i], linear);
		sampler_colour(s, linear, out[i]);
	}
}

/* Sets the clipped share of all parts. Returns that of the sky. */
static double read_clipped(struct light_sampler *s)
{
	const int parts = light_sampler_parts(s);
	double share = 0;

	for (int i = 0; i < s->table.lights; i++) {
		s->clipped[i] = (float)light_mean(s->of_all, &s->table.light[i], 3, 0);
		share += (double)s->clipped[i] * s->sky_share[i / parts];
	}
	return share;
}

int light_sampler_read_frame(struct light_sampler *s, const struct frame_reader *reader,
			     struct pool *pool, float (*radiance)[3], double *clipped)
{
	double share;
	int ret;

	if (reader->view.width != s->width || reader->view.height != s->height)
		return -EINVAL;
	ret = sampler_frame_sum(s, reader, pool);
	if (ret < 0)
		return ret;
	read_sums(s, s->of_all, s->measured);
	share = read_clipped(s);
	if (s->exposure.longer < 1)
		read_sums(s, s->exposure.above_all, s->exposure.excess);
	if (radiance)
		light_sampler_place(s, (const float(*)[3])s->measured, radiance);
	if (clipped)
		*clipped = share;
	return 0;
}

int light_sampler_read(struct light_sampler *s, const struct picture *picture, float (*radiance)[3],
		       double *clipped)
{
	const struct frame_reader reader = frame_reader_of(picture);

	return light_sampler_read_frame(s, &reader, NULL, radiance, clipped);
}

/* ---- linear pictures ---- */

static void add_linear(struct light_sampler *s, const struct image *picture, int strip,
		       const struct sampler_part *part)
{
	const struct sampler_table *t = &s->table;
	const uint16_t *weight = t->weight + part->first_weight;
	double *sum = s->linear[part->sum];

	for (int k = part->first_span; k < part->first_span + part->spans; k++) {
		const int row = (int)t->span[k].offset / t->row_stride;
		const int x = (int)t->span[k].offset % t->row_stride;
		const size_t y = (size_t)(strip * SAMPLER_STRIP_ROWS + row);
		const float *pixel = picture->f32 + 3 * (y * (size_t)s->width + (size_t)x);
		const int values = (int)t->span[k].chunks * SAMPLER_CHUNK;

		for (int i = 0; i < values; i++) {
			for (int c = 0; weight[i] && c < 3; c++)
				sum[c] += (double)weight[i] * (double)pixel[3 * i + c];
		}
		weight += values;
	}
}

int light_sampler_read_linear(struct light_sampler *s, const struct image *picture,
			      float (*radiance)[3])
{
	const struct sampler_table *t = &s->table;
	const double fine = ldexp(1, -SAMPLER_FINE_BITS);

	if (picture->width != s->width || picture->height != s->height || !picture->f32)
		return -EINVAL;
	memset(s->linear, 0, (size_t)t->sums * sizeof(*s->linear));
	memset(s->clipped, 0, (size_t)t->lights * sizeof(*s->clipped));
	memset(s->exposure.excess, 0, (size_t)t->lights * sizeof(*s->exposure.excess));
	for (int strip = 0; strip < t->strips; strip++) {
		for (int k = 0; k < t->strip[strip].parts; k++)
			add_linear(s, picture, strip, &t->part[t->strip[strip].first_part + k]);
	}
	for (int i = 0; i < t->lights; i++) {
		const struct sampler_light *l = &t->light[i];
		const double whole = l->whole[0] + fine * l->whole[1];

		double linear[3] = {0};

		for (int c = 0; l->sum >= 0 && c < 3; c++) {
			linear[c] = s->linear[l->sum][c];
			linear[c] += l->fine >= 0 ? fine * s->linear[l->fine][c] : 0;
			linear[c] = l->brighter * linear[c] / whole;
		}
		sampler_colour(s, linear, s->measured[i]);
	}
	if (radiance)
		light_sampler_place(s, (const float(*)[3])s->measured, radiance);
	return 0;
}

const float *light_sampler_clipped(const struct light_sampler *s)
{
	return s->clipped;
}

void light_sampler_destroy(struct light_sampler *s)
{
	if (!s)
		return;
	sampler_table_free(&s->table);
	dome_placed_destroy(s->placed);
	free(s->measured);
	free(s->third);
	free(s->folded);
	for (int i = 0; i < s->scratches; i++) {
		free(s->scratch[i].planes);
		free(s->scratch[i].row);
	}
	free(s->scratch);
	free(s->linear);
	free(s->of_all);
	free(s->of_parts);
	free(s->exposure.excess);
	free(s->exposure.above_parts);
	free(s->exposure.above_all);
	free(s->clipped);
	free(s->sky_share);
	free(s);
}
