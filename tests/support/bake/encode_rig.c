/* SPDX-License-Identifier: MIT */
#include "tests/support/bake/encode_rig.h"
#include "tests/support/expect.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "bake/tiles/coarse.h"

#define ALBEDO 0.5

static void encode_rig_set(struct encode_rig *e)
{
	e->ground = calloc(3 * (size_t)e->settings.lights, sizeof(*e->ground));
	assert_non_null(e->ground);
	for (int c = 0; c < 3; c++)
		for (int i = 0; i < e->settings.lights; i++)
			e->ground[c * e->settings.lights + i] =
				ALBEDO / M_PI * e->light[i].solid_angle_sr *
				fmax(e->light[i].direction[2], 0.01);
	assert_int_equal(ensemble_create(&e->ensemble, e->light, e->settings.lights), 0);
	e->settings.light = e->light;
	e->settings.grounds = 1;
	e->settings.ground = e->ground;
	e->settings.ensemble = &e->ensemble;
	e->settings.target = (struct encode_target){.rms = 0.5, .max = 2, .cell = 2};
	e->settings.column_cut = 1e-3;
}

struct encode_rig encode_rig_dome(int frequency, int coarse)
{
	struct encode_rig e = {.encoder = NULL};
	struct fault fault;
	struct dome fine, few;

	assert_int_equal(dome_create(&fine, frequency, &fault), 0);
	e.settings.lights = e.settings.coarse = fine.count;
	e.light = calloc((size_t)fine.count, sizeof(*e.light));
	assert_non_null(e.light);
	for (int i = 0; i < fine.count; i++) {
		memcpy(e.light[i].direction, fine.direction[i], sizeof(e.light[i].direction));
		e.light[i].solid_angle_sr = fine.solid_angle_sr[i];
	}
	if (coarse < frequency) {
		assert_int_equal(dome_create(&few, coarse, &fault), 0);
		e.settings.coarse = few.count;
		e.gather = calloc((size_t)fine.count, sizeof(*e.gather));
		assert_non_null(e.gather);
		coarse_fill(&fine, &few, e.gather);
		e.settings.gather = e.gather;
		dome_free(&few);
	}
	dome_free(&fine);
	encode_rig_set(&e);
	e.settings.ground = e.ground;
	return e;
}

struct encode_rig encode_rig_lamp(void)
{
	struct encode_rig e = {.settings = {.lights = 1, .coarse = 1}};

	e.light = calloc(1, sizeof(*e.light));
	assert_non_null(e.light);
	e.light->direction[2] = 1;
	e.light->solid_angle_sr = 2 * M_PI;
	encode_rig_set(&e);
	return e;
}

void encode_rig_start(struct encode_rig *e)
{
	e->settings.ensemble = &e->ensemble;
	assert_int_equal(encoder_create(&e->encoder, &e->settings), 0);
}

void encode_rig_end(struct encode_rig *e)
{
	encoder_destroy(e->encoder);
	ensemble_free(&e->ensemble);
	free(e->light);
	free(e->ground);
	free(e->gather);
}

/* ---- samples ---- */

struct encode_rig_part *encode_rig_part_new(const struct encode_rig *e, enum basis_kind kind,
					    int pixels, int channels, bool bounce)
{
	struct encode_rig_part *part = calloc(1, sizeof(*part));
	const size_t all = (size_t)pixels * 3 * (size_t)e->settings.lights;

	assert_non_null(part);
	part->direct = calloc(all, sizeof(*part->direct));
	part->bounce = bounce ? calloc(all, sizeof(*part->bounce)) : NULL;
	part->is = calloc(all, sizeof(*part->is));
	part->decoded = calloc(all, sizeof(*part->decoded));
	assert_true(part->direct && part->is && part->decoded && (part->bounce || !bounce));
	for (int p = 0; p < pixels; p++)
		part->pixel[p] = (uint16_t)(p * (ENCODE_RIG_PIXELS_MAX / pixels));
	part->samples = (struct encode_samples){.kind = kind,
						.pixels = pixels,
						.pixel = part->pixel,
						.channels = channels,
						.direct = part->direct,
						.bounce = part->bounce};
	return part;
}

void encode_rig_part_free(struct encode_rig_part *part)
{
	free(part->direct);
	free(part->bounce);
	free(part->is);
	free(part->decoded);
	free(part);
}

