/* SPDX-License-Identifier: MIT */
#include "bake/calibrate/fisheye/circle/fisheye_edge.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "bake/calibrate/estimate/order.h"

#define APART_PX 3.0 /* distance of pieces along the rim: neighbours share no pixels */
#define ALONG_PX 1.5 /* half the length of a piece */
#define DEPTH_PX 2.0 /* margin inside and outside of the places tried */
#define STEP_PX 0.25 /* step between places tried */
/* Relative deviation of the surroundings from the parabola. With it, nearly dark pixels count most:
 * the first light from outside marks the rim. */
#define UNEVEN 0.15
#define FITS_BEST 0.01	 /* least relative variance: no piece is trusted to fit better */
#define LEAST 1e-4	 /* least noise: rounding */
#define DARK_FROM_PX 3.0 /* distance from the rim where darkness is measured */
#define DARK_TO_PX 10.0
#define NARROWEST 0.02
#define DEVIATION_MOST 0.5 /* px: edges less certain are dropped */
#define CONTRAST_LEAST 5.0 /* least light at the edge, in its own deviations */
/* Error of the Gaussian as a model of blur, relative to the brightest pixel of a piece. */
#define SHAPE 0.05
#define PROBES 60      /* pieces used to estimate blur */
#define BLUR_WORTH 0.8 /* a blur must reduce the unexplained variance to this share */

enum { SAMPLES_MAX = 160, TERMS = 5, BOXES = 2 };

/* Blur by lens, focus and demosaicing: standard deviations that are tried, px, and number of
 * refinements between them. */
static const double blurs[] = {0, 0.3, 0.45, 0.6, 0.8, 1, 1.3, 1.6, 2};
#define HALVINGS 4

struct edge_sample {
	double inwards, along, light;
	double root; /* square root of its weight */
};

struct edge_piece {
	struct edge_sample sample[SAMPLES_MAX];
	int count, terms;
	/* widths of two boxes whose convolution is a pixel's footprint along the normal */
	double width[BOXES];
	double blur;  /* standard deviation, px; 0: only the pixel itself */
	double shape; /* error of the blur's shape: SHAPE, or 0 without blur */
};

/* Result of a fit at one place. */
struct found {
	double at, squares;
	double term[TERMS];
};

/* A step, a ramp and a parabola u^2 / 2, each convolved with two boxes. */
static void soften_by_boxes(const double width[BOXES], double x, double soft[3])
{
	const double unit = width[0] * width[1];

	soft[0] = soft[1] = soft[2] = 0;
	for (int corner = 0; corner < 1 << BOXES; corner++) {
		double at = x, sign = 1, power;

		for (int k = 0; k < BOXES; k++) {
			const double side = corner >> k & 1 ? -1 : 1;

			at += side * width[k] / 2;
			sign *= side;
		}
		if (at <= 0)
			continue;
		power = sign * at * at / 2;
		soft[0] += power;
		soft[1] += power * at / 3;
		soft[2] += power * at * at / 12;
	}
	for (int k = 0; k < 3; k++)
		soft[k] /= unit;
}

/* The same, convolved with a Gaussian; a pixel adds its variance, 1/12 whatever the normal. */
static void soften_by_gaussian(double deviation, double x, double soft[3])
{
	const double wide = sqrt(deviation * deviation + 1.0 / 12);
	const double below = erfc(-x / wide * M_SQRT1_2) / 2;
	const double at = wide * exp(-x * x / (2 * wide * wide)) / sqrt(2 * M_PI);

	soft[0] = below;
	soft[1] = x * below + at;
	soft[2] = ((x * x + wide * wide) * below + x * at) / 2;
}

static void row_of(const struct edge_piece *piece, const struct edge_sample *s, double at,
		   double row[TERMS])
{
	double soft[3];

	if (piece->blur > 0)
		soften_by_gaussian(piece->blur, s->inwards - at, soft);
	else
		soften_by_boxes(piece->width, s->inwards - at, soft);
	row[0] = s->root;
	row[1] = s->root * soft[0];
	row[2] = s->root * soft[1];
	row[3] = s->root * soft[0] * s->along;
	row[4] = s->root * soft[2];
}

