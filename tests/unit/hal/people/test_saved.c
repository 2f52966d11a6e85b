/* SPDX-License-Identifier: MIT */
/* What was learned, as bytes: of pictures of any size, and never taken when a number is
 * impossible. */
#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "hal/people/people_parts.h"
#include "tests/support/expect.h"
#include "tests/support/test.h"

#define MOST 20000000

/* The header's length, and where the terms stand in it. */
#define HEADER_BYTES 88

static struct people *people_of(int width, int height, const struct dome *dome)
{
	const struct people_settings settings = {
		.width = width, .height = height, .curve = {.named = TRANSFER_SRGB}, .dome = dome};
	struct fault fault = {.text = ""};
	struct people *p = NULL;

	expect_success(people_create(&p, &settings, &fault), &fault);
	return p;
}

/* As if it had learned: other numbers in each cell and term. */
static void fill(struct people *p)
{
	for (int c = 0; c < 3; c++) {
		p->first[c] = 1 + c;
		p->gain[c] = 0.5f + (float)c;
		for (int k = 0; k < PLACE_TERMS; k++)
			for (int at = 0; at < p->cells; at++)
				p->coefficient[c][k][at] =
					(float)(at % 60000 + 1) / (float)(k + 1) + (float)c;
	}
	for (int at = 0; at < p->cells; at++)
		p->known[at] = at % 3 > 0;
	for (int band = 0; band < PLACE_BANDS; band++)
		for (int k = 0; k < PLACE_TERMS; k++)
			p->fit[band][k % 3].covariance[k][k] = band + k;
}

static uint8_t *save(const struct people *p, size_t *bytes)
{
	size_t done = 0;
	uint8_t *saved;

	*bytes = people_saved_bytes(p);
	saved = malloc(*bytes);
	assert_non_null(saved);
	while (done < *bytes)
		done = people_save(p, saved, done);
	assert_int_equal(done, *bytes);
	people_seal(saved, *bytes);
	return saved;
}

/* Terms that are kept come back to the bit; the others are 0. */
static void comes_back(int width, int height, int terms)
{
	struct fault fault = {.text = ""};
	struct people *from, *to;
	struct dome dome;
	uint8_t *saved;
	size_t bytes;

	assert_int_equal(dome_create(&dome, 1, NULL), 0);
	from = people_of(width, height, &dome);
	to = people_of(width, height, &dome);
	fill(from);
	for (int c = 0; c < 3; c++)
		for (int k = 0; k < PLACE_TERMS; k++)
			to->coefficient[c][k][7] = 12; /* of before */
	saved = save(from, &bytes);
	assert_true(bytes <= MOST);
	expect_success(people_restore(to, saved, bytes, &fault), &fault);
	assert_memory_equal(from->first, to->first, sizeof(to->first));
	assert_memory_equal(from->gain, to->gain, sizeof(to->gain));
	assert_memory_equal(from->known, to->known, (size_t)to->cells);
	assert_int_equal(memcmp(from->fit, to->fit, sizeof(to->fit)) == 0, terms == PLACE_TERMS);
	for (int c = 0; c < 3; c++)
		for (int k = 0; k < PLACE_TERMS; k++)
			for (int at = 0; at < to->cells; at++)
				if (to->coefficient[c][k][at] !=
				    (k < terms ? from->coefficient[c][k][at] : 0))
					fail_msg("cell %d, channel %d, term %d: %g", at, c, k,
						 (double)to->coefficient[c][k][at]);
	free(saved);
	people_destroy(from);
	people_destroy(to);
	dome_free(&dome);
}

TEST("all terms of common pictures come back")
{
	comes_back(320, 240, PLACE_TERMS);
	comes_back(1920, 1080, PLACE_TERMS);
}

TEST("a large picture keeps its first terms")
{
	comes_back(3840, 2160, 3);
}

TEST("impossible numbers are refused")
{
	static const float wrong[] = {__builtin_nanf(""), __builtin_inff(), -2e9f};
	struct fault fault = {.text = ""};
	struct people *p;
	struct dome dome;
	uint8_t *saved;
	size_t bytes;

	assert_int_equal(dome_create(&dome, 1, NULL), 0);
	p = people_of(64, 48, &dome);
	fill(p);
	saved = save(p, &bytes);
	for (size_t n = 0; n < sizeof(wrong) / sizeof(*wrong); n++) {
		const size_t planes = bytes - (size_t)p->cells;
		float before;

		memcpy(&before, saved + planes - 4, 4);
		memcpy(saved + planes - 4, &wrong[n], 4);
		people_seal(saved, bytes);
		assert_int_equal(people_restore(p, saved, bytes, &fault), -EBADMSG);
		assert_non_null(strstr(fault.text, "impossible"));
		memcpy(saved + planes - 4, &before, 4);
	}
	saved[bytes - 1] = 2; /* neither known nor unknown */
	people_seal(saved, bytes);
	assert_int_equal(people_restore(p, saved, bytes, &fault), -EBADMSG);
	saved[bytes - 1] = 1;
	memset(saved + HEADER_BYTES, 0xff, 8); /* not a number in a covariance */
	people_seal(saved, bytes);
	assert_int_equal(people_restore(p, saved, bytes, &fault), -EBADMSG);
	expect_equal(p->gain[2], 2.5, "what was known is untouched");
	free(saved);
	people_destroy(p);
	dome_free(&dome);
}
