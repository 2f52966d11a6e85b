/* SPDX-License-Identifier: MIT */
#include "hal/base/log.h"

#include <pthread.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "hal/base/clock.h"
#include "hal/base/log_pace.h"

enum { TEXT_MAX = 2048, SAID_MAX = 256 };

/* Says which messages of a text are written. */
enum choice { EACH, ONCE, PACED };

/* Levels of syslog(3). */
static const char *const journal_prefixes[] = {
	[LOG_LEVEL_ERROR] = "<3>",
	[LOG_LEVEL_WARNING] = "<4>",
	[LOG_LEVEL_INFO] = "<6>",
	[LOG_LEVEL_DEBUG] = "<7>",
};

static struct {
	char program[64];
	enum log_level most;
	bool journal; /* stderr leads to the system's journal */
} setup = {.program = "inlay", .most = LOG_LEVEL_INFO};

/* JOURNAL_STREAM names the device and inode that the journal reads (systemd.exec(5)). stderr may
 * have been redirected since, so both are compared. */
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

/* Bytes of the control character at this place, 0 for none: C0 but tab, DEL, and C1 in UTF-8. */
static size_t control_bytes(const char *at)
{
	const unsigned char c = (unsigned char)at[0], next = (unsigned char)at[1];

	if ((c < 0x20 && c != '\t') || c == 0x7f)
		return 1;
	return c == 0xc2 && next >= 0x80 && next < 0xa0 ? 2 : 0;
}

/* Replaces control characters: names and contents of files may hold line breaks, or escape
 * sequences for the reader's terminal. */
static void text_make_plain(char *text)
{
	while (*text) {
		size_t bytes = control_bytes(text);

		if (!bytes)
			text++;
		while (bytes--)
			*text++ = '?';
	}
}

/* FNV-1a hash. */
static uint64_t text_hash(const char *text)
{
	uint64_t h = 0xcbf29ce484222325;

	for (; *text; text++)
		h = (h ^ (unsigned char)*text) * 0x100000001b3;
	return h;
}

static bool is_new(const char *text)
{
	static pthread_mutex_t lock = PTHREAD_MUTEX_INITIALIZER;
	static uint64_t said[SAID_MAX];
	static unsigned count;
	const uint64_t this = text_hash(text);
	bool found = false;

	pthread_mutex_lock(&lock);
	for (unsigned i = 0; i < SAID_MAX && i < count && !found; i++)
		found = said[i] == this;
	if (!found)
		said[count++ % SAID_MAX] = this;
	pthread_mutex_unlock(&lock);
	return !found;
}

static pthread_mutex_t pace_lock = PTHREAD_MUTEX_INITIALIZER;
static struct log_pace paced;

static bool is_in_pace(enum log_level level, const char *text)
{
	bool now;

	pthread_mutex_lock(&pace_lock);
	now = log_pace_take(&paced, level, text, clock_now_ns());
	pthread_mutex_unlock(&pace_lock);
	return now;
}

/* Calls write() once for a line, so that lines of several threads and processes do not mix. */
static void __attribute__((format(printf, 3, 0)))
log_write(enum log_level level, enum choice which, const char *format, va_list args)
{
	char line[TEXT_MAX], *text;
	size_t length, done = 0;

	if (level > setup.most)
		return;
	if (setup.journal)
		snprintf(line, sizeof(line) - 1, "%s", journal_prefixes[level]);
	else
		snprintf(line, sizeof(line) - 1, "%s: ", setup.program);
	text = line + strlen(line);
	vsnprintf(text, sizeof(line) - 1 - (size_t)(text - line), format, args);
	if ((which == ONCE && !is_new(text)) || (which == PACED && !is_in_pace(level, text)))
		return;
	text_make_plain(text);
	length = strlen(line);
	line[length++] = '\n';
	while (done < length) {
		const ssize_t n = write(STDERR_FILENO, line + done, length - done);

		if (n <= 0)
			return; /* stderr is closed: there is no place to report it */
		done += (size_t)n;
	}
}

