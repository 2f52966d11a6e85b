#include "bake/encode.h"

#include <errno.h>
#include <float.h>
#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "bake/encode_rest.h"
#include "bake/encode_values.h"
#include "hal/basis/basis_layout.h"

#define TILE_PIXELS (BASIS_TILE * BASIS_TILE)
#define VALUE_MAX 1e30F /* so that no sum of a few overflows */

/* What a difference of floats may be off by, of itself; generously. */
#define FLOAT_ERROR 0x1p-20

struct buffer {
	void *data;
	size_t room;
};

struct encoder {
	struct encode_settings settings;
	double (*ground_sum)[3]; /* [grounds] */
	struct rest rest;
	struct buffer rows;  /* int16 [pixels * channels][columns]: quantised */
	float *mean;	     /* [lights] */
	float *light_peak;   /* [lights]: largest |value| of any row */
	uint16_t *light;     /* [lights]: the list */
	uint16_t *column;    /* [lights]: where in the rows each of the list is */
	float *picked;	     /* [lights]: a row's columns */
	int16_t *light_bits; /* [lights]: by column, all rows' values or-ed */
	float scale[TILE_PIXELS * 3];
	bool keep[TILE_PIXELS];
	struct buffer blocks;	/* struct basis_block_payload [] */
	struct buffer *payload; /* [payload_count] */
	int payload_count;
};

/* What the first look at the samples finds. */
struct survey {
	float pixel_peak[TILE_PIXELS];
	float channel_spread; /* largest |value - mean of the three channels| */
};

/* How samples become a block. */
struct plan {
	int pixels, channels;
	int lights;	/* of e->light */
	bool rest;	/* the last of them is the rest */
	double dropped; /* largest |value - what stands for it| of what is not listed */
};

static int reserve(struct buffer *buffer, size_t bytes)
{
	void *data;

	if (bytes <= buffer->room)
		return 0;
	data = realloc(buffer->data, bytes);
	if (!data)
		return -ENOMEM;
	buffer->data = data;
	buffer->room = bytes;
	return 0;
}

int encoder_create(struct encoder **encoder, const struct encode_settings *settings)
{
	const size_t n = (size_t)settings->lights, grounds = (size_t)settings->grounds;
	struct encoder *e = calloc(1, sizeof(*e));

	*encoder = NULL;
	if (!e)
		return -ENOMEM;
	e->settings = *settings;
	e->ground_sum = calloc(grounds + 1, sizeof(*e->ground_sum));
	e->mean = calloc(n, sizeof(*e->mean));
	e->light_peak = calloc(n, sizeof(*e->light_peak));
	e->light_bits = calloc(n, sizeof(*e->light_bits));
	e->light = calloc(n, sizeof(*e->light));
	e->column = calloc(n, sizeof(*e->column));
	e->picked = calloc(n, sizeof(*e->picked));
	if (rest_create(&e->rest, settings->lights) < 0 || !e->ground_sum || !e->mean ||
	    !e->light_peak || !e->light_bits || !e->light || !e->column || !e->picked) {
		encoder_destroy(e);
		return -ENOMEM;
	}
	for (size_t g = 0; g < grounds * 3; g++) {
		for (size_t i = 0; i < n; i++)
			e->ground_sum[g / 3][g % 3] += settings->ground[g * n + i];
	}
	*encoder = e;
	return 0;
}

void encoder_destroy(struct encoder *e)
{
	if (!e)
		return;
	for (int i = 0; i < e->payload_count; i++)
		free(e->payload[i].data);
	free(e->payload);
	free(e->blocks.data);
	free(e->rows.data);
	free(e->ground_sum);
	free(e->mean);
	free(e->light_peak);
	free(e->light_bits);
	free(e->light);
	free(e->column);
	free(e->picked);
	rest_free(&e->rest);
	free(e);
}

