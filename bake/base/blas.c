/* SPDX-License-Identifier: MIT */
#include "bake/base/blas.h"

#include <cblas.h>
#include <stdlib.h>
#include <unistd.h>

#define CORE_VARIABLE "OPENBLAS_CORETYPE"

void blas_choose_kernels(char **argv)
{
#ifdef __x86_64__
	__builtin_cpu_init();
	if (!__builtin_cpu_supports("avx2") || !__builtin_cpu_supports("fma") ||
	    getenv(CORE_VARIABLE) || setenv(CORE_VARIABLE, "Haswell", 1))
		return;
	execv("/proc/self/exe", argv);
#else
	(void)argv;
#endif
}

void blas_setup(void)
{
	openblas_set_num_threads(1);
}
