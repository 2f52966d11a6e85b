/* SPDX-License-Identifier: MIT */
#include "bake/tiles/tile_glass.h"

#include "bake/tiles/sight.h"

#define OFFSET_MAX 2047.0 /* largest displacement, in pixels, that 16 bits hold */
#define SPREAD_MAX                                                                                 \
	24.0 /* a pixel is spread over at most this many pixels; bounds a frame's reads */
/* Light of less weight than half a step of 16 bits is not seen. */
#define WEIGHT_LEAST (0.5f / 65535)

static void glass_add_background(struct tile *tile, const struct tile_sample *s,
				 const struct sight *sight, const double place[2])
{
	struct tile_pixel *p = &tile->pixels[s->at];
	const float *w = sight->weight.c;
	const float weight = (w[0] + w[1] + w[2]) / 3;
	const int corner[2] = {tile->x + s->at % BASIS_TILE, tile->y + s->at / BASIS_TILE};

	p->other_weight += (double)weight;
	p->through_weight += (double)weight;
	for (int c = 0; c < 3; c++)
		p->through[c] += (double)w[c];
	for (int axis = 0; axis < 2; axis++) {
		const double from_middle = place[axis] - corner[axis] - 0.5;

		p->offset[axis] += (double)weight * (place[axis] - s->place[axis]);
		p->place_sum[axis] += (double)weight * from_middle;
		p->place_square[axis] += (double)weight * from_middle * from_middle;
	}
	if (sight->met)
		tile_add_receiver(tile, s, &sight->surface, sight->direction, weight);
}

static void glass_add_light(struct tile *tile, const struct sight *sight,
			    const struct transport_rows *rows)
{
	struct transport *t = &tile->transport;

	if (rgb_peak(sight->weight) < WEIGHT_LEAST)
		return;
	if (sight->met)
		transport_add(t, WITH_OBJECTS, &sight->surface, v3_scale(sight->direction, -1),
			      sight->weight, rows);
	else
		transport_add_sky(t, sight->direction, sight->weight, rows);
}

void tile_glass_add(struct tile *tile, const struct tile_sample *s,
		    const struct transport_rows *rows)
{
	struct sight passed, mirrored;
	double place[2];

	sight_through_glass(tile->scene->world, &tile->transport.random, &s->surface, s->direction,
			    &passed, &mirrored);
	glass_add_light(tile, &mirrored, rows);
	if (rgb_peak(passed.weight) >= WEIGHT_LEAST && sight_is_real(&passed) &&
	    sight_place(tile->scene, &passed, place) &&
	    fmax(fabs(place[0] - s->place[0]), fabs(place[1] - s->place[1])) < OFFSET_MAX)
		glass_add_background(tile, s, &passed, place);
	else
		glass_add_light(tile, &passed, rows);
}

static uint16_t glass_share(double sum, int samples)
{
	return (uint16_t)lround(fmin(65535 * sum / samples, 65535));
}

/* Returns the side of the rectangle that has the variance of the places seen:
 *     side = sqrt(12 * variance)
 * The variance of the camera's own blur is subtracted, as the background has it already. */
static uint8_t glass_spread(const struct tile_pixel *p, double edge_spread_px, int axis)
{
	const double mean = p->place_sum[axis] / p->through_weight;
	const double variance = p->place_square[axis] / p->through_weight - mean * mean -
				edge_spread_px * edge_spread_px;
	const double side = sqrt(fmax(12 * variance, 0));

	return (uint8_t)lround(fmin(fmax(side - 1, 0), SPREAD_MAX) * BASIS_GLASS_SPREAD);
}

static void glass_finish_pixel(struct tile *tile, int at)
{
	const struct tile_pixel *p = &tile->pixels[at];
	struct basis_glass *g = &tile->result.glass[tile->result.glass_count];
	uint16_t most = 0;

	*g = (struct basis_glass){.x = (uint16_t)(tile->x + at % BASIS_TILE),
				  .y = (uint16_t)(tile->y + at / BASIS_TILE)};
	for (int c = 0; c < 3; c++) {
		g->transmission[c] = glass_share(p->through[c], tile->samples);
		most = g->transmission[c] > most ? g->transmission[c] : most;
	}
	g->dx = (int16_t)lround(BASIS_GLASS_STEP * p->offset[0] / p->through_weight);
	g->dy = (int16_t)lround(BASIS_GLASS_STEP * p->offset[1] / p->through_weight);
	for (int axis = 0; axis < 2; axis++)
		g->spread[axis] = glass_spread(p, tile->scene->camera.edge_spread_px, axis);
	tile->result.opaque[at] =
		(uint16_t)(most < tile->result.coverage[at] ? tile->result.coverage[at] - most : 0);
	tile->result.glass_count += most > 0;
}

void tile_glass_finish(struct tile *tile)
{
	tile->result.glass_count = 0;
	for (int at = 0; at < TILE_PIXELS; at++) {
		tile->result.opaque[at] = tile->result.coverage[at];
		if (tile->pixels[at].through_weight > 0)
			glass_finish_pixel(tile, at);
	}
}
