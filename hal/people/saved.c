/* SPDX-License-Identifier: MIT */
/* What was learned, over a restart: header, covariances, coefficients of all cells, what is known. */
#include <errno.h>
#include <string.h>
#include <xxhash.h>

#include "hal/people/people_parts.h"

#define MAGIC "INLAYPL2"

struct saved_header {
	char magic[8];
	int32_t width, height, side, lights;
	double first[3];
	float gain[3];
	uint32_t reserved;
	uint64_t made_of;  /* XXH3-64 of the sky's terms and of the transfer function */
	uint64_t checksum; /* XXH3-64 of everything, with 0 in this field */
};

static size_t plane_bytes(const struct people *p)
{
	return (size_t)p->cells * sizeof(float);
}

/* Differs where the same numbers would mean another picture. */
static uint64_t saved_made_of(const struct people *p)
{
	const size_t lights = (size_t)p->settings.dome->count;

	return XXH3_64bits_withSeed(p->term, lights * sizeof(*p->term),
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
	return sizeof(struct saved_header) + sizeof(p->fit) + 3 * PLACE_TERMS * plane_bytes(p) +
	       (size_t)p->cells;
}

void people_save(const struct people *p, void *to)
{
	struct saved_header header = {.width = p->settings.width,
				      .height = p->settings.height,
				      .side = p->side,
				      .lights = p->settings.dome->count,
				      .made_of = saved_made_of(p)};
	uint8_t *at = (uint8_t *)to + sizeof(header);

	memcpy(header.magic, MAGIC, sizeof(header.magic));
	memcpy(header.first, p->first, sizeof(header.first));
	memcpy(header.gain, p->gain, sizeof(header.gain));
	memcpy(at, p->fit, sizeof(p->fit));
	at += sizeof(p->fit);
	for (int c = 0; c < 3; c++)
		for (int k = 0; k < PLACE_TERMS; k++, at += plane_bytes(p))
			memcpy(at, p->coefficient[c][k], plane_bytes(p));
	memcpy(at, p->known, (size_t)p->cells);
	header.checksum = saved_checksum(header, (uint8_t *)to + sizeof(header),
					 people_saved_bytes(p) - sizeof(header));
	memcpy(to, &header, sizeof(header));
}

int people_restore(struct people *p, const void *from, size_t bytes, struct fault *fault)
{
	const uint8_t *at = (const uint8_t *)from + sizeof(struct saved_header);
	struct saved_header header;

	if (bytes < sizeof(header))
		return fault_say(fault, -EBADMSG, "%zu bytes, expected %zu", bytes,
				 people_saved_bytes(p));
	memcpy(&header, from, sizeof(header));
	if (memcmp(header.magic, MAGIC, sizeof(header.magic)) != 0)
		return fault_say(fault, -EBADMSG, "not a learned place");
	if (header.width != p->settings.width || header.height != p->settings.height ||
	    header.side != p->side || header.lights != p->settings.dome->count ||
	    bytes != people_saved_bytes(p))
		return fault_say(fault, -EBADMSG,
				 "of %dx%d pixels, %d lights and %zu bytes, expected %dx%d, %d and "
				 "%zu",
				 header.width, header.height, header.lights, bytes,
				 p->settings.width, p->settings.height, p->settings.dome->count,
				 people_saved_bytes(p));
	if (header.made_of != saved_made_of(p))
		return fault_say(fault, -EBADMSG, "of other lights or another transfer function");
	if (saved_checksum(header, at, bytes - sizeof(header)) != header.checksum)
		return fault_say(fault, -EBADMSG, "it does not have its checksum");
	place_forget(p);
	memcpy(p->first, header.first, sizeof(header.first));
	memcpy(p->gain, header.gain, sizeof(header.gain));
	memcpy(p->fit, at, sizeof(p->fit));
	at += sizeof(p->fit);
	for (int c = 0; c < 3; c++)
		for (int k = 0; k < PLACE_TERMS; k++, at += plane_bytes(p))
			memcpy(p->coefficient[c][k], at, plane_bytes(p));
	memcpy(p->known, at, (size_t)p->cells);
	place_count_unknown(p);
	memset(p->light_then, 0, sizeof(p->light_then));
	return 0;
}
