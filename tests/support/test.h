/* SPDX-License-Identifier: MIT */
/*
 * A program of tests in cmocka's terms, without a table of them and without a main():
 *
 *	TEST("a lamp behind the camera gives nothing")
 *	{
 *		assert_int_equal(...);
 *	}
 *
 * Every TEST of the file runs, in the order of the file; `state` is cmocka's, a void **. A
 * TEST_BETWEEN has a setup and a teardown of its own; TEST_GROUP(begin, end); at the end of the
 * file names those of the whole program. Each may be NULL.
 */
#ifndef INLAY_TESTS_SUPPORT_TEST_H
#define INLAY_TESTS_SUPPORT_TEST_H

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

#include <cmocka.h>

/* What the macros call before main(). The sentence must last. */
void test_add(const char *sentence, CMUnitTestFunction run, CMFixtureFunction begin,
	      CMFixtureFunction end);
void test_group(CMFixtureFunction begin, CMFixtureFunction end);

#ifdef __cplusplus
}
#endif

#define TEST(sentence) TEST_BETWEEN(sentence, NULL, NULL)
#define TEST_BETWEEN(sentence, begin, end) TEST_AT(__LINE__, sentence, begin, end)
#define TEST_AT(line, sentence, begin, end) TEST_NAMED(line, sentence, begin, end)
#define TEST_NAMED(line, sentence, begin, end)                                                     \
	static void test_##line(void **state);                                                     \
	__attribute__((constructor)) static void add_test_##line(void)                             \
	{                                                                                          \
		test_add(sentence, test_##line, begin, end);                                       \
	}                                                                                          \
	static void test_##line(__attribute__((unused)) void **state)

#define TEST_GROUP(begin, end)                                                                     \
	__attribute__((constructor)) static void add_test_group(void)                              \
	{                                                                                          \
		test_group(begin, end);                                                            \
	}                                                                                          \
	struct takes_the_semicolon

#endif
