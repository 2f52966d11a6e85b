/* SPDX-License-Identifier: MIT */
/* Basis files copied to memory, so that a test can damage the copy and open it. */
#ifndef INLAY_TESTS_SUPPORT_BASIS_COPIED_BASIS_H
#define INLAY_TESTS_SUPPORT_BASIS_COPIED_BASIS_H

#include "tests/support/basis/synthetic_basis.h"

/* A small file with blocks of every kind, several over the same pixels, and both layers. */
extern const struct synthetic_options copied_small;

/* A whole file in memory of its own, which may be written to. */
struct copied {
	uint8_t *data;
	size_t bytes;
};

/* Free the copy with copied_free(). */
struct copied copied_file(const char *path);
void copied_free(struct copied *copy);

/* What basis_open_memory() returns for the copy; the opened basis is closed again. `fault` is
 * emptied first. copied_open() opens all parts. */
int copied_open_part(const struct copied *copy, enum basis_part part, struct fault *fault);
int copied_open(const struct copied *copy, struct fault *fault);

/* Table entry and data of the first chunk of a type; both point into the copy. */
struct basis_chunk_entry *copied_chunk(const struct copied *copy, uint32_t type);
void *copied_data(const struct copied *copy, uint32_t type);

/* Setup and teardown of a group: *state is a struct synthetic of `copied_small`, open. */
int copied_setup(void **state);
int copied_teardown(void **state);

#endif
