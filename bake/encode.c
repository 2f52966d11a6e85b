#include "bake/encode.h"

#include <errno.h>
#include <float.h>
#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "hal/basis/basis_layout.h"

#define TILE_PIXELS (BASIS_TILE * BASIS_TILE)
#define ROW_MAX 32767
#define VALUE_MAX 1e30F /* so that no sum of a few overflows */

/* Of |value - scale * row| in units of scale: half a step, and what float arithmetic adds to it
 * (hal/basis/README.md). */
#define STEP_ERROR 0.52

struct buffer {
	void *data;
	size_t room;
};

struct encoder {
	struct encode_settings settings;
	double (*ground_sum)[3]; /* [grounds] */
	struct buffer rows;	 /* int16 [pixels * channels][lights]: all lights, quantised */
	float *mean;		 /* [lights] */
	float *light_peak;	 /* [lights]: largest |value| of any row */
	int16_t *light_bits;	 /* [lights]: all rows' values or-ed */
	uint16_t *light;	 /* [lights]: the list */
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
	if (!e->ground_sum || !e->mean || !e->light_peak || !e->light_bits || !e->light) {
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
	free(e);
}

/* The largest |value|, as bits: so that infinities and NaN come out on top. */
static uint32_t peak_bits(const float *value, int count)
{
	int32_t peak = 0;

	for (int i = 0; i < count; i++) {
		int32_t bits;

		memcpy(&bits, &value[i], sizeof(bits));
		bits &= INT32_MAX;
		peak = bits > peak ? bits : peak;
	}
	return (uint32_t)peak;
}

static bool any_negative(const float *value, int count)
{
	int any = 0;

	for (int i = 0; i < count; i++)
		any |= value[i] < 0;
	return any;
}

static void raise_peaks(float *peak, const float *value, int count)
{
	for (int i = 0; i < count; i++) {
		const float magnitude = fabsf(value[i]);

		peak[i] = magnitude > peak[i] ? magnitude : peak[i];
	}
}

/* Fills mean; returns the largest distance of a channel from it. */
static float mean_of_channels(float *mean, const float *value, int n)
{
	const float *r = value, *g = value + n, *b = value + 2 * (size_t)n;
	float spread = 0;

	for (int i = 0; i < n; i++) {
		/* Exactly theirs where all three are equal. */
		const float m = r[i] + ((g[i] - r[i]) + (b[i] - r[i])) * (1.0F / 3);
		const float dr = fabsf(r[i] - m), dg = fabsf(g[i] - m), db = fabsf(b[i] - m);
		const float rg = dr > dg ? dr : dg;
		const float d = rg > db ? rg : db;

		mean[i] = m;
		spread = d > spread ? d : spread;
	}
	return spread;
}

static bool channels_equal(const float *value, int n)
{
	const size_t bytes = (size_t)n * sizeof(*value);

	return memcmp(value, value + n, bytes) == 0 &&
	       memcmp(value, value + 2 * (size_t)n, bytes) == 0;
}

static int look(struct encoder *e, const struct encode_samples *s, struct survey *found)
{
	const int n = e->settings.lights;

	memset(e->light_peak, 0, (size_t)n * sizeof(*e->light_peak));
	found->channel_spread = 0;
	for (int p = 0; p < s->pixels; p++) {
		const float *value = s->value + (size_t)p * 3 * (size_t)n;
		const uint32_t bits = peak_bits(value, 3 * n);

		memcpy(&found->pixel_peak[p], &bits, sizeof(bits));
		if (!(found->pixel_peak[p] <= VALUE_MAX))
			return -EDOM;
		if (s->kind == BASIS_KIND_U && any_negative(value, 3 * n))
			return -EDOM;
		if (s->kind == BASIS_KIND_V) {
			const float spread = mean_of_channels(e->mean, value, n);

			if (spread > found->channel_spread)
				found->channel_spread = spread;
			for (int c = 0; c < 3; c++)
				raise_peaks(e->light_peak, value + (size_t)c * (size_t)n, n);
		} else if (!(found->channel_spread > 0) && !channels_equal(value, n)) {
			found->channel_spread = INFINITY;
		}
	}
	return 0;
}

/* Row and scale of some values; the error bound is returned. A row too faint for a normal float as
 * its scale becomes zeros. */
static double quantise(int16_t *row, float *scale, const float *value, int n)
{
	const uint32_t bits = peak_bits(value, n);
	float peak, inverse;

	memcpy(&peak, &bits, sizeof(peak));
	*scale = peak / ROW_MAX;
	if (*scale < FLT_MIN) {
		*scale = 0;
		memset(row, 0, (size_t)n * sizeof(*row));
		return (double)peak;
	}
	inverse = 1 / *scale;
	for (int i = 0; i < n; i++) {
		const float x = value[i] * inverse;

		row[i] = (int16_t)(int)(x + copysignf(0.5F, x));
	}
	return STEP_ERROR * (double)*scale;
}

/* Every kept pixel's rows, all lights, and which lights are anywhere non-zero. */
static double quantise_all(struct encoder *e, const struct encode_samples *s, int channels)
{
	const int n = e->settings.lights;
	int16_t *row = e->rows.data;
	float *scale = e->scale;
	double error = 0;

	memset(e->light_bits, 0, (size_t)n * sizeof(*e->light_bits));
	for (int p = 0; p < s->pixels; p++) {
		const float *value = s->value + (size_t)p * 3 * (size_t)n;

		if (!e->keep[p])
			continue;
		if (channels == 1 && s->kind == BASIS_KIND_V) {
			mean_of_channels(e->mean, value, n);
			value = e->mean;
		}
		for (int c = 0; c < channels; c++, row += n, value += n) {
			error = fmax(error, quantise(row, scale++, value, n));
			for (int i = 0; i < n; i++)
				e->light_bits[i] |= row[i];
		}
	}
	return error;
}

/* The lights that are left, and the largest value that went with the others. */
static int list_lights(struct encoder *e, enum basis_kind kind, double *dropped)
{
	int count = 0;

	for (int i = 0; i < e->settings.lights; i++) {
		const bool faint = kind == BASIS_KIND_V &&
				   (double)e->light_peak[i] <= e->settings.ratio_cut;

		if (e->light_bits[i] && !faint)
			e->light[count++] = (uint16_t)i;
		else if (faint)
			*dropped = fmax(*dropped, (double)e->light_peak[i]);
	}
	return count;
}

static int32_t row_sum(const int16_t *row, int n)
{
	int32_t sum = 0;

	for (int i = 0; i < n; i++)
		sum += row[i];
	return sum;
}

static int32_t ground_total(const struct encoder *e, const struct encode_samples *s, int channel,
			    const int16_t *row, int lights)
{
	const size_t g = (size_t)s->ground * 3 + (size_t)channel;
	const double *u = e->settings.ground + g * (size_t)e->settings.lights;
	const double all = e->ground_sum[s->ground][channel];
	double sum = 0;

	for (int i = 0; i < lights; i++)
		sum += row[i] * u[e->light[i]];
	return all > 0 ? (int32_t)lrint(32768 * (sum / all)) : 0;
}

static void fill_rows(const struct encoder *e, const struct basis_block_entry *entry,
		      const struct basis_layout *at, uint8_t *payload)
{
	const int n = e->settings.lights, lights = (int)entry->lights;
	const int16_t *from = e->rows.data;
	int16_t *to = (int16_t *)(payload + at->row);

	for (int r = 0; r < entry->pixels * entry->channels; r++, from += n, to += at->stride) {
		if (lights == n) {
			memcpy(to, from, (size_t)n * sizeof(*to));
			continue;
		}
		for (int i = 0; i < lights; i++)
			to[i] = from[e->light[i]];
	}
}

static void fill_totals(const struct encoder *e, const struct encode_samples *s,
			const struct basis_block_entry *entry, const struct basis_layout *at,
			uint8_t *payload)
{
	const int16_t *row = (const int16_t *)(payload + at->row);
	int32_t *total = (int32_t *)(payload + at->total);
	const int lights = (int)entry->lights;

	for (int r = 0; r < entry->pixels * at->total_channels; r++) {
		const int c = r % at->total_channels;
		const int16_t *own = row;

		if (at->total_channels != entry->channels)
			own += (size_t)(r / at->total_channels) * (size_t)at->stride;
		else
			own += (size_t)r * (size_t)at->stride;
		total[r] = s->kind == BASIS_KIND_V ? ground_total(e, s, c, own, lights)
						   : row_sum(own, lights);
	}
}

static int build(struct encoder *e, const struct encode_samples *s, int pixels, int channels,
		 int lights, int tile, struct encode_result *result)
{
	const struct basis_layout at = basis_layout(s->kind, pixels, channels, lights);
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
			  .pixels = (uint16_t)pixels,
			  .channels = (uint16_t)channels,
			  .lights = (uint32_t)lights,
			  .bytes = at.bytes,
			  .ground = s->kind == BASIS_KIND_V ? (uint32_t)s->ground : 0},
	};
	pixel = (uint16_t *)(payload + at.pixel);
	for (int p = 0; p < s->pixels; p++) {
		if (e->keep[p])
			*pixel++ = s->pixel[p];
	}
	memcpy(payload + at.light, e->light, (size_t)lights * sizeof(*e->light));
	memcpy(payload + at.scale, e->scale, (size_t)(pixels * channels) * sizeof(*e->scale));
	fill_rows(e, &block->entry, &at, payload);
	fill_totals(e, s, &block->entry, &at, payload);
	result->count++;
	return 0;
}

