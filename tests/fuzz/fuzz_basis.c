/* SPDX-License-Identifier: MIT */
/*
 * Any bytes as a basis file: as they are, and as a list of chunks
 *     uint32 type, uint32 pose, uint32 bytes, data
 * that is laid out into a file with a right header, right checksums and right padding, so that what
 * the reader checks behind them is reached. A file that it accepts is composited: nothing behind
 * the reader checks anything again. The second is also opened by its path, with poses unpacked
 * ahead.
 *
 * reaches: basis.c:check_coarse basis.c:check_peaks basis.c:add_packed basis_blocks.c:check_block
 * basis_blocks.c:check_patterns basis_blocks.c:check_record basis_blocks.c:check_pairs
 * basis_blocks.c:check_padding basis_places.c:basis_foot_check basis_places.c:unfold
 * basis_glass.c:basis_read_glass basis_glass.c:basis_read_mirror basis_names.c:basis_names_check
 * basis_file.c:read_at pack.c:place_parts pack.c:unfold_words pack.c:unfold_column
 * basis_store.c:look_ahead basis_store.c:take_back basis_groups.c:basis_groups_create
 * glass.c:glass_add
 */
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "hal/basis/basis_places.h"
#include "hal/compositor/compositor.h"
#include "tests/support/as_file.h"
#include "tests/support/basis/synthetic_basis.h"

#define CHUNKS_MOST 32
#define WORK_MOST 2000000 /* largest number of pixels times lights that is composited */

struct packed_chunk {
	uint32_t type, pose, bytes;
};

static void *aligned_copy(const void *data, size_t bytes)
{
	/* at the end of its memory, so that a sanitizer sees a read beyond where the size allows
	 * it */
	void *copy = aligned_alloc(BASIS_ALIGN,
				   bytes ? (bytes + BASIS_ALIGN - 1) / BASIS_ALIGN * BASIS_ALIGN
					 : BASIS_ALIGN);

	if (!copy)
		abort();
	if (bytes)
		memcpy(copy, data, bytes);
	return copy;
}

struct fuzzed_scene {
	const struct basis *basis;
	struct picture picture;
	struct backdrop backdrop;
	struct light_selection lights;
	struct compositor *compositor;
	float (*radiance)[3];
	uint8_t *out, *again;
	double *exact;
	size_t pixels;
};

static void fuzz_basis_choose(struct fuzzed_scene *s, int pose, uint32_t step)
{
	for (uint32_t i = 0; i < s->basis->info.lights; i++)
		for (uint32_t c = 0; c < 3; c++)
			s->radiance[i][c] = (i + c + step) % 3 ? 0.25F * (float)step : 3e38F;
	light_selection_choose(&s->lights, s->basis, pose, (const float(*)[3])s->radiance, 1,
			       THRESHOLD_AMBIENT, 2);
}

static void fuzz_basis_run(struct fuzzed_scene *s, int pose, enum compositor_mode mode,
			   uint8_t *out)
{
	const struct compositor_settings settings = {
		.mode = mode, .background = {.named = TRANSFER_BT709}, .gain = 2, .object = true};

	compositor_set(s->compositor, &settings);
	if (compositor_run(s->compositor, pose, &s->lights, &s->backdrop, out,
			   (size_t)s->basis->info.width * 4) < 0 ||
	    compositor_reference(s->basis, pose, &settings, &s->lights, &s->picture, s->exact) < 0)
		abort();
}

/* Frames of two lights. A frame must not depend on the one before it. */
static void composite_pose(struct fuzzed_scene *s, int pose, enum compositor_mode mode)
{
	fuzz_basis_choose(s, pose, 0);
	fuzz_basis_run(s, pose, mode, s->out);
	fuzz_basis_choose(s, pose, 1);
	fuzz_basis_run(s, pose, mode, s->out);
	fuzz_basis_run(s, pose, mode, s->again);
	if (memcmp(s->out, s->again, s->pixels * 4) != 0)
		abort();
}

/* Places may be damaged behind their checks, and are refused then. */
static void read_places(const struct basis *basis, size_t pixels)
{
	float *distance = malloc(pixels * sizeof(*distance));

	for (uint32_t p = 0; distance && p < basis->info.poses; p++)
		for (int k = 0; k < BASIS_SURFACES; k++)
			(void)basis_places_read(basis, (int)p, (enum basis_surface)k, distance);
	free(distance);
}

