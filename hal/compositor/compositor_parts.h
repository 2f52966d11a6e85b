/* SPDX-License-Identifier: MIT */
/* The state of a compositor. Private to compositor.c and frame.c. */
#ifndef INLAY_HAL_COMPOSITOR_COMPOSITOR_PARTS_H
#define INLAY_HAL_COMPOSITOR_COMPOSITOR_PARTS_H

#include "hal/compositor/column_choice.h"
#include "hal/compositor/compositor.h"
#include "hal/compositor/division.h"
#include "hal/compositor/glass.h"
#include "hal/compositor/live/veiled_tile.h"
#include "hal/compositor/mirror.h"
#include "hal/compositor/near/near_layer.h"
#include "hal/compositor/tile.h"

/* Largest number of adjacent tiles whose background is made by one call. */
#define SPAN_TILES 8

/* A light vector that blocks of a layer need, and which parts of it. */
struct layer_light {
	struct light_vector *vector;
	struct light_order order;    /* all but the gain, which may change with each frame */
	struct column_choice choice; /* if order.cut: chooses among the columns of its blocks */
};

/* A pose's tiles in one of the file's layers. */
struct layer {
	const struct basis_layer *basis; /* the file's, or near.layer */
	struct near_layer near;		 /* where there are lamps at places */
	struct layer_plan plan;
	struct division division;
	uint8_t *untried; /* [tiles]: frames until a bounded tile is tried again (frame.c) */
	struct layer_light *light; /* in the order of kinds, then of grounds */
	int light_count;
};

/* The plans of a pose, valid while made is true. */
struct pose {
	struct glass_plan glass;
	struct mirror_plan mirrors;
	struct layer layer[COMPOSITOR_MODE_COUNT];
	bool made;
	unsigned turn; /* basis_pose.turn when the plans were made */
};

/* Scratch memory of one thread. */
struct compositor_worker {
	struct tile_work tile;
	struct tile_values values;
	struct veiled_tile veiled;
	struct grain_tile grain;
	uint8_t *rows; /* background scratch: a row of the picture, or SPAN_TILES tiles */
};

/* What the object shows of its surroundings in the current frame. */
struct shown {
	const struct glass_plan *glass;	   /* NULL: no background */
	struct picture through;		   /* background in memory, if glass is not NULL */
	const struct mirror_plan *mirrors; /* NULL: no sky */
	const struct mirror_map *sky;
	mirror_light factor; /* mirror_add() */
};

struct compositor {
	const struct basis *basis;
	int pose; /* of the last frame; -1: none yet */
	const struct kernels *kernels;
	struct pool *pool;
	struct compositor_settings settings;
	int tiles, workers;
	struct pose *poses;
	struct light_terms terms;
	struct near_sky *sky;			      /* NULL: no lamps at places */
	struct light_vector vector[BASIS_KIND_COUNT]; /* T, D and U */
	struct light_vector *ground;		      /* [grounds] */
	struct compositor_worker **worker;
	struct kernel_curves curves;
	struct compositor_frame last;
	/* Copy of a background that is made piece by piece, where the object shows it:
	 * [height][width] BGRX. NULL: no pose has glass. */
	uint8_t *behind;
	/* The lights as mirrors show them, for frames without a picture of the sky; empty: no frame
	 * was without. */
	struct mirror_map lights_map;
	/* The current frame. */
	struct shown shown;
	struct layer *layer;
	const uint16_t *coverage;
	const struct backdrop *backdrop;
	const struct light_selection *lights;
	struct frame_light light;
	uint8_t *out;
	size_t out_stride;
};

#endif
