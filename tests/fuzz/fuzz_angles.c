/* Any bytes as a file of light angles: refused in a sentence with nothing kept, or all the lights
 * of a dome, each once. */
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/mman.h>
#include <unistd.h>

#include "bake/angles.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t bytes);

static void check(const struct dome *dome, const int *light)
{
	char *taken = calloc((size_t)dome->count, 1);

	if (!taken)
		abort();
	for (int k = 0; k < dome->count; k++) {
		if (light[k] < 0 || light[k] >= dome->count || taken[light[k]])
			abort();
		taken[light[k]] = 1;
	}
	free(taken);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t bytes)
{
	static int file = -1;
	struct fault fault = {.text = ""};
	struct dome dome;
	char path[64];
	int *light;

	if (file < 0)
		file = memfd_create("angles", MFD_CLOEXEC);
	if (file < 0 || ftruncate(file, 0) || pwrite(file, data, bytes, 0) != (ssize_t)bytes)
		abort();
	snprintf(path, sizeof(path), "/proc/self/fd/%d", file);
	if (angles_read(path, &dome, &light, &fault) == 0)
		check(&dome, light);
	else if (!fault.text[0] || light)
		abort();
	free(light);
	dome_free(&dome);
	return 0;
}
