/* SPDX-License-Identifier: MIT */
#include "bake/exchange/import_pictures.h"

#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

#include "bake/exchange/pictures.h"
#include "hal/image/image.h"

/* Opens a file without a name. Where the file system does not support that, its name is removed. */
static int open_unnamed(const char *folder)
{
	char name[PATH_MAX];
	int fd = open(folder, O_TMPFILE | O_RDWR | O_CLOEXEC, 0600);

	if (fd >= 0)
		return fd;
	if (snprintf(name, sizeof(name), "%s/.pictures-XXXXXX", folder) >= (int)sizeof(name))
		return -ENAMETOOLONG;
	fd = mkostemp(name, O_CLOEXEC);
	if (fd < 0)
		return -errno;
	unlink(name);
	return fd;
}

static int stack_make_room(struct picture_stack *stack, const char *folder, struct fault *fault)
{
	void *map = MAP_FAILED;
	int err, fd = open_unnamed(folder);

	stack->bytes = (size_t)stack->count * (size_t)stack->height * (size_t)stack->width * 3 *
		       sizeof(float);
	err = fd < 0 ? fd : -posix_fallocate(fd, 0, (off_t)stack->bytes);
	if (!err)
		map = mmap(NULL, stack->bytes, PROT_READ | PROT_WRITE, MAP_SHARED, fd, 0);
	if (!err && map == MAP_FAILED)
		err = -errno;
	if (fd >= 0)
		close(fd);
	if (err)
		return fault_say(fault, err, "%s: no room for %.1f GB of pictures: %s", folder,
				 (double)stack->bytes / 1e9, strerror(-err));
	stack->value = map;
	return 0;
}

static void stack_convert(const struct image *picture,
			  const struct picture_stack_settings *settings, float *to)
{
	const size_t values = 3 * (size_t)picture->width * (size_t)picture->height;
	float decode[256];

	for (int k = 0; k < 256; k++)
		decode[k] =
			(float)(settings->scale * transfer_decode(settings->transfer, k / 255.0));
	for (size_t k = 0; k < values; k++)
		to[k] = picture->u8 ? decode[picture->u8[k]]
				    : (float)settings->scale * picture->f32[k];
}

/* Reads the picture of a light into its place. */
static int stack_read_picture(struct picture_stack *stack, const char *name, int light,
			      const struct picture_stack_settings *settings, struct fault *fault)
{
	const int place = settings->place ? settings->place[light] : light;
	struct image picture;
	int err = image_read(name, &picture, fault);

	if (err)
		return err;
	if (!stack->value) {
		stack->width = picture.width;
		stack->height = picture.height;
		err = stack_make_room(stack, settings->folder, fault);
	} else if (picture.width != stack->width || picture.height != stack->height) {
		err = fault_say(fault, -EINVAL,
				"%s: %d x %d pixels, expected %d x %d as in the first picture",
				name, picture.width, picture.height, stack->width, stack->height);
	}
	if (!err)
		stack_convert(&picture, settings,
			      stack->value + (size_t)place * 3 * (size_t)stack->width *
						     (size_t)stack->height);
	image_free(&picture);
	return err;
}

static int there_is(const char *pattern, int number)
{
	char name[PATH_MAX];

	return picture_name(pattern, number, name, sizeof(name)) == 0 && access(name, F_OK) == 0;
}

int picture_stack_read(struct picture_stack *stack, const char *pattern, int count,
		       const struct picture_stack_settings *settings, struct progress *progress,
		       struct fault *fault)
{
	const int first = !there_is(pattern, 0) && there_is(pattern, 1);
	char name[PATH_MAX];
	int err = 0;

	*stack = (struct picture_stack){.count = count};
	if (there_is(pattern, first + count)) {
		picture_name(pattern, first + count, name, sizeof(name));
		return fault_say(fault, -EINVAL,
				 "%s: one picture too many, expected %d for %d lights", name, count,
				 count);
	}
	for (int k = 0; !err && k < count; k++) {
		err = picture_name(pattern, first + k, name, sizeof(name));
		if (err)
			fault_say(fault, err, "%s: the name is too long", pattern);
		else
			err = stack_read_picture(stack, name, k, settings, fault);
		progress_show(progress, k + 1, 0);
	}
	if (err)
		picture_stack_free(stack);
	return err;
}

void picture_stack_free(struct picture_stack *stack)
{
	if (stack->value)
		munmap(stack->value, stack->bytes);
	*stack = (struct picture_stack){.value = NULL};
}
