/* SPDX-License-Identifier: MIT */
#include "bake/calibrate/camera/camera_edges.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>

#include "bake/calibrate/estimate/least_squares.h"
#include "hal/colour/transfer.h"
#include "hal/optics/tsai.h"

enum { LOW, HIGH, PLACE, TILT, SIGMA, MARKER, UNKNOWNS };
enum { SAMPLES_MOST = 1024, SAMPLES_LEAST = 30, EDGES_MOST = 240, EDGES_LEAST = 12 };

#define SHORTEST_PX 10.0
#define ALONG 0.25	   /* share of an edge at each end that the squares' corners blur */
#define ACROSS 0.4	   /* width of the profile to each side, as a share of the edge's length */
#define ACROSS_MOST 16.0   /* px */
#define MARKER_BITS_MOST 9 /* across a marker, its black rim included, which is one bit wide */
#define CONTRAST 0.1	   /* of linear light, least */
#define BRIGHTEST 0.97	   /* code values above may be clipped */
#define SIGMA_LEAST 0.02   /* px: narrower is not told from sharp */
#define SHARP 0.1	   /* px: an edge of less spread counts as sharp where the fit fails */
#define PROJECTED 0.02	   /* px: least width of a pixel's projection on either side */

struct edge_sample {
	double along, across, light;
};

struct edge {
	double a, b; /* projections of a pixel's sides on the edge's normal, px */
	/* distance of a marker's ink inside the paper, px, about; 0: there is none */
	double marker;
	int count;
	struct edge_sample sample[SAMPLES_MOST];
};

/* Second integral of a Gaussian of deviation s. */
static double edge_ramp(double v, double s)
{
	const double n = v / s;

	return ((v * v + s * s) * 0.5 * erfc(-n * M_SQRT1_2) +
		v * s * exp(-0.5 * n * n) / sqrt(2 * M_PI)) /
	       2;
}

/* E(d) of a Gaussian and a pixel's square, whose projection is the convolution of boxes of widths a
 * and b. */
static double edge_of(const struct edge *e, double d, double s)
{
	const double wide = (e->a + e->b) / 2, narrow = (e->a - e->b) / 2;

	return (edge_ramp(d + wide, s) - edge_ramp(d + narrow, s) - edge_ramp(d - narrow, s) +
		edge_ramp(d - wide, s)) /
	       (e->a * e->b);
}

/* Share of the light of the side with d > 0. */
static double edge_share(const struct edge *e, const double *x, double d, double s)
{
	const double share = edge_of(e, d, s);

	if (!(e->marker > 0))
		return share;
	return x[HIGH] > x[LOW] ? share - edge_of(e, d - x[MARKER], s)
				: 1 + share - edge_of(e, d + x[MARKER], s);
}

static bool edge_evaluate(void *context, const double *x, double *residual)
{
	const struct edge *e = context;
	const double s = fmax(fabs(x[SIGMA]), SIGMA_LEAST);

	for (int i = 0; i < e->count; i++) {
		const struct edge_sample *p = &e->sample[i];
		const double d = p->across - x[PLACE] - x[TILT] * p->along;

		residual[i] = x[LOW] + (x[HIGH] - x[LOW]) * edge_share(e, x, d, s) - p->light;
	}
	return true;
}

/* Collects the pixels around the middle of the edge from p to q. */
static void edge_collect(struct edge *e, const struct image *picture, const struct board *board,
			 const double p[2], const double q[2])
{
	const double length = hypot(q[0] - p[0], q[1] - p[1]);
	const double to[2] = {(q[0] - p[0]) / length, (q[1] - p[1]) / length};
	const double middle[2] = {(p[0] + q[0]) / 2, (p[1] + q[1]) / 2};
	const double half = (0.5 - ALONG) * length;
	const double paper = (1 - board->marker_mm / board->step_mm) / 2 * length;
	const double ink = board->marker_mm / board->step_mm / MARKER_BITS_MOST * length;
	const bool charuco = board->kind == BOARD_CHARUCO;
	const double wide = fmin(charuco ? paper + ink / 2 : ACROSS * length, ACROSS_MOST);
	const int reach = (int)ceil(hypot(wide, half));

	*e = (struct edge){.a = fmax(fabs(to[1]), PROJECTED),
			   .b = fmax(fabs(to[0]), PROJECTED),
			   .marker = charuco ? paper : 0};
	for (int y = (int)middle[1] - reach; y <= (int)middle[1] + reach; y++)
		for (int x = (int)middle[0] - reach; x <= (int)middle[0] + reach; x++) {
			const double dx = x + 0.5 - middle[0], dy = y + 0.5 - middle[1];
			struct edge_sample *s = &e->sample[e->count];
			const uint8_t *code;

			if (x < 0 || y < 0 || x >= picture->width || y >= picture->height ||
			    e->count == SAMPLES_MOST)
				continue;
			s->along = dx * to[0] + dy * to[1];
			s->across = dy * to[0] - dx * to[1];
			if (fabs(s->along) > half || fabs(s->across) > wide)
				continue;
			code = picture->u8 + 3 * ((size_t)y * (size_t)picture->width + (size_t)x);
			s->light = 0;
			for (int c = 0; c < 3; c++)
				s->light += transfer_decode(TRANSFER_SRGB, code[c] / 255.0) / 3;
			e->count++;
		}
}

