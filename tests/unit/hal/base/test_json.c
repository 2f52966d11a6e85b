/* SPDX-License-Identifier: MIT */
/* The writers of JSON and CSV: what stands between values, what is quoted, and that no digit is
 * lost. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "hal/base/json.h"
#include "tests/support/test.h"

TEST("json is indented and quoted")
{
	static const double numbers[] = {0.1, -3, NAN, 1e300};
	struct json json;
	char *text = NULL;
	size_t bytes;
	FILE *to = open_memstream(&text, &bytes);

	assert_non_null(to);
	json_begin(&json, to);
	json_text(&json, "a\"b", "tab\t, back\\slash, \xc3\xa9, \xe9t\xe9, \xed\xa0\x80");
	json_array(&json, "nested");
	json_numbers(&json, NULL, numbers, 4);
	json_object(&json, NULL);
	json_end(&json);
	json_object_line(&json, NULL);
	json_text(&json, "none", NULL);
	json_array(&json, "on the same line");
	json_number(&json, NULL, 1);
	json_number(&json, NULL, 2);
	json_end(&json);
	json_end(&json);
	json_bool(&json, NULL, false);
	json_end(&json);
	json_end(&json);
	fclose(to);
	assert_string_equal(
		text,
		"{\n"
		"\t\"a\\\"b\": \"tab\\u0009, back\\\\slash, \xc3\xa9, \\ufffdt\\ufffd, \\ufffd\\ufffd\\ufffd\",\n"
		"\t\"nested\": [\n\t\t[0.1, -3, null, 1e+300],\n\t\t{},\n"
		"\t\t{\"none\": null, \"on the same line\": [1, 2]},\n"
		"\t\tfalse\n\t]\n}\n");
	free(text);
}

TEST("json keeps every digit")
{
	static const double numbers[] = {1.0 / 3, 0.1 + 0.2, 5e-324, 9007199254740993.0, -M_PI};

	for (size_t k = 0; k < sizeof(numbers) / sizeof(*numbers); k++) {
		struct json json;
		char *text = NULL;
		size_t bytes;
		FILE *to = open_memstream(&text, &bytes);

		assert_non_null(to);
		json_begin_line(&json, to);
		json_number(&json, "x", numbers[k]);
		json_end(&json);
		fclose(to);
		assert_true(strtod(strchr(text, ':') + 1, NULL) == numbers[k]);
		free(text);
	}
}
