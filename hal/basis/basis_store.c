/* SPDX-License-Identifier: MIT */
#include "hal/basis/basis_store.h"

#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <pthread.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>
#include <xxhash.h>

#include "hal/base/pool.h"
#include "hal/basis/basis_blocks.h"
#include "hal/basis/basis_file.h"
#include "hal/basis/pack.h"

/* No baked pose unpacks to more than this many times its packed size. */
#define EXPANDS_MOST 4096
#define SMALL ((uint64_t)1 << 20)

/* An unpacked pose. */
struct unpacked_pose {
	uint8_t *memory; /* coverage, then payloads at data_at; NULL: not unpacked */
	size_t bytes, data_at;
	struct basis_layer layer;
};

enum slot_state { SLOT_PLAIN, SLOT_ABSENT, SLOT_LOADING, SLOT_READY };

struct slot {
	enum slot_state state;
	bool given;			  /* basis->poses points to its blocks */
	int failed;			  /* -errno: no further attempt until it is expected anew */
	char *why;			  /* text of the failure; NULL: no memory for it */
	struct basis_blocks_chunk blocks; /* data is NULL */
	uint64_t pack_at;		  /* in the file */
	size_t pack_bytes;
	uint64_t checksum;
	struct unpacked_pose unpacked;
};

struct basis_store {
	struct basis shell; /* only sizes, for the checks of blocks */
	char *name;
	const uint8_t *data;
	struct basis_file file; /* stays open, to read poses */
	struct basis_pose *poses;
	struct pool *pool;
	int count;
	/* protected by the lock: */
	pthread_mutex_t lock;
	pthread_cond_t turned;
	struct slot *slots; /* [count] */
	int wanted[BASIS_EXPECT_MAX], wanted_count;
	bool leave, thread_runs;
	pthread_t thread;
};

/* ---- one pose ---- */

static void pose_release(struct unpacked_pose *u)
{
	if (u->memory)
		munmap(u->memory, u->bytes);
	free(u->layer.tiles);
	free(u->layer.blocks);
	*u = (struct unpacked_pose){.memory = NULL};
}

static size_t store_pixels(const struct basis_store *store)
{
	return (size_t)store->shell.info.width * store->shell.info.height;
}

