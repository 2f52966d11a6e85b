/* SPDX-License-Identifier: MIT */
/* Writes the seeds of fuzz_basis into a folder: small files of random content, each as the list of
 * chunks that fuzz_basis.c unpacks. Each run writes the same. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "tests/support/basis/synthetic_basis.h"

static const struct {
	const char *name;
	struct synthetic_options options;
} seeds[] = {
	{"all_kinds",
	 {.width = 18,
	  .height = 4,
	  .lights = 4,
	  .coarse = 2,
	  .grounds = 2,
	  .patterns = 2,
	  .columns = 2,
	  .vary = true,
	  .layers = 2,
	  .exact = true,
	  .object_share = 0.4,
	  .ground_share = 0.3,
	  .stand_in_share = 0.3,
	  .unlit_share = 0.2,
	  .peak = 1,
	  .bounce = 0.3,
	  .seed = 1}},
	{"columns",
	 {.width = 7,
	  .height = 6,
	  .lights = 6,
	  .grounds = 1,
	  .columns = -1,
	  .bits = 8,
	  .object_share = 0.5,
	  .ground_share = 0.5,
	  .peak = 1,
	  .bounce = 2,
	  .column_cut = 0.01,
	  .exact = true,
	  .seed = 2}},
	{"tinted",
	 {.width = 6,
	  .height = 11,
	  .lights = 34,
	  .coarse = 2,
	  .patterns = 3,
	  .grey = true,
	  .tinted = true,
	  .object_share = 0.6,
	  .stand_in_share = 0.5,
	  .peak = 1,
	  .bounce = 0.3,
	  .seed = 3}},
	{"glass",
	 {.width = 19,
	  .height = 5,
	  .lights = 3,
	  .grounds = 1,
	  .columns = -1,
	  .object_share = 0.5,
	  .ground_share = 0.5,
	  .glass_share = 0.4,
	  .peak = 1,
	  .bounce = 0.3,
	  .exact = true,
	  .seed = 5}},
	{"mirrors",
	 {.width = 5,
	  .height = 4,
	  .lights = 2,
	  .object_share = 0.5,
	  .mirror_share = 0.5,
	  .columns = -1,
	  .peak = 1,
	  .seed = 7}},
	{"groups",
	 {.width = 9,
	  .height = 7,
	  .lights = 20,
	  .grounds = 1,
	  .coarse = 4,
	  .patterns = 1,
	  .columns = 12,
	  .bits = 8,
	  .object_share = 0.5,
	  .ground_share = 0.5,
	  .column_cut = 0.01,
	  .groups = 4,
	  .peak = 1,
	  .bounce = 0.3,
	  .seed = 6}},
	{"nothing", {.width = 3, .height = 2, .lights = 2, .seed = 4}},
};

/* Head of a chunk, as fuzz_basis.c reads it. */
struct packed_chunk {
	uint32_t type, pose, bytes;
};

static void must_write(FILE *out, const void *data, size_t bytes)
{
	if (fwrite(data, 1, bytes, out) != bytes)
		abort();
}

static void pack_chunk(FILE *out, const struct basis_chunk_entry *chunk, uint32_t pose,
		       const void *data)
{
	const struct packed_chunk head = {chunk->type, pose, (uint32_t)chunk->bytes};

	must_write(out, &head, sizeof(head));
	must_write(out, data, chunk->bytes);
}

static bool is_of_pose(uint32_t type)
{
	return type == BASIS_CHUNK_COVERAGE || type == BASIS_CHUNK_PEAK ||
	       type == BASIS_CHUNK_BLOCKS || type == BASIS_CHUNK_DATA ||
	       type == BASIS_CHUNK_GLASS || type == BASIS_CHUNK_MIRROR;
}

/* poses: number to be declared; 0: as the file has it. */
static void pack(const struct basis *basis, const char *path, int poses)
{
	const uint8_t *file = basis->map;
	const struct basis_file_header *header = basis->map;
	const struct basis_chunk_entry *chunk = (const void *)(header + 1);
	FILE *out = fopen(path, "wb");

	if (!out)
		abort();
	for (uint32_t i = 0; i < header->chunk_count; i++) {
		const void *data = file + chunk[i].offset;
		struct basis_info_chunk info;

		if (chunk[i].type == BASIS_CHUNK_INFO && poses) {
			memcpy(&info, data, sizeof(info));
			info.poses = (uint32_t)poses;
			data = &info;
		}
		pack_chunk(out, &chunk[i], chunk[i].pose, data);
		if (poses > 1 && is_of_pose(chunk[i].type)) /* without an exact layer */
			pack_chunk(out, &chunk[i], 1, data);
	}
	if (fclose(out) != 0)
		abort();
}

