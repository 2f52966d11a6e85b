/* SPDX-License-Identifier: MIT */
#include "hal/base/processor.h"

#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#if defined(__aarch64__)
#include <sys/auxv.h>

/* asm/hwcap.h names it HWCAP_ASIMDDP. */
#define HAS_DOTPROD (1UL << 20)
#endif

/* __builtin_cpu_supports() also checks that the system saves the wide registers. */
unsigned processor_features(void)
{
	unsigned features = 0;

#if defined(__x86_64__)
	__builtin_cpu_init();
	if (__builtin_cpu_supports("sse4.1"))
		features |= PROCESSOR_SSE41;
	if (__builtin_cpu_supports("avx2"))
		features |= PROCESSOR_AVX2;
	if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512bw") &&
	    __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512vl")) {
		features |= PROCESSOR_AVX512;
		if (__builtin_cpu_supports("avx512vnni"))
			features |= PROCESSOR_AVX512_VNNI;
	}
#elif defined(__aarch64__)
	features |= PROCESSOR_NEON;
	if (getauxval(AT_HWCAP) & HAS_DOTPROD)
		features |= PROCESSOR_DOTPROD;
#endif
	return features;
}

bool processor_features_named(const char *name, unsigned *features)
{
	static const struct {
		const char *name;
		unsigned features;
	} known[] = {
		{"auto", ~0U},
		{"c", 0},
		{"sse4.1", PROCESSOR_SSE41},
		{"avx2", PROCESSOR_SSE41 | PROCESSOR_AVX2},
		{"avx512-vnni",
		 PROCESSOR_SSE41 | PROCESSOR_AVX2 | PROCESSOR_AVX512 | PROCESSOR_AVX512_VNNI},
		{"neon", PROCESSOR_NEON},
		{"neon-dotprod", PROCESSOR_NEON | PROCESSOR_DOTPROD},
	};

	for (size_t i = 0; i < sizeof(known) / sizeof(known[0]); i++) {
		if (!strcmp(name && *name ? name : "auto", known[i].name)) {
			*features = known[i].features;
			return true;
		}
	}
	return false;
}

unsigned processor_features_allowed(const char *name)
{
	const bool automatic = !name || !*name || !strcmp(name, "auto");
	unsigned allowed = 0;

	if (!processor_features_named(automatic ? getenv("INLAY_KERNEL") : name, &allowed))
		return 0;
	return processor_features() & allowed;
}
