/* SPDX-License-Identifier: MIT */
#include "tests/people/recording.h"

#include <stdlib.h>
#include <string.h>

#include "hal/basis/basis_format.h"
#include "tests/people/rooms.h"

typedef size_t transfer_function(void *to, size_t size, size_t count, FILE *file);

static size_t put(void *from, size_t size, size_t count, FILE *file)
{
	return fwrite(from, size, count, file);
}

bool recording_make_room(struct recording *recording)
{
	const struct recording_head *head = &recording->head;
	const size_t pixels = (size_t)head->width * (size_t)head->height;

	recording->touched = calloc((size_t)head->tiles, 1);
	recording->looked = calloc(pixels, sizeof(int));
	recording->light = calloc((size_t)head->lights, sizeof(*recording->light));
	recording->bgr = calloc(pixels, 3);
	recording->alpha = calloc(pixels, 1);
	recording->who = calloc(pixels, 1);
	recording->others = calloc(pixels, 1);
	return recording->touched && recording->looked && recording->light && recording->bgr &&
	       recording->alpha && recording->who && recording->others;
}

static void list_looked(struct recording *recording)
{
	struct recording_head *head = &recording->head;
	const int across = (head->width + BASIS_TILE - 1) / BASIS_TILE;

	head->looked = 0;
	for (int k = 0; k < head->width * head->height; k++)
		if (recording->touched[k / head->width / BASIS_TILE * across +
				       k % head->width / BASIS_TILE])
			recording->looked[head->looked++] = k;
}

static bool frame_transfer(struct recording *r, int frame, transfer_function *transfer)
{
	const size_t pixels = (size_t)r->head.width * (size_t)r->head.height;
	const size_t looked = (size_t)r->head.looked, lights = (size_t)r->head.lights;

	if (transfer(&r->moment, sizeof(r->moment), 1, r->file) != 1 ||
	    transfer(r->light, sizeof(*r->light), lights, r->file) != lights ||
	    transfer(r->bgr, 3, pixels, r->file) != pixels)
		return false;
	return frame < LEARNING || (transfer(r->alpha, 1, looked, r->file) == looked &&
				    transfer(r->who, 1, looked, r->file) == looked &&
				    transfer(r->others, 1, looked, r->file) == looked);
}

bool recording_open(struct recording *recording, const char *path)
{
	memset(recording, 0, sizeof(*recording));
	recording->file = fopen(path, "rb");
	if (!recording->file ||
	    fread(&recording->head, sizeof(recording->head), 1, recording->file) != 1 ||
	    recording->head.magic != RECORDING_MAGIC || !recording_make_room(recording) ||
	    fread(recording->touched, (size_t)recording->head.tiles, 1, recording->file) != 1)
		return false;
	list_looked(recording);
	return true;
}

bool recording_read(struct recording *recording, int frame)
{
	return frame_transfer(recording, frame, fread);
}

bool recording_write_head(struct recording *recording, const char *path)
{
	list_looked(recording);
	recording->head.magic = RECORDING_MAGIC;
	recording->file = fopen(path, "wb");
	return recording->file &&
	       fwrite(&recording->head, sizeof(recording->head), 1, recording->file) == 1 &&
	       fwrite(recording->touched, (size_t)recording->head.tiles, 1, recording->file) == 1;
}

bool recording_write(struct recording *recording, int frame)
{
	return frame_transfer(recording, frame, put);
}

bool recording_close(struct recording *recording)
{
	const bool whole = !recording->file || fclose(recording->file) == 0;

	free(recording->touched);
	free(recording->looked);
	free(recording->light);
	free(recording->bgr);
	free(recording->alpha);
	free(recording->who);
	free(recording->others);
	memset(recording, 0, sizeof(*recording));
	return whole;
}
