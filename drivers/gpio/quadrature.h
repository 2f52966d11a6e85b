/* SPDX-License-Identifier: MIT */
/*
 * A rotary encoder's two lines to steps; no device in it. Turned, they go through 00 01 11 10, or
 * back. What bounces goes forth and back between two neighbours and comes to nothing.
 */
#ifndef INLAY_DRIVERS_GPIO_QUADRATURE_H
#define INLAY_DRIVERS_GPIO_QUADRATURE_H

#include <stdbool.h>

struct quadrature {
	bool a, b;
	int quarters; /* since the last step, of either sign */
	int detent;   /* so many quarters are a step: 1, 2 or 4 */
	int rest;     /* where it rested at the start, and does every detent quarters from there */
};

void quadrature_start(struct quadrature *quadrature, int detent, bool a, bool b);

/* The lines after an edge. 1: a step, a leading b; -1: one back; 0: none. Where both have changed
 * an edge was lost, and nobody knows which way: no step for that, and steps are counted anew where
 * it rests. */
int quadrature_edge(struct quadrature *quadrature, bool a, bool b);

#endif
