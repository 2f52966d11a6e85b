/* SPDX-License-Identifier: MIT */
/*
 * The edges of an encoder's two lines in the order in which they happened; no device in it.
 *
 * The kernel keeps each line's edges in order, with the times of their interrupts, but hands over
 * those of one line before or after those of the other as its threads come to run. So an edge of
 * one line counts when an older one of the other cannot come any more: when that has a younger one,
 * or when EDGE_ORDER_NS have passed.
 */
#ifndef INLAY_DRIVERS_GPIO_EDGE_ORDER_H
#define INLAY_DRIVERS_GPIO_EDGE_ORDER_H

#include <stdbool.h>
#include <stdint.h>

#define EDGE_ORDER_NS 10000000 /* less than a frame: nobody sees a step wait so long */
#define EDGE_ORDER_MAX 32      /* of each line; twice what the kernel keeps */

struct gpio_edge {
	int64_t at_ns;
	bool level;
};

struct edge_order {
	struct gpio_edge edges[2][EDGE_ORDER_MAX];
	unsigned first[2], count[2];
};

/* Whether the line has room for another edge. */
bool edge_order_has_room(const struct edge_order *order, int line);

/* The next edge of a line that has room for it. Zeroed, an order has none. */
void edge_order_add(struct edge_order *order, int line, struct gpio_edge edge);

/* Takes the oldest edge: 0 or 1, its line. -EAGAIN: none counts yet; *until_ns: when one will,
 * INT64_MAX if there is none. A line without room waits no longer. */
int edge_order_take(struct edge_order *order, int64_t now_ns, struct gpio_edge *edge,
		    int64_t *until_ns);

#endif
