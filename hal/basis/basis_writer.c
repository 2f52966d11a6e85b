/* SPDX-License-Identifier: MIT */
#include "hal/basis/basis_writer.h"

#include <errno.h>
#include <fcntl.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>
#include <xxhash.h>

#include "hal/base/output.h"
#include "hal/basis/basis_layout.h"
#include "hal/basis/basis_names.h"
#include "hal/basis/basis_places.h"
#include "hal/basis/pack.h"

/* Largest number of chunks: INFO, DOME, GROUND, COARSE and CAMERA first; DATA, BLOCKS, EXACT_DATA,
 * EXACT_BLOCKS, COVERAGE, PEAK, GLASS, MIRROR and PLACES for each pose, of several poses PACK in
 * place of DATA and COVERAGE; POSES, FOOT and PROVENANCE last. */
#define FIRST_CHUNKS 5
#define POSE_CHUNKS 8
#define SINGLE_CHUNKS 1 /* more, of a single pose */
#define LAST_CHUNKS 3

_Static_assert(FIRST_CHUNKS + POSE_CHUNKS * BASIS_POSES_MAX + SINGLE_CHUNKS + LAST_CHUNKS <=
		       BASIS_CHUNKS_MAX,
	       "chunks for all poses");

/* The blocks of the open pose in one layer. */
struct writer_blocks {
	struct basis_block_entry *entries;
	size_t count, room;
};

struct basis_writer {
	struct output output;
	struct basis_info_chunk info;
	struct basis_chunk_entry *chunks;
	uint32_t chunk_limit, chunk_count, version;
	uint64_t position; /* where the next byte goes */
	XXH3_state_t *hash;
	bool in_pose; /* the DATA chunk of a pose is open */
	uint32_t poses_done;
	struct packer *packer; /* NULL: a file of one pose, which is not packed */
	uint64_t data_bytes;   /* of the open pose's payloads, if they are packed */
	struct writer_blocks shown, exact;
	FILE *aside; /* payloads of the open pose's exact blocks; NULL: none yet */
	uint64_t aside_bytes;
};

static const uint8_t zeros[BASIS_PAGE];

static int say_write(const struct basis_writer *w, int err, struct fault *fault)
{
	return fault_say(fault, err, "%s: cannot be written: %s", w->output.path, strerror(-err));
}

static int writer_put(struct basis_writer *w, const void *data, size_t bytes)
{
	errno = 0;
	if (bytes && fwrite(data, 1, bytes, w->output.stream) != bytes)
		return errno ? -errno : -EIO;
	w->position += bytes;
	return 0;
}

/* Writes zeros up to the next multiple of step. hashed: they are inside a chunk. */
static int writer_pad(struct basis_writer *w, size_t step, bool hashed)
{
	const size_t bytes = (size_t)(-w->position & (step - 1));

	if (hashed)
		XXH3_64bits_update(w->hash, zeros, bytes);
	return writer_put(w, zeros, bytes);
}

static int chunk_begin(struct basis_writer *w, enum basis_chunk type, uint32_t pose)
{
	struct basis_chunk_entry *chunk = &w->chunks[w->chunk_count];
	const int ret = writer_pad(w, BASIS_PAGE, false);

	if (ret < 0)
		return ret;
	*chunk = (struct basis_chunk_entry){.type = type, .pose = pose, .offset = w->position};
	XXH3_64bits_reset(w->hash);
	return 0;
}

static int chunk_put(struct basis_writer *w, const void *data, size_t bytes)
{
	if (bytes)
		XXH3_64bits_update(w->hash, data, bytes);
	return writer_put(w, data, bytes);
}

static void chunk_end(struct basis_writer *w)
{
	struct basis_chunk_entry *chunk = &w->chunks[w->chunk_count++];

	chunk->bytes = w->position - chunk->offset;
	chunk->checksum = XXH3_64bits_digest(w->hash);
}

static int chunk_write(struct basis_writer *w, enum basis_chunk type, uint32_t pose,
		       const void *data, size_t bytes)
{
	int ret = chunk_begin(w, type, pose);

	if (ret < 0)
		return ret;
	ret = chunk_put(w, data, bytes);
	chunk_end(w);
	return ret;
}

