/* Any bytes as a lights file: refused in a sentence, or six lights, finite and of at least 0. */
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

#include "hal/lights/lights_file.h"

#define LIGHTS 6

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t bytes);

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t bytes)
{
	static int file = -1;
	float radiance[LIGHTS][3];
	struct fault fault = {.text = ""};
	char path[64];

	if (file < 0)
		file = memfd_create("lights", MFD_CLOEXEC);
	if (file < 0 || ftruncate(file, 0) || pwrite(file, data, bytes, 0) != (ssize_t)bytes)
		abort();
	snprintf(path, sizeof(path), "/proc/self/fd/%d", file);
	if (lights_file_read(path, radiance, LIGHTS, &fault)) {
		if (!*fault.text)
			abort();
		return 0;
	}
	for (int i = 0; i < LIGHTS; i++) {
		for (int c = 0; c < 3; c++) {
			if (!isfinite(radiance[i][c]) || radiance[i][c] < 0)
				abort();
		}
	}
	return 0;
}
