/* SPDX-License-Identifier: MIT */
#include "hal/colour/transfer.h"

#include <errno.h>
#include <math.h>
#include <stddef.h>
#include <string.h>

const char *const transfer_names[] = {"srgb", "bt709", "linear", NULL};

/*
 * Both curves are a line up to a knee and a power above it:
 *     encoded = slope * x                                 x <= knee
 *     encoded = (1 + offset) * x^(1 / power) - offset     x > knee
 * The standards print the knees rounded, which leaves a step there and no inverse across it. The
 * constants below make the pieces meet: for sRGB the knee follows from 12.92 and 1.055 (printed
 * 0.0031308; the step was 3e-8); for BT.709 knee and offset follow from equal value and slope, as
 * BT.2020 gives to more digits (printed 0.018 and 1.099; the step was 2e-4).
 */
#define SRGB_KNEE 0.0031306684425006340328
#define SRGB_SLOPE 12.92
#define SRGB_OFFSET 0.055
#define SRGB_POWER 2.4
#define BT709_KNEE 0.018053968510807807336
#define BT709_SLOPE 4.5
#define BT709_OFFSET 0.099296826809442940347
#define BT709_POWER (1 / 0.45)

struct standard_curve {
	double knee, slope, offset, power;
};

static const struct standard_curve curves[] = {
	[TRANSFER_SRGB] = {SRGB_KNEE, SRGB_SLOPE, SRGB_OFFSET, SRGB_POWER},
	[TRANSFER_BT709] = {BT709_KNEE, BT709_SLOPE, BT709_OFFSET, BT709_POWER},
};

/* Clamps to 0..1; NaN becomes 0. */
static double clamp01(double x)
{
	return x > 0 ? fmin(x, 1) : 0;
}

double transfer_decode(enum transfer t, double encoded)
{
	const double e = clamp01(encoded);
	const struct standard_curve *c;

	if (t == TRANSFER_LINEAR)
		return e;
	c = &curves[t];
	if (e <= c->slope * c->knee)
		return e / c->slope;
	return clamp01(pow((e + c->offset) / (1 + c->offset), c->power));
}

double transfer_encode(enum transfer t, double linear)
{
	const double l = clamp01(linear);
	const struct standard_curve *c;
	double p;

	if (t == TRANSFER_LINEAR)
		return l;
	c = &curves[t];
	if (l <= c->knee)
		return l * c->slope;
	p = pow(l, 1 / c->power);
	return clamp01(p + c->offset * (p - 1)); /* this form gives exactly 1 for 1 */
}

/* ---- measured curves: x counts intervals between knots, slopes are per interval ---- */

#define LAST (TRANSFER_KNOTS - 1)

static double step_of(const struct transfer_curve *m, int k)
{
	return m->knot[k + 1] - m->knot[k];
}

/* Slope at the first or last knot: that of the parabola through the three knots there, clamped to
 * step / 4..2 * step. */
static double end_slope(double step, double next)
{
	return fmin(fmax(1.5 * step - 0.5 * next, step / 4), 2 * step);
}

static double slope_at(const struct transfer_curve *m, int k)
{
	double before, after;

	if (k == 0)
		return end_slope(step_of(m, 0), step_of(m, 1));
	if (k == LAST)
		return end_slope(step_of(m, LAST - 1), step_of(m, LAST - 2));
	before = step_of(m, k - 1);
	after = step_of(m, k);
	return fmin((before + after) / 2, 2 * fmin(before, after));
}

/* Cubic of one interval: value = y + t (a + t (b + t c)), t in 0..1. */
struct cubic {
	double y, a, b, c;
};

static struct cubic cubic_of(const struct transfer_curve *m, int k)
{
	const double step = step_of(m, k), from = slope_at(m, k), to = slope_at(m, k + 1);

	return (struct cubic){m->knot[k], from, 3 * step - 2 * from - to, from + to - 2 * step};
}

static double cubic_at(const struct cubic *q, double t)
{
	return q->y + t * (q->a + t * (q->b + t * q->c));
}

static double measured_decode(const struct transfer_curve *m, double e)
{
	const double x = e * LAST;
	const int k = (int)fmin(x, LAST - 1);
	const struct cubic q = cubic_of(m, k);

	return clamp01(cubic_at(&q, x - k));
}

