/*
 * Basis files of random content for tests: made by the encoder and the writer, read by the reader.
 *
 * Header only, because each test is one program of one file.
 */
#ifndef INLAY_TESTS_SYNTHETIC_BASIS_H
#define INLAY_TESTS_SYNTHETIC_BASIS_H

#include <math.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>
#include <xxhash.h>

#include "bake/encode.h"
#include "hal/basis/basis.h"
#include "hal/basis/basis_writer.h"
#include "tests/unit/chance.h"

struct synthetic_options {
	int width, height, lights, grounds;
	int receiver_lights;   /* lights that V and D blocks list; 0: all */
	double object_share;   /* of pixels with a T row ... */
	double ground_share;   /* ... with a V row ... */
	double stand_in_share; /* ... with D and U rows (the two exclude each other) */
	double unlit_share;    /* of these pixels: U is 0 (D is not) */
	double peak;	       /* sum of a pixel's t over all lights, at most */
	double bounce;	       /* v and d / u lie in -bounce..1 */
	bool rest;	       /* lights that V blocks do not list have one v for each row, not 0;
				  needs a ratio_cut above float's rounding */
	bool grey;	       /* all channels alike */
	double ratio_cut;
	uint64_t seed;
};

struct synthetic {
	struct basis basis;
	char folder[64], path[80];
};

/* The transport of one tile, as the bake would hand it to the encoder. */
struct synthetic_tile {
	uint16_t pixel[BASIS_KIND_COUNT][BASIS_TILE * BASIS_TILE];
	float *value[BASIS_KIND_COUNT]; /* [pixels][3][lights] */
	int pixels[BASIS_KIND_COUNT];
	int ground;
};

static inline void synthetic_lights(struct basis_light *lights, int count, struct chance *chance)
{
	for (int i = 0; i < count; i++) {
		const double z = chance_real(chance, 0, 1),
			     phi = 2 * M_PI * chance_real(chance, 0, 1);
		const double r = sqrt(1 - z * z);

		lights[i] = (struct basis_light){
			.direction = {r * cos(phi), r * sin(phi), z},
			.solid_angle_sr = 2 * M_PI / count,
		};
	}
}

static inline void synthetic_row(const struct synthetic_options *o, enum basis_kind kind,
				 float *value, const float *own, struct chance *chance)
{
	const int listed = kind == BASIS_KIND_T || !o->receiver_lights ? o->lights
								       : o->receiver_lights;
	float rest = 0;

	for (int k = 0; k < 3 * o->lights; k++) {
		const int i = k % o->lights;
		const double r = chance_real(chance, 0, 1);

		if (i == 0 && o->rest && kind == BASIS_KIND_V)
			rest = (float)(chance_real(chance, 0, 1) * (1 + o->bounce) - o->bounce);
		if (o->grey && k >= o->lights)
			value[k] = value[i];
		else if (i >= listed)
			value[k] = rest;
		else if (kind == BASIS_KIND_T)
			value[k] = (float)(r * o->peak / o->lights);
		else if (kind == BASIS_KIND_U)
			value[k] = (float)(r < 0.2 ? 0 : r / o->lights);
		else
			value[k] = (float)(r * (1 + o->bounce) - o->bounce) * (own ? own[k] : 1);
	}
}

