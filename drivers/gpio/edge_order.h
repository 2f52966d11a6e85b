/* SPDX-License-Identifier: MIT */
/*
 * Merges the edges of an encoder's two lines into one sequence in order of time. Pure: touches no
 * device.
 *
 * The kernel delivers the edges of each line in order, with the times of their interrupts. But its
 * threads may deliver those of one line before or after those of the other. So an edge is held back
 * until no older edge of the other line can come: until that line has a younger one, or
 * EDGE_ORDER_NS have passed.
 */
#ifndef INLAY_DRIVERS_GPIO_EDGE_ORDER_H
#define INLAY_DRIVERS_GPIO_EDGE_ORDER_H

#include <stdbool.h>
#include <stdint.h>

#define EDGE_ORDER_NS 10000000 /* shorter than a frame, so the delay is invisible */
#define EDGE_ORDER_MAX 32      /* edges of each line; twice what the kernel buffers */

struct gpio_edge {
	int64_t at_ns;
	bool level;
};

/* A ring buffer for each line. A zeroed struct is empty. */
struct edge_order {
	struct gpio_edge edges[2][EDGE_ORDER_MAX];
	unsigned first[2], count[2];
};

/* Whether the ring of a line (0 or 1) has room for another edge. */
bool edge_order_has_room(const struct edge_order *order, int line);

/* Adds the next edge of a line; there must be room. */
void edge_order_add(struct edge_order *order, int line, struct gpio_edge edge);

/* Takes the oldest edge and returns its line, 0 or 1. -EAGAIN: no edge is ready; *until_ns is then
 * the time when one will be, INT64_MAX if there is none. If a line's ring is full, its oldest edge
 * is ready at once. */
int edge_order_take(struct edge_order *order, int64_t now_ns, struct gpio_edge *edge,
		    int64_t *until_ns);

#endif
