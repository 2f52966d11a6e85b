/* SPDX-License-Identifier: MIT */
/* Writes JSON: values one after the other, commas and indentation put between them. */
#ifndef INLAY_BAKE_CALIBRATE_ESTIMATE_JSON_H
#define INLAY_BAKE_CALIBRATE_ESTIMATE_JSON_H

#include <stdbool.h>
#include <stdio.h>

#define JSON_DEPTH_MAX 16

struct json {
	FILE *to; /* what it says of failures is the caller's to ask */
	int depth;
	bool filled[JSON_DEPTH_MAX];  /* something stands at this depth already */
	bool on_line[JSON_DEPTH_MAX]; /* an array whose values stand on one line */
	char closing[JSON_DEPTH_MAX];
};

/* The outermost object is opened; json_end() closes the last that is open. */
void json_begin(struct json *json, FILE *to);
void json_end(struct json *json);

/* key: NULL inside an array. At most JSON_DEPTH_MAX of them in each other. */
void json_object(struct json *json, const char *key);
void json_array(struct json *json, const char *key);
void json_line(struct json *json, const char *key); /* an array on one line */

void json_text(struct json *json, const char *key, const char *text);
void json_number(struct json *json, const char *key, double value); /* not finite: null */
void json_bool(struct json *json, const char *key, bool value);
void json_numbers(struct json *json, const char *key, const double *value, int count);

#endif
