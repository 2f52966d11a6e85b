/* SPDX-License-Identifier: MIT */
/*
 * Loaded before a program (LD_PRELOAD), plays a file that takes long to read: who opens the file
 * that HELD_FILE names waits until it has another name, too, with .go at its end.
 */
#include <dlfcn.h>
#include <fcntl.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

int open(const char *path, int flags, ...)
{
	int (*const next)(const char *, int,
			  ...) = (int (*)(const char *, int, ...))dlsym(RTLD_NEXT, "open");
	const char *held = getenv("HELD_FILE");
	char go[4096];
	mode_t mode = 0;
	va_list args;

	va_start(args, flags);
	if (flags & (O_CREAT | O_TMPFILE))
		mode = va_arg(args, mode_t);
	va_end(args);
	snprintf(go, sizeof(go), "%s.go", held ? held : "");
	while (held && !strcmp(path, held) && access(go, F_OK))
		usleep(10000);
	return next(path, flags, mode);
}
