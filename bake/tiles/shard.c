/* SPDX-License-Identifier: MIT */
#include "bake/tiles/shard.h"

#include <errno.h>
#include <limits.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <xxhash.h>

#include "bake/tiles/shard_format.h"
#include "hal/base/output.h"
#include "hal/basis/basis_blocks.h"

/* One array of a plan, as stored in a shard. */
struct plan_piece {
	void *data;
	size_t bytes;
};

#define PIECES 6

static void list_pieces(struct plan *plan, struct plan_piece piece[PIECES])
{
	const size_t n = plan->info.lights;

	piece[0] = (struct plan_piece){plan->light, n * sizeof(*plan->light)};
	piece[1] = (struct plan_piece){plan->ground, plan->info.grounds * 3 * n * sizeof(double)};
	piece[2] = (struct plan_piece){plan->gather, plan->gather ? n * sizeof(*plan->gather) : 0};
	piece[3] = (struct plan_piece){plan->names,
				       plan->names ? plan->info.poses * sizeof(*plan->names) : 0};
	piece[4] = (struct plan_piece){plan->camera, sizeof(plan->camera)};
	piece[5] = (struct plan_piece){plan->provenance, sizeof(plan->provenance)};
}

static uint64_t hash_header(const struct shard_header *header,
			    const struct plan_piece piece[PIECES])
{
	struct shard_header plain = *header;
	uint64_t hash;

	plain.checksum = 0;
	hash = XXH3_64bits(&plain, sizeof(plain));
	for (int k = 0; k < PIECES; k++)
		hash = XXH3_64bits_withSeed(piece[k].data, piece[k].bytes, hash);
	return hash;
}

static uint64_t hash_record(const struct shard_record *record, const void *body)
{
	struct shard_record plain = *record;

	plain.checksum = 0;
	return XXH3_64bits_withSeed(body, record->bytes, XXH3_64bits(&plain, sizeof(plain)));
}

int shard_first(const struct shard_place *place, int tiles, int pose)
{
	const int64_t before = (int64_t)pose * tiles % place->count;

	return (int)((place->index - before + place->count) % place->count);
}

/* ---- writing ---- */

struct shard_writer {
	struct output output;
	size_t lights;
	int pose; /* the pose that is being written */
};

static int shard_put(struct shard_writer *w, const void *data, size_t bytes, struct fault *fault)
{
	int err;

	errno = 0;
	if (!bytes || fwrite(data, 1, bytes, w->output.stream) == bytes)
		return 0;
	err = errno ? -errno : -EIO;
	return fault_say(fault, err, "%s: cannot be written: %s", w->output.path, strerror(-err));
}

static int write_plan(struct shard_writer *w, const struct plan *plan,
		      const struct shard_place *place, struct fault *fault)
{
	struct plan copy = *plan;
	struct shard_header header;
	struct plan_piece piece[PIECES];
	int err;

	memset(&header, 0, sizeof(header));
	memcpy(header.magic, SHARD_MAGIC, sizeof(header.magic));
	snprintf(header.program, sizeof(header.program), "%s", INLAY_VERSION);
	header.basis_version = BASIS_VERSION;
	header.account_bytes = sizeof(struct tile_account);
	header.index = (uint32_t)place->index;
	header.count = (uint32_t)place->count;
	header.has_gather = plan->gather ? 1 : 0;
	header.has_names = plan->names ? 1 : 0;
	header.info = plan->info;
	list_pieces(&copy, piece);
	header.checksum = hash_header(&header, piece);
	err = shard_put(w, &header, sizeof(header), fault);
	for (int k = 0; !err && k < PIECES; k++)
		err = shard_put(w, piece[k].data, piece[k].bytes, fault);
	return err;
}

