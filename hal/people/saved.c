/* SPDX-License-Identifier: MIT */
/*
 * What was learned, over a restart: header, covariances, coefficients of all cells, what is known.
 */
#include <errno.h>
#include <math.h>
#include <string.h>
#include <xxhash.h>

#include "hal/people/people_parts.h"

#define MAGIC "INLAYPL6"
#define SAVED_MOST 20000000 /* bytes */
#define SLICE 262144	    /* bytes that a call of people_save() copies */
#define COEFFICIENT_MOST 1e9f
#define GAIN_LEAST 0.01f
#define GAIN_MOST 100.0f

/* The header keeps what follows it aligned, as far as each number needs it. */

struct saved_header {
	char magic[8];
	int32_t width, height, side, lights, terms;
	float gain[3], moved[2];
	double first[3];
	uint64_t camera;   /* saved_camera() */
	uint64_t made_of;  /* XXH3-64 of the sky's terms and of the transfer function */
	uint64_t checksum; /* XXH3-64 of everything, with 0 in this field */
};

static size_t plane_bytes(const struct people *p)
{
	return (size_t)p->cells.count * sizeof(float);
}

/* An array that is kept. */
struct saved_part {
	void *at;
	size_t bytes;
};

/* Parts lie one after the other behind the header; bytes 0: there is no such part. */
static struct saved_part saved_part(const struct people *p, int n)
{
	const int planes = 3 * PLACE_TERMS;

	if (n == 0)
		return (struct saved_part){(void *)p->place.fit, sizeof(p->place.fit)};
	if (n <= planes)
		return (struct saved_part){p->place.coefficient[(n - 1) % 3][(n - 1) / 3],
					   plane_bytes(p)};
	if (n == planes + 1)
		return (struct saved_part){p->place.known, (size_t)p->cells.count};
	return (struct saved_part){NULL, 0};
}

uint64_t saved_camera(const struct people_settings *settings)
{
	const char *camera = settings->camera ? settings->camera : "";
	const char *calibration = settings->calibration ? settings->calibration : "";

	return XXH3_64bits_withSeed(calibration, strlen(calibration),
				    XXH3_64bits(camera, strlen(camera)));
}

/* Differs where the same numbers would mean another picture. */
static uint64_t saved_made_of(const struct people *p)
{
	const size_t lights = (size_t)p->settings.dome->count;

	return XXH3_64bits_withSeed(p->place.term, lights * sizeof(*p->place.term),
				    XXH3_64bits(p->tables.decode, sizeof(p->tables.decode)));
}

/* Checksum of header and body. */
static uint64_t saved_checksum(struct saved_header header, const uint8_t *body, size_t bytes)
{
	header.checksum = 0;
	return XXH3_64bits_withSeed(body, bytes, XXH3_64bits(&header, sizeof(header)));
}

size_t people_saved_bytes(const struct people *p)
{
	size_t bytes = sizeof(struct saved_header);

	for (int n = 0; saved_part(p, n).bytes; n++)
		bytes += saved_part(p, n).bytes;
	return bytes <= SAVED_MOST ? bytes : 0;
}

static struct saved_header header_of(const struct people *p)
{
	struct saved_header header = {.width = p->settings.width,
				      .height = p->settings.height,
				      .side = p->cells.side,
				      .lights = p->settings.dome->count,
				      .terms = PLACE_TERMS,
				      .camera = p->camera,
				      .made_of = saved_made_of(p)};

	memcpy(header.magic, MAGIC, sizeof(header.magic));
	memcpy(header.first, p->place.first, sizeof(header.first));
	memcpy(header.gain, p->place.gain, sizeof(header.gain));
	memcpy(header.moved, p->nudge.moved, sizeof(header.moved));
	return header;
}

size_t people_save(const struct people *p, void *to, size_t done)
{
	const size_t end = done + SLICE;
	size_t begin = sizeof(struct saved_header);

	if (done < begin) {
		const struct saved_header header = header_of(p);

		memcpy(to, &header, begin);
	}
	for (int n = 0; saved_part(p, n).bytes && begin < end; n++) {
		const struct saved_part part = saved_part(p, n);
		const size_t from = done > begin ? done - begin : 0;
		const size_t until = end - begin < part.bytes ? end - begin : part.bytes;

		if (from < until)
			memcpy((uint8_t *)to + begin + from, (const uint8_t *)part.at + from,
			       until - from);
		begin += part.bytes;
	}
	return end < begin ? end : begin;
}