static int writer_check_info(const struct basis_info_chunk *info, const char *path,
			     struct fault *fault)
{
	if (info->width < 1 || info->width > BASIS_SIDE_MAX || info->height < 1 ||
	    info->height > BASIS_SIDE_MAX)
		return fault_say(fault, -EINVAL, "%s: picture of %ux%u pixels, expected 1 to %d",
				 path, info->width, info->height, BASIS_SIDE_MAX);
	if (info->lights < 1 || info->lights > BASIS_LIGHTS_MAX)
		return fault_say(fault, -EINVAL, "%s: %u lights, expected 1 to %d", path,
				 info->lights, BASIS_LIGHTS_MAX);
	if (info->grounds > BASIS_GROUNDS_MAX)
		return fault_say(fault, -EINVAL, "%s: %u ground terms, expected at most %d", path,
				 info->grounds, BASIS_GROUNDS_MAX);
	if (info->poses < 1 || info->poses > BASIS_POSES_MAX)
		return fault_say(fault, -EINVAL, "%s: %u poses, expected 1 to %d", path,
				 info->poses, BASIS_POSES_MAX);
	if (info->coarse < 1 || info->coarse > info->lights)
		return fault_say(fault, -EINVAL, "%s: %u coarse lights, expected 1 to %u", path,
				 info->coarse, info->lights);
	return 0;
}

static int write_first(struct basis_writer *w, const struct basis_light *lights,
		       const double *ground, const struct basis_coarse *coarse, const char *camera)
{
	const size_t n = w->info.lights;
	const struct basis_file_header header = {0};
	int ret;

	/* Header and chunk table are known only at the end. */
	ret = writer_put(w, &header, sizeof(header));
	if (ret == 0)
		ret = writer_put(w, w->chunks, w->chunk_limit * sizeof(*w->chunks));
	if (ret == 0)
		ret = chunk_write(w, BASIS_CHUNK_INFO, 0, &w->info, sizeof(w->info));
	if (ret == 0)
		ret = chunk_write(w, BASIS_CHUNK_DOME, 0, lights, n * sizeof(*lights));
	if (ret == 0)
		ret = chunk_write(w, BASIS_CHUNK_GROUND, 0, ground,
				  w->info.grounds * 3 * n * sizeof(*ground));
	if (ret == 0 && w->info.coarse < w->info.lights)
		ret = chunk_write(w, BASIS_CHUNK_COARSE, 0, coarse, n * sizeof(*coarse));
	if (ret == 0)
		ret = chunk_write(w, BASIS_CHUNK_CAMERA, 0, camera, strlen(camera) + 1);
	return ret;
}

int basis_writer_open(struct basis_writer **writer, const char *path,
		      const struct basis_info_chunk *info, const struct basis_light *lights,
		      const double *ground, const struct basis_coarse *coarse, const char *camera,
		      struct fault *fault)
{
	struct basis_writer *w;
	int ret;

	*writer = NULL;
	ret = writer_check_info(info, path, fault);
	if (ret < 0)
		return ret;
	if (!coarse != (info->coarse == info->lights))
		return fault_say(fault, -EINVAL, "%s: %u coarse lights of %u %s a table", path,
				 info->coarse, info->lights, coarse ? "with" : "without");
	w = calloc(1, sizeof(*w));
	if (!w)
		return fault_say(fault, -ENOMEM, "%s: out of memory", path);
	w->info = *info;
	w->version = BASIS_VERSION;
	w->chunk_limit = FIRST_CHUNKS + POSE_CHUNKS * info->poses + SINGLE_CHUNKS + LAST_CHUNKS;
	w->chunks = calloc(w->chunk_limit, sizeof(*w->chunks));
	w->hash = XXH3_createState();
	if (info->poses > 1 && packer_create(&w->packer, (int)info->coarse) < 0) {
		ret = fault_say(fault, -ENOMEM, "%s: out of memory", path);
		goto fail;
	}
	if (!w->chunks || !w->hash) {
		ret = fault_say(fault, -ENOMEM, "%s: out of memory", path);
		goto fail;
	}
	ret = output_open(&w->output, path, fault);
	if (ret < 0)
		goto fail;
	ret = write_first(w, lights, ground, coarse, camera);
	if (ret < 0) {
		say_write(w, ret, fault);
		goto fail;
	}
	*writer = w;
	return 0;
fail:
	basis_writer_abandon(w);
	return ret;
}

static int pose_begin(struct basis_writer *w, struct fault *fault)
{
	int ret;

	if (w->in_pose)
		return 0;
	if (w->poses_done == w->info.poses)
		return fault_say(fault, -EINVAL, "%s: more poses written than the %u announced",
				 w->output.path, w->info.poses);
	ret = w->packer ? 0 : chunk_begin(w, BASIS_CHUNK_DATA, w->poses_done);
	if (ret < 0)
		return say_write(w, ret, fault);
	w->in_pose = true;
	w->data_bytes = 0;
	w->shown.count = w->exact.count = 0;
	w->aside_bytes = 0;
	return 0;
}

