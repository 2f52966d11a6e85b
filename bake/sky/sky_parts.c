/* SPDX-License-Identifier: MIT */
#include "bake/sky/sky_parts.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "hal/optics/vec.h"

#define SUBSAMPLES 3	/* samples along each side of a panorama's texel */
#define LEVELS 7	/* frequencies F, 2 F, 4 F ... up to DOME_FREQUENCY_MAX */
#define COSINE 0.05	/* least: light along the ground still reaches what stands on it */
#define WORTH 0.0005	/* rad by which a part must lessen how far light is moved */
#define MARGIN 0.5	/* radius of a part, in cells: light at a border needs both sides */
#define SPACING atan(2) /* between two nodes of the icosahedron, rad */

struct sky_pieces {
	struct dome level[LEVELS]; /* the cells of the last are the pieces */
	int levels;
	double *irradiance;	 /* [piece] */
	int *cell;		 /* [piece]: of the base dome */
	double (*moved)[LEVELS]; /* [cell]: m when the cell is divided as in a level */
	int *chosen;		 /* [cell]: its level */
};

static void pieces_free(struct sky_pieces *p)
{
	for (int l = 0; l < p->levels; l++)
		dome_free(&p->level[l]);
	free(p->irradiance);
	free(p->cell);
	free(p->moved);
	free(p->chosen);
}

static int pieces_create(struct sky_pieces *p, int frequency, struct fault *fault)
{
	const struct dome *base = &p->level[0], *last;
	int err = 0;

	*p = (struct sky_pieces){.levels = 0};
	for (int f = frequency; !err && (f <= DOME_FREQUENCY_MAX || f == frequency); f *= 2)
		err = dome_create(&p->level[p->levels++], f, DOME_ANGLES, fault);
	if (err)
		return err;
	last = &p->level[p->levels - 1];
	p->irradiance = calloc((size_t)last->count, sizeof(*p->irradiance));
	p->cell = calloc((size_t)last->count, sizeof(*p->cell));
	p->moved = calloc((size_t)base->count, sizeof(*p->moved));
	p->chosen = calloc((size_t)base->count, sizeof(*p->chosen));
	if (!p->irradiance || !p->cell || !p->moved || !p->chosen)
		return fault_say(fault, -ENOMEM, "not enough memory for the sky");
	for (int i = 0; i < last->count; i++)
		p->cell[i] = dome_cell_of(base, last->direction[i]);
	return 0;
}

/* Sums the mean of the channels. Returns the whole sky's irradiance. */
static double pieces_gather(struct sky_pieces *p, const struct panorama *panorama)
{
	const struct image *image = panorama->image;
	const struct dome *last = &p->level[p->levels - 1];
	double all = 0;

	for (int y = 0; y < (image->height + 1) / 2 * SUBSAMPLES; y++) {
		const double sr = panorama_row_sr(panorama, y / SUBSAMPLES) / image->width /
				  (SUBSAMPLES * SUBSAMPLES);

		for (int x = 0; x < image->width * SUBSAMPLES; x++) {
			double d[3], rgb[3], e;
			int piece;

			panorama_direction(panorama, (x + 0.5) / SUBSAMPLES, (y + 0.5) / SUBSAMPLES,
					   d);
			piece = dome_cell_of(last, d);
			if (piece < 0)
				continue;
			panorama_radiance(panorama, d, rgb);
			e = (rgb[0] + rgb[1] + rgb[2]) / 3 * fmax(d[2], COSINE) * sr;
			p->irradiance[piece] += e;
			all += e;
		}
	}
	return all;
}

/* The weight that an even sky gives to a piece. */
static double piece_even(const struct dome *last, int piece)
{
	return last->solid_angle_sr[piece] * fmax(last->direction[piece][2], COSINE);
}

/* Computes m of each cell at a level. */
static int pieces_compare(struct sky_pieces *p, int l, double all)
{
	const struct dome *dome = &p->level[l], *last = &p->level[p->levels - 1];
	double(*sum)[2] = calloc((size_t)dome->count, sizeof(*sum));

	if (!sum)
		return -ENOMEM;
	for (int i = 0; i < last->count; i++) {
		double *const s = sum[dome_cell_of(dome, last->direction[i])];

		s[0] += p->irradiance[i];
		s[1] += piece_even(last, i);
	}
	for (int i = 0; i < last->count; i++) {
		const double *const s = sum[dome_cell_of(dome, last->direction[i])];
		const double even = s[0] / s[1] * piece_even(last, i);

		p->moved[p->cell[i]][l] += 0.5 * fabs(p->irradiance[i] - even) / all * SPACING /
					   dome->frequency;
	}
	free(sum);
	return 0;
}

