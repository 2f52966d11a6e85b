/* SPDX-License-Identifier: MIT */
#include "hal/lights/sampler_parts.h"

#include <errno.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

int sampler_scratch_grow(struct light_sampler *s, int threads)
{
	struct sampler_scratch *more;

	if (threads <= s->scratches)
		return 0;
	more = realloc(s->scratch, (size_t)threads * sizeof(*more));
	if (!more)
		return -ENOMEM;
	s->scratch = more;
	for (; s->scratches < threads; s->scratches++) {
		const size_t bytes = sampler_plane_values(s) * SAMPLER_PLANES *
				     sizeof(*more->planes);
		const size_t row = ((size_t)s->width * sizeof(*more->row) + 63) / 64 * 64;

		more = &s->scratch[s->scratches];
		more->planes = aligned_alloc(64, bytes);
		more->row = aligned_alloc(64, row);
		if (!more->planes || !more->row) {
			free(more->planes);
			free(more->row);
			return -ENOMEM;
		}
		memset(more->planes, 0, bytes); /* kernels also read values of weight 0 */
	}
	return 0;
}

/* ---- one pass over a frame ---- */

struct sampler_pass {
	struct light_sampler *sampler;
	const struct frame_reader *reader;
};

/* Decodes a strip into planes. Returns whether any pixel is clipped. */
static bool decode_strip(const struct sampler_pass *pass, int strip,
			 const struct sampler_decode *decode, const struct sampler_scratch *scratch)
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
	const struct sampler_pass *pass = context;
	struct light_sampler *s = pass->sampler;
	const struct sampler_scratch *scratch = &s->scratch[worker];

	add_strip(s, strip, scratch,
		  decode_strip(pass, strip, s->exposure.shorter ? &s->exposure.soft : &s->decode,
			       scratch)
			  ? 4
			  : 3,
		  s->of_parts);
	if (s->exposure.longer < 1) {
		decode_strip(pass, strip, &s->exposure.above, scratch);
		add_strip(s, strip, scratch, 3, s->exposure.above_parts);
	}
}

static void sampler_add_parts(const struct light_sampler *s, const struct sampler_sums *parts,
			      struct sampler_sums *all)
{
	memset(all, 0, (size_t)s->table.sums * sizeof(*all));
	for (int k = 0; k < s->table.parts; k++) {
		struct sampler_sums *sum = &all[s->table.part[k].sum];

		for (int c = 0; c < SAMPLER_PLANES; c++)
			sum->plane[c] += parts[k].plane[c];
	}
}

int sampler_frame_sum(struct light_sampler *s, const struct frame_reader *reader, struct pool *pool)
{
	struct sampler_pass pass = {s, reader};
	const int ret = sampler_scratch_grow(s, pool_threads(pool));

	if (ret < 0)
		return ret;
	pool_run(pool, s->table.strips, read_strip, &pass);
	sampler_add_parts(s, s->of_parts, s->of_all);
	if (s->exposure.longer < 1)
		sampler_add_parts(s, s->exposure.above_parts, s->exposure.above_all);
	return 0;
}
