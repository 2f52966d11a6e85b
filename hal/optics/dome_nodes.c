/* SPDX-License-Identifier: MIT */
/*
 * Makes the nodes of one fifth of the dome and turns it five times.
 *
 * Rows count from the zenith. The cap's faces hold rows 0..f, the band's faces rows f..2f. A node
 * of row r lies opposite to a node of row 3f - r, because the division is the same on every face
 * and from every side of it: the dome has the full symmetry of the icosahedron, inversion included.
 * Hence
 *   - all nodes of the cap are above the horizon;
 *   - a node c steps down one of the band's ten edges from its upper end is above the horizon for
 *     c < f/2, on it for c = f/2 (the edge is bisected by an axis about which half a turn swaps the
 *     upper and the lower half), and below it for c > f/2;
 *   - of a node P inside the band's faces and the opposite node -P, one is above and one below. So
 *     only the faces that point down are divided, and each node P gives P or -P, whichever is
 *     above: never both, never none, whatever the rounding. No symmetry holds a node inside a face
 *     on the horizon, and for f up to 64 none is nearer to it than 3e-6: rounding does not decide
 *     which of the two is taken either.
 */
#include "hal/optics/dome_parts.h"

#include <errno.h>
#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "hal/optics/vec.h"

struct dividing_node {
	int row;
	double azimuth; /* 0..2 pi */
	double direction[3];
};

struct dome_dividing {
	int frequency;
	struct dividing_node *nodes;
	int count;
};

int dome_node_count(int frequency)
{
	/* Half of all 10 f^2 + 2 nodes; the ten on the horizon of an even f count whole. */
	return 5 * frequency * frequency + 1 + (frequency % 2 ? 0 : 5);
}

/* The direction that divides the angle from a to b in the ratio t : 1 - t. */
static void divide_angle(const double a[3], const double b[3], double t, double out[3])
{
	const double angle =
		atan2(hypot(hypot(a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2]),
			    a[0] * b[1] - a[1] * b[0]),
		      vec_dot(a, b));
	const double p = sin((1 - t) * angle) / sin(angle), q = sin(t * angle) / sin(angle);

	for (int i = 0; i < 3; i++)
		out[i] = p * a[i] + q * b[i];
}

/* The thesis's construction, with A the corner apex: M divides the angle BOC, P divides the angle
 * AOM. The three weights sum to f. */
static void divide_from(const double *const corner[3], const int weight[3], int apex, double out[3])
{
	const int b = (apex + 1) % 3, c = (apex + 2) % 3;
	const int rest = weight[b] + weight[c];
	double m[3];

	if (rest == 0) {
		memcpy(out, corner[apex], sizeof(m));
		return;
	}
	divide_angle(corner[b], corner[c], (double)weight[c] / rest, m);
	divide_angle(corner[apex], m, (double)rest / (rest + weight[apex]), out);
}

/*
 * The node with these weights on a face. Inside a face the thesis's construction depends on which
 * corner is called A; the mean of the three makes the division the same from every side.
 */
static void divide_face(const double *const corner[3], const int weight[3], double out[3])
{
	double sum[3] = {0, 0, 0};

	for (int i = 0; i < 3; i++) {
		double p[3];

		divide_from(corner, weight, i, p);
		for (int k = 0; k < 3; k++)
			sum[k] += p[k];
	}
	vec_normalize(sum);
	memcpy(out, sum, sizeof(sum));
}

static void add_node(struct dome_dividing *d, int row, const double direction[3], double sign,
		     bool horizon, int fifth)
{
	const double turn = fifth * (2 * M_PI / 5);
	struct dividing_node *n = &d->nodes[d->count++];
	const double x = sign * direction[0], y = sign * direction[1];

	n->row = row;
	n->direction[0] = fifth ? cos(turn) * x - sin(turn) * y : x;
	n->direction[1] = fifth ? sin(turn) * x + cos(turn) * y : y;
	n->direction[2] = horizon ? 0 : sign * direction[2];
	vec_normalize(n->direction);
	/* Nodes of one row are far apart: an azimuth just below 0 is 0, apart from rounding. */
	n->azimuth = atan2(n->direction[1], n->direction[0]);
	if (n->azimuth < -1e-9)
		n->azimuth += 2 * M_PI;
}

