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
#define FAR_DIRECTIONS 512
#define PERSONS_MAX 32
#define DIM 0.002f    /* of white: one code of sRGB is an eighth of the light there */
#define CLIPPED 0.97f /* of white: the camera's curve bends, and brighter cells teach nothing */
#define PIXEL_LANES 4 /* pixels computed side by side: a quarter of a cell of 4x4 */

/* Cells of a row that are watched. */
struct span {
	int y, x, count;
};

/* Cells left..right, top..bottom, inclusive; right < left: none. */
struct box {
	int left, right, top, bottom;
};

/* ---- the picture, in cells (cells.c) ---- */

struct cells {
	int side, across, down, count;
	struct span *spans;
	int *row_span; /* [down + 1]: first span of each row */
	int span_count, watched;
	uint8_t *watch; /* [count], and a row and a cell beyond both ends */
	/* Linear light of a mean of code values, in sixteenths. Codes are averaged before they are
	 * decoded: for a power law, seen / place is then independent of texture. */
	float linear[255 * CODE_STEPS + 1];
	float *seen[3];
	float *recent[3];   /* what a cell has shown since it last changed, in the place's units */
	uint16_t *still_ms; /* for how long */
	struct sensor_noise *sensor;
	float still[3], shot[3]; /* the variance of a cell of light L is still[c] + shot[c] L */
};

/* ---- the empty place (place.c) ---- */

/* Recursive least squares of the terms' coefficients, common to a band and channel. */
struct place_fit {
	double covariance[PLACE_TERMS][PLACE_TERMS];
};

/* Sums of seen / expected over the cells of a tile in which nobody is. */
struct ratios {
	float sum[3];
	int count;
};

struct place {
	double (*term)[PLACE_TERMS]; /* [dome->count] */
	double first[3];	     /* ground irradiance when learning began; 0: not yet */
	float light[3][PLACE_TERMS]; /* of this frame, over the ground irradiance of the first */
	float light_then[3][PLACE_TERMS]; /* of the last whole prediction */
	float gain[3];			  /* the camera's exposure, over that when learning began */
	float *coefficient[3][PLACE_TERMS];
	float *drift[3];    /* the factor by which the prediction is off at present */
	float *lit[3];	    /* predicted for light_then, per unit of ground irradiance */
	float *expected[3]; /* in the light of now, with drift and gain */
	float *spread;	    /* variance of seen - expected over that of the camera's noise */
	uint8_t *known;
	int unknown; /* watched cells that are not known */
	struct place_fit fit[PLACE_BANDS][3];
	bool *left;	       /* [dome->count]: scratch of place_light() */
	float log_darkest;     /* logarithm of the darkest shadow's ratio in this light */
	float model_variance;  /* relative; of the prediction, where the light has just turned */
	float *lessons;	       /* [across]: of a span */
	float shared[3];       /* of the known cells where nobody is: expected / seen in the mean */
	struct ratios *ratios; /* drift.c: [tiles down + 1][tiles across + 1] */
	bool learn_now;
};

/* ---- whether the camera was nudged (nudge.c) ---- */

#define NUDGE_PATCHES 256
#define NUDGE_MOST 3.5f /* pixels: up to 3, as rounded, the place moves along */

struct nudge {
	int *patch; /* [NUDGE_PATCHES]: the first cell of each */
	int patches, next;
	int usable, votes;	      /* of this round: patches with texture, and found ones */
	float vote[NUDGE_PATCHES][2]; /* cells, right and down */
	float before[2];	      /* what the round before said */
	float moved[2];		      /* by how many pixels the place has moved along */
	float told[2];		      /* by how many the picture has moved */
	bool lost;		      /* by too many */
	float sure; /* share of the last patches that are where they were learned */
};

/* ---- whose each cell is (verdict.c) ---- */

enum whose {
	WHOSE_PLACE,
	WHOSE_SHADOW, /* the place in other light: a person's shadow, or light not learned yet */
	WHOSE_PERSON,
};

