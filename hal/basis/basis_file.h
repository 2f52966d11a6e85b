/* SPDX-License-Identifier: MIT */
/*
 * The bytes of a basis file. What a part needs is read into memory: a file that is written over or
 * cut short, or a stick that is pulled out, then changes nothing for whoever shows it, where a
 * mapping would be a SIGBUS or blocks that nobody has checked. Programs that want all there is,
 * which may be more than memory holds, and end soon, map the file. Private to hal/basis.
 */
#ifndef INLAY_HAL_BASIS_BASIS_FILE_H
#define INLAY_HAL_BASIS_BASIS_FILE_H

#include "hal/basis/basis_reader.h"

struct basis_file {
	int fd;		 /* -1: mapped */
	uint8_t *memory; /* [bytes]: zeros, until basis_file_fetch() */
	size_t bytes;
};

/* -ENOENT..., -ENOMEM, -EBADMSG for an empty one, -EINVAL for what is no plain file. */
int basis_file_open(struct basis_file *file, const char *path, enum basis_part part,
		    struct fault *fault);
void basis_file_close(struct basis_file *file); /* the memory too */

/* From here on r->data holds these bytes of the file, at their place. -EIO..., -EBADMSG if the file
 * ends before. */
int basis_file_fetch(const struct basis_reader *r, uint64_t offset, uint64_t bytes);

/* The same for what is needed once: to be given back by free(*owned). -ENOMEM besides. */
int basis_file_borrow(const struct basis_reader *r, uint64_t offset, uint64_t bytes,
		      const uint8_t **data, void **owned);

#endif
