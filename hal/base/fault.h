/* SPDX-License-Identifier: MIT */
/*
 * What went wrong, in one sentence for a person.
 *
 * A function that can fail for a reason outside the program (a file, a device, a value) takes a
 * struct fault and returns 0 or a negative errno. On failure the text says what is wrong and what
 * was expected, and begins with the file (and line) where there is one:
 *     scene.ini:12: [mesh cow] file: cannot open "cow.obj": No such file or directory
 * The program's name is put before it by whoever prints it.
 */
#ifndef INLAY_HAL_BASE_FAULT_H
#define INLAY_HAL_BASE_FAULT_H

#define FAULT_TEXT_MAX 1024

struct fault {
	char text[FAULT_TEXT_MAX]; /* empty while nothing has gone wrong */
};

/* Writes the sentence and returns err, so that `return fault_say(f, -EINVAL, ...)` reads as one
 * thing. f may be NULL (the caller only wants the code). Text beyond FAULT_TEXT_MAX is cut. */
int fault_say(struct fault *f, int err, const char *format, ...)
	__attribute__((format(printf, 3, 4)));

#endif
