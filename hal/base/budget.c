/* SPDX-License-Identifier: MIT */
#include "hal/base/budget.h"

#include <errno.h>

#define LEAST 0x1p28
#define A_BYTE 256.0

int budget_fits(const struct budget *budget, double bytes, const char *name, struct fault *fault)
{
	const double most = LEAST + A_BYTE * (double)budget->file_bytes;

	if (budget->taken + bytes <= most)
		return 0;
	return fault_say(
		fault, -EFBIG,
		"%s: it would take %.0f MB of memory, expected at most %.0f MB of %llu bytes in files",
		name, (budget->taken + bytes) / 1e6, most / 1e6,
		(unsigned long long)budget->file_bytes);
}

int budget_take(struct budget *budget, double bytes, const char *name, struct fault *fault)
{
	const int err = budget_fits(budget, bytes, name, fault);

	if (!err)
		budget->taken += bytes;
	return err;
}
