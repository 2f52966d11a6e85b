/* SPDX-License-Identifier: MIT */
#include "drivers/gpio/quadrature.h"

/* Returns the phase of the lines, 0 to 3. */
static int quadrature_phase(bool a, bool b)
{
	return a ? (b ? 2 : 1) : (b ? 3 : 0);
}

void quadrature_start(struct quadrature *q, int detent, bool a, bool b)
{
	*q = (struct quadrature){.a = a, .b = b, .detent = detent, .rest = quadrature_phase(a, b)};
}

int quadrature_edge(struct quadrature *q, bool a, bool b)
{
	const int moved = (quadrature_phase(a, b) - quadrature_phase(q->a, q->b) + 4) % 4;
	int step;

	q->a = a;
	q->b = b;
	if (moved != 2)
		q->quarters += moved == 3 ? -1 : moved;
	step = q->quarters / q->detent;
	q->quarters -= step * q->detent;
	if ((quadrature_phase(a, b) - q->rest) % q->detent == 0)
		q->quarters = 0;
	return step;
}