int shard_writer_open(struct shard_writer **writer, const struct plan *plan,
		      const struct shard_place *place, const char *path, struct fault *fault)
{
	struct shard_writer *w = calloc(1, sizeof(*w));
	int err;

	if (!w)
		return fault_say(fault, -ENOMEM, "%s: out of memory", path);
	w->lights = plan->info.lights;
	err = output_open(&w->output, path, fault);
	if (!err)
		err = write_plan(w, plan, place, fault);
	if (err)
		shard_writer_abandon(w);
	else
		*writer = w;
	return err;
}

void shard_writer_abandon(struct shard_writer *w)
{
	if (!w)
		return;
	output_abandon(&w->output);
	free(w);
}

static int write_record(struct shard_writer *w, struct shard_record *record, const void *body,
			struct fault *fault)
{
	int err;

	record->checksum = hash_record(record, body);
	err = shard_put(w, record, sizeof(*record), fault);
	return err ? err : shard_put(w, body, record->bytes, fault);
}

int shard_writer_add(struct shard_writer *w, const struct finished_tile *tile, struct fault *fault)
{
	const int count = tile->shown + tile->exact;
	const size_t glass = (size_t)tile->glass_count * sizeof(*tile->glass);
	const size_t mirrors = (size_t)tile->mirror_count * sizeof(*tile->mirror);
	struct shard_record record = {.tile = (uint32_t)tile->tile,
				      .pose = (uint32_t)tile->pose,
				      .shown = (uint32_t)tile->shown,
				      .exact = (uint32_t)tile->exact,
				      .glass = (uint32_t)tile->glass_count,
				      .mirrors = (uint32_t)tile->mirror_count,
				      .bytes = sizeof(tile->account) + glass + mirrors};
	uint8_t *body, *to;
	int err;

	for (int k = 0; k < count; k++)
		record.bytes += sizeof(tile->blocks->entry) + tile->blocks[k].entry.bytes;
	body = to = malloc(record.bytes);
	if (!body)
		return fault_say(fault, -ENOMEM, "%s: out of memory", w->output.path);
	memcpy(to, &tile->account, sizeof(tile->account));
	to += sizeof(tile->account);
	if (glass)
		memcpy(to, tile->glass, glass);
	to += glass;
	if (mirrors)
		memcpy(to, tile->mirror, mirrors);
	to += mirrors;
	for (int k = 0; k < count; k++, to += sizeof(tile->blocks->entry))
		memcpy(to, &tile->blocks[k].entry, sizeof(tile->blocks->entry));
	for (int k = 0; k < count; k++) {
		memcpy(to, tile->blocks[k].payload, tile->blocks[k].entry.bytes);
		to += tile->blocks[k].entry.bytes;
	}
	err = write_record(w, &record, body, fault);
	free(body);
	return err;
}

int shard_writer_pose_end(struct shard_writer *w, const float (*peak)[3],
			  const struct basis_footprint *foot, struct fault *fault)
{
	const size_t bytes = (w->lights + 1) * sizeof(*peak);
	struct shard_record record = {
		.tile = SHARD_NO_TILE, .pose = (uint32_t)w->pose++, .bytes = bytes + sizeof(*foot)};
	uint8_t *body = malloc(record.bytes);
	int err;

	if (!body)
		return fault_say(fault, -ENOMEM, "%s: out of memory", w->output.path);
	memcpy(body, peak, bytes);
	memcpy(body + bytes, foot, sizeof(*foot));
	err = write_record(w, &record, body, fault);
	free(body);
	return err;
}

int shard_writer_finish(struct shard_writer *w, struct fault *fault)
{
	const int err = output_commit(&w->output, fault);

	shard_writer_abandon(w);
	return err;
}

/* ---- reading ---- */

struct shard_stream {
	FILE *file;
	char *path;
	uint64_t left;	/* bytes not yet read */
	int pose, next; /* pose and number of the tile that must come next */
};

static int say_damaged(const struct shard_stream *s, const char *what, struct fault *fault)
{
	return fault_say(fault, -EBADMSG,
			 "%s: %s, expected a whole file of inlay-bake render --shard", s->path,
			 what);
}

