/* SPDX-License-Identifier: MIT */
/*
 * Presses from a file. Each line holds a time in seconds since the start, an action and, for
 * threshold-set, a value:
 *
 *     # up the threshold, then look at the fisheye view
 *     1.5  threshold-set 40
 *     3    view-next
 *
 * This is the sample driver: to write another one, copy this file and read hal/device/buttons.h (or
 * camera.h, display.h) beside it. Every driver has these parts, in this order:
 *
 *     options   filled from the configuration through the table of keys; constant while open
 *     state     everything that changes; lives from open() to close() behind buttons->state
 *     ops       open, descriptor, read, close, and the constant table that drivers.c lists
 */
#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/timerfd.h>
#include <unistd.h>

#include "drivers/drivers.h"
#include "hal/base/clock.h"
#include "hal/base/input.h"
#include "hal/base/number.h"

/* A day: longer than anybody waits, and far from overflow. */
#define SECONDS_MAX 86400.0

/* ---- options ---- */

struct script_options {
	char file[INI_PATH_MAX];
};

/* The keys appear in the configuration as [buttons] script.file, checked and with their help. */
static const struct ini_key script_keys[] = {
	{"file", INI_PATH, offsetof(struct script_options, file), .fallback = "",
	 .help = "Lines \"seconds action [value]\": presses, timed from the start."},
	INI_KEYS_END,
};

/* ---- state ---- */

struct script_line {
	int64_t at_ns; /* since open() */
	struct button_press press;
};

struct script {
	struct script_line *lines; /* in order of time */
	size_t count, next;
	int64_t start_ns;
	int timer; /* one-shot timerfd: expires when the next line is due */
};

/* ---- reading the file ---- */

/* Reads one line of the file. 1: a press; 0: a blank line; -EINVAL with a fault. */
static int parse_line(char *text, const char *path, int number, struct script_line *line,
		      struct fault *fault)
{
	char *word[4] = {NULL};
	char *rest = NULL;
	int words = 0;
	struct fault reason;
	double seconds;

	text[strcspn(text, "#\r\n")] = '\0';
	for (char *w = strtok_r(text, " \t", &rest); w && words < 4;
	     w = strtok_r(NULL, " \t", &rest))
		word[words++] = w;
	if (!words)
		return 0;
	if (number_of(word[0], &seconds) < 0 || seconds < 0 || seconds > SECONDS_MAX)
		return fault_say(fault, -EINVAL,
				 "%s:%d: \"%s\" is not a time, expected seconds from 0 to %.0f",
				 path, number, word[0], SECONDS_MAX);
	if (words < 2)
		return fault_say(fault, -EINVAL, "%s:%d: expected an action after the time", path,
				 number);
	*line = (struct script_line){.at_ns = llround(seconds * 1e9)};
	if (words > 3 || button_press_parse(word[1], word[2], &line->press, &reason))
		return fault_say(fault, -EINVAL, "%s:%d: %s", path, number,
				 words > 3 ? "expected a time, an action and at most one value"
					   : reason.text);
	return 1;
}

/* Inserts a line in order of time; lines of the same time keep their order. */
static void script_insert(struct script *script, const struct script_line *line)
{
	size_t i = script->count++;

	for (; i > 0 && script->lines[i - 1].at_ns > line->at_ns; i--)
		script->lines[i] = script->lines[i - 1];
	script->lines[i] = *line;
}

static int script_append(struct script *script, const struct script_line *line)
{
	struct script_line *larger = realloc(script->lines,
					     (script->count + 1) * sizeof(*script->lines));

	if (!larger)
		return -ENOMEM;
	script->lines = larger;
	script_insert(script, line);
	return 0;
}

static int read_script(struct script *script, const char *path, struct fault *fault)
{
	FILE *stream;
	char text[256];
	int number = 0;
	int err = input_stream(path, &stream, fault);

	if (err)
		return err;
	while (!err && fgets(text, sizeof(text), stream)) {
		struct script_line line;
		int found;

		number++;
		if (strlen(text) == sizeof(text) - 1) {
			err = fault_say(fault, -EINVAL, "%s:%d: the line is too long", path,
					number);
			break;
		}
		found = parse_line(text, path, number, &line, fault);
		if (found < 0)
			err = found;
		else if (found)
			err = script_append(script, &line);
	}
	if (!err && ferror(stream))
		err = fault_say(fault, -EIO, "%s: cannot read the button script", path);
	fclose(stream);
	return err;
}

/* ---- ops ---- */

/* Sets the timer to the next line; after the last one it never expires again. */
static int script_arm(struct script *script)
{
	struct itimerspec when = {0};

	if (script->next < script->count) {
		const int64_t at_ns = script->start_ns + script->lines[script->next].at_ns;

		when.it_value.tv_sec = (time_t)(at_ns / NS_PER_S);
		when.it_value.tv_nsec = (long)(at_ns % NS_PER_S);
	}
	return timerfd_settime(script->timer, TFD_TIMER_ABSTIME, &when, NULL) < 0 ? -errno : 0;
}

/* Sets buttons->state as soon as there is one: after a failure buttons_open() calls close(), which
 * cleans up what is half-done. A fault says what is wrong and what was expected. */
static int script_open(struct buttons *buttons, struct fault *fault)
{
	const struct script_options *options = buttons->options;
	struct script *script;
	int err;

	if (!options->file[0])
		return fault_say(fault, -EINVAL,
				 "[buttons] script.file: the script driver needs a file");
	script = calloc(1, sizeof(*script));
	if (!script)
		return fault_say(fault, -ENOMEM, "not enough memory for the button script");
	buttons->state = script;
	script->timer = timerfd_create(CLOCK_MONOTONIC, TFD_NONBLOCK | TFD_CLOEXEC);
	if (script->timer < 0) {
		err = -errno;
		return fault_say(fault, err, "button script: no timer: %s", strerror(-err));
	}
	err = read_script(script, options->file, fault);
	if (err)
		return err;
	script->start_ns = clock_now_ns();
	err = script_arm(script);
	return err ? fault_say(fault, err, "button script: timer: %s", strerror(-err)) : 0;
}

/* The program polls this descriptor and calls read() when it is readable. */
static int script_descriptor(struct buttons *buttons)
{
	return ((struct script *)buttons->state)->timer;
}

/* Never blocks. */
static int script_read(struct buttons *buttons, struct button_press *press, struct fault *fault)
{
	struct script *script = buttons->state;
	int err;

	if (script->next == script->count ||
	    clock_now_ns() < script->start_ns + script->lines[script->next].at_ns)
		return -EAGAIN;
	*press = script->lines[script->next++].press;
	/* This also makes the descriptor unreadable until the next line. */
	err = script_arm(script);
	return err ? fault_say(fault, err, "button script: timer: %s", strerror(-err)) : 0;
}

/* The only cleanup: idempotent, and accepts what open() left half-done. */
static void script_close(struct buttons *buttons)
{
	struct script *script = buttons->state;

	if (!script)
		return;
	if (script->timer >= 0)
		close(script->timer);
	free(script->lines);
	free(script);
	buttons->state = NULL;
}

const struct buttons_ops buttons_script = {
	.name = "script",
	.description = "presses from a file, timed from the start",
	.keys = script_keys,
	.options_size = sizeof(struct script_options),
	.open = script_open,
	.descriptor = script_descriptor,
	.read = script_read,
	.close = script_close,
};
