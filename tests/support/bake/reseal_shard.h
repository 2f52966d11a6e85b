/* SPDX-License-Identifier: MIT */
/*
 * Repairs the outside of a shard file that a test or a fuzzer has damaged, so that the reader looks
 * at the damage and not at the checksums: magic number, program version and all checksums are
 * written anew, as far as the sizes in the file can be followed.
 */
#ifndef INLAY_TESTS_SUPPORT_BAKE_RESEAL_SHARD_H
#define INLAY_TESTS_SUPPORT_BAKE_RESEAL_SHARD_H

#include <stddef.h>
#include <stdint.h>

/* data needs no alignment. */
void reseal_shard(uint8_t *data, size_t bytes);

#endif
