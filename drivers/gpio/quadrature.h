/* SPDX-License-Identifier: MIT */
/*
 * Decodes the two lines of a rotary encoder into steps. Pure: touches no device. A turn takes the
 * lines through 00 01 11 10, or back. A bouncing contact goes forth and back between two
 * neighbours, which adds up to no step.
 */
#ifndef INLAY_DRIVERS_GPIO_QUADRATURE_H
#define INLAY_DRIVERS_GPIO_QUADRATURE_H

#include <stdbool.h>

struct quadrature {
	bool a, b;
	int quarters; /* quarter periods since the last step, signed */
	int detent;   /* quarters in a step: 1, 2 or 4 */
	int rest;     /* phase at the start; the encoder rests there and every detent quarters on */
};

void quadrature_start(struct quadrature *quadrature, int detent, bool a, bool b);

/* Takes the levels after an edge. Returns 1: a step with a leading b; -1: a step back; 0: none. If
 * both levels have changed, an edge was lost and the direction is unknown: this counts as no
 * movement, and at the next resting phase the count starts again. */
int quadrature_edge(struct quadrature *quadrature, bool a, bool b);

#endif
