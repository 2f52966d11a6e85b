/* SPDX-License-Identifier: MIT */
#include "bake/mesh/mesh_mtl.h"

#include <errno.h>
#include <limits.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "bake/mesh/plain_file.h"

#define LIBRARY_MAX ((uint64_t)64 << 20) /* bytes */
#define BLANKS " \t\r\n"

/* Names of the materials that an OBJ's libraries define, one after the other, each with its 0. */
struct mtl_names {
	char *text;
	size_t bytes;
	bool any_library;
	/* The first library that could not be opened; an error only if a material is not found
	 * elsewhere. NULL: none. */
	char *missing;
	int missing_line, missing_error;
};

/* Returns the text after a word at the beginning of a line, without the blanks around it; NULL: the
 * line begins with another word. */
static char *word_after(char *line, const char *word)
{
	const size_t length = strlen(word);
	char *end;

	line += strspn(line, BLANKS);
	if (strncmp(line, word, length) != 0 || !line[length] || !strchr(BLANKS, line[length]))
		return NULL;
	line += length + strspn(line + length, BLANKS);
	end = line + strlen(line);
	while (end > line && strchr(BLANKS, end[-1]))
		*--end = '\0';
	return line;
}

static bool is_named(const struct mtl_names *names, const char *name)
{
	for (size_t at = 0; at < names->bytes; at += strlen(names->text + at) + 1)
		if (strcmp(names->text + at, name) == 0)
			return true;
	return false;
}

static int add_name(struct mtl_names *names, const char *name)
{
	const size_t bytes = strlen(name) + 1;
	char *grown = realloc(names->text, names->bytes + bytes);

	if (!grown)
		return -ENOMEM;
	names->text = grown;
	memcpy(grown + names->bytes, name, bytes);
	names->bytes += bytes;
	return 0;
}

/* Tells whether a file exists but cannot be read to its end: a pipe, or too long. */
static bool is_there(int err)
{
	return err == -EINVAL || err == -EFBIG;
}

/* Opens the library of a line or else, like assimp, the one named as the mesh. -ENOENT ...: neither
 * exists, which is reported only when one of its materials is used. */
static int open_library(FILE **file, const char *path, const char *library, struct fault *fault)
{
	const char *slash = strrchr(path, '/'), *dot = strrchr(path, '.');
	char name[PATH_MAX];
	int err = -ENAMETOOLONG, other;

	*file = NULL;
	if (snprintf(name, sizeof(name), "%.*s%s", slash ? (int)(slash - path) + 1 : 0, path,
		     library) < (int)sizeof(name))
		err = plain_file_open(file, name, LIBRARY_MAX, fault);
	if (!err || is_there(err))
		return err;
	if (snprintf(name, sizeof(name), "%.*s.mtl", (int)(dot - path), path) >= (int)sizeof(name))
		return err;
	other = plain_file_open(file, name, LIBRARY_MAX, fault);
	return !other || is_there(other) ? other : err;
}

static int read_library(struct mtl_names *names, FILE *file)
{
	char *line = NULL;
	size_t room = 0;
	int err = 0;

	while (!err && getline(&line, &room, file) >= 0) {
		const char *name = word_after(line, "newmtl");

		err = name ? add_name(names, name) : 0;
	}
	free(line);
	return err;
}

static int miss_library(struct mtl_names *names, const char *library, int number, int err)
{
	if (names->missing)
		return 0;
	names->missing = strdup(library);
	names->missing_line = number;
	names->missing_error = err;
	return names->missing ? 0 : -ENOMEM;
}

static int check_used(const struct mtl_names *names, const char *used, const char *path, int number,
		      struct fault *fault)
{
	if (!names->any_library || is_named(names, used))
		return 0;
	if (names->missing)
		return fault_say(fault, -ENOENT,
				 "%s:%d: mtllib %s: cannot be opened: %s, expected it beside the "
				 "mesh, or a material in the scene file",
				 path, names->missing_line, names->missing,
				 strerror(-names->missing_error));
	return fault_say(fault, -EINVAL,
			 "%s:%d: usemtl %s: its libraries have no such material, expected newmtl "
			 "%s in one, or a material in the scene file",
			 path, number, used, used);
}

static int check_line(struct mtl_names *names, char *line, const char *path, int number,
		      struct fault *fault)
{
	const char *library = word_after(line, "mtllib"),
		   *used = library ? NULL : word_after(line, "usemtl");
	FILE *file;
	int err;

	if (used)
		return check_used(names, used, path, number, fault);
	if (!library)
		return 0;
	names->any_library = true;
	err = open_library(&file, path, library, fault);
	if (is_there(err))
		return err;
	if (file) {
		err = read_library(names, file);
		fclose(file);
	} else {
		err = miss_library(names, library, number, err);
	}
	return err ? fault_say(fault, err, "%s: out of memory", path) : 0;
}

int mesh_mtl_check(const char *path, struct fault *fault)
{
	const char *dot = strrchr(path, '.');
	struct mtl_names names = {.text = NULL};
	FILE *file = NULL;
	char *line = NULL;
	size_t room = 0;
	int err = 0, number = 0;

	if (dot && strcasecmp(dot, ".obj") == 0)
		err = plain_file_open(&file, path, PLAIN_FILE_MAX, fault);
	while (file && !err && getline(&line, &room, file) >= 0)
		err = check_line(&names, line, path, ++number, fault);
	if (file)
		fclose(file);
	free(line);
	free(names.missing);
	free(names.text);
	return err;
}
