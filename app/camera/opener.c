/* SPDX-License-Identifier: MIT */
#include "app/camera/source.h"

#include <errno.h>
#include <pthread.h>
#include <stdlib.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include "hal/base/pool.h"

struct opener {
	pthread_t thread;
	pthread_mutex_t lock;
	pthread_cond_t wanted;
	int ended; /* eventfd: written when an opening has ended */
	/* Under the lock: */
	bool open, done, leave;
	/* Belongs to the thread from open to done, else to the caller: */
	struct camera *camera;
	const struct camera_ops *ops;
	const struct camera_settings *settings;
	void *options;
	int err;
	struct fault fault;
};

/* False: end the thread. */
static bool opener_wait(struct opener *opener)
{
	bool open;

	pthread_mutex_lock(&opener->lock);
	while (!opener->open && !opener->leave)
		pthread_cond_wait(&opener->wanted, &opener->lock);
	open = opener->open;
	opener->open = false;
	pthread_mutex_unlock(&opener->lock);
	return open;
}

static void *open_cameras(void *context)
{
	struct opener *opener = context;

	while (opener_wait(opener)) {
		*opener->fault.text = '\0';
		opener->err = camera_open(opener->camera, opener->ops, opener->settings,
					  opener->options, &opener->fault);
		pthread_mutex_lock(&opener->lock);
		opener->done = true;
		(void)eventfd_write(opener->ended, 1); /* cannot block: its count was 0 */
		pthread_mutex_unlock(&opener->lock);
	}
	return NULL;
}

int opener_create(struct opener **out)
{
	struct opener *opener = calloc(1, sizeof(*opener));
	int err;

	if (!opener)
		return -ENOMEM;
	pthread_mutex_init(&opener->lock, NULL); /* neither fails in glibc */
	pthread_cond_init(&opener->wanted, NULL);
	opener->ended = eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK);
	err = opener->ended < 0 ? -errno : thread_start(&opener->thread, open_cameras, opener);
	if (err) {
		if (opener->ended >= 0)
			close(opener->ended);
		free(opener);
		return err;
	}
	*out = opener;
	return 0;
}

void opener_start(struct opener *opener, struct camera *camera, const struct camera_ops *ops,
		  const struct camera_settings *settings, void *options)
{
	opener->camera = camera;
	opener->ops = ops;
	opener->settings = settings;
	opener->options = options;
	pthread_mutex_lock(&opener->lock);
	opener->open = true;
	pthread_cond_signal(&opener->wanted);
	pthread_mutex_unlock(&opener->lock);
}

int opener_descriptor(const struct opener *opener)
{
	return opener->ended;
}

bool opener_take(struct opener *opener, int *err, struct fault *fault)
{
	eventfd_t count;
	bool done;

	pthread_mutex_lock(&opener->lock);
	done = opener->done;
	opener->done = false;
	if (done)
		(void)eventfd_read(opener->ended, &count);
	pthread_mutex_unlock(&opener->lock);
	if (!done)
		return false;
	*err = opener->err;
	*fault = opener->fault;
	return true;
}

void opener_destroy(struct opener *opener)
{
	if (!opener)
		return;
	pthread_mutex_lock(&opener->lock);
	opener->leave = true;
	pthread_cond_signal(&opener->wanted);
	pthread_mutex_unlock(&opener->lock);
	pthread_join(opener->thread, NULL);
	close(opener->ended);
	pthread_cond_destroy(&opener->wanted);
	pthread_mutex_destroy(&opener->lock);
	free(opener);
}
