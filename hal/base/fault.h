/* SPDX-License-Identifier: MIT */
/*
 * A fault says what went wrong, in one sentence for a person.
 *
 * A function that can fail for a reason outside the program (a file, a device, a value) takes a
 * struct fault and returns 0 or a negative errno. On failure the text says what is wrong and what
 * was expected, and begins with the file (and line) where there is one:
 *     scene.ini:12: [mesh cow] file: cannot open "cow.obj": No such file or directory
 * The code that prints it adds the program's name in front.
 */
#ifndef INLAY_HAL_BASE_FAULT_H
#define INLAY_HAL_BASE_FAULT_H

#define FAULT_TEXT_MAX 1024

struct fault {
	char text[FAULT_TEXT_MAX]; /* empty while nothing has gone wrong */
};

/* Writes the sentence and returns err, for `return fault_say(f, -EINVAL, ...)`. f may be NULL (the
 * caller only wants the code). Text beyond FAULT_TEXT_MAX is cut. */
int fault_say(struct fault *f, int err, const char *format, ...)
	__attribute__((format(printf, 3, 4)));

#endif
