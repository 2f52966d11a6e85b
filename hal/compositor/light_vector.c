#include "hal/compositor/light_vector.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "hal/basis/basis_layout.h"
#include "hal/compositor/digits.h"
#include "hal/compositor/fixed.h"

/* Fraction bits of X beyond those that N roundings take up. */
#define SPARE_BITS 15
/* The sum of a channel's X stays below 2^SUM_BITS. */
#define SUM_BITS 45
/* Of receivers, where a pixel may see but a millionth of all light: all there is room for. */
#define RECEIVER_BITS 44
/* e of compositor.h: 2^-20 of the sum of u. */
#define RESIDUE 0x1p-20
/* U + e of a ground that no light can reach: no scene has one so dark, and its inverse is finite.
 */
#define NO_GROUND 0x1p-900
/* The exponent of no light: below that of the least float times the smallest cell. */
#define DARK (-300)

static int padded(int count, int step)
{
	return (count + step - 1) / step * step;
}

int light_vector_create(struct light_vector *v, const struct basis *basis)
{
	const size_t n = basis->info.lights, k = basis->info.coarse;
	const int stride = padded((int)k, BASIS_LINE16);
	const size_t bytes = sizeof(int16_t) * 3 * KERNEL_DIGITS * (size_t)stride;

	*v = (struct light_vector){.lights = (int)n, .coarse = (int)k, .stride = stride};
	v->amount = calloc(n, sizeof(*v->amount));
	v->strength = calloc(n, sizeof(*v->strength));
	v->before = calloc(n, sizeof(*v->before));
	v->changed = calloc(n, sizeof(*v->changed));
	v->bright = calloc((n + 63) / 64 * BRIGHT_CLASSES, sizeof(*v->bright));
	v->x = calloc(n, sizeof(*v->x));
	v->y = calloc(k, sizeof(*v->y));
	v->digits = aligned_alloc(BASIS_ALIGN, bytes);
	if (!v->before || !v->changed || !v->amount || !v->strength || !v->bright || !v->x ||
	    !v->y || !v->digits) {
		light_vector_free(v);
		return -ENOMEM;
	}
	memset(v->digits, 0, bytes);
	for (int c = 0; c < 3; c++) {
		for (int d = 0; d < KERNEL_DIGITS; d++)
			v->planes[c].digit[d] = v->digits + (c * KERNEL_DIGITS + d) * stride;
	}
	return 0;
}

void light_vector_free(struct light_vector *v)
{
	free(v->amount);
	free(v->strength);
	free(v->before);
	free(v->changed);
	free(v->bright);
	free(v->x);
	free(v->y);
	free(v->digits);
	*v = (struct light_vector){0};
}

int bright_class(float reach)
{
	const int k = reach > 0 ? exponent_above((double)reach) - BRIGHT_LEAST : 0;

	return k < 0 ? 0 : k < BRIGHT_CLASSES ? k : BRIGHT_CLASSES - 1;
}

/* The least class of blocks that may need a light: with strength below 2^e no column that reaches
 * 2^-e does. */
static int class_of_strength(float strength)
{
	uint32_t bits;
	int k;

	memcpy(&bits, &strength, sizeof(bits)); /* frexpf() takes longer than all else here */
	k = 1 - ((int)(bits >> 23) - 126) - BRIGHT_LEAST;
	return k < 0 ? 0 : k < BRIGHT_CLASSES ? k : BRIGHT_CLASSES - 1;
}

/* Marks each light in its class, and then in all above it. */
static void mark_bright(struct light_vector *v)
{
	const size_t words = (size_t)(v->lights + 63) / 64;

	memset(v->bright, 0, sizeof(*v->bright) * words * BRIGHT_CLASSES);
	for (int i = 0; i < v->lights; i++) {
		if (v->strength[i] > 0)
			v->bright[(size_t)class_of_strength(v->strength[i]) * words +
				  (size_t)i / 64] |= UINT64_C(1) << i % 64;
	}
	for (size_t k = words; k < words * BRIGHT_CLASSES; k++)
		v->bright[k] |= v->bright[k - words];
}

void light_vector_track(struct light_vector *v)
{
	v->changed_count = v->lit = 0;
	for (int i = 0; i < v->lights; i++) {
		const double *now = v->amount[i];
		double *before = v->before[i];

		v->lit += now[0] > 0 || now[1] > 0 || now[2] > 0;
		if (now[0] != before[0] || now[1] != before[1] || now[2] != before[2])
			v->changed[v->changed_count++] = i;
		memcpy(before, now, sizeof(v->before[i]));
	}
}

int gain_bits(double gain)
{
	return gain > 1 ? exponent_above(gain) : 0;
}

static int count_bits(int count)
{
	return exponent_above(count);
}

