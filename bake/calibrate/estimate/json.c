/* SPDX-License-Identifier: MIT */
#include "bake/calibrate/estimate/json.h"

#include <assert.h>
#include <math.h>

/* ---- what stands before a value ---- */

/* Length in bytes of the UTF-8 character at text; 0: the bytes are not UTF-8 (RFC 3629, table 3-7
 * of Unicode). */
static int utf8_length(const unsigned char *text)
{
	const unsigned first = text[0], second = text[1];
	int length = first < 0x80 ? 1 : first < 0xe0 ? 2 : first < 0xf0 ? 3 : 4;

	if ((first >= 0x80 && first < 0xc2) || first > 0xf4 || (first == 0xe0 && second < 0xa0) ||
	    (first == 0xed && second > 0x9f) || (first == 0xf0 && second < 0x90) ||
	    (first == 0xf4 && second > 0x8f))
		return 0;
	for (int k = 1; k < length; k++)
		if ((text[k] & 0xc0) != 0x80)
			return 0;
	return length;
}

/* File names need not be UTF-8, but JSON must be: invalid bytes become U+FFFD. */
static void write_json_text(FILE *to, const char *text)
{
	fputc('"', to);
	while (*text) {
		const unsigned char c = (unsigned char)*text;
		const int length = utf8_length((const unsigned char *)text);

		if (!length)
			fputs("\\ufffd", to);
		else if (c == '"' || c == '\\')
			fprintf(to, "\\%c", c);
		else if (c < 0x20)
			fprintf(to, "\\u%04x", c);
		else
			fwrite(text, 1, (size_t)length, to);
		text += length ? length : 1;
	}
	fputc('"', to);
}

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
	write_json_text(json->to, key);
	fputs(": ", json->to);
}

static void open_level(struct json *json, char opening, char closing, bool on_line)
{
	assert(json->depth < JSON_DEPTH_MAX);
	fputc(opening, json->to);
	json->closing[json->depth] = closing;
	json->on_line[json->depth] = on_line;
	json->filled[json->depth] = false;
	json->depth++;
}

/* ---- values ---- */

void json_begin(struct json *json, FILE *to)
{
	*json = (struct json){.to = to};
	open_level(json, '{', '}', false);
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
	write_json_text(json->to, text);
}

void json_number(struct json *json, const char *key, double value)
{
	before_value(json, key);
	if (isfinite(value))
		fprintf(json->to, "%.15g", value);
	else
		fputs("null", json->to);
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