static void composite(const struct basis *basis)
{
	const size_t pixels = (size_t)basis->info.width * basis->info.height;
	const struct compositor_options options = {NULL, NULL, NULL};
	struct fuzzed_scene s = {
		.basis = basis,
		.picture = {calloc(pixels, 4), 4, (ptrdiff_t)basis->info.width * 4,
			    (int)basis->info.width, (int)basis->info.height},
		.radiance = calloc(basis->info.lights, sizeof(*s.radiance)),
		.out = malloc(pixels * 4),
		.again = malloc(pixels * 4),
		.exact = malloc(pixels * 3 * sizeof(*s.exact)),
		.pixels = pixels,
	};

	read_places(basis, pixels);
	if (!s.picture.origin || !s.radiance || !s.out || !s.again || !s.exact ||
	    light_selection_create(&s.lights, basis) < 0 ||
	    compositor_create(&s.compositor, basis, &options, NULL) < 0)
		abort();
	s.backdrop = backdrop_of(&s.picture);
	for (int pose = 0; pose < (int)basis->info.poses; pose++) {
		composite_pose(&s, pose, COMPOSITOR_FAST);
		if (basis->poses[pose].exact.tiles)
			composite_pose(&s, pose, COMPOSITOR_EXACT);
	}
	compositor_destroy(s.compositor);
	light_selection_free(&s.lights);
	free((void *)s.picture.origin);
	free(s.radiance);
	free(s.out);
	free(s.again);
	free(s.exact);
}

static int open_part(const void *data, size_t bytes, enum basis_part part, struct basis *basis)
{
	struct fault fault = {""};
	const int ret = basis_open_memory(basis, data, bytes, "fuzz", part, &fault);

	if (ret < 0 && !fault.text[0])
		abort(); /* a refusal must say why */
	return ret;
}

static void open_file(const void *data, size_t bytes)
{
	struct basis basis;
	const int shown = open_part(data, bytes, BASIS_SHOWN, &basis);
	int ret;

	basis_close(&basis);
	ret = open_part(data, bytes, BASIS_ALL, &basis);
	if (ret == 0 && shown < 0)
		abort(); /* a part of what is right */
	if (ret == 0 &&
	    (uint64_t)basis.info.width * basis.info.height * basis.info.lights < WORK_MOST)
		composite(&basis);
	basis_close(&basis);
	ret = open_part(data, bytes, BASIS_WITH_EXACT, &basis);
	if (ret == 0 && shown < 0)
		abort();
	basis_close(&basis);
}

/* A kiosk's way: from a file, with a thread that unpacks poses ahead. The result must be the same
 * as from memory. */
static void open_ahead(const void *data, size_t bytes)
{
	static const int order[] = {3, 0, 1, 2, 0};
	const int count = sizeof(order) / sizeof(*order);
	struct fault fault = {""};
	struct basis memory, file;
	const int expected = open_part(data, bytes, BASIS_SHOWN, &memory);
	int poses;

	if (basis_open(&file, as_file(data, bytes), BASIS_SHOWN, &fault) != expected)
		abort();
	poses = expected ? 0 : (int)file.info.poses;
	for (int k = 0; poses && k < count; k++) {
		const int pose = order[k] % poses,
			  ahead[2] = {pose, order[(k + 1) % count] % poses};

		basis_poses_expect(&file, ahead, 2);
		if (basis_pose_load(&memory, pose, &fault) ||
		    basis_pose_load(&file, pose, &fault) || !basis_pose_ready(&file, pose) ||
		    file.poses[pose].shown.block_count != memory.poses[pose].shown.block_count)
			abort();
	}
	basis_close(&file);
	basis_close(&memory);
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

	while (bytes >= sizeof(struct packed_chunk) && header.chunk_count < CHUNKS_MOST) {
		struct basis_chunk_entry *c = &chunk[header.chunk_count];
		struct packed_chunk head;

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
	if (file) {
		open_file(file, file_bytes);
		open_ahead(file, file_bytes);
	}
	free(file);
	return 0;
}
