/* SPDX-License-Identifier: MIT */
#include "hal/compositor/light/light_vector.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "hal/basis/basis_layout.h"
#include "hal/compositor/kernels/digits.h"
#include "hal/compositor/kernels/fixed.h"

/* Fraction bits of X beyond those that the roundings of N lights need. */
#define SPARE_BITS 15
/* The sum of a channel's X stays below 2^SUM_BITS. */
#define SUM_BITS 45
/* The same for D and U. A receiver's pixel may get only a millionth of all light, so X has as many
 * bits as fit. */
#define RECEIVER_BITS 44
/* e of compositor.h: 2^-20 of the sum of u. */
#define RESIDUE 0x1p-20
/* U + e up to this counts as 0: no scene has a ground so dark, and 1 / NO_GROUND is finite. */
#define NO_GROUND 0x1p-900
/* Exponent that stands for no light: less than that of the smallest float times the smallest cell.
 * */
#define DARK (-300)

static int padded(int count, int step)
{
	return (count + step - 1) / step * step;
}

static void *lines_of(size_t count, size_t bytes)
{
	const size_t whole = (count * bytes + BASIS_ALIGN - 1) / BASIS_ALIGN * BASIS_ALIGN;
	void *memory = aligned_alloc(BASIS_ALIGN, whole);

	return memory ? memset(memory, 0, whole) : NULL;
}

int light_vector_create(struct light_vector *v, const struct light_terms *terms)
{
	const size_t n = (size_t)terms->lights, k = (size_t)terms->coarse;
	const int stride = padded((int)k, BASIS_LINE16);
	bool fine;

	*v = (struct light_vector){
		.lights = (int)n, .coarse = (int)k, .stride = stride, .terms = terms};
	v->sent = lines_of((size_t)light_terms_lamp(terms) + (size_t)terms->lamps,
			   sizeof(*v->sent));
	v->digits = lines_of(3 * KERNEL_DIGITS * (size_t)stride, sizeof(*v->digits));
	fine = v->sent && v->digits;
	for (int c = 0; c < 3; c++) {
		v->y[c] = lines_of(k, sizeof(*v->y[c]));
		fine = fine && v->y[c];
	}
	if (!fine) {
		light_vector_free(v);
		return -ENOMEM;
	}
	for (int c = 0; c < 3; c++) {
		for (int d = 0; d < KERNEL_DIGITS; d++)
			v->planes[c].digit[d] = v->digits + (c * KERNEL_DIGITS + d) * stride;
	}
	return 0;
}

void light_vector_free(struct light_vector *v)
{
	free(v->sent);
	free(v->digits);
	for (int c = 0; c < 3; c++)
		free(v->y[c]);
	*v = (struct light_vector){0};
}

int gain_bits(double gain)
{
	return gain > 1 ? exponent_above(gain) : 0;
}

static int count_bits(int count)
{
	return exponent_above(count);
}

/* ---- X ---- */

/* The light that arrives, and its weights, by channels. */
struct arriving {
	const double (*radiance)[3];
	double more[3]; /* ambient, and e of U */
	const double *weight[3];
};

/* Computes X of light i before rounding, weight * (L + more), and adds it to part. */
static inline void weigh_light(struct light_sent *restrict sent, const struct arriving *from, int i,
			       double part[3])
{
	double x[3];

	for (int c = 0; c < 3; c++)
		x[c] = from->weight[c][i] * (from->radiance[i][c] + from->more[c]);
	for (int c = 0; c < 3; c++) {
		sent[i].amount[c] = x[c];
		part[c] += x[c];
	}
}

