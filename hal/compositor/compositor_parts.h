/* SPDX-License-Identifier: MIT */
/* What a compositor consists of. Private to compositor.c and frame.c. */
#ifndef INLAY_HAL_COMPOSITOR_COMPOSITOR_PARTS_H
#define INLAY_HAL_COMPOSITOR_COMPOSITOR_PARTS_H

#include "hal/compositor/column_choice.h"
#include "hal/compositor/compositor.h"
#include "hal/compositor/division.h"
#include "hal/compositor/glass.h"
#include "hal/compositor/tile.h"

/* Tiles side by side whose background is made at once. */
#define SPAN_TILES 8

/* A vector of light that blocks of a layer need, and what of it. */
struct layer_light {
	struct light_vector *vector;
	struct light_order order;    /* but for the gain */
	struct column_choice choice; /* where the order says cut: among its blocks' columns */
};

/* A pose's tiles in one of the file's layers. */
struct layer {
	const struct basis_layer *basis;
	struct layer_plan plan;
	struct division division;
	struct layer_light *light; /* in the order of kinds, then of grounds */
	int light_count;
};

struct pose {
	struct glass_plan glass;
	struct layer layer[COMPOSITOR_MODE_COUNT];
	bool made;
	unsigned turn; /* of the basis's pose that they were made of */
};

struct compositor_worker {
	struct tile_work tile;
	struct tile_values values;
	uint8_t *rows; /* a row of the picture, or BASIS_TILE of SPAN_TILES */
};

struct compositor {
	const struct basis *basis;
	int pose; /* of the last frame; -1: there was none */
	const struct kernels *kernels;
	struct pool *pool;
	struct compositor_settings settings;
	int tiles, workers;
	struct pose *poses;
	struct light_terms terms;
	struct light_vector vector[BASIS_KIND_COUNT]; /* T, D and U */
	struct light_vector *ground;		      /* [grounds] */
	struct compositor_worker **worker;
	struct kernel_curves curves;
	struct compositor_frame last;
	/* Sums of the frame before, for one pose in one mode. */
	bool keeps; /* as the settings have it */
	int64_t *kept;
	struct kept_block *kept_blocks;
	size_t kept_size, kept_count;
	const struct layer *kept_of; /* NULL: they hold nothing */
	double (*before)[3];	     /* [lights]: light of the last frame that could keep them */
	/* The background where the object lets it through, [height][width] BGRX, for one that is
	 * made piece by piece; NULL: no pose is seen through. */
	uint8_t *behind;
	/* The frame in the making. */
	const struct glass_plan *glass; /* NULL: nothing is seen through */
	struct picture through;		/* the background in memory, where glass is not NULL */
	struct layer *layer;
	const uint16_t *coverage;
	const struct backdrop *backdrop;
	const struct light_selection *lights;
	struct frame_light light;
	uint8_t *out;
	size_t out_stride;
};

#endif
