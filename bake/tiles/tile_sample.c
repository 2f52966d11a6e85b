/* SPDX-License-Identifier: MIT */
#include "bake/tiles/tile_sample.h"

#include <string.h>

/* Rows are cleared only when they are first used, as most tiles do not use most of them. */
struct transport_rows tile_rows_for(struct tile *tile, enum tile_kind kind, int at, bool first)
{
	const struct tile_rows *rows = &tile->rows[kind];
	const size_t direct = tile_direct_size(tile, kind), bounce = tile_bounce_size(tile);
	const size_t at_direct = (size_t)at * direct, at_bounce = (size_t)at * bounce;

	if (first) {
		memset(rows->direct + at_direct, 0, direct * sizeof(float));
		memset(rows->bounce[0] + at_bounce, 0, bounce * sizeof(float));
		memset(rows->bounce[1] + at_bounce, 0, bounce * sizeof(float));
	}
	return (struct transport_rows){
		.direct = rows->direct + at_direct,
		.bounce = rows->bounce[tile_half_of_batch(tile)] + at_bounce,
	};
}

void tile_add_receiver(struct tile *tile, const struct tile_sample *sample,
		       const struct surface *surface, struct v3 direction, float weight)
{
	const struct v3 wo = v3_scale(direction, -1);
	const struct rgb weights = {{weight, weight, weight}};
	const uint64_t seed = tile->settings.seed;
	struct transport *t = &tile->transport;
	struct tile_pixel *p = &tile->pixels[sample->at];
	const bool first = p->receiver++ == 0;
	struct transport_rows rows = tile_rows_for(tile, TILE_CHANGE, sample->at, first);

	p->receiver_weight += (double)weight;
	if (!tile_has_standins(tile)) {
		p->changed |= transport_add_shadow(t, surface->position, weight, &rows);
		return;
	}
	transport_begin(t, seed, sample->pixel, sample->sample);
	transport_add(t, WITH_OBJECTS, surface, wo, weights, &rows);
	rows = tile_rows_for(tile, TILE_WITHOUT, sample->at, first);
	transport_begin(t, seed, sample->pixel, sample->sample);
	transport_add(t, WITHOUT_OBJECTS, surface, wo, weights, &rows);
}
