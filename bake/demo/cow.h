/* SPDX-License-Identifier: MIT */
/*
 * The toy cow of the demo: its solids and the colours of its coat.
 *
 * Metres; y up, the hooves stand on y = 0; it looks along +z, its left side is +x. About 0.4 m from
 * muzzle to tail.
 */
#ifndef INLAY_BAKE_DEMO_COW_H
#define INLAY_BAKE_DEMO_COW_H

#include "bake/demo/polygonise.h"

struct cow_part {
	const char *name;
	const char *material;
	struct solid solid;
	double step; /* of the grid that it is polygonised on, in m */
};

#define COW_PARTS 5

/* The coat comes first; it is the one with the texture. */
extern const struct cow_part cow_parts[COW_PARTS];

/* sRGB code values 0..1 of a point on the coat. */
void cow_colour(const double p[3], double rgb[3]);

/* Pseudo-distances from features of the coat, in m: at most 0 inside. For colours. */
double cow_muzzle(const double p[3]);
double cow_udder(const double p[3]);
double cow_horns(const double p[3]);
double cow_ears(const double p[3]);
double cow_ear_hollows(const double p[3]);
double cow_tuft(const double p[3]);
double cow_head(const double p[3]);
double cow_nostrils(const double p[3]);
double cow_hooves(const double p[3]);

#endif
