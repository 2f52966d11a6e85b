/* SPDX-License-Identifier: MIT */
/* What bench and report measure with, and how a report prints it: runs in turn, medians, cells of
 * tables. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "bake/base/report_table.h"
#include "hal/base/clock.h"
#include "hal/measure/turns.h"
#include "tests/support/expect.h"
#include "tests/support/test.h"

/* ---- turns ---- */

#define WAYS 3
#define REPEAT 4

struct log {
	int prepared[WAYS], ran[WAYS];
	int last_turn, last_way;
	bool disordered;
	int fails_at; /* number of the way that fails; -1: none */
};

static int test_measure_prepare(void *context, int way, int turn)
{
	struct log *log = context;

	log->prepared[way]++;
	log->disordered |= turn < log->last_turn || (turn == log->last_turn && way < log->last_way);
	log->last_turn = turn;
	log->last_way = way;
	return 0;
}

/* The third way sleeps, which takes time of the clock and not of the processor. */
static int test_measure_run(void *context, int way)
{
	struct log *log = context;

	log->ran[way]++;
	log->disordered |= way != log->last_way;
	if (way == 2)
		usleep(2000);
	return way == log->fails_at ? -5 : 0;
}

static bool is_alone(void *context, int way)
{
	(void)context;
	return way != 1;
}

static struct turns turns_of(struct log *log)
{
	return (struct turns){.context = log,
			      .ways = WAYS,
			      .repeat = REPEAT,
			      .prepare = test_measure_prepare,
			      .run = test_measure_run,
			      .is_alone = is_alone};
}

TEST("ways take turns")
{
	struct log log = {.fails_at = -1};
	struct turns turns = turns_of(&log);
	double ms[WAYS * REPEAT];

	for (int k = 0; k < WAYS * REPEAT; k++)
		ms[k] = -1;
	assert_int_equal(turns_time(&turns, ms), 0);
	assert_false(log.disordered);
	for (int k = 0; k < WAYS; k++) {
		expect_at_least(log.ran[k], 2 * REPEAT, "k=%d", k); /* some of them untimed */
		expect_equal(log.prepared[k], log.ran[k], "k=%d", k);
	}
	for (int k = 0; k < WAYS * REPEAT; k++)
		expect_at_least(ms[k], 0, "k=%d", k);
	/* a sleeping way: the clock goes on, the processor does other work */
	assert_true(turns.timed_ns >= REPEAT * 2 * NS_PER_MS);
	assert_true(turns.ran_ns < turns.timed_ns);
	assert_true(turns_median(ms + (ptrdiff_t)2 * REPEAT, REPEAT) < 2);
}

TEST("a failure ends all")
{
	struct log log = {.fails_at = 1};
	struct turns turns = turns_of(&log);
	double ms[WAYS * REPEAT];

	assert_int_equal(turns_time(&turns, ms), -5);
	assert_int_equal(log.ran[1], 1);
	assert_int_equal(log.ran[2], 0);
}

TEST("the median is in the middle")
{
	double odd[] = {9, 1, 5}, even[] = {8, 2, 100, 4}, one[] = {7};

	assert_true(turns_median(odd, 3) == 5);
	assert_true(turns_median(even, 4) == 6);
	assert_true(turns_median(one, 1) == 7);
}

TEST("half of the times are between the quartiles")
{
	double nine[] = {5, 9, 1, 7, 3, 2, 8, 6, 4}, four[] = {40, 10, 30, 20}, one[] = {7};
	const struct turns_spread of_nine = turns_spread(nine, 9), of_four = turns_spread(four, 4),
				  of_one = turns_spread(one, 1);

	assert_true(of_nine.low == 3 && of_nine.median == 5 && of_nine.high == 7);
	assert_true(of_four.low == 17.5 && of_four.median == 25 && of_four.high == 32.5);
	assert_true(of_one.low == 7 && of_one.median == 7 && of_one.high == 7);
}

/* ---- tables ---- */

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

		report_rounded(cases[k].value, text, sizeof(text));
		assert_string_equal(text, cases[k].text);
	}
}

static void test_measure_fill(struct report_table *table)
{
	report_table_begin(table, "table");
	report_table_column(table, "name", "name", NULL);
	report_table_column(table, "value_ms", "time", "ms");
	report_table_column(table, "hidden", NULL, NULL);
	report_text(table, "%s", "a, \"b\" & <c>");
	report_number(table, 1.23456789);
	report_number(table, 5);
	report_text(table, "plain");
	report_number(table, NAN);
	report_number(table, 6);
	report_table_mark(table);
}

TEST("tables keep what they are given")
{
	struct report_table table;
	struct fault fault;
	char folder[] = "/tmp/inlay-table-XXXXXX", path[64], text[256];
	size_t got;
	FILE *file;

	test_measure_fill(&table);
	assert_int_equal(report_table_rows(&table), 2);
	assert_int_equal(table.marked, 1);
	assert_non_null(mkdtemp(folder));
	assert_int_equal(report_table_write_csv(&table, folder, &fault), 0);
	snprintf(path, sizeof(path), "%s/table.csv", folder);
	file = fopen(path, "r");
	assert_non_null(file);
	got = fread(text, 1, sizeof(text) - 1, file);
	text[got] = '\0';
	fclose(file);
	assert_string_equal(text, "name,value_ms,hidden\n"
				  "\"a, \"\"b\"\" & <c>\",1.234568,5\n"
				  "plain,,6\n");
	unlink(path);
	rmdir(folder);
	report_table_free(&table);
}

TEST("tables are safe in html")
{
	struct report_table table;
	char *text = NULL;
	size_t bytes = 0;
	FILE *file = open_memstream(&text, &bytes);

	assert_non_null(file);
	test_measure_fill(&table);
	report_table_write_html(&table, file);
	fclose(file);
	assert_non_null(strstr(text, "<td>a, &quot;b&quot; &amp; &lt;c&gt;</td>"));
	assert_non_null(strstr(text, "<td class=\"n\">1.23</td></tr>"));
	assert_non_null(
		strstr(text, "<tr class=\"used\"><td>plain</td><td class=\"n\"></td></tr>"));
	assert_null(strstr(text, "hidden"));
	free(text);
	report_table_free(&table);
}

TEST("too many columns are an error")
{
	struct report_table table;
	struct fault fault;

	report_table_begin(&table, "wide");
	for (int k = 0; k <= REPORT_COLUMNS_MAX; k++)
		report_table_column(&table, "x", NULL, NULL);
	assert_true(report_table_write_csv(&table, "/tmp", &fault) < 0);
	assert_non_null(strstr(fault.text, "wide"));
	report_table_free(&table);
}
