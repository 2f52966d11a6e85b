/* SPDX-License-Identifier: MIT */
#include "hal/lights/recovery.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>

#define CLIPPED 0.001 /* share of a patch's pixels that noise alone may clip */

struct light_ground light_ground_see(const struct frame_reader *picture, int x, int y, int width,
				     int height, const float decode[256], uint32_t *row)
{
	struct light_ground ground = {.clipped = 0};
	const double pixels = (double)width * height;

	for (int down = 0; down < height; down++) {
		const uint32_t *bgrx = frame_reader_row(picture, x, y + down, width, row);

		for (int i = 0; i < width; i++) {
			const uint32_t code[3] = {bgrx[i] >> 16 & 255, bgrx[i] >> 8 & 255,
						  bgrx[i] & 255};

			for (int c = 0; c < 3; c++)
				ground.radiance[c] += (double)decode[code[c]];
			ground.clipped += code[0] == 255 || code[1] == 255 || code[2] == 255;
		}
	}
	for (int c = 0; c < 3; c++)
		ground.radiance[c] /= pixels;
	ground.clipped /= pixels;
	return ground;
}

/* D' of recovery.h: the missing radiance, reduced near the uncertainty. */
static double ground_missing(double seen, double known)
{
	const double d = seen - known, unsure = LIGHT_RECOVERY_UNSURE * seen;

	return d > 0 ? d * d * d / (d * d + unsure * unsure) : 0;
}

/* Relative radiance expected of a light's clipped pixels: (u / w) / (A + SMALL_SR). */
static double pixel_brightness(const struct light_clipping *k, int i, int c)
{
	return k->term[c][i] / (k->solid_angle_sr[i] * (k->piece_sr[i] + LIGHT_RECOVERY_SMALL_SR));
}

/* Estimated share of a light that is clipped in one channel: q min(1, L / (q white))^8. */
static double clipped_in(const struct light_clipping *k, int i, double radiance)
{
	const double q = (double)k->clipped[i], full = fmin(radiance / (q * k->white), 1);
	const double squared = full * full, fourth = squared * squared;

	return q * fourth * fourth;
}

/* Recovers one channel; returns its factor. */
static double recover_channel(const struct light_ground *ground, const struct light_clipping *k,
			      int c, float (*radiance)[3], struct light_recovery *r)
{
	double known = 0, reach = 0, brightest = 0, x, most;

	for (int i = 0; i < k->lights; i++) {
		known += k->term[c][i] * (double)radiance[i][c];
		if (!(k->clipped[i] > 0))
			continue;
		reach += k->term[c][i] * pixel_brightness(k, i, c) *
			 clipped_in(k, i, (double)radiance[i][c]);
		brightest = fmax(brightest, pixel_brightness(k, i, c));
	}
	x = reach > 0 ? ground_missing(ground->radiance[c], known) / reach : 0;
	if (!(x > 0))
		return 1;
	most = (LIGHT_RECOVERY_MAX - 1) * k->white / brightest;
	r->recovered = true;
	r->at_bound |= x > most || ground->clipped > CLIPPED;
	x = fmin(x, most);
	for (int i = 0; i < k->lights; i++)
		if (k->clipped[i] > 0)
			radiance[i][c] += (float)(x * pixel_brightness(k, i, c) *
						  clipped_in(k, i, (double)radiance[i][c]));
	return 1 + x * brightest / k->white;
}

struct light_recovery light_recover(const struct light_ground *ground,
				    const struct light_clipping *clipping, float (*radiance)[3])
{
	struct light_recovery r = {.recovered = false};

	for (int c = 0; c < 3; c++)
		r.factor[c] = recover_channel(ground, clipping, c, radiance, &r);
	return r;
}

#define CORNERS_MAX 32 /* corners of a cell: five to seven, more where corners coincide */
#define BEYOND 0.01    /* step across an edge, over the distance from node to edge */

struct clipped_pieces {
	int lights;
	int *first;	  /* [lights + 1]: pairs of light i are first[i]..first[i + 1] - 1 */
	int *neighbour;	  /* [pairs]: each pair once, at the light of greater index */
	int *parent;	  /* [lights]: union-find: an earlier light of the same piece, or itself */
	double *solid_sr; /* [lights]: solid angle */
	double *piece_sr; /* [lights]: result of clipped_pieces_find() */
};