static int shard_get(struct shard_stream *s, void *data, size_t bytes, struct fault *fault)
{
	if (bytes > s->left || fread(data, 1, bytes, s->file) != bytes)
		return say_damaged(s, "ends too early", fault);
	s->left -= bytes;
	return 0;
}

static int shard_check_header(const struct shard_stream *s, const struct shard_header *h,
			      struct fault *fault)
{
	const struct basis_info_chunk *info = &h->info;

	if (memcmp(h->magic, SHARD_MAGIC, sizeof(h->magic)) != 0)
		return say_damaged(s, "is no shard of a bake", fault);
	if (strncmp(h->program, INLAY_VERSION, sizeof(h->program)) != 0 ||
	    h->basis_version != BASIS_VERSION || h->account_bytes != sizeof(struct tile_account))
		return fault_say(
			fault, -ENOTSUP,
			"%s: was made by inlay-bake %.*s for basis files of version %u, expected one made by this program, inlay-bake %s for version %d",
			s->path, SHARD_PROGRAM_MAX - 1, h->program, h->basis_version, INLAY_VERSION,
			BASIS_VERSION);
	if (h->count < 1 || h->count > SHARDS_MAX || h->index >= h->count || info->width < 1 ||
	    info->width > BASIS_SIDE_MAX || info->height < 1 || info->height > BASIS_SIDE_MAX ||
	    info->lights < 1 || info->lights > BASIS_LIGHTS_MAX ||
	    info->grounds > BASIS_GROUNDS_MAX || info->coarse < 1 || info->coarse > info->lights ||
	    info->poses < 1 || info->poses > BASIS_POSES_MAX ||
	    (h->has_gather != 0) != (info->coarse != info->lights))
		return say_damaged(s, "is damaged", fault);
	return 0;
}

/* Returns the sum of the bytes that list_pieces() will list. */
static uint64_t plan_bytes(const struct shard_header *h)
{
	const struct plan *plan = NULL; /* used in sizeof alone */
	const uint64_t n = h->info.lights;

	return n * sizeof(*plan->light) + h->info.grounds * 3 * n * sizeof(*plan->ground) +
	       (h->has_gather ? n * sizeof(*plan->gather) : 0) +
	       (h->has_names ? h->info.poses * sizeof(*plan->names) : 0) + sizeof(plan->camera) +
	       sizeof(plan->provenance);
}

static int create_plan(struct plan *plan, const struct shard_header *h)
{
	const size_t n = h->info.lights;

	plan->info = h->info;
	plan->light = calloc(n, sizeof(*plan->light));
	plan->ground = calloc(3 * h->info.grounds * n + 1, sizeof(*plan->ground));
	if (h->has_gather)
		plan->gather = calloc(n, sizeof(*plan->gather));
	if (h->has_names)
		plan->names = calloc(h->info.poses, sizeof(*plan->names));
	return plan->light && plan->ground && (plan->gather || !h->has_gather) &&
			       (plan->names || !h->has_names)
		       ? 0
		       : -ENOMEM;
}

static int read_plan(struct shard *shard, struct fault *fault)
{
	struct shard_stream *s = shard->stream;
	struct plan *plan = &shard->plan;
	struct plan_piece piece[PIECES];
	struct shard_header header;
	int err = shard_get(s, &header, sizeof(header), fault);

	if (!err)
		err = shard_check_header(s, &header, fault);
	if (err)
		return err;
	if (plan_bytes(&header) > s->left)
		return say_damaged(s, "ends too early", fault);
	if (create_plan(plan, &header))
		return fault_say(fault, -ENOMEM, "%s: out of memory", s->path);
	list_pieces(plan, piece);
	for (int k = 0; !err && k < PIECES; k++)
		err = shard_get(s, piece[k].data, piece[k].bytes, fault);
	if (err)
		return err;
	if (hash_header(&header, piece) != header.checksum ||
	    !memchr(plan->camera, 0, sizeof(plan->camera)) ||
	    !memchr(plan->provenance, 0, sizeof(plan->provenance)))
		return say_damaged(s, "is damaged", fault);
	shard->place = (struct shard_place){(int)header.index, (int)header.count};
	s->next = shard->place.index;
	return 0;
}