/* Cholesky factorisation of a symmetric matrix in place; false: singular. */
static bool factor_normal(double a[TERMS + 1][TERMS + 1], int n)
{
	for (int j = 0; j < n; j++) {
		const double before = a[j][j];

		for (int k = 0; k < j; k++)
			a[j][j] -= a[j][k] * a[j][k];
		if (!(a[j][j] > 1e-10 * before))
			return false;
		a[j][j] = sqrt(a[j][j]);
		for (int i = j + 1; i < n; i++) {
			for (int k = 0; k < j; k++)
				a[i][j] -= a[i][k] * a[j][k];
			a[i][j] /= a[j][j];
		}
	}
	return true;
}

static void solve_normal(double a[TERMS + 1][TERMS + 1], int n, double *x)
{
	for (int i = 0; i < n; i++) {
		for (int k = 0; k < i; k++)
			x[i] -= a[i][k] * x[k];
		x[i] /= a[i][i];
	}
	for (int i = n - 1; i >= 0; i--) {
		for (int k = i + 1; k < n; k++)
			x[i] -= a[k][i] * x[k];
		x[i] /= a[i][i];
	}
}

/* Fits the levels for an edge at this place; infinite squares: singular. */
static struct found edge_fit_at(const struct edge_piece *piece, double at)
{
	double a[TERMS + 1][TERMS + 1] = {{0}}, row[TERMS];
	struct found found = {.at = at, .squares = INFINITY};

	for (int n = 0; n < piece->count; n++) {
		row_of(piece, &piece->sample[n], at, row);
		for (int i = 0; i < piece->terms; i++) {
			found.term[i] += row[i] * piece->sample[n].root * piece->sample[n].light;
			for (int j = 0; j <= i; j++)
				a[i][j] += row[i] * row[j];
		}
	}
	if (!factor_normal(a, piece->terms))
		return found;
	solve_normal(a, piece->terms, found.term);
	found.squares = 0;
	for (int n = 0; n < piece->count; n++) {
		double r = piece->sample[n].root * piece->sample[n].light;

		row_of(piece, &piece->sample[n], at, row);
		for (int i = 0; i < piece->terms; i++)
			r -= row[i] * found.term[i];
		found.squares += r * r;
	}
	return found;
}

/* Finds the best place: in steps, then by parabolas through three places, with ever smaller
 * steps. */
static bool edge_fit(const struct edge_piece *piece, double reach, struct found *best)
{
	*best = (struct found){.squares = INFINITY};
	for (double at = -reach; at <= reach; at += STEP_PX) {
		const struct found found = edge_fit_at(piece, at);

		if (found.squares < best->squares)
			*best = found;
	}
	if (isinf(best->squares) || fabs(best->at) > reach - STEP_PX / 2)
		return false;
	for (double step = STEP_PX; step > 1e-3; step /= 4) {
		const struct found less = edge_fit_at(piece, best->at - step);
		const struct found more = edge_fit_at(piece, best->at + step);
		const double bend = less.squares + more.squares - 2 * best->squares;
		struct found next;

		if (!(bend > 0) || isinf(bend))
			return isfinite(bend);
		next = edge_fit_at(
			piece, best->at + fmin(fmax(step / 2 * (less.squares - more.squares) / bend,
						    -step),
					       step));
		if (next.squares < best->squares)
			*best = next;
	}
	return true;
}

/* Computes the deviations of the place and of the light at the edge, for a given variance of a
 * sample. */
