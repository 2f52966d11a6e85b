/* SPDX-License-Identifier: MIT */
/* A folder of the test's own, for a group's setup and teardown. It must be empty again at the end:
 * a test removes what it wrote. */
#ifndef INLAY_TESTS_SUPPORT_OWN_FOLDER_H
#define INLAY_TESTS_SUPPORT_OWN_FOLDER_H

#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

static char own_folder[] = "/tmp/inlay-test-XXXXXX";

static inline int own_folder_make(void **state)
{
	(void)state;
	return mkdtemp(own_folder) ? 0 : -1;
}

static inline int own_folder_remove(void **state)
{
	(void)state;
	return rmdir(own_folder);
}

/* Until the next call. */
static inline const char *own_path(const char *name)
{
	static char path[PATH_MAX];

	snprintf(path, sizeof(path), "%s/%s", own_folder, name);
	return path;
}

#endif