static void add_five(struct dome_dividing *d, int row, const double direction[3], double sign,
		     bool horizon)
{
	for (int fifth = 0; fifth < 5; fifth++)
		add_node(d, row, direction, sign, horizon, fifth);
}

/* Rows 1..f of the face below the zenith, without its right edge, which belongs to the next
 * fifth. */
static void divide_cap(struct dome_dividing *d, const double *const corner[3])
{
	const int f = d->frequency;

	for (int row = 1; row <= f; row++)
		for (int j = 0; j < row; j++) {
			const int weight[3] = {f - row, row - j, j};
			double p[3];

			divide_face(corner, weight, p);
			add_five(d, row, p, 1, false);
		}
}

/* The face of the band that points down; its corners are upper left, upper right, lower. */
static void divide_band(struct dome_dividing *d, const double *const corner[3])
{
	const int f = d->frequency;

	for (int c = 1; c < f; c++)
		for (int j = 0; j <= f - c; j++) {
			const bool edge = j == 0 || j == f - c, middle = 2 * c == f;
			const int weight[3] = {f - c - j, j, c};
			double p[3];

			if (edge && 2 * c > f)
				continue;
			divide_face(corner, weight, p);
			if (edge) {
				add_five(d, f + c, p, 1, middle);
			} else {
				const bool above = p[2] > 0;

				add_five(d, above ? f + c : 2 * f - c, p, above ? 1 : -1, false);
			}
		}
}

static int by_row_and_azimuth(const void *pa, const void *pb)
{
	const struct dividing_node *a = pa, *b = pb;

	if (a->row != b->row)
		return a->row < b->row ? -1 : 1;
	return a->azimuth < b->azimuth ? -1 : a->azimuth > b->azimuth;
}

int dome_nodes_fill(int frequency, double (*direction)[3])
{
	const double z = 1 / sqrt(5), r = 2 / sqrt(5);
	const double zenith[3] = {0, 0, 1};
	const double left[3] = {r, 0, z};
	const double right[3] = {r * cos(2 * M_PI / 5), r * sin(2 * M_PI / 5), z};
	const double lower[3] = {r * cos(M_PI / 5), r * sin(M_PI / 5), -z};
	const double *const cap[3] = {zenith, left, right}, *const band[3] = {left, right, lower};
	const int count = dome_node_count(frequency);
	struct dome_dividing d = {.frequency = frequency};

	d.nodes = calloc((size_t)count, sizeof(*d.nodes));
	if (!d.nodes)
		return -ENOMEM;
	add_node(&d, 0, zenith, 1, false, 0);
	divide_cap(&d, cap);
	divide_band(&d, band);
	qsort(d.nodes, (size_t)count, sizeof(*d.nodes), by_row_and_azimuth);
	for (int i = 0; i < count; i++)
		memcpy(direction[i], d.nodes[i].direction, sizeof(direction[i]));
	free(d.nodes);
	return 0;
}

/* ---- finer parts ---- */

/* Steps from the middle of a part to its rim, at most so far apart, against the spacing of nodes:
 * cells whose corner a part just touches are left whole. */
#define PART_STEP 0.1
/* Nodes nearer than this, against the spacing of the finer dome, are one. */
#define ONE_NODE 0.25

/* Angle between two neighbouring nodes: 63.4 degrees between the vertices of the icosahedron. */
static double node_spacing_rad(int frequency)
{
	return atan(2) / frequency;
}

/* The nodes of the base dome, whose cells are divided. */
struct base_nodes {
	int frequency;
	const double (*node)[3];
	int count;
};

/* The cell of a direction, that of the nearest node; -1: below the horizon. */
static int base_cell(const struct base_nodes *base, const double d[3])
{
	double best = -INFINITY;
	int found = -1;

	for (int k = 0; d[2] >= 0 && k < base->count; k++) {
		const double near = vec_dot(base->node[k], d);

		if (near > best) {
			best = near;
			found = k;
		}
	}
	return found;
}