static int look(struct encoder *e, const struct encode_samples *s, struct survey *found)
{
	const int n = e->settings.lights;

	memset(e->light_peak, 0, (size_t)n * sizeof(*e->light_peak));
	found->channel_spread = 0;
	for (int p = 0; p < s->pixels; p++) {
		const float *value = s->value + (size_t)p * 3 * (size_t)n;

		found->pixel_peak[p] = values_peak(value, 3 * n);
		if (!(found->pixel_peak[p] <= VALUE_MAX))
			return -EDOM;
		if (s->kind == BASIS_KIND_U && values_any_negative(value, 3 * n))
			return -EDOM;
		if (s->kind == BASIS_KIND_V) {
			const float spread = values_mean_of_channels(e->mean, value, n);

			if (spread > found->channel_spread)
				found->channel_spread = spread;
			for (int c = 0; c < 3; c++)
				values_raise_peaks(e->light_peak, value + (size_t)c * (size_t)n, n);
		} else if (!(found->channel_spread > 0) && !values_channels_equal(value, n)) {
			found->channel_spread = INFINITY;
		}
	}
	return 0;
}

/* The columns of a V row: of the lights listed, and of the rest. */
static const float *pick(struct encoder *e, const struct plan *plan, const float *value, float rest)
{
	const int listed = plan->lights - plan->rest;

	for (int k = 0; k < listed; k++)
		e->picked[k] = value[e->light[k]];
	if (plan->rest)
		e->picked[listed] = rest;
	return e->picked;
}

/* Every kept pixel's rows, and which columns are anywhere non-zero. */
static double quantise_all(struct encoder *e, const struct encode_samples *s,
			   const struct plan *plan)
{
	const int n = e->settings.lights;
	int16_t *row = e->rows.data;
	float *scale = e->scale;
	double error = 0;

	memset(e->light_bits, 0, (size_t)plan->lights * sizeof(*e->light_bits));
	for (int p = 0; p < s->pixels; p++) {
		const float *value = s->value + (size_t)p * 3 * (size_t)n;

		if (!e->keep[p])
			continue;
		if (plan->channels == 1 && s->kind == BASIS_KIND_V) {
			values_mean_of_channels(e->mean, value, n);
			value = e->mean;
		}
		for (int c = 0; c < plan->channels; c++, row += plan->lights, value += n) {
			const float *from = value;

			if (s->kind == BASIS_KIND_V)
				from = pick(e, plan, value, e->rest.value[p][c]);
			error = fmax(error, values_quantise(row, scale++, from, plan->lights));
			for (int k = 0; k < plan->lights; k++)
				e->light_bits[k] |= row[k];
		}
	}
	return error;
}

static size_t block_bytes(const struct encode_samples *s, const struct plan *plan, int lights)
{
	return basis_layout(s->kind, plan->pixels, plan->channels, lights).bytes;
}

/* Lights of V that are not near 0 or, when that lists so few that the block is smaller, those that
 * are not near the others, and the rest. All lights of other kinds. */
static void choose_lights(struct encoder *e, const struct encode_samples *s, struct plan *plan)
{
	const double cut = s->kind == BASIS_KIND_V ? e->settings.ratio_cut : -1;
	const int n = e->settings.lights;
	double dropped = 0;

	plan->lights = 0;
	plan->rest = false;
	for (int i = 0; i < n; i++) {
		if ((double)e->light_peak[i] > cut)
			e->light[plan->lights++] = (uint16_t)i;
		else
			dropped = fmax(dropped, (double)e->light_peak[i]);
	}
	if (s->kind == BASIS_KIND_V) {
		rest_choose(&e->rest, s, e->keep,
			    e->settings.ground + (size_t)s->ground * 3 * (size_t)n, cut,
			    plan->channels == 1);
		plan->rest = e->rest.listed + 1 < plan->lights &&
			     block_bytes(s, plan, e->rest.listed + 1) <
				     block_bytes(s, plan, plan->lights);
	}
	if (plan->rest) {
		dropped = e->rest.error * (1 + FLOAT_ERROR);
		plan->lights = 0;
		for (int i = 0; i < n; i++) {
			if (!e->rest.shares[i])
				e->light[plan->lights++] = (uint16_t)i;
		}
		e->light[plan->lights++] = (uint16_t)n;
	}
	plan->dropped = fmax(plan->dropped, dropped);
}

/* Lights whose rows came out as zeros leave the list; but not where a rest would stand for them. */
static void drop_zeros(struct encoder *e, struct plan *plan)
{
	int count = 0;

	for (int k = 0; k < plan->lights; k++) {
		if (!plan->rest && !e->light_bits[k])
			continue;
		e->light[count] = e->light[k];
		e->column[count++] = (uint16_t)k;
	}
	plan->lights = count;
}

