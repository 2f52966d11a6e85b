/* The transport of one tile of the picture: BASIS_TILE x BASIS_TILE pixels, fewer at the edges. */
#ifndef INLAY_BAKE_TILE_H
#define INLAY_BAKE_TILE_H

#include "bake/encode.h"
#include "bake/scene.h"
#include "bake/transport.h"

#define TILE_PIXELS (BASIS_TILE * BASIS_TILE)

struct tile_settings {
	int samples;	     /* a pixel; when noise_levels is 0 */
	double noise_levels; /* stop below this */
	double ratio_cut;    /* pixels of stand-in scenes whose ratio changes less are left out */
	uint64_t seed;
};

/* What a pixel has come to; sums over its samples. */
struct tile_pixel {
	int object, receiver, other; /* samples that met an object; a real surface; no object */
	bool changed;		     /* an object was involved */
	/* of the value under a uniform sky of radiance 1 over a background of one half: */
	double before[3][3]; /* sums of the rows up to the last batch */
	int before_count[3];
	double mean[3], spread[3]; /* over batches: mean, sum of squared deviations */
};

/* Scratch of one thread, and the result. Rows are [pixels][3][lights]. */
struct tile {
	struct transport transport;
	const struct scene *scene;
	const struct cells *cells;
	struct tile_settings settings;
	int x, y, width, height; /* in the picture */
	struct tile_pixel pixels[TILE_PIXELS];
	float *object;	/* t */
	float *without; /* u; NULL when there are no stand-ins */
	float *change;	/* (u - s) / albedo on flat ground; with stand-ins: first s, then u - s */
	int batches, samples;
	/* ready for the encoder: */
	uint16_t object_pixel[TILE_PIXELS], change_pixel[TILE_PIXELS];
	struct encode_samples part[3];
	int part_count;
	uint16_t coverage[TILE_PIXELS];
	double ratio_error;  /* largest change of the ratio that was left out */
	double noise_square; /* sum of squared standard errors, 8-bit levels */
	long noise_count;    /* channels of pixels in it */
};

/* The largest memory that a tile takes is 3 * 256 * 3 * lights floats. */
int tile_create(struct tile *tile, const struct scene *scene, const struct cells *cells,
		const struct tile_settings *settings, int bounces);
void tile_free(struct tile *tile); /* idempotent; zeroed is fine */

/* Renders tile number index of the picture. */
void tile_render(struct tile *tile, int index);

/* peak[lights + 1][3] grows to what this tile holds (see BASIS_CHUNK_PEAK). */
void tile_peaks(const struct tile *tile, float (*peak)[3]);

#endif
