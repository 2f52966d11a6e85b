/* SPDX-License-Identifier: MIT */
/*
 * The toy cow of the demo: its solids, and where its features are.
 *
 * Metres; y up, the hooves stand on y = 0; it looks along +z, its left side is +x. About 0.4 m from
 * muzzle to tail.
 */
#ifndef INLAY_BAKE_DEMO_COW_SHAPE_H
#define INLAY_BAKE_DEMO_COW_SHAPE_H

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

/* Pseudo-distances from features of the coat, in m: at most 0 inside. cow_coat.c colours by them. */
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
