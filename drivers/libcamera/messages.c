/* SPDX-License-Identifier: MIT */
#include "drivers/libcamera/parts.h"

#include <ctype.h>
#include <pthread.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>

#include "hal/base/log.h"

/* Returns the message behind "[time] [thread] ". */
static const char *after_head(const char *line)
{
	const char *thread = strstr(line, "] ["), *tail = thread ? strchr(thread + 3, ']') : NULL;

	line = tail ? tail + 1 : line;
	return line + strspn(line, " ");
}

void libcamera_message(const char *text, size_t length)
{
	static pthread_mutex_t lock = PTHREAD_MUTEX_INITIALIZER;
	static char last[1024];
	char whole[sizeof(last)];
	const char *line;
	bool error;

	while (length > 0 && isspace((unsigned char)text[length - 1]))
		length--;
	snprintf(whole, sizeof(whole), "%.*s", (int)length, text);
	line = after_head(whole);
	error = strncmp(line, "ERROR", 5) == 0 || strncmp(line, "FATAL", 5) == 0;
	pthread_mutex_lock(&lock);
	if (*line && strcmp(line, last) != 0) {
		strcpy(last, line);
		log_say(error ? LOG_LEVEL_WARNING : LOG_LEVEL_DEBUG, "libcamera: %s", line);
	}
	pthread_mutex_unlock(&lock);
}