void log_say(enum log_level level, const char *format, ...)
{
	va_list args;

	va_start(args, format);
	log_write(level, EACH, format, args);
	va_end(args);
}

void log_say_once(enum log_level level, const char *format, ...)
{
	va_list args;

	va_start(args, format);
	log_write(level, ONCE, format, args);
	va_end(args);
}

void log_say_paced(enum log_level level, const char *format, ...)
{
	va_list args;

	va_start(args, format);
	log_write(level, PACED, format, args);
	va_end(args);
}

void log_tick(void)
{
	char line[LOG_PACE_TEXT_MAX + 64];
	enum log_level level;
	bool due;

	do {
		pthread_mutex_lock(&pace_lock);
		due = log_pace_due(&paced, clock_now_ns(), &level, line);
		pthread_mutex_unlock(&pace_lock);
		if (due)
			log_say(level, "%s", line);
	} while (due);
}

#define MINUTE_NS (60 * NS_PER_S)
#define HOUR_NS (60 * MINUTE_NS)

/* The place of this text, or else the place whose text came longest ago; that of a count which has
 * not been written only where all have one. */
static int find_place(const struct log_pace *pace, const char *text)
{
	int best = 0;

	for (int i = 0; i < LOG_PACE_TEXTS; i++) {
		const bool waits = pace->texts[i].counted > 0;
		const bool best_waits = pace->texts[best].counted > 0;

		if (!strncmp(pace->texts[i].text, text, LOG_PACE_TEXT_MAX - 1))
			return i;
		if (waits == best_waits ? pace->texts[i].last_ns < pace->texts[best].last_ns
					: best_waits)
			best = i;
	}
	return best;
}

bool log_pace_take(struct log_pace *pace, enum log_level level, const char *text, int64_t now_ns)
{
	const int i = find_place(pace, text);
	const bool known = !strncmp(pace->texts[i].text, text, LOG_PACE_TEXT_MAX - 1);

	if (!known || (!pace->texts[i].counted && now_ns - pace->texts[i].last_ns >= HOUR_NS)) {
		snprintf(pace->texts[i].text, LOG_PACE_TEXT_MAX, "%s", text);
		pace->texts[i].written = pace->texts[i].counted = 0;
		pace->texts[i].span_ns = MINUTE_NS;
	}
	pace->texts[i].level = level;
	pace->texts[i].last_ns = now_ns;
	if (pace->texts[i].written < LOG_PACE_FIRST) {
		pace->texts[i].written++;
		pace->texts[i].begun_ns = now_ns;
		return true;
	}
	pace->texts[i].counted++;
	return false;
}

bool log_pace_due(struct log_pace *pace, int64_t now_ns, enum log_level *level,
		  char line[LOG_PACE_TEXT_MAX + 64])
{
	int due = -1;
	int64_t seconds;

	for (int i = 0; i < LOG_PACE_TEXTS; i++) {
		const bool over = now_ns - pace->texts[i].begun_ns >= pace->texts[i].span_ns ||
				  now_ns - pace->texts[i].last_ns >= MINUTE_NS;

		if (pace->texts[i].counted && over &&
		    (due < 0 || pace->texts[i].last_ns < pace->texts[due].last_ns))
			due = i;
	}
	if (due < 0)
		return false;
	seconds = (now_ns - pace->texts[due].begun_ns) / NS_PER_S;
	*level = pace->texts[due].level;
	snprintf(line, LOG_PACE_TEXT_MAX + 64, "%s (%u time%s more in the last %lld %s)",
		 pace->texts[due].text, pace->texts[due].counted,
		 pace->texts[due].counted == 1 ? "" : "s",
		 (long long)(seconds < 120 ? seconds : seconds / 60), seconds < 120 ? "s" : "min");
	pace->texts[due].counted = 0;
	pace->texts[due].begun_ns = now_ns;
	if (pace->texts[due].span_ns < HOUR_NS)
		pace->texts[due].span_ns = 2 * pace->texts[due].span_ns < HOUR_NS
						   ? 2 * pace->texts[due].span_ns
						   : HOUR_NS;
	return true;
}
