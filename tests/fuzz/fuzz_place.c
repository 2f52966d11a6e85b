/* SPDX-License-Identifier: MIT */
/* Any bytes as what was learned of a place, as they are and with a right checksum: refused in a
 * sentence that leaves everything alone, or numbers that a look at a picture can use.
 *
 * reaches: saved.c:are_possible saved.c:take_parts
 */
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "hal/people/people.h"

#define WIDTH 16
#define HEIGHT 16

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t bytes);

/* A place of one tile, which the object touches. */
static struct people *place_of(const struct dome *dome)
{
	static uint16_t coverage[HEIGHT * WIDTH];
	static const uint8_t touched[1] = {1};
	const struct people_settings settings = {
		.width = WIDTH, .height = HEIGHT, .curve = {.named = TRANSFER_SRGB}, .dome = dome};
	const struct people_object object = {.coverage = coverage, .touched = touched};
	struct people *people;

	if (people_create(&people, &settings, NULL))
		abort();
	people_place(people, &object);
	return people;
}

static void look(struct people *people, const struct dome *dome)
{
	static uint8_t pixels[HEIGHT * WIDTH * 4];
	const struct picture picture = {pixels, 4, 4 * WIDTH, WIDTH, HEIGHT};
	float(*radiance)[3] = calloc((size_t)dome->count, sizeof(*radiance));

	if (!radiance)
		abort();
	for (size_t i = 0; i < sizeof(pixels); i++)
		pixels[i] = (uint8_t)(i * 37);
	for (int i = 0; i < dome->count; i++)
		radiance[i][0] = radiance[i][1] = radiance[i][2] = 0.3f;
	for (int frame = 1; frame < 4; frame++)
		people_look(people, &picture, (const float(*)[3])radiance, frame * 40000000LL);
	if (!(people_report(people).learned >= 0 && people_report(people).learned <= 1))
		abort();
	free(radiance);
}

/* A whole file with these bytes, again and again, as its numbers. */
static uint8_t *file_of(const struct people *people, const uint8_t *data, size_t bytes)
{
	const size_t header = 88, known = WIDTH * HEIGHT / 4, all = people_saved_bytes(people);
	uint8_t *file = malloc(all);
	size_t done = 0;

	if (!file)
		abort();
	while (done < all)
		done = people_save(people, file, done);
	for (size_t i = header; i < all && bytes; i++)
		file[i] = data[(i - header) % bytes] & (i < all - known ? 255 : 1);
	people_seal(file, all);
	return file;
}

static void restore(struct people *people, const struct dome *dome, const uint8_t *saved,
		    size_t bytes)
{
	struct fault fault = {.text = ""};

	people_forget(people);
	if (people_restore(people, saved, bytes, &fault) == 0)
		look(people, dome);
	else if (!*fault.text)
		abort();
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t bytes)
{
	static struct people *people;
	static struct dome dome;
	uint8_t *copy = malloc(bytes + 128); /* longer than a header */

	if (!copy || (!people && dome_create(&dome, 1, NULL)))
		abort();
	if (!people)
		people = place_of(&dome);
	memcpy(copy, data, bytes);
	restore(people, &dome, copy, bytes);
	if (bytes >= 128) {
		people_seal(copy, bytes);
		restore(people, &dome, copy, bytes);
	}
	free(copy);
	copy = file_of(people, data, bytes);
	restore(people, &dome, copy, people_saved_bytes(people));
	free(copy);
	return 0;
}
