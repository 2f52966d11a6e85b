/* SPDX-License-Identifier: MIT */
/* Renders one tile of the picture: the light transport of BASIS_TILE x BASIS_TILE pixels, fewer at
 * the edges. */
#ifndef INLAY_BAKE_TILES_TILE_H
#define INLAY_BAKE_TILES_TILE_H

#include "bake/encode/encode.h"
#include "bake/scene/scene.h"
#include "bake/trace/bounce.h"
#include "bake/trace/transport.h"

#define TILE_PIXELS (BASIS_TILE * BASIS_TILE)

struct tile_settings {
	int samples;	     /* camera rays a pixel, when noise_levels is 0 */
	double noise_levels; /* above 0: render until the noise is below this, in 8-bit levels */
	double ratio_cut;    /* with stand-ins, pixels whose ratio changes less are left out */
	uint64_t seed;
	const struct ensemble *ensemble; /* noise is measured under its suns; NULL: not at all */
};

/* The kinds of transport that a tile gathers. CHANGE and WITHOUT belong to the real surfaces. */
enum tile_kind {
	TILE_OBJECT,  /* t */
	TILE_CHANGE,  /* on flat ground (u - s) / u; with stand-ins s, finally u - s */
	TILE_WITHOUT, /* u; with stand-ins only */
	TILE_KINDS
};

/* Rows of one kind: sums over a pixel's samples, finally means. Samples are made in batches.
 * Bounced light of even batches and that of odd ones have separate sums, the two halves of struct
 * bounce_halves. */
struct tile_rows {
	int channels;	  /* channels of direct */
	float *direct;	  /* [pixels][channels][lights]; NULL: this kind does not occur */
	float *bounce[2]; /* [pixels][3][lights] */
};

/* Sums over a pixel's samples. */
struct tile_pixel {
	/* samples that met an object, or ground that mirrors it; samples that saw a real surface */
	int object, receiver;
	int direct; /* those of them that did not look through glass */
	/* Weights of the background, and of the real surfaces in it. The weight of a sample beside
	 * the object is 1, that of one through glass its transmission, the mean of three
	 * channels. */
	double other_weight, receiver_weight;
	double through[3]; /* transmission of samples that see the background through glass */
	double offset[2];  /* displacement by glass, in pixels, times weight */
	/* The place seen through glass, from the pixel's centre, and its square, times weight. */
	double place_sum[2], place_square[2];
	double through_weight; /* weights of samples through glass */
	double distance[2];    /* from the camera; of receivers seen directly */
	bool changed;	       /* the object changes this pixel */
};

struct tile_noise; /* tile_noise.h */

/* A rendered tile, ready for the encoder. */
struct tile_result {
	uint16_t object_pixel[TILE_PIXELS], change_pixel[TILE_PIXELS];
	struct encode_samples part[TILE_KINDS];
	int part_count;
	uint16_t coverage[TILE_PIXELS]; /* share of the object in the pixel; 65535 = 1 */
	uint16_t opaque[TILE_PIXELS];	/* coverage minus the largest transmission of glass */
	struct basis_glass glass[TILE_PIXELS];
	int glass_count;
	double ratio_error; /* the largest change of a ratio that was left out */
	float distance[BASIS_SURFACES][TILE_PIXELS]; /* basis_places.h */
};

/* State of one thread, and the tile it has rendered. */
struct tile {
	struct transport transport;
	struct bounce bounce;
	const struct scene *scene;
	const struct cells *cells;
	struct tile_settings settings;
	float *even_sky;		     /* [lights]: all 1 */
	float *radiance_scale, *ratio_scale; /* [lights]: scale of struct bounce_halves */
	int x, y, width, height;	     /* the tile's rectangle in the picture, in pixels */
	struct tile_pixel pixels[TILE_PIXELS];
	struct tile_rows rows[TILE_KINDS];
	int batches, samples, half_samples[2];
	struct tile_result result;
	struct tile_noise *noise;
};

/*
 * Memory, in floats for each pixel and light: 9 for t, and 7 on flat ground or 18 with stand-ins.
 * That is 16 MB at 1,000 lights, 27 MB with stand-ins. The filter adds 0.9 KB a light. Scene and
 * cells must outlive the tile. -ENOMEM.
 */
int tile_create(struct tile *tile, const struct scene *scene, const struct cells *cells,
		const struct tile_settings *settings, int bounces);
void tile_free(struct tile *tile); /* idempotent; zeroed is fine */

/* Return the number of floats of one pixel's row. */
static inline size_t tile_direct_size(const struct tile *tile, enum tile_kind kind)
{
	return (size_t)tile->rows[kind].channels * (size_t)tile->cells->count;
}

static inline size_t tile_bounce_size(const struct tile *tile)
{
	return 3 * (size_t)tile->cells->count;
}

/* Returns the index, 0 or 1, of the bounce rows to which the current batch adds. */
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