static bool edge_deviations(const struct edge_piece *piece, const struct found *best,
			    double variance, double *place, double *light)
{
	double a[TERMS + 1][TERMS + 1] = {{0}}, unit[TERMS + 1];
	const int n = piece->terms + 1;

	for (int k = 0; k < piece->count; k++) {
		double row[TERMS + 1], before[TERMS], after[TERMS];

		row_of(piece, &piece->sample[k], best->at, row);
		row_of(piece, &piece->sample[k], best->at - 1e-3, before);
		row_of(piece, &piece->sample[k], best->at + 1e-3, after);
		row[n - 1] = 0;
		for (int i = 0; i < piece->terms; i++)
			row[n - 1] += best->term[i] * (after[i] - before[i]) / 2e-3;
		for (int i = 0; i < n; i++)
			for (int j = 0; j <= i; j++)
				a[i][j] += row[i] * row[j];
	}
	if (!factor_normal(a, n))
		return false;
	memset(unit, 0, sizeof(unit));
	unit[n - 1] = 1;
	solve_normal(a, n, unit);
	*place = sqrt(variance * unit[n - 1]);
	memset(unit, 0, sizeof(unit));
	unit[1] = 1;
	solve_normal(a, n, unit);
	*light = sqrt(variance * unit[1]);
	return true;
}

/* Collects the pixels near a place of the rim. False: too few, or the picture ends there. */
static bool gather_light(struct edge_piece *piece, const struct rim *rim, const double ellipse[4],
			 const double at[2], const double normal[2], double reach_px)
{
	const double deep = reach_px + DEPTH_PX + 2 * piece->blur;
	const double around = deep + ALONG_PX + 1;
	double brightest = 0;

	piece->count = 0;
	for (int k = 0; k < BOXES; k++)
		piece->width[k] = fmax(fabs(normal[k]), NARROWEST);
	if (at[0] - around < 0 || at[1] - around < 0 || at[0] + around > rim->width ||
	    at[1] + around > rim->height)
		return false;
	for (int y = (int)(at[1] - around); y <= at[1] + around && y < rim->height; y++)
		for (int x = (int)(at[0] - around); x <= at[0] + around && x < rim->width; x++) {
			const double px[2] = {x + 0.5, y + 0.5};
			const double along = normal[0] * (px[1] - at[1]) -
					     normal[1] * (px[0] - at[0]);
			const double inwards = -ellipse_distance(ellipse, px);
			const float light = rim->light[(size_t)y * (size_t)rim->width + (size_t)x];

			if (fabs(along) > ALONG_PX || fabs(inwards) > deep)
				continue;
			if (rim->codes && light > RIM_CLIPPED)
				continue;
			if (piece->count == SAMPLES_MAX)
				return false;
			piece->sample[piece->count++] = (struct edge_sample){inwards, along, light,
									     1};
			brightest = fmax(brightest, light - rim->dark);
		}
	for (int n = 0; n < piece->count; n++) {
		struct edge_sample *s = &piece->sample[n];

		s->root = 1 / hypot(hypot(fmax(rim->noise, LEAST), piece->shape * brightest),
				    UNEVEN * (s->light - rim->dark));
	}
	return piece->count > 2 * (TERMS + 1);
}

/* Collects the piece at an angle of the ellipse. */
static bool gather_at(struct edge_piece *piece, const struct rim *rim, const double ellipse[4],
		      double turn, double reach_px, double at[2], double normal[2])
{
	at[0] = ellipse[0] + ellipse[2] * cos(turn);
	at[1] = ellipse[1] + ellipse[3] * sin(turn);
	ellipse_normal(ellipse, at, normal);
	return gather_light(piece, rim, ellipse, at, normal, reach_px);
}

static bool place_edge(struct edge_piece *piece, const struct rim *rim, const double ellipse[4],
		       double turn, double reach_px, struct rim_edge *edge)
{
	struct found plain, bent;
	double at[2], normal[2], variance, light, deviation;

	edge->clipped = false;
	if (!gather_at(piece, rim, ellipse, turn, reach_px, at, normal))
		return false;
	piece->terms = TERMS - 1;
	if (!edge_fit(piece, reach_px, &plain))
		return false;
	variance = fmax(plain.squares / (piece->count - TERMS), FITS_BEST);
	if (!edge_deviations(piece, &plain, variance, &deviation, &light) ||
	    plain.term[1] < CONTRAST_LEAST * light)
		return false;
	piece->terms = TERMS;
	if (!edge_fit(piece, reach_px, &bent))
		return false;
	edge->deviation = hypot(deviation, bent.at - plain.at);
	for (int i = 0; i < 2; i++)
		edge->px[i] = at[i] - bent.at * normal[i];
	return edge->deviation < DEVIATION_MOST;
}

