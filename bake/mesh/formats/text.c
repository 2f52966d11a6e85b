/* SPDX-License-Identifier: MIT */
#include "bake/mesh/formats/soup.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#define SHOWN_MAX 64

static bool is_blank(char c)
{
	return c == ' ' || c == '\t';
}

void text_begin(struct text_lines *lines, const char *at, size_t bytes)
{
	if (bytes >= 3 && memcmp(at, "\xef\xbb\xbf", 3) == 0) {
		at += 3;
		bytes -= 3;
	}
	*lines = (struct text_lines){.rest = {at, at + bytes}};
}

bool text_next(struct text_lines *lines, struct text_span *line)
{
	struct text_span *rest = &lines->rest;

	line->at = line->end = rest->at;
	if (text_empty(*rest))
		return false;
	while (rest->at < rest->end && *rest->at != '\n' && *rest->at != '\r')
		rest->at++;
	line->end = rest->at;
	if (rest->at < rest->end)
		rest->at += rest->end - rest->at > 1 && !memcmp(rest->at, "\r\n", 2) ? 2 : 1;
	lines->line += 1 + lines->joined;
	lines->joined = 0;
	return true;
}

static bool is_continued(struct text_span line)
{
	return !text_empty(line) && line.end[-1] == '\\';
}

/* Appends a line to the buffer, a blank in place of its backslash. */
static bool text_append(struct text_lines *lines, size_t used, struct text_span line)
{
	const size_t bytes = (size_t)(line.end - line.at);

	if (used + bytes > lines->room) {
		const size_t room = 2 * (used + bytes);
		char *grown = realloc(lines->buffer, room);

		if (!grown)
			return false;
		lines->buffer = grown;
		lines->room = room;
	}
	memcpy(lines->buffer + used, line.at, bytes);
	if (is_continued(line))
		lines->buffer[used + bytes - 1] = ' ';
	return true;
}

bool text_next_joined(struct text_lines *lines, struct text_span *line)
{
	size_t used = 0;
	int first;
	bool more;

	if (!text_next(lines, line))
		return false;
	if (!is_continued(*line))
		return true;
	first = lines->line;
	do {
		more = is_continued(*line);
		if (!text_append(lines, used, *line))
			break;
		used += (size_t)(line->end - line->at);
	} while (more && text_next(lines, line));
	lines->joined = lines->line - first;
	lines->line = first;
	*line = (struct text_span){lines->buffer, lines->buffer + used};
	return true;
}

void text_end(struct text_lines *lines)
{
	free(lines->buffer);
	*lines = (struct text_lines){.line = 0};
}

struct text_span text_word(struct text_span *line)
{
	struct text_span word;

	while (line->at < line->end && is_blank(*line->at))
		line->at++;
	word.at = line->at;
	while (line->at < line->end && !is_blank(*line->at))
		line->at++;
	word.end = line->at;
	return word;
}

struct text_span text_name(struct text_span line)
{
	while (line.at < line.end && is_blank(*line.at))
		line.at++;
	while (line.at < line.end && is_blank(line.end[-1]))
		line.end--;
	return line;
}

int text_shown(struct text_span span)
{
	return span.end - span.at < SHOWN_MAX ? (int)(span.end - span.at) : SHOWN_MAX;
}

bool text_is(struct text_span word, const char *text)
{
	const size_t length = (size_t)(word.end - word.at);

	return length == strlen(text) && memcmp(word.at, text, length) == 0;
}

bool text_begins(struct text_span line, const char *text)
{
	const size_t length = strlen(text);

	return (size_t)(line.end - line.at) >= length && memcmp(line.at, text, length) == 0;
}

bool text_is_any_case(struct text_span word, const char *text)
{
	const size_t length = (size_t)(word.end - word.at);

	return length == strlen(text) && strncasecmp(word.at, text, length) == 0;
}

int text_place(struct text_span word, const char *list)
{
	const size_t length = (size_t)(word.end - word.at);

	for (int place = 0; *list && length; place++) {
		const size_t end = strcspn(list, " ");

		if (end == length && strncasecmp(list, word.at, length) == 0)
			return place;
		list += end + (list[end] != '\0');
	}
	return -1;
}

char *text_copy(struct text_span span)
{
	return strndup(span.at, (size_t)(span.end - span.at));
}

bool text_number(struct text_span word, double *value)
{
	const size_t length = (size_t)(word.end - word.at);
	char text[128], *stop;

	if (length >= sizeof(text))
		return false;
	memcpy(text, word.at, length);
	text[length] = '\0';
	*value = strtod(text, &stop);
	if (*stop == '#' && stop > text && stop[-1] == '.') {
		*value = strncmp(stop, "#INF", 4) == 0 ? copysign(INFINITY, *value) : NAN;
		return isinf(*value) || !strncmp(stop, "#IND", 4) || !strncmp(stop, "#QNAN", 5);
	}
	return length && stop == text + length;
}

bool text_whole(struct text_span *word, int64_t *value)
{
	const char *c = word->at;
	const bool minus = c < word->end && *c == '-';
	int64_t whole = 0;

	c += c < word->end && (*c == '-' || *c == '+');
	if (c == word->end || *c < '0' || *c > '9')
		return false;
	for (; c < word->end && *c >= '0' && *c <= '9'; c++) {
		whole = 10 * whole + (*c - '0');
		if (whole >> 40)
			return false;
	}
	word->at = c;
	*value = minus ? -whole : whole;
	return true;
}