/* First guess: the means of both sides. False: there is no edge. */
static bool edge_guess(const struct edge *e, double x[UNKNOWNS])
{
	double sum[2] = {0, 0};
	int count[2] = {0, 0};

	for (int i = 0; i < e->count; i++) {
		const int side = e->sample[i].across > 0;

		if (e->sample[i].light > BRIGHTEST)
			return false;
		sum[side] += e->sample[i].light;
		count[side]++;
	}
	if (e->count < SAMPLES_LEAST || !count[0] || !count[1])
		return false;
	x[LOW] = sum[0] / count[0];
	x[HIGH] = sum[1] / count[1];
	x[PLACE] = x[TILT] = 0;
	x[SIGMA] = 0.7;
	x[MARKER] = e->marker;
	return fabs(x[HIGH] - x[LOW]) > CONTRAST;
}

/* Fits an edge. Returns its sigma, px; negative: it cannot be told. */
static double edge_fit(struct edge *e)
{
	static const double scale[UNKNOWNS] = {0.1, 0.1, 0.1, 0.01, 0.1, 0.1};
	const bool fixed[UNKNOWNS] = {[MARKER] = !(e->marker > 0)};
	const struct least_squares problem = {.parameters = UNKNOWNS,
					      .residuals = e->count,
					      .evaluate = edge_evaluate,
					      .context = e,
					      .scale = scale,
					      .fixed = fixed,
					      .group = 1};
	struct least_squares_fit fit = {.freedom = 0};
	double x[UNKNOWNS], wide = 0, sigma = -1;
	int err;

	if (!edge_guess(e, x))
		return -1;
	for (int i = 0; i < e->count; i++)
		wide = fmax(wide, e->sample[i].across);
	err = least_squares_solve(&problem, x, &fit, NULL);
	if (fabs(x[SIGMA]) > wide / 2.5 || fabs(x[PLACE]) > wide / 2 ||
	    fabs(x[HIGH] - x[LOW]) < CONTRAST)
		sigma = -1;
	else if (!err)
		sigma = fabs(x[SIGMA]);
	else if (fabs(x[SIGMA]) < SHARP)
		sigma = 0; /* where an edge is sharp, the sum of squares is flat */
	least_squares_free(&fit);
	return sigma;
}

static bool are_neighbours(const struct observation *p, const struct observation *q, double step)
{
	double square = 0;

	for (int i = 0; i < 3; i++)
		square += (p->world[i] - q->world[i]) * (p->world[i] - q->world[i]);
	return fabs(sqrt(square) / step - 1) < 1e-3 &&
	       hypot(p->px[0] - q->px[0], p->px[1] - q->px[1]) >= SHORTEST_PX;
}

static int by_size(const void *a, const void *b)
{
	const double x = *(const double *)a, y = *(const double *)b;

	return (x > y) - (x < y);
}

static double median_of(double *value, int count)
{
	qsort(value, (size_t)count, sizeof(*value), by_size);
	return (value[(count - 1) / 2] + value[count / 2]) / 2;
}

/* The median; the deviation of a median of normal values, theirs from the median of distances:
 *     deviation = sqrt(pi / 2) 1.4826 MAD / sqrt(count) */
static void edges_conclude(struct camera_edges *edges, double *sigma, int count)
{
	*edges = (struct camera_edges){.count = 0};
	if (count < EDGES_LEAST)
		return;
	edges->count = count;
	edges->sigma_px = median_of(sigma, count);
	for (int i = 0; i < count; i++)
		sigma[i] = fabs(sigma[i] - edges->sigma_px);
	edges->deviation_px = sqrt(M_PI / 2) * 1.4826 * median_of(sigma, count) / sqrt(count);
}

/* Pairs of neighbouring corners. */
struct neighbours {
	const struct observations *seen;
	double step;
	int *first, *second; /* [room]; NULL: they are only counted */
};

/* Lists them in the order of views and points. Returns how many there are. */
static int neighbours_list(const struct neighbours *n)
{
	int count = 0;

	for (int v = 0; v < n->seen->views; v++) {
		const int begin = n->seen->view[v].first;
		const int end = begin + n->seen->view[v].count;

		for (int i = begin; i < end; i++)
			for (int j = i + 1; j < end; j++) {
				if (!are_neighbours(&n->seen->point[i], &n->seen->point[j],
						    n->step))
					continue;
				if (n->first) {
					n->first[count] = i;
					n->second[count] = j;
				}
				count++;
			}
	}
	return count;
}

int camera_edges_measure(const struct observations *seen, const struct image *picture,
			 const struct board *board, struct camera_edges *edges)
{
	struct neighbours n = {.seen = seen, .step = board->step_mm * board->unit};
	const int all = neighbours_list(&n), most = all < EDGES_MOST ? all : EDGES_MOST;
	struct edge *edge = malloc(sizeof(*edge));
	double sigma[EDGES_MOST];
	int count = 0, err = 0;

	*edges = (struct camera_edges){.count = 0};
	n.first = calloc(2 * (size_t)all + 1, sizeof(*n.first));
	if (!edge || !n.first) {
		err = -ENOMEM;
		goto out;
	}
	n.second = n.first + all;
	neighbours_list(&n);
	for (int k = 0; k < most; k++) {
		const int at = (int)((long)k * all / most);
		const struct observation *p = &seen->point[n.first[at]];

		if (!picture[p->view].u8)
			continue;
		edge_collect(edge, &picture[p->view], board, p->px, seen->point[n.second[at]].px);
		sigma[count] = edge_fit(edge);
		count += sigma[count] >= 0;
	}
	edges_conclude(edges, sigma, count);
	if (edges->sigma_px > TSAI_EDGE_SPREAD_MAX)
		edges->count = 0;
out:
	free(edge);
	free(n.first);
	return err;
}