/* Y from X, one channel, as digits. */
static void gather(struct light_vector *v, const struct basis *basis, int c)
{
	const int64_t *y = v->x;
	int64_t most = 0;

	if (basis->coarse) {
		memset(v->y, 0, sizeof(*v->y) * (size_t)v->coarse);
		for (int i = 0; i < v->lights; i++) {
			const struct basis_coarse *g = &basis->coarse[i];

			for (int j = 0; j < 3; j++)
				v->y[g->index[j]] += v->x[i] * g->weight[j];
		}
		for (int k = 0; k < v->coarse; k++)
			v->y[k] = round_shift(v->y[k], 15);
		y = v->y;
	}
	for (int k = 0; k < v->coarse; k++)
		most = y[k] > most ? y[k] : most;
	v->planes[c].digits = digits_of(most);
	for (int d = 0; d < v->planes[c].digits; d++)
		digits_split(y, v->coarse, d, v->digits + (c * KERNEL_DIGITS + d) * v->stride);
}

/* X of a channel from v->amount, which is then what X stands for. */
static void round_channel(struct light_vector *v, const struct basis *basis, int c, int bits)
{
	const double one = power_of_two(bits);

	v->unit[c] = power_of_two(-bits);
	for (int i = 0; i < v->lights; i++) {
		v->x[i] = round_double(v->amount[i][c] * one);
		v->amount[i][c] = (double)v->x[i] * v->unit[c];
	}
	gather(v, basis, c);
}

static double channel_sum(const struct light_vector *v, int c)
{
	double sum = 0;

	for (int i = 0; i < v->lights; i++)
		sum += v->amount[i][c];
	return sum;
}

/* What a column of value 1 changes, by what may be left out. */
static void set_strength(struct light_vector *v, const double share[3], double cut)
{
	for (int i = 0; i < v->lights; i++) {
		const double *x = v->amount[i];
		double most = 0;

		for (int c = 0; c < 3; c++)
			most = x[c] * share[c] > most ? x[c] * share[c] : most;
		v->strength[i] = most > 0 ? (float)(most / cut) : 0;
	}
	mark_bright(v);
}

static void fill_weighted(struct light_vector *v, const struct basis *basis,
			  const struct light_selection *lights, double more)
{
	for (int i = 0; i < v->lights; i++) {
		for (int c = 0; c < 3; c++)
			v->amount[i][c] = basis->lights[i].solid_angle_sr *
					  (lights->radiance[i][c] + lights->ambient[c] + more);
	}
}

/* most: fraction bits, fewer where the light is so strong that X would exceed its range. */
static void round_weighted(struct light_vector *v, const struct basis *basis, int most, int room)
{
	v->reach = DARK;
	for (int c = 0; c < 3; c++) {
		const double sum = channel_sum(v, c);
		const int exponent = sum > 0 ? ilogb(sum) + 1 : DARK;

		/* Roundings may double X, and Y again, where nearly all is rounded off. */
		if (v->reach < exponent + 2)
			v->reach = exponent + 2;
		round_channel(v, basis, c, most < room - exponent ? most : room - exponent);
	}
}

void light_vector_object(struct light_vector *v, const struct basis *basis,
			 const struct light_selection *lights, double gain)
{
	const int up = gain_bits(gain);
	const double share[3] = {gain, gain, gain};

	fill_weighted(v, basis, lights, 0);
	round_weighted(v, basis, SPARE_BITS + count_bits(v->lights) + up, SUM_BITS);
	for (int c = 0; c < 3; c++)
		v->factor[c] = (uint32_t)round_double(ldexp(gain, 30 - up));
	set_strength(v, share, basis->info.column_cut);
}

void light_vector_receiver(struct light_vector *v, const struct basis *basis,
			   const struct light_selection *lights, bool residue)
{
	fill_weighted(v, basis, lights, residue ? RESIDUE : 0);
	round_weighted(v, basis, RECEIVER_BITS - DARK, RECEIVER_BITS);
}

void light_vector_ground(struct light_vector *v, const struct basis *basis,
			 const struct light_selection *lights, int ground)
{
	double share[3];

	v->reach = 2;
	for (int c = 0; c < 3; c++) {
		const double *u = basis_ground(basis, ground, c);
		double all = 0, there, scale;
		int exponent;

		for (int i = 0; i < v->lights; i++) {
			v->amount[i][c] = u[i] * (lights->radiance[i][c] + lights->ambient[c]);
			all += u[i];
		}
		there = channel_sum(v, c) + RESIDUE * all;
		exponent = there > NO_GROUND ? ilogb(there) : 0;
		scale = power_of_two(-exponent);
		for (int i = 0; i < v->lights; i++)
			v->amount[i][c] *= scale;
		round_channel(v, basis, c, SPARE_BITS + count_bits(v->lights));
		/* Where no light can arrive, nothing is taken away. */
		share[c] = there > NO_GROUND ? 1 / (there * scale) : 0;
		v->factor[c] = (uint32_t)round_double(ldexp(share[c], 30));
	}
	set_strength(v, share, basis->info.column_cut);
}