struct verdict {
	float *chi;		   /* deviation from the place, squared, in standard deviations */
	float *weight[3];	   /* 1 / s^2 */
	float *bright, *lit;	   /* seen, expected: sums of the channels */
	float *ratio;		   /* of these */
	float *evidence;	   /* for a person, -1..1 */
	float *last;		   /* the opinion of the frame before */
	float *opinion, *revised;  /* the same with the neighbours' weighed in; padded with -1 */
	uint8_t *of;		   /* enum whose */
	uint8_t *copy;		   /* before an edge is refined */
	struct box differing, box; /* of cells that differ, and two more; of all people */
};

/* ---- who it is (groups.c, persons.c) ---- */

/* A connected group of cells. */
struct group {
	int cells, left, right, top, bottom; /* inclusive */
	bool dropped;			     /* too small, a ghost, or only light */
	bool ghost;
	double edge_now, edge_place; /* contrast along its outline: seen, and in the empty place */
	double edge_own;	     /* what of it the place in other light does not explain */
	double edge_level;
};

/* Horizontal run of cells of equal value, for finding connected groups. */
struct run {
	int y, left, right, parent;
};

/* Somebody who is followed from frame to frame. In cells. */
struct person {
	float x, half;	 /* middle, and half the width */
	float top, foot; /* rows */
	float reach;	 /* columns beside his middle that may be his */
	float speed[2];	 /* of middle and foot, cells a second */
	float height_m;	 /* 0: not known */
	int missed_ms;	 /* since he was last seen */
	int opposed_ms;	 /* for how long his feet have been on the other side of the object */
	int group;	 /* of this frame; -1: none */
	float began_x, began_foot;
	bool walked; /* he has moved since he was met */
	bool front;  /* before the object */
	bool placed; /* front is known */
	bool over_object;
};

/* ---- how far the object is (footprint.c) ---- */

/* Distance over ground from the camera to the object's far side; < 0: there is none. By direction
 * where its footprint is known, in equal steps from first to last, which turn from the middle; else
 * by columns of cells. */
struct far_side {
	float around[FAR_DIRECTIONS];
	double middle_rad, first_rad, last_rad;
	bool is_known;
	float *column; /* [across] */
};

struct crowd {
	struct run *runs;
	int run_count;
	int *label; /* [cells]: run, then group, then person; -1: none; in the box of all people */
	struct group *groups;
	int group_count;
	struct person person[PERSONS_MAX];
	int persons;
	uint8_t *order;	  /* [cells]: 0 nobody, 1 behind, 2 in front */
	uint8_t *covered; /* [cells]: the object covers the cell's middle */
	struct far_side far_side;
	const struct depth_map *depth; /* of this frame; NULL: there is none */
	struct depths *depths; /* depths.c; NULL: the depth camera is in the background's place */
	double crowded_ms;     /* for how long nearly everything has been a person */
};

/* ---- how much of each pixel (edges.c, outline.c) ---- */

/* The cells around one that do not touch the edge of a person. */
struct sides {
	bool both;	 /* some are a person's, some are not */
	float person[3]; /* mean light of the former */
	float light[3];	 /* of the others, over that of the empty place */
};

struct outline {
	uint8_t *side_of; /* [cells] */
	uint8_t *tile, *front, *anybody, *foremost;
	struct veil veil;
};

struct people {
	struct people_settings settings;
	struct people_object object;
	uint64_t camera; /* XXH3-64 of the settings' camera and calibration */
	struct transfer_tables tables;
	int tiles_across, tiles_down;
	int64_t frame, captured_ns;
	double step_ms; /* since the frame before, at most 500 */
	void *memory;	/* of all planes */
	struct cells cells;
	struct place place;
	struct nudge nudge;
	struct verdict verdict;
	struct crowd crowd;
	struct outline outline;
	bool visited; /* the veil shows somebody */
	struct people_report report;
};

/* ---- cells.c ---- */

void cells_read(struct people *people, const struct picture *picture);
/* Follows for how long each cell has shown the same. Before place_learn(). */
void cells_follow_stillness(struct people *people);
/* The variance of what a cell has shown, over that of a frame: 1 / 8 of each frame goes into it. */
#define CELLS_RECENT_NOISE (1 / 15.0f)
/* Follows the camera's noise. */
void cells_follow_noise(struct people *people, const struct picture *picture);

static inline float cells_variance(const struct cells *cells, int channel, float light)
{
	return cells->still[channel] + cells->shot[channel] * light;
}

/* ---- gain.c ---- */

