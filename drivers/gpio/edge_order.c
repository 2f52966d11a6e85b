/* SPDX-License-Identifier: MIT */
#include "drivers/gpio/edge_order.h"

#include <errno.h>
#include <stddef.h>

bool edge_order_has_room(const struct edge_order *order, int line)
{
	return order->count[line] < EDGE_ORDER_MAX;
}

void edge_order_add(struct edge_order *order, int line, struct gpio_edge edge)
{
	const unsigned at = (order->first[line] + order->count[line]) % EDGE_ORDER_MAX;

	order->edges[line][at] = edge;
	order->count[line]++;
}

static const struct gpio_edge *edge_order_oldest(const struct edge_order *order, int line)
{
	return order->count[line] ? &order->edges[line][order->first[line]] : NULL;
}

int edge_order_take(struct edge_order *order, int64_t now_ns, struct gpio_edge *edge,
		    int64_t *until_ns)
{
	const struct gpio_edge *const e[2] = {edge_order_oldest(order, 0),
					      edge_order_oldest(order, 1)};
	int line;

	*until_ns = INT64_MAX;
	if (!e[0] && !e[1])
		return -EAGAIN;
	line = !e[0] || (e[1] && e[1]->at_ns < e[0]->at_ns);
	/* A time in the future is of another clock: there is no point in waiting for it. */
	if (!e[!line] && edge_order_has_room(order, line) && e[line]->at_ns <= now_ns &&
	    now_ns - e[line]->at_ns < EDGE_ORDER_NS) {
		*until_ns = e[line]->at_ns + EDGE_ORDER_NS;
		return -EAGAIN;
	}
	*edge = *e[line];
	order->first[line] = (order->first[line] + 1) % EDGE_ORDER_MAX;
	order->count[line]--;
	return line;
}