void people_seal(void *saved, size_t bytes)
{
	struct saved_header header;

	memcpy(&header, saved, sizeof(header));
	header.checksum = saved_checksum(header, (const uint8_t *)saved + sizeof(header),
					 bytes - sizeof(header));
	memcpy(saved, &header, sizeof(header));
}

/* ---- reading ---- */

static int check_header(const struct people *p, const struct saved_header *header, size_t bytes,
			struct fault *fault)
{
	const struct people_settings *settings = &p->settings;

	if (memcmp(header->magic, MAGIC, sizeof(header->magic)) != 0)
		return fault_say(fault, -EBADMSG, "is not the picture of a place");
	if (header->width != settings->width || header->height != settings->height ||
	    header->side != p->cells.side || header->terms != PLACE_TERMS)
		return fault_say(fault, -EBADMSG, "is of %dx%d pixels, expected %dx%d",
				 header->width, header->height, settings->width, settings->height);
	if (header->camera != p->camera)
		return fault_say(fault, -EBADMSG, "is of another camera, or of its place before");
	if (header->lights != settings->dome->count)
		return fault_say(fault, -EBADMSG, "is of %d lights, expected %d", header->lights,
				 settings->dome->count);
	if (header->made_of != saved_made_of(p))
		return fault_say(fault, -EBADMSG,
				 "is of lights elsewhere or of another transfer function");
	if (bytes != people_saved_bytes(p))
		return fault_say(fault, -EBADMSG, "has %zu bytes, expected %zu", bytes,
				 people_saved_bytes(p));
	return 0;
}

static bool are_in_range(const float *values, size_t count, float least, float most)
{
	for (size_t i = 0; i < count; i++)
		if (!(values[i] >= least && values[i] <= most))
			return false;
	return true;
}

static bool are_finite(const double *values, size_t count)
{
	for (size_t i = 0; i < count; i++)
		if (!isfinite(values[i]))
			return false;
	return true;
}

/* Whether all numbers are such as learning gives. */
static bool are_possible(const struct people *p, const struct saved_header *header,
			 const uint8_t *body)
{
	const size_t values = 3 * PLACE_TERMS * (size_t)p->cells.count;
	const uint8_t *planes = body + sizeof(p->place.fit),
		      *known = planes + values * sizeof(float);
	bool fine = are_in_range(header->gain, 3, GAIN_LEAST, GAIN_MOST) &&
		    are_in_range(header->moved, 2, -NUDGE_MOST, NUDGE_MOST) &&
		    are_finite(header->first, 3) &&
		    are_finite((const void *)body, sizeof(p->place.fit) / sizeof(double)) &&
		    are_in_range((const void *)planes, values, -COEFFICIENT_MOST, COEFFICIENT_MOST);

	for (int c = 0; c < 3; c++)
		fine = fine && header->first[c] >= 0;
	for (int at = 0; at < p->cells.count && fine; at++)
		fine = known[at] <= 1;
	return fine;
}

static void take_parts(struct people *p, const uint8_t *body)
{
	place_forget(p);
	for (int n = 0; saved_part(p, n).bytes; n++) {
		const struct saved_part part = saved_part(p, n);

		memcpy(part.at, body, part.bytes);
		body += part.bytes;
	}
	place_count_unknown(p);
}

int people_restore(struct people *p, const void *from, size_t bytes, struct fault *fault)
{
	const uint8_t *body = (const uint8_t *)from + sizeof(struct saved_header);
	struct saved_header header;
	int err;

	if (bytes < sizeof(header))
		return fault_say(fault, -EBADMSG, "has %zu bytes, expected %zu", bytes,
				 people_saved_bytes(p));
	memcpy(&header, from, sizeof(header));
	err = check_header(p, &header, bytes, fault);
	if (err)
		return err;
	if (saved_checksum(header, body, bytes - sizeof(header)) != header.checksum)
		return fault_say(fault, -EBADMSG, "is damaged, its checksum differs");
	if (!are_possible(p, &header, body))
		return fault_say(fault, -EBADMSG, "is damaged, a number in it is impossible");
	take_parts(p, body);
	memcpy(p->place.first, header.first, sizeof(header.first));
	memcpy(p->place.gain, header.gain, sizeof(header.gain));
	memcpy(p->nudge.moved, header.moved, sizeof(header.moved));
	return 0;
}
