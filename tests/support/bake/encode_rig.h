/* SPDX-License-Identifier: MIT */
/*
 * A rig for tests of the encoder: light transport of a simple scene (a ball above ground and a
 * curved wall), encoded, and decoded again by a second decoder in double precision that is written
 * from basis_format.h alone.
 */
#ifndef INLAY_TESTS_SUPPORT_BAKE_ENCODE_RIG_H
#define INLAY_TESTS_SUPPORT_BAKE_ENCODE_RIG_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "bake/encode/encode.h"

#define ENCODE_RIG_PIXELS_MAX (BASIS_TILE * BASIS_TILE)

/* The lights, and the encoder with its settings. A test may change settings.target before
 * encode_rig_start(). */
struct encode_rig {
	struct basis_light *light;   /* [lights] */
	double *ground;		     /* [3][lights]: what the ground reflects of each */
	struct basis_coarse *gather; /* [lights]; NULL: each light is its own coarse light */
	struct ensemble ensemble;
	struct encode_settings settings;
	struct encoder *encoder;
	uint16_t coverage[ENCODE_RIG_PIXELS_MAX];
};

/* Samples of one kind with memory of their own, and what the encoded blocks say of them, per unit
 * of L. */
struct encode_rig_part {
	struct encode_samples samples;
	uint16_t pixel[ENCODE_RIG_PIXELS_MAX];
	float *direct, *bounce;
	double *is;	 /* [pixels][3][lights]: the truth, direct + bounce */
	double *decoded; /* the same shape: what the blocks say */
};

/* Lights are the cells of a dome; coarse lights those of a coarser one where coarse < frequency. */
struct encode_rig encode_rig_dome(int frequency, int coarse);

/* One light, straight above. */
struct encode_rig encode_rig_lamp(void);

/* Creates the encoder. The rig must not move from here on. */
void encode_rig_start(struct encode_rig *e);
void encode_rig_end(struct encode_rig *e);

/* A part of zeros, its pixels spread over the tile; free it with encode_rig_part_free(). */
struct encode_rig_part *encode_rig_part_new(const struct encode_rig *e, enum basis_kind kind,
					    int pixels, int channels, bool bounce);
void encode_rig_part_free(struct encode_rig_part *part);

double encode_rig_dot(const double a[3], const double b[3]);

/* Fills a part: V is the ball's shadow on the ground, U a curved wall, T that wall in the shadow, D
 * what the shadow takes of U. */
void encode_rig_fill(const struct encode_rig *e, struct encode_rig_part *part);

/* The arrays of a payload, in the order in which basis_format.h lists them; they point into it. */
struct encode_rig_arrays {
	const uint16_t *pixel, *tint, *light;
	const float *pattern_scale, *column_scale;
	const int16_t *pattern, *coefficient, *column16;
	const uint32_t *record_at;
	const uint8_t *record;
	int stride;   /* of a pattern, in values */
	size_t bytes; /* of the payload */
};

struct encode_rig_arrays encode_rig_arrays_of(const struct basis_block_payload *block, int coarse);

/* Value of column n of 8 bits at a place of a channel, in -127..127. */
int encode_rig_byte(const struct basis_block_entry *e, const struct encode_rig_arrays *a,
		    size_t place, size_t channel, uint32_t n);

/* Value of column n, of 8 or 16 bits, times its scale, at pixel p of channel c. */
double encode_rig_column(const struct basis_block_entry *e, const struct encode_rig_arrays *a,
			 int p, int c, uint32_t n);

/* X_i / L_i: the solid angle of the light in sr; 1 for kind V. */
double encode_rig_unit(const struct encode_rig *e, enum basis_kind kind, int light);

/* Encodes parts of one tile and decodes the blocks into them: those of the exact layer, or those
 * that are shown. The result's payloads belong to the encoder. */
struct encode_result encode_rig_run(struct encode_rig *e, struct encode_rig_part **part, int count,
				    bool exact);

/* 8-bit level, not rounded, that sRGB gives linear light x; x is cut to 0..1. */
double encode_rig_level(double x);

#endif
