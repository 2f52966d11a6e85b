/* SPDX-License-Identifier: MIT */
#include "hal/device/node_link.h"

#include <dirent.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

bool node_link(const char *folder, const char *node, char *link, size_t room)
{
	char path[PATH_MAX], target[PATH_MAX];
	DIR *links = opendir(folder);

	*link = '\0';
	for (struct dirent *entry; links && (entry = readdir(links));) {
		snprintf(path, sizeof(path), "%s/%s", folder, entry->d_name);
		if (strlen(path) < room && (!*link || strcmp(path, link) < 0) &&
		    realpath(path, target) && strcmp(target, node) == 0)
			strcpy(link, path);
	}
	if (links)
		closedir(links);
	return *link;
}
