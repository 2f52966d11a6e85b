/* SPDX-License-Identifier: MIT */
#include <errno.h>
#include <math.h>
#include <stdlib.h>

#include "hal/measure/measure.h"

int scope_create(struct scope *s, const struct basis *basis, const struct basis_layer *layer)
{
	const uint16_t *coverage = basis->poses[0].coverage;
	const int tiles = basis->tiles_across * basis->tiles_down;
	size_t pixels;

	*s = (struct scope){.width = (int)basis->info.width, .height = (int)basis->info.height};
	pixels = (size_t)s->width * (size_t)s->height;
	s->pixel = calloc(pixels, 1);
	if (!s->pixel)
		return -ENOMEM;
	for (int k = 0; k < tiles; k++) {
		const struct basis_tile *tile = &layer->tiles[k];

		for (int b = 0; b < tile->block_count; b++) {
			const struct basis_block *block = &tile->blocks[b];

			for (int p = 0; p < block->pixels; p++) {
				const int x = tile->x + block->pixel[p] % BASIS_TILE;
				const int y = tile->y + block->pixel[p] / BASIS_TILE;

				/* T comes first */
				if (!s->pixel[y * s->width + x])
					s->pixel[y * s->width + x] = block->kind == BASIS_KIND_T
									     ? SCOPE_OBJECT
									     : SCOPE_SHADOW;
			}
		}
	}
	for (size_t at = 0; at < pixels; at++) {
		if (coverage[at])
			s->pixel[at] = SCOPE_OBJECT;
		s->objects += s->pixel[at] == SCOPE_OBJECT;
		s->shadows += s->pixel[at] == SCOPE_SHADOW;
	}
	return 0;
}

void scope_free(struct scope *s)
{
	free(s->pixel);
	*s = (struct scope){.pixel = NULL};
}

double error_psnr(double rms)
{
	return rms > 0 ? fmin(20 * log10(255 / rms), 120) : 120;
}

/* Sums over a picture. */
struct error_sums {
	double square, count;	  /* over object and shadow */
	double frame_square, max; /* over all pixels; over object and shadow */
	double contrast, behind;  /* over the shadow, in linear light */
};

static void sums_add_pixel(struct error_sums *sums, enum scope_pixel scope, const double *truth,
			   const uint8_t *is, const uint8_t *background, const double *linear,
			   enum transfer transfer)
{
	for (int c = 0; c < 3; c++) {
		const double off = fabs(is[2 - c] - truth[c]);

		sums->frame_square += off * off;
		if (scope == SCOPE_UNTOUCHED)
			continue;
		sums->square += off * off;
		sums->count++;
		sums->max = fmax(sums->max, off);
		if (scope != SCOPE_SHADOW)
			continue;
		sums->contrast +=
			fabs(linear[is[2 - c]] - transfer_decode(transfer, truth[c] / 255));
		sums->behind += linear[background[2 - c]];
	}
}

struct composite_error error_measure(const struct scope *s, const double *truth,
				     const struct canvas *is, const struct picture *background,
				     enum transfer transfer)
{
	struct error_sums sums = {.square = 0};
	struct composite_error e;
	double linear[256];

	for (int code = 0; code < 256; code++)
		linear[code] = transfer_decode(transfer, code / 255.0);
	for (int y = 0; y < s->height; y++) {
		for (int x = 0; x < s->width; x++) {
			const size_t at = (size_t)y * (size_t)s->width + (size_t)x;

			sums_add_pixel(&sums, (enum scope_pixel)s->pixel[at], truth + 3 * at,
				       is->pixels + (size_t)y * is->stride + (size_t)x * 4,
				       background->origin + y * background->y_step +
					       x * background->x_step,
				       linear, transfer);
		}
	}
	e.rms = sums.count > 0 ? sqrt(sums.square / sums.count) : 0;
	e.psnr_db = error_psnr(e.rms);
	e.max = sums.max;
	e.frame_psnr_db = error_psnr(sqrt(sums.frame_square / (3.0 * s->width * s->height)));
	e.contrast = sums.behind > 0 ? sums.contrast / sums.behind : 0;
	return e;
}

void error_worse(struct composite_error *worst, const struct composite_error *other)
{
	worst->rms = fmax(worst->rms, other->rms);
	worst->psnr_db = fmin(worst->psnr_db, other->psnr_db);
	worst->max = fmax(worst->max, other->max);
	worst->frame_psnr_db = fmin(worst->frame_psnr_db, other->frame_psnr_db);
	worst->contrast = fmax(worst->contrast, other->contrast);
}

/* A bright floor that darkens to the left, tiles on it, grain, a dark quarter and a white bar. */
void background_fill(struct canvas *canvas)
{
	uint32_t grain = 1;

	for (int y = 0; y < canvas->height; y++) {
		for (int x = 0; x < canvas->width; x++) {
			uint8_t *to = canvas->pixels + (size_t)y * canvas->stride + (size_t)x * 4;
			const int across = 180 * x / canvas->width;
			const int down = 60 * y / canvas->height;
			const int tile = (x / 24 + y / 24) % 2 * 12;
			const int bar = x % 200 < 10;

			grain = grain * 1664525 + 1013904223;
			for (int c = 0; c < 3; c++) {
				int v = across + down + tile + (int)(grain >> (8 * c + 2) & 7);

				v -= c * (255 - v) / 16; /* warmer where it is dark */
				if (x < canvas->width / 2 && y > canvas->height / 2)
					v /= 4;
				v = bar ? 255 : v;
				to[2 - c] = (uint8_t)(v < 0 ? 0 : v > 255 ? 255 : v);
			}
			to[3] = 255;
		}
	}
}

struct compositor_settings background_settings(enum compositor_mode mode)
{
	return (struct compositor_settings){
		.mode = mode,
		.background = {.named = TRANSFER_SRGB},
		.output = {.named = TRANSFER_SRGB},
		.gain = 1,
		.object = true,
	};
}