/* Adds a block at `offset` to the list. */
static int list_note(const struct basis_writer *w, struct writer_blocks *list,
		     const struct basis_block_entry *entry, uint64_t offset, struct fault *fault)
{
	const struct basis_block_entry *last = list->count ? &list->entries[list->count - 1] : NULL;

	if (last &&
	    (entry->tile < last->tile || (entry->tile == last->tile && entry->kind < last->kind)))
		return fault_say(
			fault, -EINVAL,
			"%s: a block of tile %u, kind %d follows one of tile %u, kind %d, expected the order of tiles, then of kinds",
			w->output.path, entry->tile, entry->kind, last->tile, last->kind);
	if (list->count == list->room) {
		const size_t room = list->room ? 2 * list->room : 1024;
		struct basis_block_entry *entries = realloc(list->entries, room * sizeof(*entries));

		if (!entries)
			return fault_say(fault, -ENOMEM, "%s: out of memory", w->output.path);
		list->entries = entries;
		list->room = room;
	}
	list->entries[list->count] = *entry;
	list->entries[list->count++].offset = offset;
	return 0;
}

static int pack_blocks(struct basis_writer *w, const struct basis_block_payload *blocks, int count,
		       struct fault *fault)
{
	int ret = 0;

	for (int i = 0; i < count && ret == 0; i++) {
		ret = list_note(w, &w->shown, &blocks[i].entry, w->data_bytes, fault);
		if (ret < 0)
			return ret;
		ret = packer_add(w->packer, &blocks[i].entry, blocks[i].payload);
		w->data_bytes += blocks[i].entry.bytes;
	}
	return ret < 0 ? say_write(w, ret, fault) : 0;
}

int basis_writer_blocks(struct basis_writer *w, const struct basis_block_payload *blocks, int count,
			struct fault *fault)
{
	uint64_t data;
	int ret = pose_begin(w, fault);

	if (ret < 0 || w->packer)
		return ret < 0 ? ret : pack_blocks(w, blocks, count, fault);
	data = w->chunks[w->chunk_count].offset;
	for (int i = 0; i < count; i++) {
		ret = writer_pad(w, BASIS_ALIGN, true);
		if (ret < 0)
			return say_write(w, ret, fault);
		ret = list_note(w, &w->shown, &blocks[i].entry, w->position - data, fault);
		if (ret < 0)
			return ret;
		ret = chunk_put(w, blocks[i].payload, blocks[i].entry.bytes);
		if (ret < 0)
			return say_write(w, ret, fault);
	}
	return 0;
}

/* ---- the exact layer, kept aside until the end of its pose ---- */

/* Opens a file without a name in the output's folder, which has room for the output. Nothing of it
 * remains, however the program ends. */
static int aside_open(struct basis_writer *w)
{
	char name[PATH_MAX];
	char *slash;
	int fd, ret;

	strcpy(name, w->output.path);
	slash = strrchr(name, '/');
	if (slash)
		slash[slash == name ? 1 : 0] = '\0';
	fd = open(slash ? name : ".", O_RDWR | O_TMPFILE | O_CLOEXEC, 0600);
	if (fd < 0) { /* the file system has no unnamed files */
		ret = snprintf(name, sizeof(name), "%s.XXXXXX", w->output.path);
		if (ret < 0 || (size_t)ret >= sizeof(name))
			return -ENAMETOOLONG;
		fd = mkostemp(name, O_CLOEXEC);
		if (fd < 0)
			return -errno;
		unlink(name);
	}
	w->aside = fdopen(fd, "w+b");
	if (!w->aside) {
		ret = -errno;
		close(fd);
		return ret;
	}
	return 0;
}

static int aside_put(struct basis_writer *w, const void *data, size_t bytes)
{
	errno = 0;
	if (bytes && fwrite(data, 1, bytes, w->aside) != bytes)
		return errno ? -errno : -EIO;
	w->aside_bytes += bytes;
	return 0;
}

int basis_writer_exact_blocks(struct basis_writer *w, const struct basis_block_payload *blocks,
			      int count, struct fault *fault)
{
	int ret = pose_begin(w, fault);

	if (ret < 0)
		return ret;
	if (count && !w->aside) {
		ret = aside_open(w);
		if (ret < 0)
			return say_write(w, ret, fault);
	}
	for (int i = 0; i < count; i++) {
		ret = aside_put(w, zeros, (size_t)(-w->aside_bytes & (BASIS_ALIGN - 1)));
		if (ret < 0)
			return say_write(w, ret, fault);
		ret = list_note(w, &w->exact, &blocks[i].entry, w->aside_bytes, fault);
		if (ret < 0)
			return ret;
		ret = aside_put(w, blocks[i].payload, blocks[i].entry.bytes);
		if (ret < 0)
			return say_write(w, ret, fault);
	}
	return 0;
}

