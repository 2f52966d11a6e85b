/* SPDX-License-Identifier: MIT */
/* Sets OpenBLAS up, so that a bake is the same on all processors with AVX2. */
#ifndef INLAY_BAKE_BASE_BLAS_H
#define INLAY_BAKE_BASE_BLAS_H

/*
 * To be called first of all: chooses OpenBLAS's kernels. OpenBLAS takes other ones for other
 * processors, which add in another order, so that files differ in their last bits and shards of
 * unlike machines are not those of one; for a processor that is newer than itself it takes the
 * oldest ones. Here all x86-64 processors with AVX2 and FMA take the same. OpenBLAS reads the
 * choice when it is loaded, so the program starts itself once more (2 ms); where it cannot, it goes
 * on with OpenBLAS's own choice. Who has set OPENBLAS_CORETYPE keeps it.
 */
void blas_choose_kernels(char **argv);

/* Makes OpenBLAS work on the calling thread alone: tiles are what is shared among threads. */
void blas_setup(void);

#endif