static int32_t row_sum(const int16_t *row, int n)
{
	int32_t sum = 0;

	for (int i = 0; i < n; i++)
		sum += row[i];
	return sum;
}

static int32_t ground_total(const struct encoder *e, const struct encode_samples *s, int channel,
			    const int16_t *row, const struct plan *plan)
{
	const size_t g = (size_t)s->ground * 3 + (size_t)channel;
	const double *u = e->settings.ground + g * (size_t)e->settings.lights;
	const double all = e->ground_sum[s->ground][channel];
	const int count = plan->lights - plan->rest;
	double sum = 0, listed = 0;

	for (int i = 0; i < count; i++) {
		sum += row[i] * u[e->light[i]];
		listed += u[e->light[i]];
	}
	if (plan->rest)
		sum += row[count] * fmax(all - listed, 0);
	return all > 0 ? (int32_t)lrint(32768 * (sum / all)) : 0;
}

static void fill_rows(const struct encoder *e, const struct plan *plan, int columns,
		      const struct basis_layout *at, uint8_t *payload)
{
	const int16_t *from = e->rows.data;
	int16_t *to = (int16_t *)(payload + at->row);

	for (int r = 0; r < plan->pixels * plan->channels; r++, from += columns, to += at->stride) {
		for (int k = 0; k < plan->lights; k++)
			to[k] = from[e->column[k]];
	}
}

static void fill_totals(const struct encoder *e, const struct encode_samples *s,
			const struct plan *plan, const struct basis_layout *at, uint8_t *payload)
{
	const int16_t *row = (const int16_t *)(payload + at->row);
	int32_t *total = (int32_t *)(payload + at->total);

	for (int r = 0; r < plan->pixels * at->total_channels; r++) {
		const int c = r % at->total_channels;
		const int16_t *own = row;

		if (at->total_channels != plan->channels)
			own += (size_t)(r / at->total_channels) * (size_t)at->stride;
		else
			own += (size_t)r * (size_t)at->stride;
		total[r] = s->kind == BASIS_KIND_V ? ground_total(e, s, c, own, plan)
						   : row_sum(own, plan->lights);
	}
}

static int build(struct encoder *e, const struct encode_samples *s, const struct plan *plan,
		 int columns, int tile, struct encode_result *result)
{
	const size_t rows = (size_t)plan->pixels * (size_t)plan->channels;
	const struct basis_layout at = basis_layout(s->kind, plan->pixels, plan->channels,
						    plan->lights);
	struct basis_block_payload *block =
		&((struct basis_block_payload *)e->blocks.data)[result->count];
	struct buffer *buffer = &e->payload[result->count];
	uint16_t *pixel;
	uint8_t *payload;
	int ret = reserve(buffer, at.bytes);

	if (ret < 0)
		return ret;
	payload = buffer->data;
	memset(payload, 0, at.bytes);
	*block = (struct basis_block_payload){
		.payload = payload,
		.entry = {.tile = (uint32_t)tile,
			  .kind = (uint16_t)s->kind,
			  .encoding = BASIS_ENCODING_DENSE,
			  .pixels = (uint16_t)plan->pixels,
			  .channels = (uint16_t)plan->channels,
			  .lights = (uint32_t)plan->lights,
			  .bytes = at.bytes,
			  .ground = s->kind == BASIS_KIND_V ? (uint32_t)s->ground : 0},
	};
	pixel = (uint16_t *)(payload + at.pixel);
	for (int p = 0; p < s->pixels; p++) {
		if (e->keep[p])
			*pixel++ = s->pixel[p];
	}
	memcpy(payload + at.light, e->light, (size_t)plan->lights * sizeof(*e->light));
	memcpy(payload + at.scale, e->scale, rows * sizeof(*e->scale));
	fill_rows(e, plan, columns, &at, payload);
	fill_totals(e, s, plan, &at, payload);
	result->count++;
	return 0;
}

