/* SPDX-License-Identifier: MIT */
#include <errno.h>
#include <limits.h>
#include <pthread.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "app/records/records.h"
#include "hal/base/log.h"
#include "hal/base/output.h"
#include "hal/base/pool.h"
#include "hal/people/people.h"

static const struct {
	const char *name, *lost;
} words[KEEPER_FILES] = {
	[KEEPER_STATE] = {"state", "what was chosen is not kept"},
	[KEEPER_PLACE] = {"people", "what was learned of the place is not kept"},
};

struct keeper_job {
	char path[PATH_MAX];
	void *bytes; /* NULL: the file condition to be removed */
	size_t count;
	bool due, failed;
};

struct keeper {
	pthread_t thread;
	pthread_mutex_t lock;
	pthread_cond_t wake;
	/* Under the lock: */
	struct keeper_job jobs[KEEPER_FILES];
	int writing; /* enum keeper_file; -1: none */
	bool leave;
	/* For the thread alone: */
	struct fault said[KEEPER_FILES];
};

static int replace_file(const struct keeper_job *job, struct fault *fault)
{
	struct output out;
	int err = output_open(&out, job->path, fault);

	if (err)
		return err;
	fwrite(job->bytes, 1, job->count, out.stream); /* output_commit() tells of failures */
	return output_commit(&out, fault);
}

static int remove_file(const char *path, struct fault *fault)
{
	const int err = unlink(path) < 0 && errno != ENOENT ? -errno : 0;

	return err ? fault_say(fault, err, "%s: cannot be removed: %s", path, strerror(-err)) : 0;
}

/* Called without the lock. */
static int keeper_run(struct keeper *k, int file, const struct keeper_job *job)
{
	struct fault fault = {.text = ""}, *said = &k->said[file];
	int err;

	if (job->bytes && file == KEEPER_PLACE)
		people_seal(job->bytes, job->count);
	err = job->bytes ? replace_file(job, &fault) : remove_file(job->path, &fault);
	if (err && strcmp(said->text, fault.text) != 0)
		log_warning("%s: %s; %s", words[file].name, fault.text, words[file].lost);
	if (!err && *said->text)
		log_info("%s: %s is written again", words[file].name, job->path);
	*said = fault;
	free(job->bytes);
	return err;
}

static void *keeper_main(void *context)
{
	struct keeper *k = context;

	pthread_mutex_lock(&k->lock);
	for (;;) {
		struct keeper_job job;
		int file = 0, err;

		while (file < KEEPER_FILES && !k->jobs[file].due)
			file++;
		if (file == KEEPER_FILES && k->leave)
			break;
		if (file == KEEPER_FILES) {
			pthread_cond_wait(&k->wake, &k->lock);
			continue;
		}
		job = k->jobs[file];
		k->jobs[file].due = false;
		k->writing = file;
		pthread_mutex_unlock(&k->lock);
		err = keeper_run(k, file, &job);
		pthread_mutex_lock(&k->lock);
		k->writing = -1;
		k->jobs[file].failed = err != 0;
	}
	pthread_mutex_unlock(&k->lock);
	return NULL;
}

int keeper_create(struct keeper **out)
{
	struct keeper *k = calloc(1, sizeof(*k));
	int err;

	if (!k)
		return -ENOMEM;
	k->writing = -1;
	pthread_mutex_init(&k->lock, NULL); /* these do not fail in glibc */
	pthread_cond_init(&k->wake, NULL);
	err = thread_start(&k->thread, keeper_main, k);
	if (err)
		free(k);
	else
		*out = k;
	return err;
}

void keeper_put(struct keeper *k, enum keeper_file file, const char *path, void *bytes,
		size_t count)
{
	struct keeper_job *job = &k->jobs[file];

	pthread_mutex_lock(&k->lock);
	if (job->due)
		free(job->bytes);
	snprintf(job->path, sizeof(job->path), "%s", path);
	job->bytes = bytes;
	job->count = count;
	job->due = true;
	pthread_cond_signal(&k->wake);
	pthread_mutex_unlock(&k->lock);
}

enum keeper_condition keeper_look(struct keeper *k, enum keeper_file file)
{
	enum keeper_condition condition;

	pthread_mutex_lock(&k->lock);
	condition = k->jobs[file].due || k->writing == (int)file ? KEEPER_BUSY
		    : k->jobs[file].failed			 ? KEEPER_FAILED
								 : KEEPER_DONE;
	pthread_mutex_unlock(&k->lock);
	return condition;
}

void keeper_destroy(struct keeper *k)
{
	if (!k)
		return;
	pthread_mutex_lock(&k->lock);
	k->leave = true;
	pthread_cond_signal(&k->wake);
	pthread_mutex_unlock(&k->lock);
	pthread_join(k->thread, NULL);
	pthread_cond_destroy(&k->wake);
	pthread_mutex_destroy(&k->lock);
	free(k);
}