static int pose_allocate(const struct basis_store *store, struct unpacked_pose *u,
			 uint64_t data_bytes)
{
	const size_t coverage = store_pixels(store) * sizeof(uint16_t);

	u->data_at = (coverage + BASIS_PAGE - 1) / BASIS_PAGE * BASIS_PAGE;
	u->bytes = u->data_at + data_bytes;
	u->memory = mmap(NULL, u->bytes, PROT_READ | PROT_WRITE,
			 MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
	if (u->memory == MAP_FAILED) {
		u->memory = NULL;
		return -ENOMEM;
	}
	(void)madvise(u->memory, u->bytes, MADV_HUGEPAGE);
	return 0;
}

struct unpacking {
	const struct pack *pack;
	uint8_t *data;
	int err; /* of any part that failed; atomic */
};

static void unpack_part(void *context, int part, int worker)
{
	struct unpacking *job = context;
	const int err = pack_unpack(job->pack, part, job->data);

	(void)worker;
	if (err)
		__atomic_store_n(&job->err, err, __ATOMIC_RELAXED);
}

/* pool: NULL to use the calling thread alone. */
static int unpack_all(const struct basis_store *store, const struct pack *pack,
		      struct unpacked_pose *u, struct pool *pool)
{
	struct unpacking job = {.pack = pack, .data = u->memory + u->data_at};
	uint16_t *coverage = (uint16_t *)(void *)u->memory;
	const int ret = pack_coverage(pack, coverage, store_pixels(store));

	if (ret < 0)
		return ret;
	pool_run(pool, pack->parts, unpack_part, &job);
	return job.err;
}

/* Reads the chunk of a pose and checks that it is the one checked at opening. */
static int borrow_from(const struct basis_reader *reader, const struct slot *slot, int pose,
		       const uint8_t **chunk, void **owned)
{
	const int ret = basis_file_borrow(reader, slot->pack_at, slot->pack_bytes, chunk, owned);

	if (ret < 0 || XXH3_64bits(*chunk, slot->pack_bytes) == slot->checksum)
		return ret;
	free(*owned);
	return basis_damaged(reader, "pose %d does not have its checksum any more", pose);
}

/* Reads the chunk from the file that has the name now, in case the file was restored or its medium
 * plugged in again. If the chunk is right, this file replaces the open one. */
static int borrow_anew(struct basis_store *store, const struct basis_reader *reader, int pose,
		       const uint8_t **chunk, void **owned)
{
	const struct basis_file file = {.fd = open(store->name, O_RDONLY | O_CLOEXEC | O_NONBLOCK)};
	struct basis_reader anew = *reader;
	int ret;

	if (file.fd < 0)
		return -errno;
	anew.file = &file;
	anew.fault = NULL;
	ret = borrow_from(&anew, &store->slots[pose], pose, chunk, owned);
	if (ret == 0)
		(void)dup3(file.fd, store->file.fd, O_CLOEXEC);
	close(file.fd);
	return ret;
}

static int borrow_pack(struct basis_store *store, const struct basis_reader *reader, int pose,
		       const uint8_t **chunk, void **owned)
{
	const int ret = borrow_from(reader, &store->slots[pose], pose, chunk, owned);

	if (ret == 0 || ret == -ENOMEM || store->file.fd < 0)
		return ret;
	return borrow_anew(store, reader, pose, chunk, owned) == 0 ? 0 : ret;
}

static int pose_unpack(struct basis_store *store, int pose, struct pool *pool,
		       struct unpacked_pose *u, struct fault *fault)
{
	const struct slot *slot = &store->slots[pose];
	struct basis_blocks_chunk blocks = slot->blocks;
	const struct basis_reader reader = {
		.basis = &store->shell,
		.data = store->data,
		.name = store->name,
		.file = &store->file,
		.fault = fault,
	};
	struct pack pack = {.parts = 0};
	const uint8_t *chunk;
	void *owned;
	int ret = borrow_pack(store, &reader, pose, &chunk, &owned);

	*u = (struct unpacked_pose){.memory = NULL};
	if (ret < 0)
		return ret;
	ret = pack_open(&pack, &reader, chunk, slot->pack_bytes, &blocks);
	if (ret < 0)
		goto give_back;
	ret = pose_allocate(store, u, pack.data_bytes);
	if (ret == 0)
		ret = unpack_all(store, &pack, u, pool);
	if (ret == -EBADMSG)
		basis_damaged(&reader, "pose %d cannot be unpacked", pose);
	else if (ret < 0)
		fault_say(fault, ret, "%s: out of memory", store->name);
	pack_close(&pack);
	if (ret == 0) {
		blocks.data = u->memory + u->data_at;
		ret = basis_read_blocks(&reader, &blocks, &u->layer);
	}
	if (ret < 0)
		pose_release(u);
give_back:
	free(owned);
	return ret;
}

/* ---- the file ---- */

int basis_store_create(struct basis_store **out, const struct basis_reader *reader,
		       struct basis_pose *poses)
{
	const struct basis *basis = reader->basis;
	struct basis_store *store = calloc(1, sizeof(*store));
	int ret = -ENOMEM;

	*out = store;
	if (!store)
		return fault_say(reader->fault, ret, "%s: out of memory", reader->name);
	store->shell.info = basis->info;
	store->shell.tiles_across = basis->tiles_across;
	store->shell.tiles_down = basis->tiles_down;
	store->data = reader->data;
	store->file.fd = -1;
	store->poses = poses;
	store->count = (int)basis->info.poses;
	pthread_mutex_init(&store->lock, NULL); /* neither fails in glibc */
	pthread_cond_init(&store->turned, NULL);
	store->name = strdup(reader->name);
	store->slots = calloc(basis->info.poses, sizeof(*store->slots));
	if (store->name && store->slots)
		ret = pool_create(&store->pool, 0);
	if (ret == 0 && reader->file && reader->file->fd >= 0) {
		store->file.fd = fcntl(reader->file->fd, F_DUPFD_CLOEXEC, 0);
		ret = store->file.fd < 0 ? -errno : 0;
	}
	return ret < 0 ? fault_say(reader->fault, ret, "%s: cannot be unpacked: %s", reader->name,
				   strerror(-ret))
		       : 0;
}

int basis_store_add(struct basis_store *store, const struct basis_reader *reader, int pose,
		    const struct basis_chunk_entry *blocks, const struct basis_chunk_entry *pack)
{
	struct basis_pack head;
	struct slot *slot = &store->slots[pose];
	const size_t entry = sizeof(*slot->blocks.entries);
	const uint8_t *at;
	void *owned;
	int ret;

	if (blocks->bytes % entry || blocks->bytes / entry > INT_MAX)
		return basis_damaged(reader, "BLCK chunk of %llu bytes, expected a multiple of %zu",
				     (unsigned long long)blocks->bytes, entry);
	if (pack->bytes < sizeof(head))
		return basis_damaged(reader, "PACK chunk of %llu bytes, expected %zu and more",
				     (unsigned long long)pack->bytes, sizeof(head));
	ret = basis_file_borrow(reader, pack->offset, sizeof(head), &at, &owned);
	if (ret < 0)
		return ret;
	memcpy(&head, at, sizeof(head));
	free(owned);
	if (head.data_bytes > SMALL && head.data_bytes / EXPANDS_MOST > pack->bytes)
		return basis_damaged(
			reader,
			"PACK chunk of %llu bytes unpacks to %llu, expected less than %d times as many",
			(unsigned long long)pack->bytes, (unsigned long long)head.data_bytes,
			EXPANDS_MOST);
	slot->state = SLOT_ABSENT;
	slot->blocks = (struct basis_blocks_chunk){
		.entries = (const void *)(reader->data + blocks->offset),
		.count = blocks->bytes / entry,
		.data_bytes = head.data_bytes,
		.pose = pose,
	};
	slot->pack_at = pack->offset;
	slot->pack_bytes = pack->bytes;
	slot->checksum = pack->checksum;
	return basis_check_shapes(reader, &slot->blocks);
}

struct checking {
	struct basis_store *store;
	const struct basis_reader *reader;
	int err, pose; /* of the first pose that is damaged */
};

static void store_check_pose(void *context, int pose, int worker)
{
	struct checking *job = context;
	struct basis_store *store = job->store;
	struct fault fault = {.text = ""};
	struct unpacked_pose u;
	int err;

	(void)worker;
	if (store->slots[pose].state == SLOT_PLAIN)
		return;
	err = pose_unpack(store, pose, NULL, &u, &fault);
	pose_release(&u);
	pthread_mutex_lock(&store->lock);
	if (err && (!job->err || pose < job->pose)) {
		job->err = err;
		job->pose = pose;
		if (job->reader->fault)
			*job->reader->fault = fault;
	}
	pthread_mutex_unlock(&store->lock);
}

int basis_store_check(struct basis_store *store, const struct basis_reader *reader)
{
	struct checking job = {.store = store, .reader = reader};

	pool_run(store->pool, store->count, store_check_pose, &job);
	return job.err;
}

/* ---- in use ---- */

static bool is_wanted(const struct basis_store *store, int pose)
{
	for (int k = 0; k < store->wanted_count; k++)
		if (store->wanted[k] == pose)
			return true;
	return false;
}

/* Lets basis->poses point to an unpacked pose. The caller holds the lock and is the thread that
 * uses the poses. */
static void slot_give(struct basis_store *store, int pose)
{
	struct basis_pose *to = &store->poses[pose];
	struct slot *slot = &store->slots[pose];

	if (slot->given)
		return;
	to->shown = slot->unpacked.layer;
	to->coverage = (const uint16_t *)(const void *)slot->unpacked.memory;
	to->turn++;
	slot->given = true;
}

/* Frees an unpacked pose. The caller holds the lock; if the pose was given, it is the thread that
 * uses the poses. */
static void take_back(struct basis_store *store, int pose)
{
	struct basis_pose *from = &store->poses[pose];
	struct slot *slot = &store->slots[pose];

	if (slot->given) {
		from->shown = (struct basis_layer){.tiles = NULL};
		from->coverage = NULL;
		from->turn++;
		slot->given = false;
	}
	pose_release(&slot->unpacked);
	slot->state = SLOT_ABSENT;
}

/* Unpacks a pose. The caller holds the lock, which is released while unpacking. */
static void load_slot(struct basis_store *store, int pose, struct pool *pool)
{
	struct slot *slot = &store->slots[pose];
	struct fault fault = {.text = ""};

	slot->state = SLOT_LOADING;
	pthread_mutex_unlock(&store->lock);
	slot->failed = pose_unpack(store, pose, pool, &slot->unpacked, &fault);
	pthread_mutex_lock(&store->lock);
	slot->state = slot->failed ? SLOT_ABSENT : SLOT_READY;
	free(slot->why);
	slot->why = slot->failed ? strdup(fault.text) : NULL;
	pthread_cond_broadcast(&store->turned);
}

int basis_pose_load(const struct basis *basis, int pose, struct fault *fault)
{
	struct basis_store *store = basis->store;
	struct slot *slot;
	int ret;

	if (!store)
		return 0;
	slot = &store->slots[pose];
	pthread_mutex_lock(&store->lock);
	while (slot->state == SLOT_LOADING)
		pthread_cond_wait(&store->turned, &store->lock);
	if (slot->state == SLOT_ABSENT && !slot->failed)
		load_slot(store, pose, store->pool);
	ret = slot->failed;
	if (ret < 0)
		fault_say(fault, ret, "%s", slot->why ? slot->why : "out of memory");
	else if (slot->state == SLOT_READY)
		slot_give(store, pose);
	pthread_mutex_unlock(&store->lock);
	return ret;
}

bool basis_pose_ready(const struct basis *basis, int pose)
{
	struct basis_store *store = basis->store;
	bool comes;

	if (!store)
		return true;
	pthread_mutex_lock(&store->lock);
	comes = store->slots[pose].state == SLOT_LOADING ||
		(store->slots[pose].state == SLOT_ABSENT && !store->slots[pose].failed &&
		 (store->thread_runs || !is_wanted(store, pose)));
	pthread_mutex_unlock(&store->lock);
	return !comes;
}

/* Returns the next expected pose to unpack, or -1. The caller holds the lock. */
static int next_wanted(const struct basis_store *store)
{
	for (int k = 0; k < store->wanted_count; k++) {
		const struct slot *slot = &store->slots[store->wanted[k]];

		if (slot->state == SLOT_ABSENT && !slot->failed)
			return store->wanted[k];
	}
	return -1;
}

static void *look_ahead(void *context)
{
	struct basis_store *store = context;

	pthread_mutex_lock(&store->lock);
	while (!store->leave) {
		const int pose = next_wanted(store);

		if (pose < 0) {
			pthread_cond_wait(&store->turned, &store->lock);
			continue;
		}
		load_slot(store, pose, NULL);
		if (!is_wanted(store, pose) && store->slots[pose].state == SLOT_READY)
			take_back(store, pose); /* it was not given yet */
	}
	pthread_mutex_unlock(&store->lock);
	return NULL;
}

/* If the thread cannot start, poses are unpacked when they are asked for. */
static void start_thread(struct basis_store *store)
{
	sigset_t all, before;

	sigfillset(&all);
	pthread_sigmask(SIG_SETMASK, &all, &before);
	store->thread_runs = pthread_create(&store->thread, NULL, look_ahead, store) == 0;
	pthread_sigmask(SIG_SETMASK, &before, NULL);
}

void basis_poses_expect(const struct basis *basis, const int *poses, int count)
{
	struct basis_store *store = basis->store;

	if (!store)
		return;
	pthread_mutex_lock(&store->lock);
	store->wanted_count = 0;
	for (int k = 0; k < count && store->wanted_count < BASIS_EXPECT_MAX; k++)
		if (!is_wanted(store, poses[k]))
			store->wanted[store->wanted_count++] = poses[k];
	for (int p = 0; p < store->count; p++) {
		if (store->slots[p].state == SLOT_ABSENT)
			store->slots[p].failed = 0;
		if (store->slots[p].state == SLOT_READY && !is_wanted(store, p))
			take_back(store, p);
	}
	if (!store->thread_runs && next_wanted(store) >= 0)
		start_thread(store);
	pthread_cond_broadcast(&store->turned);
	pthread_mutex_unlock(&store->lock);
}

void basis_store_destroy(struct basis_store *store)
{
	if (!store)
		return;
	pthread_mutex_lock(&store->lock);
	store->leave = true;
	pthread_cond_broadcast(&store->turned);
	pthread_mutex_unlock(&store->lock);
	if (store->thread_runs)
		pthread_join(store->thread, NULL);
	for (int p = 0; store->slots && p < store->count; p++) {
		if (store->slots[p].state == SLOT_READY)
			take_back(store, p);
		free(store->slots[p].why);
	}
	pool_destroy(store->pool);
	pthread_cond_destroy(&store->turned);
	pthread_mutex_destroy(&store->lock);
	free(store->slots);
	free(store->name);
	if (store->file.fd >= 0)
		close(store->file.fd);
	free(store);
}
