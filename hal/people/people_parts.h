/* SPDX-License-Identifier: MIT */
/*
 * Private to hal/people. The picture is looked at in cells of side x side pixels. Light is linear,
 * 65535 is white; planes are [cells], row by row. Only spans of watched cells are read and written.
 * Sums run in one order and nothing is contracted, so bytes do not depend on the processor.
 */
#ifndef INLAY_HAL_PEOPLE_PEOPLE_PARTS_H
#define INLAY_HAL_PEOPLE_PEOPLE_PARTS_H

#include "hal/basis/basis_format.h"
#include "hal/look/sensor_noise.h"
#include "hal/people/people.h"

#define PLACE_TERMS 9  /* functions of the sky's light that a cell's light is a sum of */
#define PLACE_BANDS 30 /* rows that learn together: y % PLACE_BANDS; one learns in each frame */
#define WHITE 65535.0f
#define CODE_STEPS 16
#define ORDER_DIRECTIONS 512
#define DIM 0.002f	/* of white: darker cells do not drift */
#define CLIPPED 0.97f	/* of white: brighter cells teach nothing */
#define DRIFT_MOST 3.0f /* and its inverse */
#define PIXEL_LANES 4	/* a quarter of a cell, 4x4 at most: pixels computed side by side */
#define STILL_LEAST                                                                                \
	6000.0f /* variance of a cell: rounding, and what a model is off by in the dark */

/* Cells of a row that are watched. */
struct span {
	int y, x, count;
};

enum verdict {
	VERDICT_EMPTY,
	VERDICT_SHADED, /* the place in other light: a person's shadow, or light not learned yet */
	VERDICT_PERSON,
};

/* Recursive least squares of the terms' coefficients, common to a band and channel. */
struct place_fit {
	double covariance[PLACE_TERMS][PLACE_TERMS];
};

/* A connected group of cells. */
struct group {
	int cells, left, right, top, bottom; /* inclusive */
	/* middle of its lowest row, or of that of the group that it stands on; cells */
	double foot_x;
	int foot_y;
	bool front;	     /* before the object */
	bool dropped, ghost; /* dropped: too small, or a ghost */
	int before[2];	     /* cells that were of a group behind, in front, in the frame before */
	double edge_now;     /* contrast along its outline, in the frame and in the empty place */
	double edge_place;
	double edge_own,
		edge_level; /* contrast that the place's in the light beside it does not explain */
};

/* Cells left..right, top..bottom, inclusive; right < left: none. */
struct box {
	int left, right, top, bottom;
};

/* Sums of seen / place, R, G, B, over the cells of a tile in which nobody is. */
struct ratios {
	float sum[3];
	int count;
};

/* What the cells around one tell that do not touch the edge. */
struct sides {
	bool told;	 /* there are some on both sides */
	float person[3]; /* mean light of people */
	float light[3];	 /* beside them, over that of the empty place */
};

/* Horizontal run of cells of equal value, for finding connected groups. */
struct run {
	int y, left, right, parent;
};

struct people {
	struct people_settings settings;
	int side, across, down, cells; /* cells */
	int tiles_across, tiles_down;
	struct transfer_tables tables;
	uint64_t camera; /* XXH3-64 of the settings' camera and calibration */
	struct people_object object;

	struct span *spans;
	int *row_span; /* [down + 1]: first span of each row */
	int span_count, watched;
	uint8_t *watch; /* [cells] */

	/* cells.c */
	/* Linear light of a mean of code values, in sixteenths: light does not become another
	 * multiple of the place where the cell has texture, as transfer functions are nearly
	 * powers. */
	float linear[255 * CODE_STEPS + 1];
	float *seen[3];
	struct sensor_noise *sensor;
	/* Variance of a cell of light L: still[c] + shot[c] L. */
	float still[3], shot[3];
	float gain[3];
	int64_t frame, captured_ns;
	double step_ms; /* since the frame before, at most 500 */

	/* place.c */
	double (*term)[PLACE_TERMS]; /* [dome->count] */
	float light[3][PLACE_TERMS]; /* of this frame, over that of the first */
	double first[3];	     /* ground irradiance when learning began; 0: not yet */
	float *coefficient[3][PLACE_TERMS];
	float light_then[3][PLACE_TERMS]; /* of the last whole prediction */
	float *drift[3];		  /* what the model is off by at present, as a factor */
	float light_rate; /* share of what is seen that it takes over in this frame */
	bool jumped;	  /* a lamp was switched in this frame */
	float *lit[3];	  /* predicted for light_then, per unit of light_0 */
	float *place[3];  /* in the light of now, gain applied */
	struct place_fit fit[PLACE_BANDS][3];
	uint16_t *stable_ms; /* how long a cell that is not known has been stable */
	uint8_t *known;
	int *unknown; /* [down]: watched cells of the row that are not known */
	bool learn_now;

