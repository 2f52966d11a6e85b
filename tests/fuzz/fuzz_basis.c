/*
 * Any bytes as a basis file: as they are, and as a list of chunks
 *     uint32 type, uint32 pose, uint32 bytes, data
 * that is laid out into a file with a right header, right checksums and right padding, so that what
 * the reader checks behind them is reached. A file that it accepts is composited: nothing behind
 * the reader checks anything again.
 */
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "hal/compositor/compositor.h"
#include "tests/synthetic_basis.h"

#define CHUNKS_MOST 32
#define WORK_MOST 2000000 /* pixels times lights */

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t bytes);

struct packed {
	uint32_t type, pose, bytes;
};

static void *aligned_copy(const void *data, size_t bytes)
{
	/* At its end, so that a sanitizer sees one byte too many where the size allows it. */
	void *copy = aligned_alloc(BASIS_ALIGN,
				   bytes ? (bytes + BASIS_ALIGN - 1) / BASIS_ALIGN * BASIS_ALIGN
					 : BASIS_ALIGN);

	if (!copy)
		abort();
	if (bytes)
		memcpy(copy, data, bytes);
	return copy;
}

static void composite(const struct basis *basis)
{
	const size_t pixels = (size_t)basis->info.width * basis->info.height;
	const struct picture picture = {calloc(pixels, 4), 4, (ptrdiff_t)basis->info.width * 4,
					(int)basis->info.width, (int)basis->info.height};
	const struct compositor_settings settings = {TRANSFER_BT709, TRANSFER_SRGB, 2, true};
	float(*radiance)[3] = calloc(basis->info.lights, sizeof(*radiance));
	uint8_t *out = malloc(pixels * 4);
	double *exact = malloc(pixels * 3 * sizeof(*exact));
	struct light_selection lights;
	struct compositor *compositor;

	if (!picture.origin || !radiance || !out || !exact ||
	    light_selection_create(&lights, basis) < 0 ||
	    compositor_create(&compositor, basis, NULL, NULL) < 0)
		abort();
	compositor_set(compositor, &settings);
	for (uint32_t pose = 0; pose < basis->info.poses; pose++) {
		for (uint32_t i = 0; i < basis->info.lights; i++)
			for (int c = 0; c < 3; c++)
				radiance[i][c] = (i + (uint32_t)c) % 3 ? 0.25F : 3e38F;
		light_selection_choose(&lights, basis, (int)pose, (const float(*)[3])radiance, 1,
				       THRESHOLD_AMBIENT, settings.gain);
		if (compositor_run(compositor, (int)pose, &lights, &picture, out,
				   (size_t)basis->info.width * 4) < 0 ||
		    compositor_reference(basis, (int)pose, &settings, &lights, &picture, exact) < 0)
			abort();
	}
	compositor_destroy(compositor);
	light_selection_free(&lights);
	free((void *)picture.origin);
	free(radiance);
	free(out);
	free(exact);
}

static void open_file(const void *data, size_t bytes)
{
	struct fault fault = {""};
	struct basis basis;
	const int ret = basis_open_memory(&basis, data, bytes, "fuzz", &fault);

	if (ret < 0 && !fault.text[0])
		abort(); /* a refusal must say why */
	if (ret == 0 &&
	    (uint64_t)basis.info.width * basis.info.height * basis.info.lights < WORK_MOST)
		composite(&basis);
	basis_close(&basis);
}

static size_t page_up(size_t bytes)
{
	return (bytes + BASIS_PAGE - 1) / BASIS_PAGE * BASIS_PAGE;
}

/* NULL when it is not a list of chunks. */
static uint8_t *unpack(const uint8_t *data, size_t bytes, size_t *file_bytes)
{
	struct basis_chunk_entry chunk[CHUNKS_MOST];
	const uint8_t *from[CHUNKS_MOST];
	struct basis_file_header header = {.magic = BASIS_MAGIC, .version = BASIS_VERSION};
	size_t end = BASIS_PAGE;
	uint8_t *file;

	while (bytes >= sizeof(struct packed) && header.chunk_count < CHUNKS_MOST) {
		struct basis_chunk_entry *c = &chunk[header.chunk_count];
		struct packed head;

		memcpy(&head, data, sizeof(head));
		data += sizeof(head);
		bytes -= sizeof(head);
		if (head.bytes > bytes)
			head.bytes = (uint32_t)bytes;
		*c = (struct basis_chunk_entry){head.type, head.pose, end, head.bytes, 0};
		from[header.chunk_count++] = data;
		data += head.bytes;
		bytes -= head.bytes;
		end = page_up(end + head.bytes);
	}
	if (!header.chunk_count)
		return NULL;
	header.file_bytes = end;
	file = aligned_alloc(BASIS_PAGE, end);
	if (!file)
		abort();
	memset(file, 0, end);
	memcpy(file, &header, sizeof(header));
	memcpy(file + sizeof(header), chunk, header.chunk_count * sizeof(*chunk));
	for (uint32_t i = 0; i < header.chunk_count; i++)
		memcpy(file + chunk[i].offset, from[i], chunk[i].bytes);
	synthetic_reseal(file, end);
	*file_bytes = end;
	return file;
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t bytes)
{
	size_t file_bytes = 0;
	uint8_t *copy = aligned_copy(data, bytes), *file;

	open_file(copy, bytes);
	free(copy);
	file = unpack(data, bytes, &file_bytes);
	if (file)
		open_file(file, file_bytes);
	free(file);
	return 0;
}
