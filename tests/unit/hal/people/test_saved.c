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
#define HEADER_BYTES 96

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
	struct place *place = &p->place;

	for (int c = 0; c < 3; c++) {
		place->first[c] = 1 + c;
		place->gain[c] = 0.5f + (float)c;
		for (int k = 0; k < PLACE_TERMS; k++)
			for (int at = 0; at < p->cells.count; at++)
				place->coefficient[c][k][at] =
					(float)(at % 60000 + 1) / (float)(k + 1) + (float)c;
	}
	for (int at = 0; at < p->cells.count; at++)
		place->known[at] = at % 3 > 0;
	for (int band = 0; band < PLACE_BANDS; band++)
		for (int k = 0; k < PLACE_TERMS; k++)
			place->fit[band][k % 3].covariance[k][k] = band + k;
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

/* What was learned comes back to the bit. */
static void comes_back(int width, int height)
{
	struct fault fault = {.text = ""};
	struct people *from, *to;
	struct place *was, *is;
	struct dome dome;
	uint8_t *saved;
	size_t bytes;

	assert_int_equal(dome_create(&dome, 1, NULL), 0);
	from = people_of(width, height, &dome);
	to = people_of(width, height, &dome);
	was = &from->place;
	is = &to->place;
	fill(from);
	for (int c = 0; c < 3; c++)
		for (int k = 0; k < PLACE_TERMS; k++)
			is->coefficient[c][k][7] = 12; /* of before */
	saved = save(from, &bytes);
	assert_true(bytes <= MOST);
	expect_success(people_restore(to, saved, bytes, &fault), &fault);
	assert_memory_equal(was->first, is->first, sizeof(is->first));
	assert_memory_equal(was->gain, is->gain, sizeof(is->gain));
	assert_memory_equal(was->known, is->known, (size_t)to->cells.count);
	assert_memory_equal(was->fit, is->fit, sizeof(is->fit));
	for (int c = 0; c < 3; c++)
		for (int k = 0; k < PLACE_TERMS; k++)
			for (int at = 0; at < to->cells.count; at++)
				expect_equal(is->coefficient[c][k][at], was->coefficient[c][k][at],
					     "cell %d, channel %d, term %d", at, c, k);
	free(saved);
	people_destroy(from);
	people_destroy(to);
	dome_free(&dome);
}

TEST("what was learned comes back, of pictures of any size")
{
	comes_back(320, 240);
	comes_back(1920, 1080);
	comes_back(3840, 2160);
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
		const size_t planes = bytes - (size_t)p->cells.count;
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
	expect_equal(p->place.gain[2], 2.5, "what was known is untouched");
	free(saved);
	people_destroy(p);
	dome_free(&dome);
}