static inline void synthetic_fill_tile(const struct synthetic_options *o,
				       struct synthetic_tile *tile, int x0, int y0,
				       uint16_t *coverage, struct chance *chance)
{
	const size_t row = 3 * (size_t)o->lights;

	memset(tile->pixels, 0, sizeof(tile->pixels));
	tile->ground = o->grounds ? chance_int(chance, 0, o->grounds - 1) : 0;
	for (int p = 0; p < BASIS_TILE * BASIS_TILE; p++) {
		const int x = x0 + p % BASIS_TILE, y = y0 + p / BASIS_TILE;
		const double r = chance_real(chance, 0, 1);
		int *n = tile->pixels;

		if (x >= o->width || y >= o->height)
			continue;
		if (chance_real(chance, 0, 1) < o->object_share) {
			const double a = chance_real(chance, 0, 1);

			coverage[y * o->width + x] = (uint16_t)(a < 0.3	  ? 65535
								: a < 0.4 ? 0
									  : a * 65535);
			tile->pixel[BASIS_KIND_T][n[BASIS_KIND_T]] = (uint16_t)p;
			synthetic_row(o, BASIS_KIND_T,
				      tile->value[BASIS_KIND_T] + row * (size_t)n[BASIS_KIND_T]++,
				      NULL, chance);
		}
		if (r < o->ground_share) {
			tile->pixel[BASIS_KIND_V][n[BASIS_KIND_V]] = (uint16_t)p;
			synthetic_row(o, BASIS_KIND_V,
				      tile->value[BASIS_KIND_V] + row * (size_t)n[BASIS_KIND_V]++,
				      NULL, chance);
		} else if (r < o->ground_share + o->stand_in_share) {
			bool unlit;
			float *u = tile->value[BASIS_KIND_U] + row * (size_t)n[BASIS_KIND_U];

			tile->pixel[BASIS_KIND_D][n[BASIS_KIND_D]] = (uint16_t)p;
			tile->pixel[BASIS_KIND_U][n[BASIS_KIND_U]++] = (uint16_t)p;
			synthetic_row(o, BASIS_KIND_U, u, NULL, chance);
			unlit = chance_real(chance, 0, 1) < o->unlit_share;
			if (unlit)
				memset(u, 0, row * sizeof(*u));
			synthetic_row(o, BASIS_KIND_D,
				      tile->value[BASIS_KIND_D] + row * (size_t)n[BASIS_KIND_D]++,
				      unlit ? NULL : u, chance);
		}
	}
}

static inline void synthetic_raise_peaks(const struct synthetic_options *o,
					 const struct synthetic_tile *tile, float (*peak)[3])
{
	const size_t n = (size_t)o->lights;

	for (int p = 0; p < tile->pixels[BASIS_KIND_T]; p++) {
		for (size_t c = 0; c < 3; c++) {
			const float *t = tile->value[BASIS_KIND_T] + ((size_t)p * 3 + c) * n;
			double sum = 0;

			for (size_t i = 0; i < n; i++) {
				peak[i][c] = fmaxf(peak[i][c], t[i]);
				sum += (double)t[i];
			}
			peak[n][c] = fmaxf(peak[n][c], (float)(sum * (1 + 1e-6)));
		}
	}
}

/* Stops the program when anything fails: the tests of encoder and writer say why. */
static inline void synthetic_must(int ret, const struct fault *fault)
{
	if (ret < 0) {
		fprintf(stderr, "synthetic basis: %s (%d)\n", fault->text, ret);
		abort();
	}
}