double encode_rig_dot(const double a[3], const double b[3])
{
	return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* Share of a light's cell that the ball hides from a pixel, 0..1, with an edge as wide as a
 * cell. */
static double encode_rig_hidden(const struct encode_rig *e, int pixel, int light)
{
	const double w = e->light[light].solid_angle_sr, width = sqrt(w / M_PI);
	double to[3] = {0.9 - 0.07 * (pixel % BASIS_TILE), 0.2 - 0.07 * (pixel / BASIS_TILE), 1};
	const double far = sqrt(encode_rig_dot(to, to));
	double angle, in;

	for (int k = 0; k < 3; k++)
		to[k] /= far;
	angle = acos(fmin(encode_rig_dot(to, e->light[light].direction), 1));
	in = (asin(0.5 / far) - angle) / width;
	return in > 1 ? 1 : in < -1 ? 0 : 0.5 + 0.5 * sin(M_PI / 2 * in);
}

void encode_rig_fill(const struct encode_rig *e, struct encode_rig_part *part)
{
	static const double colour[3] = {0.7, 0.5, 0.2}, thrown[3] = {0.04, 0.02, 0.01};
	const int n = e->settings.lights, channels = part->samples.channels;

	for (int p = 0; p < part->samples.pixels; p++) {
		const int at = part->pixel[p];
		const double turn = 0.1 * (at % BASIS_TILE);
		const double normal[3] = {0.8 * cos(turn), 0.8 * sin(turn), 0.6};

		for (int i = 0; i < n; i++) {
			const double *d = e->light[i].direction, w = e->light[i].solid_angle_sr;
			const double hidden = encode_rig_hidden(e, at, i);
			const double facing = fmax(encode_rig_dot(normal, d), 0) * w / M_PI;
			const double smooth = (1 + 0.5 * d[0]) * (1 + 0.02 * (at / BASIS_TILE));
			const bool shadow = part->samples.kind == BASIS_KIND_V;
			const double unit = shadow				 ? 1
					    : part->samples.kind == BASIS_KIND_T ? 1 - hidden
					    : part->samples.kind == BASIS_KIND_D ? hidden
										 : 1;

			for (int c = 0; c < channels; c++)
				part->direct[((size_t)p * (size_t)channels + (size_t)c) *
						     (size_t)n +
					     (size_t)i] =
					(float)(shadow ? hidden : colour[c] * facing * unit);
			for (int c = 0; c < 3 && part->bounce; c++)
				part->bounce[((size_t)p * 3 + (size_t)c) * (size_t)n + (size_t)i] =
					(float)(thrown[c] * smooth * (shadow ? -1 : w));
		}
	}
}

/* ---- blocks ---- */

static size_t encode_rig_align(size_t bytes)
{
	return (bytes + 63) / 64 * 64;
}

struct encode_rig_arrays encode_rig_arrays_of(const struct basis_block_payload *block, int coarse)
{
	const struct basis_block_entry *e = &block->entry;
	const uint8_t *at = block->payload;
	const size_t panels16 = (e->pixels + 31U) / 32;
	struct encode_rig_arrays a = {.stride = (coarse + 31) / 32 * 32};

	a.pixel = (const uint16_t *)at;
	at += encode_rig_align(e->pixels * 2U);
	a.tint = e->tinted ? (const uint16_t *)at : NULL;
	at += e->tinted ? encode_rig_align(e->pixels * 6U) : 0;
	a.pattern_scale = (const float *)at;
	at += encode_rig_align(e->patterns * 4U);
	a.pattern = (const int16_t *)at;
	at += (size_t)e->patterns * (size_t)a.stride * 2;
	a.coefficient = (const int16_t *)at;
	at += panels16 * e->channels * e->patterns * 64;
	a.light = (const uint16_t *)at;
	at += encode_rig_align(e->columns * 2U);
	a.column_scale = (const float *)at;
	at += encode_rig_align(e->columns * 4U);
	a.column16 = (const int16_t *)at;
	a.record_at = (const uint32_t *)at;
	a.record = at + encode_rig_align(e->columns * 4U);
	at += e->bits == 16 ? panels16 * e->channels * e->columns * 64
			    : encode_rig_align(e->columns * 4U) + encode_rig_align(e->record_bytes);
	a.bytes = (size_t)(at - (const uint8_t *)block->payload);
	return a;
}

int encode_rig_byte(const struct basis_block_entry *e, const struct encode_rig_arrays *a,
		    size_t place, size_t channel, uint32_t n)
{
	const size_t lines = (e->pixels + 63U) / 64 * e->channels;
	const size_t line = place / 64 * e->channels + channel;
	const uint8_t *code = a->record + a->record_at[n], *at = code + (lines + 3) / 4 * 4;
	int half;

	for (size_t k = 0; k < line; k++)
		at += code[k] == 255 ? 64 : code[k] ? 32 : 0;
	if (code[line] == 0 || code[line] == 255)
		return code[line] ? (int8_t)at[place % 64] : 0;
	half = place % 64 < 32 ? at[place % 64] % 16 : at[place % 64 - 32] / 16;
	return (half - 7) * code[line];
}

double encode_rig_column(const struct basis_block_entry *e, const struct encode_rig_arrays *a,
			 int p, int c, uint32_t n)
{
	const size_t place = (size_t)p, channel = (size_t)c, panels = (e->pixels + 31U) / 32;

	return (double)a->column_scale[n] *
	       (e->bits == 8 ? encode_rig_byte(e, a, place, channel, n)
			     : a->column16[((channel * panels + place / 32) * e->columns + n) * 32 +
					   place % 32]);
}

static double encode_rig_pattern(const struct encode_rig *e, const int16_t *pattern, int light)
{
	double y = 0;

	if (!e->gather)
		return pattern[light];
	for (int k = 0; k < 3; k++)
		y += pattern[e->gather[light].index[k]] *
		     (e->gather[light].weight[k] / (double)BASIS_COARSE_ONE);
	return y;
}

double encode_rig_unit(const struct encode_rig *e, enum basis_kind kind, int light)
{
	return kind == BASIS_KIND_V ? 1 : e->light[light].solid_angle_sr;
}

/* part->decoded += what a block says. */
static void encode_rig_decode(const struct encode_rig *e, struct encode_rig_part *part,
			      const struct basis_block_payload *block)
{
	const struct basis_block_entry *b = &block->entry;
	const struct encode_rig_arrays a = encode_rig_arrays_of(block, e->settings.coarse);
	const size_t n = (size_t)e->settings.lights;

	assert_int_equal(b->bytes, a.bytes);
	for (int q = 0; q < b->pixels; q++) {
		int own = 0;

		while (part->pixel[own] != a.pixel[q])
			own++;
		expect_below(own, part->samples.pixels, "q=%d", q);
		for (int c = 0; c < 3; c++) {
			const int row = b->channels == 3 ? c : 0;
			const double tint =
				b->tinted ? a.tint[c * b->pixels + q] / (double)BASIS_TINT_ONE : 1;
			double *to = part->decoded + ((size_t)own * 3 + (size_t)c) * n;

			for (int j = 0; j < b->patterns; j++) {
				const size_t panels = (b->pixels + 31U) / 32;
				const size_t line = ((size_t)row * panels + (size_t)(q / 32)) *
							    b->patterns +
						    (size_t)j;
				const double k = (double)a.pattern_scale[j] *
						 a.coefficient[line * 32 + (size_t)(q % 32)];

				for (size_t i = 0; i < n; i++)
					to[i] += tint * k *
						 encode_rig_pattern(e, a.pattern + j * a.stride,
								    (int)i) *
						 encode_rig_unit(e, b->kind, (int)i);
			}
			/* Columns of groups repeat what the lights' own columns say, and are left
			 * out. */
			for (uint32_t k = 0; k < b->columns && a.light[k] < n; k++)
				to[a.light[k]] += tint * encode_rig_column(b, &a, q, row, k) *
						  encode_rig_unit(e, b->kind, a.light[k]);
		}
	}
}

struct encode_result encode_rig_run(struct encode_rig *e, struct encode_rig_part **part, int count,
				    bool exact)
{
	struct encode_samples samples[4] = {{.pixels = 0}};
	struct encode_result result;
	const size_t n = (size_t)e->settings.lights;

	for (int k = 0; k < count; k++)
		samples[k] = part[k]->samples;
	assert_int_equal(encode_tile(e->encoder, 5, e->coverage, samples, count, &result), 0);
	for (int k = 0; k < count; k++) {
		const struct basis_block_payload *block = exact ? result.exact : result.shown;
		const int blocks = exact ? result.exact_count : result.shown_count;
		const int channels = part[k]->samples.channels;

		memset(part[k]->decoded, 0,
		       (size_t)part[k]->samples.pixels * 3 * n * sizeof(double));
		for (size_t r = 0; r < (size_t)part[k]->samples.pixels * 3; r++)
			for (size_t i = 0; i < n; i++) {
				const size_t own = channels == 3 ? r : r / 3;

				part[k]->is[r * n + i] = (double)part[k]->direct[own * n + i];
				if (part[k]->bounce)
					part[k]->is[r * n + i] +=
						(double)part[k]->bounce[r * n + i];
			}
		for (int b = 0; b < blocks; b++)
			if (block[b].entry.kind == part[k]->samples.kind)
				encode_rig_decode(e, part[k], &block[b]);
	}
	return result;
}

/* ---- levels ---- */

double encode_rig_level(double x)
{
	x = fmin(fmax(x, 0), 1);
	return 255 * (x <= 0.0031308 ? 12.92 * x : 1.055 * pow(x, 1 / 2.4) - 0.055);
}
