/* SPDX-License-Identifier: MIT */
/* The light in a frame: one pass over its rows. */
#include <errno.h>
#include <math.h>
#include <stdbool.h>
#include <string.h>

#include "hal/lights/sampler_parts.h"

struct pass {
	struct light_sampler *sampler;
	const struct frame_reader *reader;
};

/* Whether anything of it is clipped. */
static bool decode_strip(const struct pass *pass, int strip, const struct sampler_decode *decode,
			 const struct sampler_scratch *scratch)
{
	const struct light_sampler *s = pass->sampler;
	const struct sampler_table *t = &s->table;
	const struct sampler_strip *which = &t->strip[strip];
	bool clipped = false;

	for (int k = 0; k < which->segments; k++) {
		const struct sampler_segment *g = &t->segment[which->first_segment + k];

		if (k + 1 < which->segments)
			frame_reader_prefetch(pass->reader, g[1].x,
					      strip * SAMPLER_STRIP_ROWS + g[1].row, g[1].count);
		const uint32_t *pixels = frame_reader_row(pass->reader, g->x,
							  strip * SAMPLER_STRIP_ROWS + g->row,
							  g->count, scratch->row);

		clipped |= s->kernels->decode(decode, pixels, g->count,
					      scratch->planes +
						      (size_t)g->row * (size_t)t->row_stride + g->x,
					      sampler_plane_values(s));
	}
	return clipped;
}

static void add_strip(const struct light_sampler *s, int strip,
		      const struct sampler_scratch *scratch, int planes, struct sampler_sums *sums)
{
	const struct sampler_table *t = &s->table;
	const struct sampler_strip *which = &t->strip[strip];

	for (int k = which->first_part; k < which->first_part + which->parts; k++) {
		const struct sampler_part *part = &t->part[k];

		s->kernels->add(scratch->planes, planes, sampler_plane_values(s),
				t->span + part->first_span, part->spans,
				t->weight + part->first_weight, sums[k].plane);
	}
}

static void read_strip(void *context, int strip, int worker)
{
	const struct pass *pass = context;
	struct light_sampler *s = pass->sampler;
	const struct sampler_scratch *scratch = &s->scratch[worker];

	add_strip(s, strip, scratch, decode_strip(pass, strip, &s->decode, scratch) ? 4 : 3,
		  s->of_parts);
	if (s->above_value < SAMPLER_VALUE_MAX) {
		decode_strip(pass, strip, &s->above, scratch);
		add_strip(s, strip, scratch, 3, s->above_parts);
	}
}

static void add_parts(const struct light_sampler *s, const struct sampler_sums *parts,
		      struct sampler_sums *all)
{
	memset(all, 0, (size_t)s->table.sums * sizeof(*all));
	for (int k = 0; k < s->table.parts; k++) {
		struct sampler_sums *sum = &all[s->table.part[k].sum];

		for (int c = 0; c < SAMPLER_PLANES; c++)
			sum->plane[c] += parts[k].plane[c];
	}
}

/* The mean of a plane over a light, whose values are so much less than they stand for. */
static double mean_of(const struct sampler_sums *all, const struct sampler_light *light, int c,
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

static void linear_of(const struct sampler_sums *all, const struct sampler_light *light,
		      double linear[3])
{
	for (int c = 0; c < 3; c++)
		linear[c] = light->brighter * mean_of(all, light, c, SAMPLER_VALUE_BIAS) /
			    SAMPLER_VALUE_MAX;
}

static void read_excess(struct light_sampler *s)
{
	add_parts(s, s->above_parts, s->above_all);
	for (int i = 0; i < s->table.lights; i++) {
		double linear[3];

		linear_of(s->above_all, &s->table.light[i], linear);
		sampler_colour(s, linear, s->excess[i]);
	}
}

int light_sampler_read_frame(struct light_sampler *s, const struct frame_reader *reader,
			     struct pool *pool, float (*radiance)[3], double *clipped)
{
	struct pass pass = {s, reader};
	double share = 0;
	int ret;

	if (reader->view.width != s->width || reader->view.height != s->height)
		return -EINVAL;
	ret = sampler_grow(s, pool ? pool_threads(pool) : 1);
	if (ret < 0)
		return ret;
	if (pool) {
		pool_run(pool, s->table.strips, read_strip, &pass);
	} else {
		for (int strip = 0; strip < s->table.strips; strip++)
			read_strip(&pass, strip, 0);
	}
	add_parts(s, s->of_parts, s->of_all);
	for (int i = 0; i < s->table.lights; i++) {
		const struct sampler_light *light = &s->table.light[i];
		double linear[3];

		linear_of(s->of_all, light, linear);
		sampler_colour(s, linear, radiance[i]);
		s->clipped[i] = (float)mean_of(s->of_all, light, 3, 0);
		share += (double)s->clipped[i] * s->sky_share[i];
	}
	if (s->above_value < SAMPLER_VALUE_MAX)
		read_excess(s);
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