int shard_open(struct shard *shard, const char *path, struct fault *fault)
{
	struct shard_stream *s = calloc(1, sizeof(*s));
	struct stat about;
	int err;

	*shard = (struct shard){.stream = s};
	if (s)
		s->path = strdup(path);
	if (!s || !s->path) {
		shard_close(shard);
		return fault_say(fault, -ENOMEM, "%s: out of memory", path);
	}
	s->file = fopen(path, "rb");
	if (!s->file || fstat(fileno(s->file), &about)) {
		err = -errno;
		fault_say(fault, err, "%s: cannot be opened: %s", path, strerror(-err));
	} else {
		s->left = (uint64_t)about.st_size;
		err = read_plan(shard, fault);
	}
	if (err)
		shard_close(shard);
	return err;
}

void shard_close(struct shard *shard)
{
	if (shard->stream) {
		if (shard->stream->file)
			fclose(shard->stream->file);
		free(shard->stream->path);
	}
	free(shard->stream);
	free(shard->peak);
	plan_free(&shard->plan);
	*shard = (struct shard){.stream = NULL};
}

/* Reads the body of a record and checks it; the caller frees it. Returns NULL if it is damaged or
 * cut off. */
static uint8_t *read_body(struct shard_stream *s, const struct shard_record *record,
			  struct fault *fault)
{
	uint8_t *body = record->bytes <= s->left ? malloc(record->bytes + 1) : NULL;

	if (!body) {
		say_damaged(s, "ends too early", fault);
		return NULL;
	}
	if (shard_get(s, body, record->bytes, fault) == 0 &&
	    hash_record(record, body) == record->checksum)
		return body;
	say_damaged(s, "is damaged", fault);
	free(body);
	return NULL;
}

static int shard_take_peaks(struct shard *shard, const struct shard_record *record, uint8_t *body,
			    struct fault *fault)
{
	struct shard_stream *s = shard->stream;
	const int tiles = plan_tiles(&shard->plan), poses = (int)shard->plan.info.poses;
	const size_t peaks = ((size_t)shard->plan.info.lights + 1) * sizeof(*shard->peak);

	if (record->bytes != peaks + sizeof(shard->foot) || record->pose != (uint32_t)s->pose ||
	    s->next < tiles || (s->pose + 1 == poses && s->left)) {
		free(body);
		return say_damaged(s, "is damaged", fault);
	}
	free(shard->peak);
	shard->peak = (float(*)[3])(void *)body;
	memcpy(&shard->foot, body + peaks, sizeof(shard->foot));
	s->next = shard_first(&shard->place, tiles, ++s->pose);
	return 0;
}

/* Finds entries and payloads in a body; the blocks point into it. */
static int list_blocks(const struct shard_record *record, const uint8_t *entries,
		       const uint8_t *end, struct basis_block_payload *blocks)
{
	const int count = (int)(record->shown + record->exact);
	const uint8_t *payload = entries + (size_t)count * sizeof(blocks->entry);

	for (int k = 0; k < count; k++) {
		struct basis_block_entry *entry = &blocks[k].entry;

		memcpy(entry, entries + (size_t)k * sizeof(*entry), sizeof(*entry));
		if (entry->tile != record->tile || entry->bytes > (uint64_t)(end - payload))
			return -EBADMSG;
		blocks[k].payload = payload;
		payload += entry->bytes;
	}
	return payload == end ? 0 : -EBADMSG;
}