	struct ratios *ratios; /* hidden.c: [tiles] */

	/* judge.c */
	uint8_t *verdict, *raw;
	uint8_t *before; /* the verdict of the frame before one in which a lamp was switched */
	/* Products of cells that may be the place in other light, else 0: see cell_products(). 0
	 * between frames. */
	float *product[3][3];
	int *last_differs;   /* [down]: last such cell of the row; -1: none */
	float *column[3][3]; /* [across]: sums of a few rows */
	uint8_t *count;	     /* [across]: of cells in them, two counts in one */

	/* groups.c */
	struct run *runs;
	int run_count;
	int *label;	/* [cells]: run of the cell, then group; -1: none; in the box alone */
	struct box box; /* of all people in this frame */
	struct group *groups;
	int group_count;
	uint8_t *order, *order_before; /* 0 nobody, 1 behind, 2 in front */
	/* order.c: distance over ground from the camera to the object's far side; < 0: there is
	 * none. By direction where its footprint is known, in equal steps from first to last, which
	 * turn from the middle; else by columns of cells. */
	float around_far[ORDER_DIRECTIONS];
	double around_middle_rad, around_first_rad, around_last_rad;
	bool around;		       /* the footprint is known */
	float *object_far;	       /* [across] */
	const struct depth_map *depth; /* of this frame; NULL: there is none */
	struct depths *depths; /* depths.c; NULL: the depth camera is in the background's place */
	double still_ms;       /* for how long nearly everything has been foreground */

	uint8_t *side_of; /* edges.c: [cells] */

	/* outline.c */
	uint8_t *tile, *front, *anybody, *foremost;
	struct veil veil;
	bool visited; /* veil shows somebody */
	struct people_report report;
};

/* A cell's drift becomes so many times as large. */
static inline void place_drift(struct people *people, int channel, int cell, float factor)
{
	float *drift = &people->drift[channel][cell];
	const float is = *drift * factor;

	*drift = is < DRIFT_MOST ? is > 1 / DRIFT_MOST ? is : 1 / DRIFT_MOST : DRIFT_MOST;
}

static inline float of_white(double share)
{
	return (float)(share * (double)WHITE);
}

/* ---- cells.c ---- */

void cells_read(struct people *people, const struct picture *picture);
/* Follows the camera's exposure, where seen / place lies densest over cells that are known and were
 * empty, and makes the place from what is predicted. */
void cells_follow_gain(struct people *people);
/* Follows the camera's noise. */
void cells_follow_noise(struct people *people, const struct picture *picture);

/* ---- place.c ---- */

int place_create(struct people *people);
/* Takes the frame's light. False: it is too dark to tell anything. */
bool place_light(struct people *people, const float (*radiance)[3]);
/* Predicts the place per unit of light_0, where light or coefficients have changed. */
void place_predict(struct people *people);
void place_learn(struct people *people);
/* Takes what is seen in a cell as the empty place. */
void place_adopt(struct people *people, int cell);
void place_forget(struct people *people);
/* Counts, row by row, the watched cells that are not known. */
void place_count_unknown(struct people *people);

/* ---- hidden.c ---- */

/* Before the others drift: what hides follows as its surroundings do. */
void hidden_follow(struct people *people);

/* ---- judge.c ---- */

void judge_cells(struct people *people);

/* ---- order.c ---- */

/* Measures how far the object is over ground, column by column. */
void order_measure_object(struct people *people);
bool order_is_front(struct people *people, const struct group *group);

/* ---- depths.c ---- */

/* camera: the depth camera; NULL: it sees what the background's sees. 0 or -ENOMEM. */
int depths_create(struct people *people, const struct tsai_camera *camera);
void depths_free(struct people *people); /* idempotent */
/* This frame's depths, as the background's camera would measure them; NULL: there are none. */
const struct depth_map *depths_of_background(struct people *people);

/* ---- groups.c ---- */

void groups_find(struct people *people);

/* ---- edges.c ---- */

void edges_refine(struct people *people);
/* Finds the cells of the box and around it that do not touch the edge. */
void edges_mark(struct people *people, const uint8_t *verdict);
/* What is around a cell of the box, or beside it, of those that are marked. */
struct sides edges_around(const struct people *people, int x, int y);
/* The share of a person in what is seen before a place in that light, not clamped: of
 * PIXEL_LANES. */
void edges_share(const struct people *people, const struct sides *sides,
		 const float seen[3][PIXEL_LANES], const float place[3][PIXEL_LANES], float *share);

/* ---- saved.c ---- */

uint64_t saved_camera(const struct people_settings *settings);

/* ---- outline.c ---- */

void outline_draw(struct people *people, const struct picture *picture);

#endif
