#include "hal/compositor/tile.h"

#include <stdlib.h>
#include <string.h>

#include "hal/compositor/kernels.h"

/* Beyond this much of full radiance nothing that is added can change the clipped result. */
#define OBJECT_LIMIT (1 << 20)
#define RATIO_MAX ((int32_t)(COMPOSITOR_RATIO_MAX * Q16_ONE))

struct tile_scratch *tile_scratch_create(int lights)
{
	struct tile_scratch *scratch = calloc(1, sizeof(*scratch));

	if (!scratch)
		return NULL;
	for (int c = 0; c < 3; c++) {
		if (segments_create(&scratch->segments[c], lights) < 0) {
			tile_scratch_destroy(scratch);
			return NULL;
		}
	}
	return scratch;
}

void tile_scratch_destroy(struct tile_scratch *scratch)
{
	if (!scratch)
		return;
	for (int c = 0; c < 3; c++)
		segments_free(&scratch->segments[c]);
	free(scratch);
}

/* sum over all lights of row * weight, the ambient term included. */
static void block_sums(const struct basis_block *b, const struct weights weights[3],
		       struct segments segments[3], int64_t (*sum)[3])
{
	const int totals = b->kind == BASIS_KIND_V ? 3 : b->channels;

	for (int c = 0; c < 3; c++)
		segments_gather(&segments[c], &weights[c], b);
	kernel_sums_c(b, segments, sum);
	for (int c = 0; c < 3; c++) {
		const int32_t *total = b->total + (totals == 3 ? c : 0);
		const int64_t ambient = weights[c].ambient;
		const int shift = weights[c].ambient_shift;

		for (int p = 0; ambient && p < b->pixels; p++) {
			const int64_t more = total[p * totals] * ambient;

			sum[p][c] += shift ? round_shift(more, shift) : more;
		}
	}
}

static int32_t scaled(const struct basis_block *b, int p, int c, const struct weights *weights,
		      int64_t sum, int32_t limit)
{
	const float scale = b->scale[b->channels == 3 ? p * 3 + c : p];

	return multiplier_apply(multiplier_product(multiplier_from_scale(scale), weights->unit),
				sum, limit);
}

static void add_object(const struct tile_frame *f, const struct basis_block *b,
		       struct tile_scratch *s)
{
	block_sums(b, f->object, s->segments, s->sum);
	for (int p = 0; p < b->pixels; p++) {
		for (int c = 0; c < 3; c++)
			s->object[b->pixel[p]][c] = scaled(b, p, c, &f->object[c], s->sum[p][c],
							   OBJECT_LIMIT);
	}
}

static int32_t ratio_without(int32_t share)
{
	const int32_t ratio = Q16_ONE - share;

	return ratio < 0 ? 0 : ratio > RATIO_MAX ? RATIO_MAX : ratio;
}

static void add_ground(const struct tile_frame *f, const struct basis_block *b,
		       struct tile_scratch *s)
{
	const struct weights *weights = f->ground[b->ground];

	block_sums(b, weights, s->segments, s->sum);
	for (int p = 0; p < b->pixels; p++) {
		for (int c = 0; c < 3; c++)
			s->ratio[b->pixel[p]][c] = ratio_without(
				scaled(b, p, c, &weights[c], s->sum[p][c], RATIO_MAX));
	}
}

/* d: its light taken away; u: its own light without the object. */
static void add_receiver(const struct tile_frame *f, const struct basis_block *d,
			 const struct basis_block *u, struct tile_scratch *s)
{
	block_sums(d, f->receiver, s->segments, s->sum);
	block_sums(u, f->receiver, s->segments, s->own_sum);
	for (int p = 0; p < d->pixels; p++) {
		for (int c = 0; c < 3; c++) {
			const struct weights *w = &f->receiver[c];
			const int d_row = d->channels == 3 ? p * 3 + c : p;
			const int u_row = u->channels == 3 ? p * 3 + c : p;
			const struct multiplier u_scale = multiplier_from_scale(u->scale[u_row]);
			const int64_t e = u->total[u_row] * w->residue;
			const int64_t own = s->own_sum[p][c] +
					    (w->residue_shift ? round_shift(e, w->residue_shift)
							      : e);
			int32_t share = 0; /* where no light can arrive, none is taken away */

			if (own > 0 && u_scale.mantissa)
				share = quotient_q16(s->sum[p][c],
						     multiplier_from_scale(d->scale[d_row]), own,
						     u_scale, RATIO_MAX);
			s->ratio[d->pixel[p]][c] = ratio_without(share);
		}
	}
}

