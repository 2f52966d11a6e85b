/* SPDX-License-Identifier: MIT */
/* The transport of one tile of the picture: BASIS_TILE x BASIS_TILE pixels, fewer at the edges. */
#ifndef INLAY_BAKE_TILES_TILE_H
#define INLAY_BAKE_TILES_TILE_H

#include "bake/encode/encode.h"
#include "bake/scene/scene.h"
#include "bake/trace/bounce.h"
#include "bake/trace/transport.h"

#define TILE_PIXELS (BASIS_TILE * BASIS_TILE)

struct tile_settings {
	int samples;	     /* a pixel; when noise_levels is 0 */
	double noise_levels; /* stop below this */
	double ratio_cut;    /* pixels of stand-in scenes whose ratio changes less are left out */
	uint64_t seed;
};

/* The transport that a tile keeps: t; (u - s) / u on flat ground, with stand-ins first s, then
 * u - s; u, with stand-ins alone. */
enum tile_kind { TILE_OBJECT, TILE_CHANGE, TILE_WITHOUT, TILE_KINDS };

/* Sums over samples, later means over pixels. Samples are made in batches; those of even and of odd
 * batches bounce apart. */
struct tile_rows {
	int channels;	  /* of direct */
	float *direct;	  /* [pixels][channels][lights]; NULL: this kind does not occur */
	float *bounce[2]; /* [pixels][3][lights] */
};

/* What a pixel has come to; sums over its samples. */
struct tile_pixel {
	int object, receiver; /* samples that met an object; that saw a real surface */
	/* How much was seen of the background, and of real surfaces in it: each sample beside the
	 * object 1, each through its glass what arrives, as the mean of three channels. */
	double other_weight, receiver_weight;
	double through[3]; /* what arrives of the background through glass */
	double offset[2];  /* from the pixel to where it is seen, times the weight of each sample */
	double seen[2], seen_square[2]; /* of these places, from the pixel's middle: moments */
	double through_weight;
	bool changed; /* an object was involved */
	/* of the value under a uniform sky of radiance 1 over a background of one half: */
	double before[3][TILE_KINDS]; /* sums of the rows up to the last batch */
	double before_weight[2];      /* other, receiver */
	double mean[3], spread[3];    /* over batches: mean, sum of squared deviations */
};

/* Scratch of one thread, and the result. */
struct tile {
	struct transport transport;
	struct bounce bounce;
	const struct scene *scene;
	const struct cells *cells;
	struct tile_settings settings;
	float *even_sky;		     /* [lights]: 1 */
	float *radiance_scale, *ratio_scale; /* [lights]: of struct bounce_halves */
	int x, y, width, height;	     /* in the picture */
	struct tile_pixel pixels[TILE_PIXELS];
	struct tile_rows rows[TILE_KINDS];
	int batches, samples, half_samples[2];
	/* ready for the encoder: */
	uint16_t object_pixel[TILE_PIXELS], change_pixel[TILE_PIXELS];
	struct encode_samples part[TILE_KINDS];
	int part_count;
	uint16_t coverage[TILE_PIXELS];
	uint16_t opaque[TILE_PIXELS]; /* coverage less what glass lets through at most */
	struct basis_glass glass[TILE_PIXELS];
	int glass_count;
	double ratio_error; /* largest change of the ratio that was left out */
	/* Squared standard errors in 8-bit levels. They come from the batches before the bounce is
	 * filtered, and hold afterwards: under a uniform sky the filter changes nothing. Under
	 * other skies it leaves less noise than that. */
	double noise_square;
	long noise_count;
};

/*
 * A pixel takes 9 floats of memory a light (t), 7 on flat ground, twice 9 more with stand-ins: 16
 * MB a tile at 1,000 lights, 27 MB with stand-ins. The filter adds 0.9 KB a light.
 */
int tile_create(struct tile *tile, const struct scene *scene, const struct cells *cells,
		const struct tile_settings *settings, int bounces);
void tile_free(struct tile *tile); /* idempotent; zeroed is fine */

/* Floats of a pixel. */
static inline size_t tile_direct_size(const struct tile *tile, enum tile_kind kind)
{
	return (size_t)tile->rows[kind].channels * (size_t)tile->cells->count;
}

static inline size_t tile_bounce_size(const struct tile *tile)
{
	return 3 * (size_t)tile->cells->count;
}

/* Which of the two bounce rows of a kind the current batch adds to: 0 or 1. */
static inline int tile_half_of_batch(const struct tile *tile)
{
	return (tile->batches - 1) & 1;
}

static inline bool tile_has_standins(const struct tile *tile)
{
	return tile->rows[TILE_WITHOUT].direct;
}

/* Renders tile number index of the picture. */
void tile_render(struct tile *tile, int index);

#endif