/* ---- neighbours ---- */

/* The light behind the edge between corners a and b of a light's cell; -1: below the horizon. */
static int cell_across(const struct dome *dome, int light, const double a[3], const double b[3])
{
	double out[3];

	for (int k = 0; k < 3; k++) {
		const double middle = (a[k] + b[k]) / 2;

		out[k] = middle + BEYOND * (middle - dome->direction[light][k]);
	}
	return dome_cell_of(dome, out);
}

/* Lists the neighbours of a light that have a smaller index; to may be NULL. Returns their
 * count. */
static int light_neighbours(const struct dome *dome, int light, int *to)
{
	double corner[CORNERS_MAX][3];
	const int corners = dome_cell_corners(dome, light, corner, CORNERS_MAX);
	const int known = corners < CORNERS_MAX ? corners : CORNERS_MAX;
	int count = 0;

	for (int k = 0; k < known; k++) {
		const int other = cell_across(dome, light, corner[k], corner[(k + 1) % known]);

		if (other < 0 || other >= light)
			continue;
		if (to)
			to[count] = other;
		count++;
	}
	return count;
}

int clipped_pieces_create(struct clipped_pieces **out, const struct dome *dome)
{
	const size_t lights = (size_t)dome->count;
	struct clipped_pieces *p = calloc(1, sizeof(*p));

	*out = NULL;
	if (!p)
		return -ENOMEM;
	p->lights = dome->count;
	p->first = calloc(lights + 1, sizeof(*p->first));
	p->parent = calloc(lights, sizeof(*p->parent));
	p->solid_sr = calloc(lights, sizeof(*p->solid_sr));
	p->piece_sr = calloc(lights, sizeof(*p->piece_sr));
	if (!p->first || !p->parent || !p->solid_sr || !p->piece_sr)
		goto destroy;
	for (int i = 0; i < p->lights; i++) {
		p->solid_sr[i] = dome->solid_angle_sr[i];
		p->first[i + 1] = p->first[i] + light_neighbours(dome, i, NULL);
	}
	p->neighbour = calloc((size_t)p->first[p->lights] + 1, sizeof(*p->neighbour));
	if (!p->neighbour)
		goto destroy;
	for (int i = 0; i < p->lights; i++)
		light_neighbours(dome, i, p->neighbour + p->first[i]);
	*out = p;
	return 0;

destroy:
	clipped_pieces_destroy(p);
	return -ENOMEM;
}

void clipped_pieces_destroy(struct clipped_pieces *p)
{
	if (!p)
		return;
	free(p->first);
	free(p->neighbour);
	free(p->parent);
	free(p->solid_sr);
	free(p->piece_sr);
	free(p);
}

/* ---- union-find over the clipped lights of a frame ---- */

/* The root of a light's piece, its light of smallest index. Halves the path on the way. */
static int piece_root(struct clipped_pieces *p, int light)
{
	while (p->parent[light] != light) {
		p->parent[light] = p->parent[p->parent[light]];
		light = p->parent[light];
	}
	return light;
}

static void pieces_join(struct clipped_pieces *p, int light, int neighbour)
{
	const int a = piece_root(p, light), b = piece_root(p, neighbour);

	if (a < b)
		p->parent[b] = a;
	else
		p->parent[a] = b;
}

const double *clipped_pieces_find(struct clipped_pieces *p, const float *clipped)
{
	for (int i = 0; i < p->lights; i++) {
		p->parent[i] = i;
		p->piece_sr[i] = 0;
		for (int k = p->first[i]; clipped[i] > 0 && k < p->first[i + 1]; k++)
			if (clipped[p->neighbour[k]] > 0)
				pieces_join(p, i, p->neighbour[k]);
	}
	for (int i = 0; i < p->lights; i++)
		if (clipped[i] > 0)
			p->piece_sr[piece_root(p, i)] += (double)clipped[i] * p->solid_sr[i];
	/* A root comes first in its piece and holds the sum; the other lights copy it. */
	for (int i = 0; i < p->lights; i++)
		if (clipped[i] > 0)
			p->piece_sr[i] = p->piece_sr[piece_root(p, i)];
	return p->piece_sr;
}
