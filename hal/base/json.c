/* SPDX-License-Identifier: MIT */
#include "hal/base/json.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>

#include "hal/base/utf8.h"

/* ---- what stands before a value ---- */

static void new_line(const struct json *json)
{
	fputc('\n', json->to);
	for (int k = 0; k < json->depth; k++)
		fputc('\t', json->to);
}

static void before_value(struct json *json, const char *key)
{
	const int at = json->depth - 1;

	if (json->filled[at])
		fputs(json->on_line[at] ? ", " : ",", json->to);
	json->filled[at] = true;
	if (!json->on_line[at])
		new_line(json);
	if (!key)
		return;
	utf8_write_json(json->to, key);
	fputs(": ", json->to);
}

static void open_level(struct json *json, char opening, char closing, bool on_line)
{
	assert(json->depth < JSON_DEPTH_MAX);
	fputc(opening, json->to);
	json->closing[json->depth] = closing;
	json->on_line[json->depth] = on_line || (json->depth && json->on_line[json->depth - 1]);
	json->filled[json->depth] = false;
	json->depth++;
}

/* ---- values ---- */

void json_begin(struct json *json, FILE *to)
{
	*json = (struct json){.to = to};
	open_level(json, '{', '}', false);
}

void json_begin_line(struct json *json, FILE *to)
{
	*json = (struct json){.to = to};
	open_level(json, '{', '}', true);
}

void json_end(struct json *json)
{
	const int at = json->depth - 1;

	json->depth--;
	if (json->filled[at] && !json->on_line[at])
		new_line(json);
	fputc(json->closing[at], json->to);
	if (!json->depth)
		fputc('\n', json->to);
}

void json_object(struct json *json, const char *key)
{
	before_value(json, key);
	open_level(json, '{', '}', false);
}

void json_object_line(struct json *json, const char *key)
{
	before_value(json, key);
	open_level(json, '{', '}', true);
}

void json_array(struct json *json, const char *key)
{
	before_value(json, key);
	open_level(json, '[', ']', false);
}

void json_line(struct json *json, const char *key)
{
	before_value(json, key);
	open_level(json, '[', ']', true);
}

void json_text(struct json *json, const char *key, const char *text)
{
	before_value(json, key);
	if (text)
		utf8_write_json(json->to, text);
	else
		fputs("null", json->to);
}

void json_number(struct json *json, const char *key, double value)
{
	char text[32] = "null";

	before_value(json, key);
	/* most doubles come from a decimal number of at most 15 digits, the others need 17 */
	if (isfinite(value) && snprintf(text, sizeof(text), "%.15g", value) &&
	    strtod(text, NULL) != value)
		snprintf(text, sizeof(text), "%.17g", value);
	fputs(text, json->to);
}

void json_bool(struct json *json, const char *key, bool value)
{
	before_value(json, key);
	fputs(value ? "true" : "false", json->to);
}

void json_numbers(struct json *json, const char *key, const double *value, int count)
{
	json_line(json, key);
	for (int k = 0; k < count; k++)
		json_number(json, NULL, value[k]);
	json_end(json);
}