/* The same for all lights; sum: over all lights, in each channel. */
static void weigh_lights(struct light_sent *restrict sent, const struct arriving *light, int count,
			 double sum[3])
{
	const struct arriving from = *light;
	const int whole = count / LIGHT_PARTS * LIGHT_PARTS;
	double a[3] = {0}, b[3] = {0}, c[3] = {0}, d[3] = {0};

	for (int i = 0; i < whole; i += LIGHT_PARTS) {
		weigh_light(sent, &from, i, a);
		weigh_light(sent, &from, i + 1, b);
		weigh_light(sent, &from, i + 2, c);
		weigh_light(sent, &from, i + 3, d);
	}
	for (int i = whole; i < count; i++)
		weigh_light(sent, &from, i, a);
	for (int k = 0; k < 3; k++)
		sum[k] = light_parts(a[k], b[k], c[k], d[k]);
}

/* Adds X of the lamps before rounding, and to the sums. */
static void weigh_lamps(struct light_vector *v, const struct light_order *order,
			const struct light_selection *lights, double sum[3])
{
	struct light_sent *sent = v->sent + light_terms_lamp(v->terms);

	for (int l = 0; l < v->terms->lamps; l++)
		for (int c = 0; c < 3; c++) {
			const double unit = order->kind == BASIS_KIND_V
						    ? v->terms->lamp_ground[l][c]
						    : 1;

			sent[l].amount[c] = unit * fmax(lights->lamp[l][c], 0);
			sum[c] += sent[l].amount[c];
		}
}

/* The integer X = round(amount * 2^up * 2^bits). */
struct rounding {
	int bits[3], up[3];
	double share[3]; /* change of O, or of 1 - ratio, by a column of value 1 per amount of 1 */
};

/* Rounds X of all lights. Treats strength, which is computed later, as a fourth channel, because
 * four doubles are whole vectors. */
static void round_lights(struct light_sent *restrict sent, int count, const double factor[4],
			 const double unit[4])
{
	double *restrict x = (double *)sent;

	_Static_assert(sizeof(*sent) == 4 * sizeof(*x), "four doubles");
	for (int i = 0; i < 4 * count; i += 4) {
		for (int c = 0; c < 4; c++)
			x[i + c] = round_narrow(x[i + c] * factor[c]) * unit[c];
	}
}

/* Bound for light_vector.strongest. All roundings of X and Y together are less than N units; the
 * relative error of sums of doubles is far below 1e-6. */
static double strongest_of(const struct light_vector *v, const double sum[3],
			   const struct rounding *how)
{
	double strongest = 0;

	for (int c = 0; c < 3; c++) {
		const double all = sum[c] * power_of_two(how->up[c]) +
				   (v->lights + v->terms->lamps) * power_of_two(-how->bits[c]);

		strongest = fmax(strongest, how->share[c] * all * (1 + 1e-6));
	}
	return strongest;
}

/* ---- strength ---- */

static inline double strength_of(const double amount[3], const double worth[3])
{
	const double r = fabs(amount[0]) * worth[0], g = fabs(amount[1]) * worth[1],
		     b = fabs(amount[2]) * worth[2];
	const double most = r > g ? r : g;

	return most > b ? most : b;
}

/* Limit of 1 / cut: no file has a cut so small, and no product overflows. */
#define WORTH_MOST 0x1p900

/* worth = share / cut: the strength of an amount of 1, in each channel. */
static void worth_of(double cut, const struct rounding *how, double worth[3])
{
	const double per_cut = cut * WORTH_MOST > 1 ? 1 / cut : WORTH_MOST;

	for (int c = 0; c < 3; c++)
		worth[c] = how->share[c] * per_cut;
}

static void round_all(struct light_vector *v, const struct rounding *how, bool cut)
{
	struct light_sent *lamp = v->sent + light_terms_lamp(v->terms);
	double factor[4] = {0}, unit[4] = {0}, worth[3];

	for (int c = 0; c < 3; c++) {
		v->unit[c] = unit[c] = power_of_two(-how->bits[c]);
		factor[c] = power_of_two(how->bits[c] + how->up[c]);
	}
	worth_of(v->terms->basis->info.column_cut, how, worth);
	round_lights(v->sent, v->lights, factor, unit);
	for (int i = 0; i < v->lights && cut; i++)
		v->sent[i].strength = strength_of(v->sent[i].amount, worth);
	round_lights(lamp, v->terms->lamps, factor, unit);
	for (int l = 0; l < v->terms->lamps; l++) {
		lamp[l].strength = strength_of(lamp[l].amount, worth);
		for (int c = 0; c < 3; c++)
			v->lamp_share[l][c] = (float)(lamp[l].amount[c] * how->share[c]);
	}
}