/* Finds the cell and level that are worth the most for each light. Returns the cell; -1: none is
 * worth it. */
static int pieces_best(const struct sky_pieces *p, int *level)
{
	double most = 0;
	int best = -1;

	for (int i = 0; i < p->level[0].count; i++)
		for (int l = p->chosen[i] + 1; l < p->levels; l++) {
			const double gain = p->moved[i][p->chosen[i]] - p->moved[i][l];
			const double lights = ldexp(1, 2 * l) - ldexp(1, 2 * p->chosen[i]);

			if (gain < WORTH || gain / lights <= most)
				continue;
			most = gain / lights;
			best = i;
			*level = l;
		}
	return best;
}

/* The middle of the light of a cell, which is in the cell. */
static void cell_middle(const struct sky_pieces *p, int cell, double middle[3])
{
	const struct dome *last = &p->level[p->levels - 1];

	middle[0] = middle[1] = middle[2] = 0;
	for (int i = 0; i < last->count; i++)
		for (int k = 0; k < 3 && p->cell[i] == cell; k++)
			middle[k] += p->irradiance[i] * last->direction[i][k];
	vec_normalize(middle);
}

static void list_parts(struct sky_parts *parts, const struct sky_pieces *p)
{
	parts->count = 0;
	for (int i = 0; i < p->level[0].count; i++) {
		struct dome_fine *const part = &parts->part[parts->count];

		if (!p->chosen[i])
			continue;
		part->frequency = p->level[p->chosen[i]].frequency;
		part->radius_rad = MARGIN * SPACING / part->frequency;
		cell_middle(p, i, part->direction);
		parts->count++;
	}
}

/* Divides cells, the best first, as long as the lights suffice. */
static int choose(struct sky_parts *parts, struct sky_pieces *p, int most, struct fault *fault)
{
	const struct dome *base = &p->level[0];
	int cell, level = 0;

	while ((cell = pieces_best(p, &level)) >= 0) {
		const int before = p->chosen[cell];
		struct dome dome;
		int err, wrong;

		p->chosen[cell] = level;
		list_parts(parts, p);
		err = dome_create_fine(&dome, base->frequency, base->division, DOME_CELLS,
				       parts->part, parts->count, &wrong, fault);
		if (err)
			return err;
		if (dome.count <= most) {
			parts->lights = dome.count;
		} else {
			/* nothing is gained by dividing this cell as in that level or a finer */
			parts->limited = true;
			p->chosen[cell] = before;
			for (int l = level; l < p->levels; l++)
				p->moved[cell][l] = p->moved[cell][before];
		}
		dome_free(&dome);
	}
	list_parts(parts, p);
	return 0;
}

int sky_parts_choose(struct sky_parts *parts, const struct panorama *panorama, int frequency,
		     int most, struct fault *fault)
{
	struct sky_pieces p;
	int err = pieces_create(&p, frequency, fault);

	*parts = (struct sky_parts){.lights = err ? 0 : p.level[0].count};
	if (!err && parts->lights > most)
		err = fault_say(fault, -E2BIG,
				"a dome of frequency %d alone has %d lights, more "
				"than %d",
				frequency, parts->lights, most);
	if (!err) {
		const double all = pieces_gather(&p, panorama);

		parts->part = calloc((size_t)parts->lights, sizeof(*parts->part));
		if (!parts->part)
			err = -ENOMEM;
		for (int l = 0; !err && all > 0 && l < p.levels; l++)
			err = pieces_compare(&p, l, all);
		if (err)
			fault_say(fault, err, "not enough memory for the sky");
	}
	if (!err)
		err = choose(parts, &p, most, fault);
	pieces_free(&p);
	if (err)
		sky_parts_free(parts);
	return err;
}

void sky_parts_free(struct sky_parts *parts)
{
	free(parts->part);
	*parts = (struct sky_parts){.count = 0};
}
