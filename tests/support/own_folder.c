/* SPDX-License-Identifier: MIT */
#include "tests/support/own_folder.h"

#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

static char own_folder_name[] = "/tmp/inlay-test-XXXXXX";

int own_folder_make(void **state)
{
	(void)state;
	return mkdtemp(own_folder_name) ? 0 : -1;
}

int own_folder_remove(void **state)
{
	(void)state;
	return rmdir(own_folder_name);
}

const char *own_folder(void)
{
	return own_folder_name;
}

const char *own_folder_path(const char *name)
{
	static char path[PATH_MAX];

	snprintf(path, sizeof(path), "%s/%s", own_folder_name, name);
	return path;
}