/* ---- groups ---- */

/* Computes S of each group and X - q S of each light. These are no integers, but the same on every
 * machine. */
static void part_groups(struct light_vector *v, const struct light_order *order,
			const struct rounding *how)
{
	const struct basis_groups *groups = &v->terms->groups;
	const size_t grounds = v->terms->basis->info.grounds;
	const size_t row = order->kind == BASIS_KIND_V ? (size_t)order->ground : grounds;
	const double *share = v->terms->share + row * (size_t)v->lights;
	struct light_sent *beside = v->sent + v->lights, *even = beside + v->lights;
	const double cut = v->terms->basis->info.column_cut;
	double worth[3], worth_even[3], most[3];

	worth_of(cut, how, worth);
	worth_of(basis_group_cut(groups, cut), how, worth_even);
	for (int c = 0; c < 3; c++)
		most[c] = worth_even[c] > 0 ? BASIS_GROUP_MOST / worth_even[c] : 0;
	for (int k = 0; k < groups->count; k++) {
		basis_group_even(groups, k, share, (const double(*)[4])v->sent, most,
				 even[k].amount);
		even[k].strength = strength_of(even[k].amount, worth_even);
	}
	for (int i = 0; i < v->lights; i++) {
		const double *own = v->sent[i].amount, *common = even[groups->of[i]].amount;
		double x[3];

		for (int c = 0; c < 3; c++)
			x[c] = own[c] - share[i] * common[c];
		beside[i] = (struct light_sent){{x[0], x[1], x[2]}, strength_of(x, worth)};
	}
}

/* ---- Y ---- */

/* A double holds integers up to 2^NARROW_BITS exactly. */
#define NARROW_BITS 53

static void gather_narrow(struct light_vector *v, const double one[3])
{
	const struct light_terms *t = v->terms;

	for (int k = 0; k < v->coarse; k++) {
		double sum[3] = {0};

		for (uint32_t n = t->first[k]; n < t->first[k + 1]; n++) {
			const double *x = v->sent[t->light[n]].amount;
			const double weight = t->weight[n];

			for (int c = 0; c < 3; c++)
				sum[c] += x[c] * weight;
		}
		for (int c = 0; c < 3; c++)
			v->y[c][k] = round_shift((int64_t)(sum[c] * one[c]), 15);
	}
}

static void gather_wide(struct light_vector *v, const double one[3])
{
	const struct light_terms *t = v->terms;

	for (int k = 0; k < v->coarse; k++) {
		int64_t sum[3] = {0};

		for (uint32_t n = t->first[k]; n < t->first[k + 1]; n++) {
			for (int c = 0; c < 3; c++)
				sum[c] += (int64_t)(v->sent[t->light[n]].amount[c] * one[c]) *
					  (int64_t)t->weight[n];
		}
		for (int c = 0; c < 3; c++)
			v->y[c][k] = round_shift(sum[c], 15);
	}
}

static void copy_lights(struct light_vector *v, const double one[3])
{
	for (int k = 0; k < v->coarse; k++) {
		for (int c = 0; c < 3; c++)
			v->y[c][k] = (int64_t)(v->sent[k].amount[c] * one[c]);
	}
}

static void split_channel(struct light_vector *v, int c)
{
	const int64_t *y = v->y[c];
	int64_t most = 0;

	for (int k = 0; k < v->coarse; k++)
		most = y[k] > most ? y[k] : most;
	v->planes[c].digits = digits_of(most);
	for (int d = 0; d < v->planes[c].digits; d++)
		digits_split(y, v->coarse, d, v->digits + (c * KERNEL_DIGITS + d) * v->stride);
}