/* Follows the camera's exposure, where seen / place lies densest over cells that are known and were
 * empty, and makes place.expected from what is predicted. */
void gain_follow(struct people *people);

/* ---- place.c ---- */

void place_create(struct people *people);
/* Takes the frame's light. False: it is too dark to tell anything. */
bool place_light(struct people *people, const float (*radiance)[3]);
/* Predicts the place per unit of ground irradiance, where light or coefficients have changed. */
void place_predict(struct people *people);
void place_learn(struct people *people);
/* Takes what a cell has shown since it changed as the empty place. */
void place_adopt(struct people *people, int cell);
void place_forget(struct people *people);
/* Moves everything that is known by so many cells, right and down. */
void place_move(struct people *people, const float shift[2]);
/* Counts the watched cells that are not known. */
void place_count_unknown(struct people *people);

/* ---- nudge.c ---- */

/* Chooses the patches, where another object is watched. */
void nudge_place(struct people *people);
void nudge_follow(struct people *people);
/* The camera is where it was when the place was learned. */
static inline void nudge_forget(struct nudge *nudge)
{
	nudge->next = nudge->usable = nudge->votes = 0;
	nudge->moved[0] = nudge->moved[1] = nudge->told[0] = nudge->told[1] = 0;
	nudge->lost = false;
	nudge->sure = 1;
}

/* ---- drift.c ---- */

/* Call before place_learn() teaches. */
void drift_follow(struct people *people);

/* ---- verdict.c ---- */

#define VERDICT_CLUES 16
/* What tells whether a cell that differs from the place is a person's; clue[0] is 1. After
 * verdict_judge() the same as in it. */
void verdict_clues(const struct people *people, int x, int y, float clue[VERDICT_CLUES]);
void verdict_judge(struct people *people);

/* ---- groups.c ---- */

/* Finds the groups and drops what is nobody. */
void groups_find(struct people *people);
/* Writes crowd.order from the persons that the groups' cells are labelled with. */
void groups_order(struct people *people);

/* ---- persons.c ---- */

void persons_follow(struct people *people);

/* ---- footprint.c ---- */

void far_side_measure(struct people *people);
/* Where a point of the picture, in cells, lies at this height above the ground, seen from above:
 * its direction and its distance from the camera. False: it is beyond the horizon. */
bool far_side_point(const struct people *people, double x, double y, double height,
		    double *direction_rad, float *far);
/* The height above the ground, in metres, of what a point of the picture shows at a distance. */
double far_side_height(const struct people *people, double x, double y, double far);
/* The row of a point at this height over the ground. NAN: the picture does not show it. */
double far_side_row(const struct people *people, double direction_rad, double far, double height);
/* The object's far side in a direction; x: in cells. < 0: there is none. */
float far_side_at(const struct people *people, double x, double direction_rad);

/* ---- depths.c ---- */

/* camera: the depth camera; NULL: it sees what the background's sees. 0 or -ENOMEM. */
int depths_create(struct people *people, const struct tsai_camera *camera);
void depths_free(struct people *people); /* idempotent */
/* Makes crowd.depth what the background's camera would measure. */
void depths_move(struct people *people);
enum told { TOLD_NOTHING, TOLD_BEHIND, TOLD_FRONT };
/* On which side of the object most of a person's cells are by their depth; lean: share of the
 * object's distance by which its far side is moved away. */
enum told depths_ask(const struct people *people, int person, const struct box *box, float lean);

/* ---- edges.c ---- */

void edges_refine(struct people *people);
/* Finds the cells of the box and around it that do not touch the edge. */
void edges_mark(struct people *people, const uint8_t *whose);
/* What is around a cell of the box, or beside it, of those that are marked. */
struct sides edges_around(const struct people *people, int x, int y);
/* alpha = <seen - place, F - place> / |F - place|^2 of PIXEL_LANES pixels, F the person's colour;
 * not clamped. */
void edges_share(const struct people *people, const struct sides *sides,
		 const float seen[3][PIXEL_LANES], const float place[3][PIXEL_LANES], float *share);

/* ---- saved.c ---- */

uint64_t saved_camera(const struct people_settings *settings);

/* ---- outline.c ---- */

void outline_draw(struct people *people, const struct picture *picture);

#endif
