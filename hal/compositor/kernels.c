#include "hal/compositor/kernels.h"

#include <stdlib.h>
#include <string.h>

const struct kernels *const kernels_all[] = {
	&kernels_c,
	NULL,
};

const struct kernels *kernels_choose(const char *name)
{
	const struct kernels *fastest = NULL;

	if (!name || strcmp(name, "auto") == 0)
		name = getenv("INLAY_KERNEL");
	if (name && strcmp(name, "auto") == 0)
		name = NULL;
	for (int i = 0; kernels_all[i]; i++) {
		if ((!name || strcmp(kernels_all[i]->name, name) == 0) &&
		    kernels_all[i]->supported())
			fastest = kernels_all[i];
	}
	return fastest;
}
