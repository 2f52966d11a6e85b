/* SPDX-License-Identifier: MIT */
/* Writes a basis file tile by tile, so that a bake never holds all of it. The file appears by
 * rename when it is complete. */
#ifndef INLAY_HAL_BASIS_BASIS_WRITER_H
#define INLAY_HAL_BASIS_BASIS_WRITER_H

#include <stddef.h>

#include "hal/base/fault.h"
#include "hal/basis/basis_format.h"

struct basis_writer;

/* A block for the writer, which sets entry.offset itself. entry.bytes is the payload's length. */
struct basis_block_payload {
	struct basis_block_entry entry;
	const void *payload;
};

/* A file of several poses is packed (basis_format.h), a file of one pose is not. lights:
 * [info->lights]; ground: [info->grounds][3][info->lights]; coarse: [info->lights], or NULL when
 * info->coarse is info->lights. All are written at once; the caller keeps them. camera: INI text.
 * -EINVAL: a size is out of range; -ENOMEM; errors of the file system. */
int basis_writer_open(struct basis_writer **writer, const char *path,
		      const struct basis_info_chunk *info, const struct basis_light *lights,
		      const double *ground, const struct basis_coarse *coarse, const char *camera,
		      struct fault *fault);

/* Poses are written in order. Each pose takes its blocks by ascending tile, the two layers in any
 * sequence, then basis_writer_pose_end() with its coverage and peaks. Exact blocks wait in an
 * unnamed file beside the output until then. */
int basis_writer_blocks(struct basis_writer *writer, const struct basis_block_payload *blocks,
			int count, struct fault *fault);
int basis_writer_exact_blocks(struct basis_writer *writer, const struct basis_block_payload *blocks,
			      int count, struct fault *fault);
int basis_writer_pose_end(struct basis_writer *writer, const uint16_t *coverage,
			  const float (*peak)[3], struct fault *fault);

/* For a pose that shows the background through the object: right after its end, once, sorted as in
 * basis_format.h. */
int basis_writer_glass(struct basis_writer *writer, const struct basis_glass *glass, size_t count,
		       struct fault *fault);

/* For a pose that mirrors the sky, likewise; after basis_writer_glass(). */
int basis_writer_mirror(struct basis_writer *writer, const struct basis_mirror *mirror,
			size_t count, struct fault *fault);

/* Where a pose's surfaces are, distance[BASIS_SURFACES][height * width] as in basis_places.h; right
 * after its end, once, optional. */
int basis_writer_places(struct basis_writer *writer, const float *const distance[BASIS_SURFACES],
			struct fault *fault);

/* Names of the poses, [info->poses]; optional, once, before the end. -EINVAL: invalid names. */
int basis_writer_names(struct basis_writer *writer, const struct basis_pose_name *names,
		       struct fault *fault);

/* Footprints of the poses, [info->poses]; optional, once, before the end. -EINVAL: impossible
 * ones. */
int basis_writer_feet(struct basis_writer *writer, const struct basis_footprint *feet,
		      struct fault *fault);

/* Ends the file. info is the same but for errors and noise, which are known only now. Frees the
 * writer, also on failure. */
int basis_writer_finish(struct basis_writer *writer, const struct basis_info_chunk *info,
			const char *provenance, struct fault *fault);

void basis_writer_abandon(struct basis_writer *writer); /* NULL is harmless */

#endif
