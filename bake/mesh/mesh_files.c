/* SPDX-License-Identifier: MIT */
#include "bake/mesh/mesh_files.h"

#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sys/stat.h>

#include "bake/mesh/plain_file.h"

/* A whole file in memory, and assimp's place in it. */
struct held_file {
	struct aiFile file;
	char *bytes;
	size_t size, at;
};

static struct held_file *held_of(struct aiFile *file)
{
	return (struct held_file *)(void *)file->UserData;
}

/* ---- the text of an OBJ ---- */

static bool obj_is_blank(char c)
{
	return c == ' ' || c == '\t';
}

static bool obj_ends_line(char c)
{
	return c == '\n' || c == '\r';
}

/*
 * Corrects the text of an OBJ: "v .5 .5 1" becomes "v 0.5 0.5 1", the same for vt and vn, and
 * blanks at the beginning of lines are dropped. to: room for the result, or NULL. Returns its
 * bytes.
 */
static size_t obj_plain_text(const char *from, size_t size, char *to)
{
	bool begins = true, vertex = false; /* at the beginning of a line; the line begins with v */
	size_t out = 0;
	char last = '\n'; /* the last character that does not end a line */

	for (size_t k = 0; k < size; k++) {
		const char c = from[k];

		if (begins && obj_is_blank(c))
			continue;
		if (obj_ends_line(c)) {
			begins = begins || last != '\\'; /* after \ the next line continues it */
		} else {
			vertex = begins ? c == 'v' : vertex;
			begins = false;
			if (vertex && c == '.' && obj_is_blank(last)) {
				if (to)
					to[out] = '0';
				out++;
			}
			last = c;
		}
		if (to)
			to[out] = c;
		out++;
	}
	return out;
}

static bool is_obj(const char *path)
{
	const char *dot = strrchr(path, '.');

	return dot && strcasecmp(dot, ".obj") == 0;
}

static bool obj_make_plain(struct held_file *h)
{
	const size_t size = obj_plain_text(h->bytes, h->size, NULL);
	char *bytes = malloc(size + 1);

	if (!bytes)
		return false;
	obj_plain_text(h->bytes, h->size, bytes);
	free(h->bytes);
	h->bytes = bytes;
	h->size = size;
	return true;
}

/* ---- assimp's callbacks ---- */

static size_t held_read(struct aiFile *file, char *to, size_t size, size_t count)
{
	struct held_file *h = held_of(file);
	const size_t left = size ? (h->size - h->at) / size : 0;

	count = count < left ? count : left;
	if (count)
		memcpy(to, h->bytes + h->at, size * count);
	h->at += size * count;
	return count;
}

static size_t held_write(struct aiFile *file, const char *from, size_t size, size_t count)
{
	(void)file, (void)from, (void)size, (void)count;
	return 0;
}

static size_t held_tell(struct aiFile *file)
{
	return held_of(file)->at;
}

static size_t held_size(struct aiFile *file)
{
	return held_of(file)->size;
}

/* Assimp passes a negative offset as a huge unsigned one; the sum wraps around to the right
 * place. */
static aiReturn held_seek(struct aiFile *file, size_t offset, enum aiOrigin origin)
{
	struct held_file *h = held_of(file);
	const size_t base = origin == aiOrigin_SET ? 0 : origin == aiOrigin_CUR ? h->at : h->size;
	const size_t at = base + offset;

	if (at > h->size)
		return aiReturn_FAILURE;
	h->at = at;
	return aiReturn_SUCCESS;
}

static void held_flush(struct aiFile *file)
{
	(void)file;
}

static bool read_whole(struct held_file *h, const char *path)
{
	struct stat is;
	FILE *stream;
	bool fine = false;

	if (plain_file_open(&stream, path, PLAIN_FILE_MAX, NULL) < 0)
		return false;
	if (fstat(fileno(stream), &is) == 0) {
		h->size = (size_t)is.st_size;
		h->bytes = malloc(h->size + 1);
		fine = h->bytes && fread(h->bytes, 1, h->size, stream) == h->size;
	}
	fclose(stream);
	return fine;
}

static void held_close(struct aiFileIO *files, struct aiFile *file)
{
	struct held_file *h = held_of(file);

	(void)files;
	free(h->bytes);
	free(h);
}

static struct aiFile *held_open(struct aiFileIO *files, const char *path, const char *mode)
{
	struct held_file *h = calloc(1, sizeof(*h));

	if (!h)
		return NULL;
	h->file = (struct aiFile){.ReadProc = held_read,
				  .WriteProc = held_write,
				  .TellProc = held_tell,
				  .FileSizeProc = held_size,
				  .SeekProc = held_seek,
				  .FlushProc = held_flush,
				  .UserData = (char *)h};
	if (mode[0] == 'r' && read_whole(h, path) && (!is_obj(path) || obj_make_plain(h)))
		return &h->file;
	held_close(files, &h->file);
	return NULL;
}

struct aiFileIO mesh_files(void)
{
	return (struct aiFileIO){.OpenProc = held_open, .CloseProc = held_close};
}