/* Solves cubic_at(q, t) = value for t in 0..1: Newton's method, with bisection where a step leaves
 * the bracket. */
static double cubic_root(const struct cubic *q, double value)
{
	double low = 0, high = 1, t = 0.5;

	for (int i = 0; i < 60 && high - low > 1e-15; i++) {
		const double off = cubic_at(q, t) - value;
		const double next = t - off / (q->a + t * (2 * q->b + t * 3 * q->c));

		if (off > 0)
			high = t;
		else
			low = t;
		if (fabs(next - t) < 1e-15)
			break;
		t = next > low && next < high ? next : (low + high) / 2;
	}
	return t;
}

static double measured_encode(const struct transfer_curve *m, double linear)
{
	int low = 0, high = LAST;
	struct cubic q;

	if (linear >= 1)
		return 1;
	while (high - low > 1) {
		const int middle = (low + high) / 2;

		if (m->knot[middle] <= linear)
			low = middle;
		else
			high = middle;
	}
	q = cubic_of(m, low);
	if (linear <= q.y)
		return (double)low / LAST;
	return (low + cubic_root(&q, linear)) / LAST;
}

/* ---- a camera's curve ---- */

double transfer_curve_decode(const struct transfer_curve *curve, double code)
{
	const double black = curve->black / 255;
	const double e = clamp01((clamp01(code) - black) / (1 - black));

	return curve->measured ? measured_decode(curve, e) : transfer_decode(curve->named, e);
}

double transfer_curve_encode(const struct transfer_curve *curve, double linear)
{
	const double l = clamp01(linear);
	const double e = curve->measured ? measured_encode(curve, l)
					 : transfer_encode(curve->named, l);

	return curve->black > 0 ? (curve->black + (255 - curve->black) * e) / 255 : e;
}

bool transfer_curve_same(const struct transfer_curve *a, const struct transfer_curve *b)
{
	if (a->measured != b->measured || a->black != b->black)
		return false;
	return a->measured ? memcmp(a->knot, b->knot, sizeof(a->knot)) == 0 : a->named == b->named;
}

int transfer_curve_check(const struct transfer_curve *curve, struct fault *fault)
{
	if (!(curve->black >= 0 && curve->black <= 254))
		return fault_say(fault, -EINVAL, "black level is %g, expected 0 to 254",
				 curve->black);
	if (!curve->measured && (curve->named < 0 || curve->named >= TRANSFER_COUNT))
		return fault_say(fault, -EINVAL,
				 "transfer %d is unknown, expected srgb, bt709 or linear",
				 (int)curve->named);
	if (!curve->measured)
		return 0;
	if (curve->knot[0] != 0 || curve->knot[LAST] != 1)
		return fault_say(fault, -EINVAL,
				 "response runs from %g to %g, expected from 0 to 1",
				 curve->knot[0], curve->knot[LAST]);
	for (int k = 1; k < TRANSFER_KNOTS; k++)
		if (!(curve->knot[k] > curve->knot[k - 1]))
			return fault_say(
				fault, -EINVAL,
				"response does not rise from number %d (%g) to number %d (%g), expected ascending numbers",
				k, curve->knot[k - 1], k + 1, curve->knot[k]);
	return 0;
}

void transfer_tables_fill(struct transfer_tables *tables, const struct transfer_curve *curve)
{
	for (int i = 0; i < 256; i++)
		tables->decode[i] =
			(uint16_t)lround(65535 * transfer_curve_decode(curve, i / 255.0));
	for (int i = 0; i < 65536; i++)
		tables->encode[i] =
			(uint8_t)lround(255 * transfer_curve_encode(curve, i / 65535.0));
}

static uint8_t code_of_linear(const struct transfer_tables *tables, float linear)
{
	/* Written so that a NaN is black. */
	if (!(linear > 0))
		return tables->encode[0];
	return tables->encode[linear < 1 ? (int)(linear * 65535 + 0.5f) : 65535];
}

void encode_row(const struct transfer_tables *tables, const float *rgb, int pixels, uint8_t *bgrx)
{
	for (int x = 0; x < pixels; x++, rgb += 3, bgrx += 4) {
		bgrx[0] = code_of_linear(tables, rgb[2]);
		bgrx[1] = code_of_linear(tables, rgb[1]);
		bgrx[2] = code_of_linear(tables, rgb[0]);
		bgrx[3] = 255;
	}
}