/* Checks blocks as basis files are checked: later code trusts them like those of its own bake. */
static int shard_check_tile(const struct basis_info_chunk *info, const struct finished_tile *tile)
{
	const int err = basis_check_tile(info, tile->tile, false, tile->blocks, tile->shown);

	if (tile->account.noise_count < 0 || tile->account.noise_count > UINT32_MAX)
		return -EBADMSG;
	return err ? err
		   : basis_check_tile(info, tile->tile, true, tile->blocks + tile->shown,
				      tile->exact);
}

/* Copies a tile out of a body whose checksum is right. */
static int shard_take_tile(const struct basis_info_chunk *info, const struct shard_record *record,
			   const uint8_t *body, struct finished_tile *tile)
{
	const uint64_t count = (uint64_t)record->shown + record->exact;
	const uint64_t glass = (uint64_t)record->glass * sizeof(*tile->glass);
	const uint64_t mirrors = (uint64_t)record->mirrors * sizeof(*tile->mirror);
	const uint64_t fixed = sizeof(tile->account) + glass + mirrors;
	struct basis_block_payload *blocks;
	int err;

	if (record->bytes < fixed || record->glass > BASIS_TILE * BASIS_TILE ||
	    record->mirrors > BASIS_TILE * BASIS_TILE * BASIS_MIRROR_MOST || count > INT_MAX ||
	    count > (record->bytes - fixed) / sizeof(blocks->entry))
		return -EBADMSG;
	blocks = calloc(count + 1, sizeof(*blocks));
	if (!blocks)
		return -ENOMEM;
	*tile = (struct finished_tile){.pose = (int)record->pose, .tile = (int)record->tile};
	memcpy(&tile->account, body, sizeof(tile->account));
	err = list_blocks(record, body + fixed, body + record->bytes, blocks);
	if (!err)
		err = finished_tile_keep(tile, blocks, (int)record->shown, blocks + record->shown,
					 (int)record->exact);
	if (!err)
		err = shard_check_tile(info, tile);
	if (!err)
		err = finished_tile_keep_glass(tile, (const void *)(body + sizeof(tile->account)),
					       (int)record->glass);
	if (!err)
		err = finished_tile_keep_mirror(
			tile, (const void *)(body + sizeof(tile->account) + glass),
			(int)record->mirrors);
	if (err)
		finished_tile_free(tile);
	free(blocks);
	return err;
}

int shard_next(struct shard *shard, struct finished_tile *tile, struct fault *fault)
{
	struct shard_stream *s = shard->stream;
	struct shard_record record;
	uint8_t *body;
	int err = shard_get(s, &record, sizeof(record), fault);

	if (err)
		return err;
	body = read_body(s, &record, fault);
	if (!body)
		return -EBADMSG;
	if (record.tile == SHARD_NO_TILE)
		return shard_take_peaks(shard, &record, body, fault);
	err = record.tile == (uint32_t)s->next && s->next < plan_tiles(&shard->plan) &&
			      record.pose == (uint32_t)s->pose &&
			      record.pose < shard->plan.info.poses
		      ? shard_take_tile(&shard->plan.info, &record, body, tile)
		      : -EBADMSG;
	free(body);
	s->next += shard->place.count;
	if (err == -ENOMEM)
		return fault_say(fault, err, "%s: out of memory", s->path);
	return err ? say_damaged(s, "is damaged", fault) : 1;
}

bool shard_same_bake(const struct shard *a, const struct shard *b)
{
	struct plan left = a->plan, right = b->plan;
	struct plan_piece x[PIECES], y[PIECES];

	if (a->place.count != b->place.count || memcmp(&left.info, &right.info, sizeof(left.info)))
		return false;
	list_pieces(&left, x);
	list_pieces(&right, y);
	for (int k = 0; k < PIECES; k++)
		if (x[k].bytes != y[k].bytes ||
		    (x[k].bytes && memcmp(x[k].data, y[k].data, x[k].bytes) != 0))
			return false;
	return true;
}
