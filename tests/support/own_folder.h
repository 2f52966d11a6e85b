/* SPDX-License-Identifier: MIT */
/*
 * A temporary folder for one group of tests: own_folder_make() is the group's setup,
 * own_folder_remove() its teardown. The teardown fails where a test has left a file behind.
 */
#ifndef INLAY_TESTS_SUPPORT_OWN_FOLDER_H
#define INLAY_TESTS_SUPPORT_OWN_FOLDER_H

#ifdef __cplusplus
extern "C" {
#endif

int own_folder_make(void **state);
int own_folder_remove(void **state);

/* The folder's path. */
const char *own_folder(void);

/* Path of a file in the folder. The text is valid until the next call. */
const char *own_folder_path(const char *name);

#ifdef __cplusplus
}
#endif

#endif