/* Copies the file aside into the output and empties it. */
static int copy_aside(struct basis_writer *w)
{
	uint8_t part[1 << 16];
	int ret = 0;

	errno = 0;
	if (fseeko(w->aside, 0, SEEK_SET) < 0)
		return errno ? -errno : -EIO;
	for (uint64_t left = w->aside_bytes; left && ret == 0;) {
		const size_t bytes = left < sizeof(part) ? (size_t)left : sizeof(part);

		errno = 0;
		if (fread(part, 1, bytes, w->aside) != bytes)
			return errno ? -errno : -EIO;
		ret = chunk_put(w, part, bytes);
		left -= bytes;
	}
	errno = 0;
	if (ret == 0 && (fseeko(w->aside, 0, SEEK_SET) < 0 || ftruncate(fileno(w->aside), 0) < 0))
		ret = errno ? -errno : -EIO;
	return ret;
}

static int write_exact(struct basis_writer *w, uint32_t pose)
{
	int ret = chunk_begin(w, BASIS_CHUNK_EXACT_DATA, pose);

	if (ret == 0)
		ret = copy_aside(w);
	if (ret < 0)
		return ret;
	chunk_end(w);
	return chunk_write(w, BASIS_CHUNK_EXACT_BLOCKS, pose, w->exact.entries,
			   w->exact.count * sizeof(*w->exact.entries));
}

static int write_packed(struct basis_writer *w, uint32_t pose, const uint16_t *coverage,
			size_t pixels)
{
	const void *chunk = NULL;
	size_t bytes = 0;
	const int ret = packer_finish(w->packer, coverage, pixels, &chunk, &bytes);

	return ret < 0 ? ret : chunk_write(w, BASIS_CHUNK_PACK, pose, chunk, bytes);
}

int basis_writer_pose_end(struct basis_writer *w, const uint16_t *coverage, const float (*peak)[3],
			  struct fault *fault)
{
	const size_t pixels = (size_t)w->info.width * w->info.height;
	const uint32_t pose = w->poses_done;
	int ret = pose_begin(w, fault); /* a pose without any block */

	if (ret < 0)
		return ret;
	if (!w->packer)
		chunk_end(w);
	w->in_pose = false;
	w->poses_done++;
	ret = chunk_write(w, BASIS_CHUNK_BLOCKS, pose, w->shown.entries,
			  w->shown.count * sizeof(*w->shown.entries));
	if (ret == 0 && w->exact.count)
		ret = write_exact(w, pose);
	if (ret == 0 && w->packer)
		ret = write_packed(w, pose, coverage, pixels);
	else if (ret == 0)
		ret = chunk_write(w, BASIS_CHUNK_COVERAGE, pose, coverage,
				  pixels * sizeof(*coverage));
	if (ret == 0)
		ret = chunk_write(w, BASIS_CHUNK_PEAK, pose, peak,
				  (w->info.lights + (size_t)1) * sizeof(*peak));
	return ret < 0 ? say_write(w, ret, fault) : 0;
}

int basis_writer_glass(struct basis_writer *w, const struct basis_glass *glass, size_t count,
		       struct fault *fault)
{
	int ret;

	if (w->in_pose || !w->poses_done || !count ||
	    w->chunks[w->chunk_count - 1].type == BASIS_CHUNK_GLASS)
		return fault_say(
			fault, -EINVAL,
			"%s: %zu pixels that are seen through, expected some, once, after the end of their pose",
			w->output.path, count);
	ret = chunk_write(w, BASIS_CHUNK_GLASS, w->poses_done - 1, glass, count * sizeof(*glass));
	return ret < 0 ? say_write(w, ret, fault) : 0;
}

int basis_writer_mirror(struct basis_writer *w, const struct basis_mirror *mirror, size_t count,
			struct fault *fault)
{
	int ret;

	if (w->in_pose || !w->poses_done || !count)
		return fault_say(fault, -EINVAL,
				 "%s: %zu mirrors, expected some, after the end of their pose",
				 w->output.path, count);
	w->version = BASIS_VERSION_MIRROR;
	ret = chunk_write(w, BASIS_CHUNK_MIRROR, w->poses_done - 1, mirror,
			  count * sizeof(*mirror));
	return ret < 0 ? say_write(w, ret, fault) : 0;
}

int basis_writer_places(struct basis_writer *w, const float *const distance[BASIS_SURFACES],
			struct fault *fault)
{
	void *chunk = NULL;
	size_t bytes;
	int ret;