/* Measures the darkness around the ellipse and its noise, by median and quartiles. */
static int look_outside(struct rim *rim, const double ellipse[ELLIPSE_NUMBERS])
{
	const size_t room = (size_t)rim->width * (size_t)rim->height;
	float *light = malloc(room * sizeof(*light));
	size_t count = 0;

	if (!light)
		return -ENOMEM;
	for (size_t p = 0; p < room; p++) {
		const double px[2] = {(double)(p % (size_t)rim->width) + 0.5,
				      (double)(p / (size_t)rim->width) + 0.5};
		const double away = ellipse_distance(ellipse, px);

		if (away > DARK_FROM_PX && away < DARK_TO_PX)
			light[count++] = rim->light[p];
	}
	qsort(light, count, sizeof(*light), order_floats);
	if (count > 0) {
		rim->dark = light[count / 2];
		rim->noise = (light[count * 3 / 4] - light[count / 4]) / 1.35;
	}
	free(light);
	return 0;
}

/* Median variance that edges with this blur leave unexplained; infinite: no piece is seen. */
static double unexplained_squares(struct edge_piece *piece, const struct rim *rim,
				  const double ellipse[4], double reach_px, double deviation)
{
	double variance[PROBES];
	int count = 0;

	piece->blur = deviation;
	piece->shape = SHAPE; /* the same for all, so that they compare */
	for (int k = 0; k < PROBES; k++) {
		double at[2], normal[2];
		struct found found;

		piece->terms = TERMS - 1;
		if (!gather_at(piece, rim, ellipse, 2 * M_PI * k / PROBES, reach_px, at, normal))
			continue;
		edge_fit(piece, reach_px, &found);
		if (isfinite(found.squares))
			variance[count++] = found.squares / (piece->count - TERMS);
	}
	if (!count)
		return INFINITY;
	qsort(variance, (size_t)count, sizeof(*variance), order_doubles);
	return variance[count / 2];
}

/* Estimates the blur; 0 unless a blur explains the rim clearly better. */
static void find_blur(struct edge_piece *piece, struct rim *rim, const double ellipse[4],
		      double reach_px)
{
	const double none = unexplained_squares(piece, rim, ellipse, reach_px, 0);
	const size_t count = sizeof(blurs) / sizeof(*blurs);
	double best = INFINITY, is = 0;

	for (size_t k = 1; k < count; k++) {
		const double left = unexplained_squares(piece, rim, ellipse, reach_px, blurs[k]);

		is = left < best ? blurs[k] : is;
		best = fmin(best, left);
	}
	for (int k = 0, away = 8; k < HALVINGS; k++, away *= 2)
		for (int side = -1; side <= 1; side += 2) {
			const double other = is * (1 + (double)side / away);
			const double left = unexplained_squares(piece, rim, ellipse, reach_px,
								other);

			is = left < best ? other : is;
			best = fmin(best, left);
		}
	rim->blur = piece->blur = best < BLUR_WORTH * none ? is : 0;
	piece->shape = rim->blur > 0 ? SHAPE : 0;
}

int edges_place(struct rim *rim, const double ellipse[ELLIPSE_NUMBERS], double reach_px)
{
	const int pieces = (int)(M_PI * (ellipse[2] + ellipse[3]) / APART_PX);
	struct rim_edge *edge = calloc((size_t)pieces, sizeof(*edge));
	struct edge_piece *piece = calloc(1, sizeof(*piece));

	if (!edge || !piece) {
		free(edge);
		free(piece);
		return -ENOMEM;
	}
	free(rim->edge);
	rim->edge = edge;
	rim->count = 0;
	if (look_outside(rim, ellipse)) {
		free(piece);
		return -ENOMEM;
	}
	find_blur(piece, rim, ellipse, reach_px);
	for (int k = 0; k < pieces; k++)
		if (place_edge(piece, rim, ellipse, 2 * M_PI * k / pieces, reach_px,
			       &edge[rim->count]))
			rim->count++;
	free(piece);
	return 0;
}
