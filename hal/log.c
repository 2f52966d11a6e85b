#include "hal/log.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

static struct {
	char program[64];
	enum log_level most;
} setup = {.program = "inlay", .most = LOG_LEVEL_INFO};

void log_setup(const char *program, enum log_level most)
{
	snprintf(setup.program, sizeof(setup.program), "%s", program);
	setup.most = most;
}

/* One write() for a line, so that lines of several threads (and processes) do not mix. */
void log_say(enum log_level level, const char *format, ...)
{
	char line[2048];
	size_t length, done = 0;
	va_list args;

	if (level > setup.most)
		return;
	snprintf(line, sizeof(line) - 1, "%s: ", setup.program);
	length = strlen(line);
	va_start(args, format);
	vsnprintf(line + length, sizeof(line) - 1 - length, format, args);
	va_end(args);
	length = strlen(line);
	line[length++] = '\n';
	while (done < length) {
		const ssize_t n = write(STDERR_FILENO, line + done, length - done);

		if (n <= 0)
			return; /* nobody left to tell */
		done += (size_t)n;
	}
}
