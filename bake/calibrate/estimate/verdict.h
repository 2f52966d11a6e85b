/* SPDX-License-Identifier: MIT */
/* Verdict on a calibration: whether it can be trusted, and if not, why and what to do, in one
 * sentence. */
#ifndef INLAY_BAKE_CALIBRATE_ESTIMATE_VERDICT_H
#define INLAY_BAKE_CALIBRATE_ESTIMATE_VERDICT_H

#include <stdbool.h>

#define VERDICT_SENTENCE_MAX 516

struct json;

struct verdict {
	bool trusted;
	char reason[256]; /* "the board is parallel to the picture: f and distance ..."; empty if
			     trusted */
	char remedy[256]; /* "tilt it by 30 degrees or more" */
};

/* Sets the verdict to trusted. */
void verdict_begin(struct verdict *verdict);

/* Records a doubt. Only the first one is kept: call in order of gravity. */
void verdict_doubt(struct verdict *verdict, const char *remedy, const char *reason, ...)
	__attribute__((format(printf, 3, 4)));

/* Writes "reason; remedy" or "trusted"; VERDICT_SENTENCE_MAX bytes are enough. */
void verdict_sentence(const struct verdict *verdict, char *text, int room);

/* Writes an object "verdict" with the members trusted, sentence, reason, remedy. */
void verdict_write_json(struct json *json, const struct verdict *verdict);

/* Returns 0 if trusted; else logs the sentence and returns 1. */
int verdict_end(const struct verdict *verdict);

#endif
