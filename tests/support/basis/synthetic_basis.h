/* SPDX-License-Identifier: MIT */
/*
 * Basis files of random content, written by the writer and read by the reader. The values are
 * possible results of a bake: under a sky of radiance 1 the object gives off up to `peak`, and
 * ratios lie in about 0..1 + bounce.
 */
#ifndef INLAY_TESTS_SUPPORT_BASIS_SYNTHETIC_BASIS_H
#define INLAY_TESTS_SUPPORT_BASIS_SYNTHETIC_BASIS_H

#include "tests/support/basis/synthetic_block.h"

struct synthetic {
	struct basis basis; /* open */
	char folder[64], path[80];
};

/* Prints the fault and aborts where ret < 0; needs no test framework. */
void synthetic_must(int ret, const struct fault *fault);

/* Random directions of the upper half, equal solid angles. */
void synthetic_lights(struct basis_light *lights, int count, struct chance *chance);

/* Creates a temporary folder, writes a file there and opens it. */
void synthetic_open(struct synthetic *s, const struct synthetic_options *options);

/* Closes the basis and removes file and folder. */
void synthetic_close(struct synthetic *s);

/* Writes the file at s->path anew. */
void synthetic_write(struct synthetic *s, const struct synthetic_options *o);

/* Makes all checksums of a file in memory right again after a change, as far as its chunk table can
 * be followed. */
void synthetic_reseal(uint8_t *data, size_t bytes);

#endif
