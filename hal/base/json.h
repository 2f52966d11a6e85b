/* SPDX-License-Identifier: MIT */
/* A JSON writer: values in order; it adds commas and indentation. */
#ifndef INLAY_HAL_BASE_JSON_H
#define INLAY_HAL_BASE_JSON_H

#include <stdbool.h>
#include <stdio.h>

#define JSON_DEPTH_MAX 16

struct json {
	FILE *to; /* the caller checks it for write errors */
	int depth;
	bool filled[JSON_DEPTH_MAX];  /* a value was written at this depth already */
	bool on_line[JSON_DEPTH_MAX]; /* its values, and all that they hold, share one line */
	char closing[JSON_DEPTH_MAX];
};

/* json_begin() opens the outermost object, json_begin_line() one on a single line; json_end()
 * closes the innermost open object or array. */
void json_begin(struct json *json, FILE *to);
void json_begin_line(struct json *json, FILE *to);
void json_end(struct json *json);

/* Open an object or an array. key is NULL inside an array. At most JSON_DEPTH_MAX levels. */
void json_object(struct json *json, const char *key);
void json_array(struct json *json, const char *key);
/* The same with all that they hold on one line. */
void json_object_line(struct json *json, const char *key);
void json_line(struct json *json, const char *key);

/* null where text is NULL */
void json_text(struct json *json, const char *key, const char *text);
/* all digits of value; null where it is not finite */
void json_number(struct json *json, const char *key, double value);
void json_bool(struct json *json, const char *key, bool value);
void json_numbers(struct json *json, const char *key, const double *value, int count);

#endif
