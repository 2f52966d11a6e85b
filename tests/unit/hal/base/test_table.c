/* SPDX-License-Identifier: MIT */
/* Tables: what is put into them comes out as CSV, as JSON, and rounded for people. */
#include <errno.h>
#include <math.h>
#include <stdlib.h>

#include "hal/base/table.h"
#include "tests/support/test.h"

TEST("numbers are rounded for readers")
{
	static const struct {
		double value;
		const char *text;
	} cases[] = {
		{0, "0"},	   {406, "406"},       {1234567, "1234567"},
		{0.1234, "0.123"}, {0.01234, "0.012"}, {1.005e-5, "1e-05"},
		{9.996, "10.0"},   {99.6, "100"},      {-2.345, "-2.35"},
		{12.34, "12.3"},   {NAN, ""},	       {INFINITY, ""},
	};

	for (size_t k = 0; k < sizeof(cases) / sizeof(*cases); k++) {
		char text[32];

		table_rounded(cases[k].value, text, sizeof(text));
		assert_string_equal(text, cases[k].text);
	}
}

static void fill(struct table *table)
{
	table_begin(table, "rows");
	table_column(table, "group", NULL, NULL);
	table_column(table, "name", "name", NULL);
	table_column(table, "value_ms", "time", "ms");
	table_column(table, "hidden", NULL, NULL);
	table_text(table, "first");
	table_text(table, "%s", "a, \"b\"");
	table_number(table, 1.23456789);
	table_number(table, 5);
	table_text(table, "first");
	table_text(table, "plain");
	table_number(table, NAN);
	table_number(table, 6);
	table_mark(table);
	table_text(table, "second");
	table_text(table, "c, d");
	table_number(table, 1000);
	table_number(table, INFINITY);
}

TEST("tables keep what they are given")
{
	struct table table;
	struct json json;
	char *text = NULL;
	size_t bytes;
	FILE *to = open_memstream(&text, &bytes);

	assert_non_null(to);
	fill(&table);
	assert_int_equal(table_rows(&table), 3);
	assert_int_equal(table.marked, 1);
	table_write_csv(&table, to);
	json_begin_line(&json, to);
	table_write_json(&table, &json);
	json_end(&json);
	table_write_text(&table, to);
	fclose(to);
	assert_string_equal(
		text,
		"group,name,value_ms,hidden\n"
		"first,\"a, \"\"b\"\"\",1.234568,5\n"
		"first,plain,,6\n"
		"second,\"c, d\",1000,\n"
		"{\"rows\": [{\"group\": \"first\", \"name\": \"a, \\\"b\\\"\", \"value_ms\": 1.23456789, \"hidden\": 5}, "
		"{\"group\": \"first\", \"name\": \"plain\", \"value_ms\": null, \"hidden\": 6}, "
		"{\"group\": \"second\", \"name\": \"c, d\", \"value_ms\": 1000, \"hidden\": null}]}\n"
		"\nfirst\nname    time\na, \"b\"  1.23\nplain      -\n"
		"\nsecond\nname    time\nc, d    1000\n");
	free(text);
	table_free(&table);
}

TEST("too many columns are an error")
{
	struct table table;

	table_begin(&table, "wide");
	for (int k = 0; k <= TABLE_COLUMNS_MAX; k++)
		table_column(&table, "x", NULL, NULL);
	table_number(&table, 1);
	assert_int_equal(table.err, -E2BIG);
	assert_int_equal(table_rows(&table), 0);
	table_free(&table);
}