/* Computes Y and its digits. x_bits: the sum of integers X in any channel is below 2^x_bits. */
static void make_planes(struct light_vector *v, int x_bits)
{
	const double one[3] = {1 / v->unit[0], 1 / v->unit[1], 1 / v->unit[2]};

	if (!v->terms->first)
		copy_lights(v, one);
	else if (x_bits + 15 <= NARROW_BITS)
		gather_narrow(v, one);
	else
		gather_wide(v, one);
	for (int c = 0; c < 3; c++)
		split_channel(v, c);
}

/* ---- a frame ---- */

/* Chooses the fraction bits of T, D and U: as many as keep the sum below 2^room, but at most
 * `most`. Returns the bits of the largest sum of X. */
static int plan_weighted(struct light_vector *v, const double sum[3], int most, int room,
			 struct rounding *how)
{
	int x_bits = count_bits(v->lights + v->terms->lamps);

	v->reach = DARK;
	for (int c = 0; c < 3; c++) {
		const int exponent = sum[c] > 0 ? ilogb(sum[c]) + 1 : DARK;
		const int bits = most < room - exponent ? most : room - exponent;

		/* Very weak light: rounding may double X, and then Y. */
		v->reach = v->reach < exponent + 2 ? exponent + 2 : v->reach;
		x_bits = x_bits < exponent + bits ? exponent + bits : x_bits;
		how->bits[c] = bits;
	}
	return x_bits;
}

static int plan_object(struct light_vector *v, const double sum[3], double gain,
		       struct rounding *how)
{
	const int up = gain_bits(gain);

	for (int c = 0; c < 3; c++) {
		how->share[c] = gain;
		v->factor[c] = (uint32_t)round_double(ldexp(gain, 30 - up));
	}
	return plan_weighted(v, sum, SPARE_BITS + count_bits(v->lights + v->terms->lamps) + up,
			     SUM_BITS, how);
}

static int plan_ground(struct light_vector *v, const double sum[3], int ground,
		       struct rounding *how)
{
	const int bits = SPARE_BITS + count_bits(v->lights + v->terms->lamps);

	for (int c = 0; c < 3; c++) {
		const double there = sum[c] + RESIDUE * v->terms->ground_sum[ground][c];
		const int exponent = there > NO_GROUND ? ilogb(there) : 0;

		how->bits[c] = bits;
		how->up[c] = -exponent;
		/* Where no light arrives, the object takes none away. */
		how->share[c] = there > NO_GROUND ? 1 / (there * power_of_two(-exponent)) : 0;
		v->factor[c] = (uint32_t)round_double(ldexp(how->share[c], 30));
	}
	v->reach = 2;
	return bits + 1;
}

void light_vector_make(struct light_vector *v, const struct light_order *order,
		       const struct light_selection *lights)
{
	struct arriving from = {.radiance = (const double(*)[3])lights->radiance};
	struct rounding how = {.up = {0}};
	double sum[3];
	int x_bits;

	for (int c = 0; c < 3; c++) {
		from.more[c] = lights->ambient[c] + (order->kind == BASIS_KIND_U ? RESIDUE : 0);
		from.weight[c] = order->kind == BASIS_KIND_V
					 ? basis_ground(v->terms->basis, order->ground, c)
					 : v->terms->solid_angle;
	}
	weigh_lights(v->sent, &from, v->lights, sum);
	weigh_lamps(v, order, lights, sum);
	switch (order->kind) {
	case BASIS_KIND_T:
		x_bits = plan_object(v, sum, order->gain, &how);
		break;
	case BASIS_KIND_V:
		x_bits = plan_ground(v, sum, order->ground, &how);
		break;
	default:
		x_bits = plan_weighted(v, sum, RECEIVER_BITS - DARK, RECEIVER_BITS, &how);
		break;
	}
	v->strongest = strongest_of(v, sum, &how);
	round_all(v, &how, order->cut);
	if (order->groups)
		part_groups(v, order, &how);
	if (order->patterns)
		make_planes(v, x_bits + 1); /* + 1: for N roundings of 1/2 */
}
