/* SPDX-License-Identifier: MIT */
#include "drivers/kms/kms.h"

#include <dirent.h>
#include <fcntl.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static bool has_open(const char *pid, dev_t device)
{
	char path[300];
	DIR *folder;
	bool found = false;

	snprintf(path, sizeof(path), "/proc/%.255s/fd", pid);
	folder = opendir(path);
	for (struct dirent *entry; folder && !found && (entry = readdir(folder));) {
		struct stat of;

		found = !fstatat(dirfd(folder), entry->d_name, &of, 0) && S_ISCHR(of.st_mode) &&
			of.st_rdev == device;
	}
	if (folder)
		closedir(folder);
	return found;
}

static void process_name(const char *pid, char *name, size_t room)
{
	char path[300];
	FILE *file;

	snprintf(path, sizeof(path), "/proc/%.255s/comm", pid);
	file = fopen(path, "re");
	if (!file || !fgets(name, (int)room, file))
		snprintf(name, room, "a program");
	name[strcspn(name, "\n")] = 0;
	if (file)
		fclose(file);
}

int kms_holders(const char *device, char *text, size_t room)
{
	const long self = getpid();
	struct stat node;
	DIR *processes;
	size_t used = 0;
	int count = 0;

	text[0] = 0;
	if (stat(device, &node))
		return 0;
	processes = opendir("/proc");
	for (struct dirent *entry; processes && (entry = readdir(processes));) {
		const long pid = strtol(entry->d_name, NULL, 10);
		char name[32];

		if (pid <= 0 || pid == self || !has_open(entry->d_name, node.st_rdev))
			continue;
		process_name(entry->d_name, name, sizeof(name));
		if (used + sizeof(name) + 32 < room)
			used += (size_t)snprintf(text + used, room - used, "%s%s (pid %ld)",
						 count ? ", " : "", name, pid);
		count++;
	}
	if (processes)
		closedir(processes);
	return count;
}
