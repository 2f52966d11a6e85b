/* SPDX-License-Identifier: MIT */
/*
 * The thesis's own files of light transport, .msi (its appendix): for each pixel its type (object,
 * shadow or neither), and a byte for each light and channel.
 *
 *     int width, height, lights; long bytes          as the machine that wrote it has them: a long
 *                                                    of 4 or 8 bytes, either byte order
 *     for each pixel, row by row:
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
	const uint8_t *data; /* the mapped file */
	size_t bytes;
	size_t *start; /* [height * width]: offset of each pixel's type */
};

/* Maps a file and finds its variant. -EBADMSG: no variant fits: the file is cut off, too long, has
 * a wrong type, or sizes out of range; the fault describes the variant that comes nearest. */
int msi_open(struct msi *msi, const char *path, struct fault *fault);
void msi_close(struct msi *msi); /* idempotent; zeroed is fine */

/* A file as a source of import. */
struct msi_source {
	const struct msi *msi;
	const int *place; /* [lights]: the dome's index of each light of the file */
	double rate;	  /* light that 255 of an object stands for (the thesis's light rate) */
	double *ground;	  /* [3][lights]: of flat ground, else NULL */
};

/* The ground is flat if all pixels in shadow have the same light without the object, up to a
 * factor. Then source->ground is set to the light of level ground of albedo 0.5. msi and
 * place must outlive the source. -ENOMEM. */
int msi_source_create(struct msi_source *source, const struct msi *msi, const struct dome *dome,
		      const int *place, double rate);
void msi_source_free(struct msi_source *source);

/* fill() of struct import_source; context is a struct msi_source. */
void msi_fill(const void *context, struct import_tile *tile);

/* ---- writing ---- */

/* Writes a basis as the thesis's program reads it, little-endian with a long of 8 bytes. */
int msi_write(const char *path, const struct thesis *thesis, int width, int height, int lights,
	      struct fault *fault);

#endif
