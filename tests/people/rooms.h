/* SPDX-License-Identifier: MIT */
/*
 * The rooms that people are judged in, each drawn from its number: surfaces, lamps, camera, noise,
 * and people, their clothes and ways. Rooms 0 to 5 are there to choose constants on; 6 to 11 are
 * held out, of the same six kinds.
 *
 *     0 .. LEARNING - 1             the place is learned; in some rooms people are there already
 *     LEARNING .. LEAVING - 1       is judged, RATE_HZ
 *     LEAVING .. ROOM_FRAMES - 1    who is there leaves, and nobody comes any more; LEAVING_HZ
 */
#ifndef INLAY_TESTS_PEOPLE_ROOMS_H
#define INLAY_TESTS_PEOPLE_ROOMS_H

#include <stdio.h>

#include "drivers/sim/sim.h"
#include "tests/people/filmed.h"

enum {
	ROOMS = 12,
	HALF = ROOMS / 2,
	LEARNING = 600,
	LEAVING = LEARNING + 300,
	ROOM_FRAMES = LEAVING + 200,
	RATE_HZ = 15,
	LEAVING_HZ = 5,
	MOST_CROSSINGS = 32
};

enum floor_kind {
	FLOOR_STUDIO,
	FLOOR_TILES,
	FLOOR_CONCRETE,
	FLOOR_GRAVEL,
	FLOOR_CARPET,
	FLOOR_KINDS
};

/* A walk through the room, with a stop on the way; who returns goes back from there. */
struct room_crossing {
	double begin_s, end_s;
	double from[2], turn_rad;
	double speed, stop_m, stop_s;
	bool returns;
};

struct room_walker {
	enum walker_style style; /* the pattern of the clothes */
	double height, cloth[6][3];
	int crossings;
	struct room_crossing crossing[MOST_CROSSINGS];
};

struct room_lamp {
	struct studio_lantern lantern;
	double circle_m, turn_s; /* moves on a circle around its centre; 0: stays */
	double phase, switch_s;	 /* off and on again; 0: stays on */
};

struct room {
	int number, width, height;
	double eye[3], target[3], field_deg;
	double box_m, box_turn_deg; /* the object, which stands in the origin */
	enum floor_kind floor;
	double floor_albedo[2][3], grain_m;
	double wall[STUDIO_SURFACE_COUNT][3]; /* against the studio's */
	struct room_lamp lamp[STUDIO_LANTERNS];
	double panels, panels_switch_s;
	double level;		    /* mean of the empty picture, linear, white is 1 */
	double step, step_s, drift; /* of the exposure, as factors; drift: of red and blue */
	double read_noise, shot_noise, edge_spread_px;
	bool inhabited; /* people are there from the start */
	int walkers;
	struct room_walker walker[WALKER_STYLES];
};

void room_draw(int number, struct room *room);
/* Prints the scene file of its object. */
void room_print_scene(const struct room *room, FILE *out);
/* Gives a point its colour in the room, a struct room, for filmed_paint(). */
void room_paint(const void *room, struct studio_hit *hit);
double room_time_s(int frame);
struct studio_lamps room_lamps(const struct room *room, double time_s);
/* The lamps must outlive the moment. */
void room_moment(const struct room *room, int frame, double exposure, struct studio_lamps *lamps,
		 struct filmed_moment *moment);

#endif