static const void *data_of(const struct basis *basis, uint32_t type)
{
	const struct basis_file_header *header = basis->map;
	const struct basis_chunk_entry *chunk = (const void *)(header + 1);

	while (chunk->type != type)
		chunk++;
	return (const uint8_t *)basis->map + chunk->offset;
}

/* Writes the same blocks as two poses, which the writer packs; one has none of the first tile. */
static void pack_poses(const struct synthetic *s, const char *path)
{
	static const struct basis_pose_name names[2] = {{"one"}, {""}};
	static const struct basis_footprint feet[2] = {
		{.corner = {-1, 0.5F}, .side = 0.25F, .row = {[7] = 6}}, {.side = 0}};
	const struct basis *basis = &s->basis;
	const struct basis_pose *pose = &basis->poses[0];
	const struct basis_block_entry *entries = data_of(basis, BASIS_CHUNK_BLOCKS);
	const uint8_t *data = data_of(basis, BASIS_CHUNK_DATA);
	struct basis_info_chunk info = basis->info;
	struct basis_writer *writer;
	struct fault fault = {""};
	const size_t pixels = (size_t)info.width * info.height;
	float *map = malloc(pixels * sizeof(*map));
	struct basis joint;
	char file[128];

	info.poses = 2;
	snprintf(file, sizeof(file), "%s/joint.inlay", s->folder);
	synthetic_must(basis_writer_open(&writer, file, &info, basis->lights, basis->ground,
					 basis->coarse, "", &fault),
		       &fault);
	for (size_t at = 0; at < pixels; at++)
		map[at] = at % 5 ? 1 + (float)(at % 11) : 0;
	for (int p = 0; p < 2; p++) {
		for (int n = 0; n < pose->shown.block_count; n++) {
			const struct basis_block_payload block = {entries[n],
								  data + entries[n].offset};

			if (p == 0 || entries[n].tile > 0)
				synthetic_must(basis_writer_blocks(writer, &block, 1, &fault),
					       &fault);
		}
		synthetic_must(basis_writer_pose_end(writer, pose->coverage, pose->peak, &fault),
			       &fault);
		synthetic_must(
			basis_writer_places(writer, (const float *const[]){map, map, map}, &fault),
			&fault);
	}
	free(map);
	synthetic_must(basis_writer_names(writer, names, &fault), &fault);
	synthetic_must(basis_writer_feet(writer, feet, &fault), &fault);
	synthetic_must(basis_writer_finish(writer, &info, "", &fault), &fault);
	synthetic_must(basis_open(&joint, file, BASIS_ALL, &fault), &fault);
	unlink(file);
	pack(&joint, path, 0);
	basis_close(&joint);
}

int main(int argc, char **argv)
{
	char path[4096];
	FILE *out;

	if (argc != 2) {
		fprintf(stderr, "usage: basis_seeds FOLDER\n");
		return 2;
	}
	for (size_t i = 0; i < sizeof(seeds) / sizeof(seeds[0]); i++) {
		struct synthetic s;

		synthetic_open(&s, &seeds[i].options);
		snprintf(path, sizeof(path), "%s/%s.chunks", argv[1], seeds[i].name);
		pack(&s.basis, path, 1);
		if (i == 0) {
			snprintf(path, sizeof(path), "%s/poses_packed.chunks", argv[1]);
			pack_poses(&s, path);
		}
		if (i == 1) {
			snprintf(path, sizeof(path), "%s/poses.chunks", argv[1]);
			pack(&s.basis, path, 2);
			snprintf(path, sizeof(path), "%s/cut.inlay", argv[1]);
			out = fopen(path, "wb");
			if (!out)
				abort();
			must_write(out, s.basis.map, 400);
			if (fclose(out) != 0)
				abort();
		}
		synthetic_close(&s);
	}
	return 0;
}
