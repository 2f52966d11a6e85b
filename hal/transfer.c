#include "hal/transfer.h"

#include <math.h>
#include <stddef.h>

const char *const transfer_names[] = {"srgb", "bt709", "linear", NULL};

/*
 * Both curves are a line up to a knee and a power above it. The standards print the knees rounded,
 * which leaves a step there and no inverse across it; these are the places where the printed
 * pieces truly meet: for sRGB that of 12.92 and 1.055 (printed 0.0031308; the step was 3e-8), for
 * BT.709 those of value and slope, as BT.2020 gives to more digits (printed 0.018 and 1.099; the
 * step was 2e-4).
 */
#define SRGB_KNEE 0.0031306684425006340328
#define SRGB_SLOPE 12.92
#define SRGB_OFFSET 0.055
#define SRGB_POWER 2.4
#define BT709_KNEE 0.018053968510807807336
#define BT709_SLOPE 4.5
#define BT709_OFFSET 0.099296826809442940347
#define BT709_POWER (1 / 0.45)

struct curve {
	double knee, slope, offset, power;
};

static const struct curve curves[] = {
	[TRANSFER_SRGB] = {SRGB_KNEE, SRGB_SLOPE, SRGB_OFFSET, SRGB_POWER},
	[TRANSFER_BT709] = {BT709_KNEE, BT709_SLOPE, BT709_OFFSET, BT709_POWER},
};

/* NaN counts as 0. */
static double clamp01(double x)
{
	return x > 0 ? fmin(x, 1) : 0;
}

double transfer_decode(enum transfer t, double encoded)
{
	const double e = clamp01(encoded);
	const struct curve *c;

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
	const struct curve *c;
	double p;

	if (t == TRANSFER_LINEAR)
		return l;
	c = &curves[t];
	if (l <= c->knee)
		return l * c->slope;
	p = pow(l, 1 / c->power);
	return clamp01(p + c->offset * (p - 1)); /* so that 1 gives 1 to the bit */
}

void transfer_tables_fill(struct transfer_tables *tables, enum transfer t)
{
	for (int i = 0; i < 256; i++)
		tables->decode[i] = (uint16_t)lround(65535 * transfer_decode(t, i / 255.0));
	for (int i = 0; i < 65536; i++)
		tables->encode[i] = (uint8_t)lround(255 * transfer_encode(t, i / 65535.0));
}
