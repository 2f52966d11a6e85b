/* SPDX-License-Identifier: MIT */
#include "tests/support/test.h"

#include <stdlib.h>

/* The largest file has 33 tests. */
enum { TESTS_MAX = 100 };

static struct CMUnitTest tests[TESTS_MAX];
static size_t count;
static CMFixtureFunction group_begin, group_end;

void test_add(const char *sentence, CMUnitTestFunction run, CMFixtureFunction begin,
	      CMFixtureFunction end)
{
	if (count == TESTS_MAX)
		abort();
	tests[count++] = (struct CMUnitTest){sentence, run, begin, end, NULL};
}

void test_group(CMFixtureFunction begin, CMFixtureFunction end)
{
	group_begin = begin;
	group_end = end;
}

int main(void)
{
	return _cmocka_run_group_tests("tests", tests, count, group_begin, group_end);
}
