/* SPDX-License-Identifier: MIT */
/* Whether a calibration can be trusted, and if not, why and what to do: one sentence. */
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

/* Trusted, until verdict_doubt() says otherwise. */
void verdict_begin(struct verdict *verdict);

/* The first doubt stands: call in order of gravity. */
void verdict_doubt(struct verdict *verdict, const char *remedy, const char *reason, ...)
	__attribute__((format(printf, 3, 4)));

/* "reason; remedy" or "trusted"; VERDICT_SENTENCE_MAX is room enough. */
void verdict_sentence(const struct verdict *verdict, char *text, int room);

/* An object "verdict": trusted, sentence, reason, remedy. */
void verdict_write_json(struct json *json, const struct verdict *verdict);

/* 0, or says in the log why not to trust what was found, and 1. */
int verdict_end(const struct verdict *verdict);

#endif
