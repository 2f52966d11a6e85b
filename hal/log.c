#include "hal/log.h"

#include <stdarg.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

/* As in syslog(3). */
static const char *const journal_prefixes[] = {
	[LOG_LEVEL_ERROR] = "<3>",
	[LOG_LEVEL_WARNING] = "<4>",
	[LOG_LEVEL_INFO] = "<6>",
	[LOG_LEVEL_DEBUG] = "<7>",
};

static struct {
	char program[64];
	enum log_level most;
	bool journal; /* reads our stderr */
} setup = {.program = "inlay", .most = LOG_LEVEL_INFO};

/* The journal names the pipe that it reads, systemd.exec(5): it may be another one than our stderr
 * by now. */
static bool is_journal(int descriptor)
{
	const char *name = getenv("JOURNAL_STREAM");
	unsigned long long device, inode;
	struct stat s;

	return name && sscanf(name, "%llu:%llu", &device, &inode) == 2 &&
	       fstat(descriptor, &s) == 0 && s.st_dev == device && s.st_ino == inode;
}

void log_setup(const char *program, enum log_level most)
{
	setup.journal = is_journal(STDERR_FILENO);
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
	if (setup.journal)
		snprintf(line, sizeof(line) - 1, "%s", journal_prefixes[level]);
	else
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