static void add_blocks(const struct tile_frame *f, const struct basis_tile *tile,
		       struct tile_scratch *s)
{
	for (int i = 0; i < tile->block_count; i++) {
		const struct basis_block *b = &tile->blocks[i];

		switch (b->kind) {
		case BASIS_KIND_T:
			add_object(f, b, s);
			break;
		case BASIS_KIND_V:
			add_ground(f, b, s);
			break;
		case BASIS_KIND_D:
			add_receiver(f, b, b + 1, s);
			break;
		default: /* U came with its D */
			break;
		}
	}
}

/* out = O + (1 - a) * ratio * B, one rounding, clipped and encoded. */
static uint8_t mix(int32_t object, int32_t ratio, int32_t left, uint16_t background,
		   const uint8_t *encode)
{
	const int64_t product = (int64_t)ratio * left * background;
	const int32_t sum = object + (int32_t)round_shift(product, 32);

	return encode[sum < 0 ? 0 : sum > 65535 ? 65535 : sum];
}

void tile_composite(const struct tile_frame *f, const struct basis_tile *tile,
		    struct tile_scratch *s)
{
	const size_t width = f->basis->info.width;
	const uint16_t *coverage = f->basis->poses[f->pose].coverage;

	memset(s->object, 0, sizeof(s->object));
	for (int p = 0; p < TILE_PIXELS; p++) {
		for (int c = 0; c < 3; c++)
			s->ratio[p][c] = Q16_ONE;
	}
	add_blocks(f, tile, s);
	for (int y = 0; y < tile->height; y++) {
		const uint8_t *in = f->background.origin + (tile->y + y) * f->background.y_step +
				    tile->x * f->background.x_step;
		const uint16_t *a = coverage + (size_t)(tile->y + y) * width + tile->x;
		uint8_t *out = f->out + (size_t)(tile->y + y) * f->out_stride + (size_t)tile->x * 4;

		for (int x = 0; x < tile->width; x++, in += f->background.x_step, out += 4) {
			const int p = y * BASIS_TILE + x;
			/* 1 - coverage in Q16, rounded: a / 65535 is (a + a / 32768) / 65536. */
			const int32_t left = Q16_ONE - a[x] - (a[x] >> 15);

			for (int c = 0; c < 3; c++) /* R, G, B lie at bytes 2, 1, 0 */
				out[2 - c] = mix(s->object[p][c], s->ratio[p][c], left,
						 f->decode[in[2 - c]], f->encode);
			out[3] = 255;
		}
	}
}

/* In the order of reading, with nothing to recode: four bytes at once. */
static void copy_row(uint8_t *out, const uint8_t *in, int width)
{
	const uint8_t opaque[4] = {0, 0, 0, 255};
	uint32_t pixel, filler;

	memcpy(&filler, opaque, sizeof(filler));
	for (int x = 0; x < width; x++) {
		memcpy(&pixel, in + (size_t)x * 4, sizeof(pixel));
		pixel |= filler;
		memcpy(out + (size_t)x * 4, &pixel, sizeof(pixel));
	}
}

static void recode_row(uint8_t *out, const uint8_t *in, ptrdiff_t step, int width,
		       const uint8_t *recode)
{
	for (int x = 0; x < width; x++, in += step, out += 4) {
		for (int c = 0; c < 3; c++)
			out[c] = recode[in[c]];
		out[3] = 255;
	}
}

void tile_copy(const struct tile_frame *f, const struct basis_tile *tile)
{
	const ptrdiff_t step = f->background.x_step;

	for (int y = 0; y < tile->height; y++) {
		const uint8_t *in = f->background.origin + (tile->y + y) * f->background.y_step +
				    tile->x * step;
		uint8_t *out = f->out + (size_t)(tile->y + y) * f->out_stride + (size_t)tile->x * 4;

		if (f->same_codes && step == 4)
			copy_row(out, in, tile->width);
		else
			recode_row(out, in, step, tile->width, f->recode);
	}
}
