/* SPDX-License-Identifier: MIT */
/*
 * Messages that come again and again: the first LOG_PACE_FIRST of a text are written, later ones
 * are counted, and the count is written after a minute, after two more, four, and so on up to an
 * hour. A text that has not come for an hour is new. Pure: asks no clock, writes nothing.
 */
#ifndef INLAY_HAL_BASE_LOG_PACE_H
#define INLAY_HAL_BASE_LOG_PACE_H

#include <stdbool.h>
#include <stdint.h>

#include "hal/base/log.h"

#define LOG_PACE_FIRST 4
#define LOG_PACE_TEXTS 48     /* that are remembered; the one that came longest ago is forgotten */
#define LOG_PACE_TEXT_MAX 512 /* with its NUL; longer texts are cut */

struct log_pace {
	struct {
		char text[LOG_PACE_TEXT_MAX];
		enum log_level level;
		int64_t last_ns;  /* when it came last */
		int64_t begun_ns; /* since when it has been counted */
		int64_t span_ns;  /* for how long it is counted before that is written */
		unsigned written, counted;
	} texts[LOG_PACE_TEXTS];
};

/* Whether the text is to be written now; else it is counted. */
bool log_pace_take(struct log_pace *pace, enum log_level level, const char *text, int64_t now_ns);

/* Writes the oldest count that is due: "TEXT (60 times more in the last 60 s)". False: none is. A
 * count is also due when its text has not come for a minute. */
bool log_pace_due(struct log_pace *pace, int64_t now_ns, enum log_level *level,
		  char line[LOG_PACE_TEXT_MAX + 64]);

#endif
