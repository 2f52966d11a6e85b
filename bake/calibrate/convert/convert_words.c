/* SPDX-License-Identifier: MIT */
#include "bake/calibrate/convert/convert_words.h"

#include <ctype.h>
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "hal/base/number.h"

/* Whether a key is this word, without regard to case and underscores. */
static bool is_word(const char *key, const char *word)
{
	for (;;) {
		key += strspn(key, "_");
		if (!*key || !*word)
			return !*key && !*word;
		if (tolower((unsigned char)*key++) != *word++)
			return false;
	}
}

struct words_place words_place(struct lens_words *w, const char *key)
{
	const struct {
		const char *word;
		struct words_place place;
	} all[] = {
		{"cameramatrix", {.kind = WORDS_MATRIX, .matrix = &w->matrix}},
		{"k", {.kind = WORDS_MATRIX, .matrix = &w->matrix}},
		{"distortioncoefficients", {.kind = WORDS_MATRIX, .matrix = &w->distortion}},
		{"distortioncoeffs", {.kind = WORDS_MATRIX, .matrix = &w->distortion}},
		{"distcoeffs", {.kind = WORDS_MATRIX, .matrix = &w->distortion}},
		{"distcoeff", {.kind = WORDS_MATRIX, .matrix = &w->distortion}},
		{"d", {.kind = WORDS_MATRIX, .matrix = &w->distortion}},
		{"intrinsics", {.kind = WORDS_MATRIX, .matrix = &w->intrinsics}},
		{"xi", {.kind = WORDS_MATRIX, .matrix = &w->xi}},
		{"resolution", {.kind = WORDS_MATRIX, .matrix = &w->resolution}},
		{"imagesize", {.kind = WORDS_MATRIX, .matrix = &w->resolution}},
		{"imagewidth", {WORDS_INT, .number = &w->width, .least = 1, .most = TSAI_SIDE_MAX}},
		{"width", {WORDS_INT, .number = &w->width, .least = 1, .most = TSAI_SIDE_MAX}},
		{"imageheight",
		 {WORDS_INT, .number = &w->height, .least = 1, .most = TSAI_SIDE_MAX}},
		{"height", {WORDS_INT, .number = &w->height, .least = 1, .most = TSAI_SIDE_MAX}},
		{"fisheyemodel", {WORDS_INT, .number = &w->fisheye, .least = 0, .most = 1}},
		{"distortionmodel", {.kind = WORDS_TEXT, .text = &w->distortion_model}},
		{"cameramodel", {.kind = WORDS_TEXT, .text = &w->camera_model}},
	};

	for (size_t i = 0; i < sizeof(all) / sizeof(all[0]); i++)
		if (is_word(key, all[i].word))
			return all[i].place;
	return (struct words_place){.kind = WORDS_UNKNOWN};
}

int words_fault(const struct lens_words *words, int line, const char *key, const char *expected)
{
	return fault_say(words->fault, -EINVAL, "%s:%d: %s: expected %s", words->path, line, key,
			 expected);
}

int words_int(const struct lens_words *words, int line, const char *key, const char *text,
	      int least, int most, int *value)
{
	char *end, expected[64];
	long n;

	errno = 0;
	n = strtol(text, &end, 10);
	if (!errno && end != text && !end[strspn(end, " \t")] && n >= least && n <= most) {
		*value = (int)n;
		return 0;
	}
	snprintf(expected, sizeof(expected), "a whole number from %d to %d", least, most);
	return words_fault(words, line, key, expected);
}

int words_numbers(const struct lens_words *words, int line, const char **at, char end,
		  struct words_matrix *m)
{
	for (;;) {
		double value;

		*at += strspn(*at, " \t,");
		if (!**at || **at == '#' || (end && **at == end))
			return 0;
		if (number_read(at, &value) || (**at && **at != end && !strchr(" \t,", **at)))
			return words_fault(words, line, m->key,
					   end ? "finite numbers between [ and ]"
					       : "finite numbers");
		if (m->count == WORDS_DATA_MAX)
			return words_fault(words, line, m->key, "fewer numbers");
		m->data[m->count++] = value;
	}
}

int words_begin(const struct lens_words *words, int line, const char *key, struct words_matrix *m)
{
	if (m->line)
		return words_fault(words, line, key, "to be there once");
	*m = (struct words_matrix){.line = line};
	snprintf(m->key, sizeof(m->key), "%s", key);
	return 0;
}

int words_end(const struct lens_words *words, struct words_matrix *m, bool list)
{
	if (list) {
		m->rows = m->count == 9 ? 3 : 1;
		m->columns = m->count / m->rows;
		return 0;
	}
	if (m->count && m->count == m->rows * m->columns)
		return 0;
	return fault_say(
		words->fault, -EINVAL,
		"%s:%d: %s: has %d rows, %d columns and %d numbers, expected as many as rows times columns",
		words->path, m->line, m->key, m->rows, m->columns, m->count);
}
