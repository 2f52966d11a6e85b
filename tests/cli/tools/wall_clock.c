/* SPDX-License-Identifier: MIT */
/*
 * Loaded before a program (LD_PRELOAD), plays the clock on the wall: time() says what stands in the
 * file that WALL_CLOCK names, in seconds since 1970, at each call anew.
 */
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

time_t time(time_t *to)
{
	const char *name = getenv("WALL_CLOCK");
	FILE *file = name ? fopen(name, "r") : NULL;
	long long seconds = 0;

	if (!file || fscanf(file, "%lld", &seconds) != 1)
		abort(); /* a test that plays no time plays nothing */
	fclose(file);
	if (to)
		*to = (time_t)seconds;
	return (time_t)seconds;
}