/* Raises level[] of each cell that a part touches to the part's frequency. */
static void mark_part(const struct base_nodes *base, const struct dome_fine *part, int *level)
{
	const double step = PART_STEP * node_spacing_rad(base->frequency);
	const int rings = (int)ceil(part->radius_rad / step);
	const double *d = part->direction;
	const double axis[3] = {fabs(d[0]) < 0.6, fabs(d[0]) >= 0.6, 0};
	double e1[3], e2[3];

	vec_cross(axis, d, e1);
	vec_normalize(e1);
	vec_cross(d, e1, e2);
	for (int ring = 0; ring <= rings; ring++) {
		const double away = rings ? part->radius_rad * ring / rings : 0;
		const int points = 1 + (int)ceil(2 * M_PI * sin(away) / step);

		for (int k = 0; k < points; k++) {
			const double turn = 2 * M_PI * k / points;
			double at[3];
			int cell;

			for (int c = 0; c < 3; c++)
				at[c] = cos(away) * d[c] +
					sin(away) * (cos(turn) * e1[c] + sin(turn) * e2[c]);
			cell = base_cell(base, at);
			if (cell >= 0 && level[cell] < part->frequency)
				level[cell] = part->frequency;
		}
	}
}

/* Whether one of the nodes is within an angle of d. */
static bool node_near(const double (*node)[3], int count, const double d[3], double angle)
{
	const double least = cos(angle);

	for (int k = 0; k < count; k++)
		if (vec_dot(node[k], d) > least)
			return true;
	return false;
}

/* Appends the nodes of a finer dome in the base dome's cells that have this level. Neighbouring
 * cells of other levels may have a node on their common border. */
static int append_level(const struct base_nodes *base, int frequency, const int *level,
			double (*node)[3], int *count)
{
	const double apart = ONE_NODE * node_spacing_rad(frequency);
	const int all = dome_node_count(frequency);
	double(*finer)[3] = malloc((size_t)all * sizeof(*finer));
	int ret = finer ? dome_nodes_fill(frequency, finer) : -ENOMEM;

	for (int k = 0; k < all && !ret; k++) {
		const int cell = base_cell(base, finer[k]);

		if (level[cell] != frequency ||
		    node_near((const double(*)[3])node, *count, finer[k], apart))
			continue;
		memcpy(node[(*count)++], finer[k], sizeof(*node));
	}
	free(finer);
	return ret;
}

static int append_parts(const struct base_nodes *base, const struct dome_fine *fine, int parts,
			double (*node)[3], int *count)
{
	int *level = calloc((size_t)base->count, sizeof(*level)), ret = level ? 0 : -ENOMEM;

	for (int k = 0; k < parts && !ret; k++)
		mark_part(base, &fine[k], level);
	for (int f = 2 * base->frequency; f <= DOME_FREQUENCY_MAX && !ret; f += base->frequency) {
		bool used = false;

		for (int i = 0; i < base->count; i++)
			used |= level[i] == f;
		if (used)
			ret = append_level(base, f, level, node, count);
	}
	free(level);
	return ret;
}

int dome_nodes_create(int frequency, const struct dome_fine *fine, int parts,
		      double (**direction)[3], int *count)
{
	/* Even a whole sky of the finest cells has fewer. */
	const int room = parts ? DOME_LIGHTS_MAX : dome_node_count(frequency);
	double(*node)[3] = malloc((size_t)room * sizeof(*node)), (*shrunk)[3];
	const int whole = dome_node_count(frequency);
	const struct base_nodes base = {frequency, (const double(*)[3])node, whole};
	int ret = node ? dome_nodes_fill(frequency, node) : -ENOMEM;

	*count = whole;
	if (!ret && parts)
		ret = append_parts(&base, fine, parts, node, count);
	if (ret) {
		free(node);
		return ret;
	}
	shrunk = realloc(node, (size_t)*count * sizeof(*node));
	*direction = shrunk ? shrunk : node;
	return 0;
}
