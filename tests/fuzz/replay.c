/* SPDX-License-Identifier: MIT */
/* Stands in for the fuzzing engine where there is none: feeds each file named on the command line
 * to the target once. */
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t bytes);

static int replay(const char *path)
{
	FILE *stream = fopen(path, "rb");
	uint8_t *data = NULL;
	long bytes;
	int status = -1;

	if (!stream)
		goto out;
	if (fseek(stream, 0, SEEK_END) || (bytes = ftell(stream)) < 0 || fseek(stream, 0, SEEK_SET))
		goto out;
	/* memory of exactly that length, so that a sanitizer sees a read beyond */
	data = malloc(bytes ? (size_t)bytes : 1);
	if (!data || fread(data, 1, (size_t)bytes, stream) != (size_t)bytes)
		goto out;
	LLVMFuzzerTestOneInput(data, (size_t)bytes);
	status = 0;
out:
	free(data);
	if (stream)
		fclose(stream);
	if (status)
		perror(path);
	return status;
}

int main(int argc, char **argv)
{
	for (int i = 1; i < argc; i++)
		if (replay(argv[i]))
			return 1;
	printf("replayed %d inputs\n", argc - 1);
	return 0;
}