/* Which pixels stay; the largest value of those that go is returned. */
static double choose_pixels(struct encoder *e, const struct encode_samples *s,
			    const struct survey *found, int *kept)
{
	const double cut = s->kind == BASIS_KIND_V ? e->settings.ratio_cut : 0;
	double dropped = 0;

	*kept = 0;
	for (int p = 0; p < s->pixels; p++) {
		const double peak = (double)found->pixel_peak[p];

		if (s->kind != BASIS_KIND_U) /* which follows its D */
			e->keep[p] = peak > cut && peak / ROW_MAX >= (double)FLT_MIN;
		if (e->keep[p])
			(*kept)++;
		else
			dropped = fmax(dropped, peak);
	}
	return dropped;
}

static int encode_samples(struct encoder *e, int tile, const struct encode_samples *s,
			  struct encode_result *result)
{
	const double cut = s->kind == BASIS_KIND_V ? e->settings.ratio_cut : 0;
	const size_t n = (size_t)e->settings.lights;
	struct survey found;
	double dropped, error = 0;
	int pixels, channels, lights = 0;
	int ret = look(e, s, &found);

	if (ret < 0)
		return ret;
	dropped = choose_pixels(e, s, &found, &pixels);
	channels = (double)found.channel_spread <= cut ? 1 : 3;
	if (pixels) {
		ret = reserve(&e->rows, (size_t)(pixels * channels) * n * sizeof(int16_t));
		if (ret < 0)
			return ret;
		error = quantise_all(e, s, channels);
		lights = list_lights(e, s->kind, &dropped);
		if (channels == 1 && s->kind == BASIS_KIND_V)
			error += (double)found.channel_spread * (1 + 0x1p-20); /* it is a float's */
	}
	if (lights == 0 && pixels && s->kind == BASIS_KIND_U)
		lights = 1; /* light 0 with a row of zeros: a D block must have its U */
	if (lights) {
		ret = build(e, s, pixels, channels, lights, tile, result);
		if (ret < 0)
			return ret;
	}
	if (s->kind == BASIS_KIND_T)
		result->object_error = fmax(result->object_error, fmax(error, dropped));
	if (s->kind == BASIS_KIND_V)
		result->ratio_error = fmax(result->ratio_error, fmax(error, dropped));
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
