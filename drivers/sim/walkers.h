/* SPDX-License-Identifier: MIT */
/*
 * People who walk through the studio: who they are and where they go. Bodies are made of capsules
 * (walker_body.h); studio_people.h draws them.
 *
 * Each walker crosses the room along x every 10 to 12 s, before the object, behind it or through
 * its place, and is not there in between: it comes and goes through the walls, out of sight of a
 * camera that looks along y. All is a function of time.
 */
#ifndef INLAY_DRIVERS_SIM_WALKERS_H
#define INLAY_DRIVERS_SIM_WALKERS_H

#include <stdbool.h>

/* Who they are, in the order in which sim.walkers lets them in. */
enum walker_style {
	WALKER_JUMPER, /* striped */
	WALKER_SUIT,   /* dark */
	WALKER_CHECKS, /* checked shirt */
	WALKER_CHILD,  /* small, in yellow */
	WALKER_RUG,    /* in the colour of the rug that the object stands on, without texture */
	WALKER_BAG,    /* carries a bag, and leaves it standing until the next crossing */
	WALKER_STYLES
};

struct walker {
	enum walker_style style;
	double place[2];    /* on the ground, m */
	double heading_rad; /* of the walk, from +X towards +Y */
	double walked;	    /* strides (of two steps); its fraction is the phase of the legs */
	double pace;	    /* 0: stands, feet side by side; 1: walks */
	double time_s;	    /* who stands sways a little */
	bool bag_in_hand;   /* of WALKER_BAG */
	bool bag_left;
	double bag_place[2]; /* if it is left */
	bool absent;	     /* only the bag is there */
	double height;	     /* see walker_height(); 0: the style's */
	/* Albedos of skin, hair, top, legs, shoes and bag, under the style's pattern; NULL: the
	 * style's. */
	const double (*cloth)[3];
};

/* Lists who, and whose bag, is in the room at a time. Returns their number, at most count. */
int walkers_at(double time_s, int count, struct walker list[WALKER_STYLES]);

/* Height of a walker of this style against a grown person's, who is about 1.75 m tall; a stride is
 * WALKER_STRIDE_M long at height 1. */
double walker_height(enum walker_style style);
#define WALKER_STRIDE_M 1.35

#endif