static void choose_pixels(struct encoder *e, const struct encode_samples *s,
			  const struct survey *found, struct plan *plan)
{
	const double cut = s->kind == BASIS_KIND_V ? e->settings.ratio_cut : 0;

	plan->pixels = 0;
	plan->dropped = 0;
	for (int p = 0; p < s->pixels; p++) {
		const double peak = (double)found->pixel_peak[p];

		if (s->kind != BASIS_KIND_U) /* which follows its D */
			e->keep[p] = peak > cut && peak / ENCODE_ROW_MAX >= (double)FLT_MIN;
		if (e->keep[p])
			plan->pixels++;
		else
			plan->dropped = fmax(plan->dropped, peak);
	}
}

/* The bound of the errors that the plan made; step is that of rounding. */
static double error_of(const struct encode_samples *s, const struct survey *found,
		       const struct plan *plan, double step)
{
	double listed = step;

	if (plan->channels == 1 && s->kind == BASIS_KIND_V)
		listed += (double)found->channel_spread * (1 + FLOAT_ERROR);
	return fmax(listed, plan->dropped + (plan->rest ? step : 0));
}

static int encode_samples(struct encoder *e, int tile, const struct encode_samples *s,
			  struct encode_result *result)
{
	const double cut = s->kind == BASIS_KIND_V ? e->settings.ratio_cut : 0;
	struct survey found;
	struct plan plan;
	double error;
	int columns, ret = look(e, s, &found);

	if (ret < 0)
		return ret;
	choose_pixels(e, s, &found, &plan);
	error = plan.dropped;
	if (plan.pixels) {
		plan.channels = (double)found.channel_spread <= cut ? 1 : 3;
		choose_lights(e, s, &plan);
		columns = plan.lights;
		ret = reserve(&e->rows, (size_t)(plan.pixels * plan.channels) * (size_t)columns *
						sizeof(int16_t));
		if (ret < 0)
			return ret;
		error = error_of(s, &found, &plan, quantise_all(e, s, &plan));
		drop_zeros(e, &plan);
		if (plan.lights == 0 && s->kind == BASIS_KIND_U) {
			/* Light 0 with a row of zeros: a D block must have its U. */
			e->light[plan.lights] = 0;
			e->column[plan.lights++] = 0;
		}
		if (plan.lights) {
			ret = build(e, s, &plan, columns, tile, result);
			if (ret < 0)
				return ret;
		}
	}
	if (s->kind == BASIS_KIND_T)
		result->object_error = fmax(result->object_error, error);
	if (s->kind == BASIS_KIND_V)
		result->ratio_error = fmax(result->ratio_error, error);
	return 0;
}

static bool pairs(const struct encode_samples *samples, int count)
{
	for (int i = 0; i < count; i++) {
		const struct encode_samples *s = &samples[i];
		const bool owed = i && samples[i - 1].kind == BASIS_KIND_D;

		if (owed != (s->kind == BASIS_KIND_U))
			return false;
		if (owed && (s->pixels != samples[i - 1].pixels ||
			     memcmp(s->pixel, samples[i - 1].pixel,
				    (size_t)s->pixels * sizeof(*s->pixel)) != 0))
			return false;
	}
	return !count || samples[count - 1].kind != BASIS_KIND_D;
}

static int reserve_blocks(struct encoder *e, int count)
{
	struct buffer *payload;

	if (count <= e->payload_count)
		return 0;
	payload = realloc(e->payload, (size_t)count * sizeof(*payload));
	if (!payload)
		return -ENOMEM;
	memset(payload + e->payload_count, 0,
	       (size_t)(count - e->payload_count) * sizeof(*payload));
	e->payload = payload;
	e->payload_count = count;
	return reserve(&e->blocks, (size_t)count * sizeof(struct basis_block_payload));
}

int encode_tile(struct encoder *e, int tile, const struct encode_samples *samples, int count,
		struct encode_result *result)
{
	int ret;

	*result = (struct encode_result){0};
	if (!pairs(samples, count))
		return -EINVAL;
	ret = reserve_blocks(e, count);
	if (ret < 0)
		return ret;
	for (int i = 0; i < count; i++) {
		ret = encode_samples(e, tile, &samples[i], result);
		if (ret < 0)
			return ret;
	}
	result->blocks = e->blocks.data;
	return 0;
}