static inline void synthetic_write(struct synthetic *s, const struct synthetic_options *o)
{
	const size_t n = (size_t)o->lights, pixels = (size_t)o->width * (size_t)o->height;
	struct basis_info_chunk info = {.width = (uint32_t)o->width,
					.height = (uint32_t)o->height,
					.lights = (uint32_t)o->lights,
					.grounds = (uint32_t)o->grounds,
					.poses = 1};
	struct basis_light *lights = calloc(n, sizeof(*lights));
	double *ground = calloc((size_t)o->grounds * 3 * n + 1, sizeof(*ground));
	uint16_t *coverage = calloc(pixels, sizeof(*coverage));
	float(*peak)[3] = calloc(n + 1, sizeof(*peak));
	struct encode_settings settings = {o->lights, o->grounds, ground, o->ratio_cut};
	struct synthetic_tile tile = {0};
	struct basis_writer *writer;
	struct encoder *encoder;
	struct fault fault = {""};
	struct chance chance = {o->seed};
	int index = 0;

	for (int k = 0; k < BASIS_KIND_COUNT; k++)
		tile.value[k] = calloc(BASIS_TILE * BASIS_TILE * 3 * n, sizeof(float));
	synthetic_lights(lights, o->lights, &chance);
	for (size_t i = 0; i < (size_t)o->grounds * 3 * n; i++)
		ground[i] = chance_real(&chance, 0, 1) / o->lights;
	synthetic_must(encoder_create(&encoder, &settings), &fault);
	synthetic_must(
		basis_writer_open(&writer, s->path, &info, lights, ground, "[camera]\n", &fault),
		&fault);
	for (int y = 0; y < o->height; y += BASIS_TILE) {
		for (int x = 0; x < o->width; x += BASIS_TILE) {
			struct encode_samples samples[BASIS_KIND_COUNT];
			struct encode_result result;

			synthetic_fill_tile(o, &tile, x, y, coverage, &chance);
			synthetic_raise_peaks(o, &tile, peak);
			for (int k = 0; k < BASIS_KIND_COUNT; k++)
				samples[k] = (struct encode_samples){
					(enum basis_kind)k, k == BASIS_KIND_V ? tile.ground : 0,
					tile.pixels[k], tile.pixel[k], tile.value[k]};
			synthetic_must(
				encode_tile(encoder, index++, samples, BASIS_KIND_COUNT, &result),
				&fault);
			synthetic_must(
				basis_writer_blocks(writer, result.blocks, result.count, &fault),
				&fault);
			info.object_error = fmax(info.object_error, result.object_error);
			info.ratio_error = fmax(info.ratio_error, result.ratio_error);
		}
	}
	synthetic_must(basis_writer_pose_end(writer, coverage, (const float(*)[3])peak, &fault),
		       &fault);
	synthetic_must(basis_writer_finish(writer, &info, "made = by a test\n", &fault), &fault);
	encoder_destroy(encoder);
	for (int k = 0; k < BASIS_KIND_COUNT; k++)
		free(tile.value[k]);
	free(lights);
	free(ground);
	free(coverage);
	free(peak);
}

/* Makes all checksums of a file in memory right again after something in it was changed, as far as
 * its chunk table can be followed. */
static inline void synthetic_reseal(uint8_t *data, size_t bytes)
{
	struct basis_file_header *header = (struct basis_file_header *)data;
	struct basis_chunk_entry *chunk = (struct basis_chunk_entry *)(header + 1);
	XXH3_state_t *hash;

	if (bytes < sizeof(*header) ||
	    header->chunk_count > (bytes - sizeof(*header)) / sizeof(*chunk))
		return;
	for (uint32_t i = 0; i < header->chunk_count; i++) {
		if (chunk[i].offset <= bytes && chunk[i].bytes <= bytes - chunk[i].offset)
			chunk[i].checksum = XXH3_64bits(data + chunk[i].offset, chunk[i].bytes);
	}
	hash = XXH3_createState();
	if (!hash)
		abort();
	header->checksum = 0;
	XXH3_64bits_reset(hash);
	XXH3_64bits_update(hash, header, sizeof(*header));
	XXH3_64bits_update(hash, chunk, header->chunk_count * sizeof(*chunk));
	header->checksum = XXH3_64bits_digest(hash);
	XXH3_freeState(hash);
}

static inline void synthetic_open(struct synthetic *s, const struct synthetic_options *options)
{
	struct fault fault = {""};

	memset(s, 0, sizeof(*s));
	snprintf(s->folder, sizeof(s->folder), "/tmp/inlay-basis-XXXXXX");
	if (!mkdtemp(s->folder))
		abort();
	snprintf(s->path, sizeof(s->path), "%s/b.inlay", s->folder);
	synthetic_write(s, options);
	synthetic_must(basis_open(&s->basis, s->path, &fault), &fault);
}

static inline void synthetic_close(struct synthetic *s)
{
	basis_close(&s->basis);
	unlink(s->path);
	rmdir(s->folder);
}

#endif
