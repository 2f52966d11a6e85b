/* What a compositor consists of. Private to compositor.c and frame.c. */
#ifndef INLAY_HAL_COMPOSITOR_COMPOSITOR_PARTS_H
#define INLAY_HAL_COMPOSITOR_COMPOSITOR_PARTS_H

#include "hal/compositor/compositor.h"
#include "hal/compositor/division.h"
#include "hal/compositor/tile.h"

/* Tiles side by side whose background is made at once. */
#define SPAN_TILES 8

/* A pose's tiles in one of the file's layers. */
struct layer {
	const struct basis_layer *basis;
	struct layer_plan plan;
	struct division division;
	bool needs[BASIS_KIND_COUNT]; /* which kinds of block there are */
	bool *needs_ground;	      /* [grounds] */
};

struct pose {
	struct layer layer[COMPOSITOR_MODE_COUNT];
};

struct worker {
	struct tile_work tile;
	struct tile_values values;
	uint8_t *rows; /* a row of the picture, or BASIS_TILE of SPAN_TILES */
};

struct compositor {
	const struct basis *basis;
	const struct kernels *kernels;
	struct pool *pool;
	struct compositor_settings settings;
	int tiles, workers;
	struct pose *poses;
	struct light_vector vector[BASIS_KIND_COUNT]; /* T, D and U */
	struct light_vector *ground;		      /* [grounds] */
	struct worker **worker;
	struct kernel_curves curves;
	struct compositor_frame last;
	/* Sums of the frame before, for one pose in one mode. */
	int64_t *kept;
	struct kept_block *kept_blocks;
	size_t kept_size, kept_count;
	const struct layer *kept_of; /* NULL: they hold nothing */
	double (*before)[3];	     /* [lights]: light of the last frame that could keep them */
	/* The frame in the making. */
	struct layer *layer;
	const uint16_t *coverage;
	const struct backdrop *backdrop;
	struct frame_light light;
	uint8_t *out;
	size_t out_stride;
};

#endif
