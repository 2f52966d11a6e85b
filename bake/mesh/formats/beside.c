/* SPDX-License-Identifier: MIT */
#include "bake/mesh/formats/soup.h"

#include <dirent.h>
#include <stdio.h>
#include <string.h>
#include <strings.h>
#include <unistd.h>

#include "hal/base/input.h"
#include "hal/base/log.h"

/* Appends part of a name to a path; false: it is too long. */
static bool path_append(char path[PATH_MAX], const char *name, size_t length)
{
	const size_t used = strlen(path);

	if (used + length >= PATH_MAX)
		return false;
	memcpy(path + used, name, length);
	path[used + length] = '\0';
	return true;
}

/* Appends the file of a folder that has this name but for the case of letters; of several the first
 * in the order of characters. */
static bool append_any_case(char path[PATH_MAX], const char *name, size_t length)
{
	char best[NAME_MAX + 1] = "";
	const struct dirent *entry;
	DIR *folder = opendir(path[0] ? path : ".");

	if (!folder)
		return false;
	while ((entry = readdir(folder)))
		if (strlen(entry->d_name) == length &&
		    strncasecmp(entry->d_name, name, length) == 0 &&
		    (!best[0] || strcmp(entry->d_name, best) < 0))
			snprintf(best, sizeof(best), "%s", entry->d_name);
	closedir(folder);
	return best[0] && path_append(path, best, length);
}

/* Appends a name, folder by folder. */
static bool path_follow(char path[PATH_MAX], const char *name)
{
	while (*name) {
		const size_t length = strcspn(name, "/"), used = strlen(path);

		if (!path_append(path, name, length))
			return false;
		if (length && access(path, F_OK) < 0) {
			path[used] = '\0';
			if (!append_any_case(path, name, length))
				return false;
		}
		name += length;
		if (*name == '/' && !path_append(path, name++, 1))
			return false;
	}
	return true;
}

static bool find_from(const char *folder, size_t length, const char *name, char path[PATH_MAX])
{
	path[0] = '\0';
	return path_append(path, folder, length) && path_follow(path, name);
}

bool beside_find(const char *other, const char *name, char path[PATH_MAX])
{
	const char *slash = strrchr(other, '/'), *last;
	const size_t folder = slash ? (size_t)(slash - other) + 1 : 0;
	char plain[PATH_MAX] = "";

	if (!name[0] || !path_append(plain, name, strlen(name)))
		return false;
	for (char *c = plain; *c; c++)
		if (*c == '\\')
			*c = '/';
	last = strrchr(plain, '/');
	last = last ? last + 1 : plain;
	if (!find_from(other, plain[0] == '/' ? 0 : folder, plain, path) &&
	    (!last[0] || !find_from(other, folder, last, path))) {
		path[0] = '\0';
		if (path_append(path, other, plain[0] == '/' ? 0 : folder) &&
		    path_append(path, plain, strlen(plain)))
			input_note(path);
		return false;
	}
	if (strcmp(path + (plain[0] == '/' ? 0 : folder), plain) != 0)
		log_say_once(LOG_LEVEL_INFO, "%s: %s is taken from %s", other, name, path);
	return true;
}
