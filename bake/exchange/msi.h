/* SPDX-License-Identifier: MIT */
/*
 * The thesis's own files of light transport, .msi (its appendix): a picture's pixels, each object,
 * shadow or neither, a byte for each light and channel.
 *
 *     int width, height, lights; long bytes          of the machine that wrote it: 4 or 8 bytes a
 *                                                    long, either byte order
 *     of each pixel, row by row:
 *         byte type                                  enum thesis_role (hal/measure/thesis.h)
 *         of an object: R G B of each light
 *         in shadow: R G B of the ground, R G B of the ground with the object, of each light
 */
#ifndef INLAY_BAKE_EXCHANGE_MSI_H
#define INLAY_BAKE_EXCHANGE_MSI_H

#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>

#include "bake/exchange/import.h"
#include "hal/measure/thesis.h"

struct msi_variant {
	bool big_endian;
	int long_bytes; /* 4 or 8 */
};

/* ---- reading ---- */

struct msi {
	int width, height, lights;
	struct msi_variant variant;
	const uint8_t *data; /* mapped */
	size_t bytes;
	size_t *start; /* [height * width]: of each pixel, its type */
};

/* Of whatever variant fits. -EBADMSG: none does: cut off, too long, a type that is none, sizes out
 * of range; the fault says what is wrong with the one that comes nearest. */
int msi_open(struct msi *msi, const char *path, struct fault *fault);
void msi_close(struct msi *msi); /* idempotent; zeroed is fine */

/* A source of import. */
struct msi_source {
	const struct msi *msi;
	const int *place; /* [lights]: the dome's index of each light of the file */
	double rate;	  /* light that 255 of an object stands for (the thesis's light rate) */
	double *ground;	  /* [3][lights]: where it is flat, else NULL */
};

/* Ground is flat where all pixels in shadow have the same light without the object, but for their
 * scale: then ground is filled, else freed. ground: of a dome's cells, as albedo 0.5 has it.
 * -ENOMEM.
 */
int msi_source_create(struct msi_source *source, const struct msi *msi, const struct dome *dome,
		      const int *place, double rate);
void msi_source_free(struct msi_source *source);

/* Of struct import_source; context is the msi_source. */
void msi_fill(const void *context, struct import_tile *tile);

/* ---- writing ---- */

/* What the thesis's program would read of a basis. */
int msi_write(const char *path, const struct thesis *thesis, int width, int height, int lights,
	      const struct msi_variant *variant, struct fault *fault);

#endif
