/* SPDX-License-Identifier: MIT */
/* Writes a basis file tile by tile, so that a bake never holds all of it. Appears by rename. */
#ifndef INLAY_HAL_BASIS_BASIS_WRITER_H
#define INLAY_HAL_BASIS_BASIS_WRITER_H

#include <stddef.h>

#include "hal/base/fault.h"
#include "hal/basis/basis_format.h"

struct basis_writer;

/* A block as handed over: entry.offset is set by the writer, entry.bytes is payload's length. */
struct basis_block_payload {
	struct basis_block_entry entry;
	const void *payload;
};

/* Payloads of a file of several poses are packed (basis_format.h), those of one lie in place.
 * lights: [info->lights]; ground: [info->grounds][3][info->lights]; coarse: [info->lights], or NULL
 * when info->coarse is info->lights. All are copied. camera and provenance are texts. */
int basis_writer_open(struct basis_writer **writer, const char *path,
		      const struct basis_info_chunk *info, const struct basis_light *lights,
		      const double *ground, const struct basis_coarse *coarse, const char *camera,
		      struct fault *fault);

/* Poses in order; each takes its blocks in ascending tile order, those of either layer as they come
 * (the exact ones wait in an unnamed file beside the other), then its coverage and peaks. */
int basis_writer_blocks(struct basis_writer *writer, const struct basis_block_payload *blocks,
			int count, struct fault *fault);
int basis_writer_exact_blocks(struct basis_writer *writer, const struct basis_block_payload *blocks,
			      int count, struct fault *fault);
int basis_writer_pose_end(struct basis_writer *writer, const uint16_t *coverage,
			  const float (*peak)[3], struct fault *fault);

/* Right after the end of the pose that it belongs to, if there is any; in the order of the format.
 */
int basis_writer_glass(struct basis_writer *writer, const struct basis_glass *glass, size_t count,
		       struct fault *fault);

/* [info->poses], once before the end; without it they have none. -EINVAL: not names of poses. */
int basis_writer_names(struct basis_writer *writer, const struct basis_pose_name *names,
		       struct fault *fault);

/* info again, because errors and noise are known only now. Frees the writer, also on failure. */
int basis_writer_finish(struct basis_writer *writer, const struct basis_info_chunk *info,
			const char *provenance, struct fault *fault);

void basis_writer_abandon(struct basis_writer *writer); /* NULL is harmless */

#endif