	if (w->in_pose || !w->poses_done)
		return fault_say(fault, -EINVAL, "%s: places, expected after the end of a pose",
				 w->output.path);
	ret = basis_places_pack(distance, (int)w->info.width, (int)w->info.height, &chunk, &bytes);
	if (ret == 0)
		ret = chunk_write(w, BASIS_CHUNK_PLACES, w->poses_done - 1, chunk, bytes);
	free(chunk);
	return ret < 0 ? say_write(w, ret, fault) : 0;
}

/* Writes INFO, header and chunk table, which were left empty. */
static int write_back(struct basis_writer *w)
{
	const size_t table_bytes = w->chunk_count * sizeof(*w->chunks);
	struct basis_file_header header = {
		.magic = BASIS_MAGIC,
		.version = w->version,
		.chunk_count = w->chunk_count,
		.file_bytes = w->position,
	};

	w->chunks[0].checksum = XXH3_64bits(&w->info, sizeof(w->info));
	XXH3_64bits_reset(w->hash);
	XXH3_64bits_update(w->hash, &header, sizeof(header));
	XXH3_64bits_update(w->hash, w->chunks, table_bytes);
	header.checksum = XXH3_64bits_digest(w->hash);

	errno = 0;
	if (fseeko(w->output.stream, (off_t)w->chunks[0].offset, SEEK_SET) < 0 ||
	    fwrite(&w->info, sizeof(w->info), 1, w->output.stream) != 1 ||
	    fseeko(w->output.stream, 0, SEEK_SET) < 0 ||
	    fwrite(&header, sizeof(header), 1, w->output.stream) != 1 ||
	    fwrite(w->chunks, 1, table_bytes, w->output.stream) != table_bytes)
		return errno ? -errno : -EIO;
	return 0;
}

int basis_writer_names(struct basis_writer *w, const struct basis_pose_name *names,
		       struct fault *fault)
{
	const uint32_t poses = w->info.poses;
	int ret = basis_names_check(names, poses);

	if (ret == -EINVAL)
		return fault_say(
			fault, ret,
			"%s: names of poses, expected letters, digits, - and _, not digits alone, and no two alike",
			w->output.path);
	if (ret == 0)
		ret = chunk_write(w, BASIS_CHUNK_POSES, 0, names, poses * sizeof(*names));
	return ret < 0 ? say_write(w, ret, fault) : 0;
}

int basis_writer_feet(struct basis_writer *w, const struct basis_footprint *feet,
		      struct fault *fault)
{
	uint32_t bad = 0;
	int ret = basis_foot_check(feet, w->info.poses, &bad);

	if (ret < 0)
		return fault_say(fault, ret, "%s: footprint of pose %u is impossible",
				 w->output.path, bad);
	ret = chunk_write(w, BASIS_CHUNK_FOOT, 0, feet, w->info.poses * sizeof(*feet));
	return ret < 0 ? say_write(w, ret, fault) : 0;
}

static int writer_finish(struct basis_writer *w, const struct basis_info_chunk *info,
			 const char *provenance, struct fault *fault)
{
	int ret;

	if (w->in_pose || w->poses_done != w->info.poses)
		return fault_say(fault, -EINVAL, "%s: %u poses finished, expected %u",
				 w->output.path, w->poses_done, w->info.poses);
	if (info->width != w->info.width || info->height != w->info.height ||
	    info->lights != w->info.lights || info->grounds != w->info.grounds ||
	    info->poses != w->info.poses || info->coarse != w->info.coarse)
		return fault_say(fault, -EINVAL, "%s: sizes changed since the file was begun",
				 w->output.path);
	w->info = *info;
	ret = chunk_write(w, BASIS_CHUNK_PROVENANCE, 0, provenance, strlen(provenance) + 1);
	if (ret == 0)
		ret = write_back(w);
	if (ret < 0)
		return say_write(w, ret, fault);
	return output_commit(&w->output, fault);
}

int basis_writer_finish(struct basis_writer *writer, const struct basis_info_chunk *info,
			const char *provenance, struct fault *fault)
{
	const int ret = writer_finish(writer, info, provenance, fault);

	basis_writer_abandon(writer);
	return ret;
}

void basis_writer_abandon(struct basis_writer *w)
{
	if (!w)
		return;
	output_abandon(&w->output);
	XXH3_freeState(w->hash);
	free(w->chunks);
	packer_destroy(w->packer);
	free(w->shown.entries);
	free(w->exact.entries);
	if (w->aside)
		fclose(w->aside);
	free(w);
}
