/* SPDX-License-Identifier: MIT */
/*
 * INI files by table: each key is declared once, and the table drives parsing, ranges, defaults,
 * help, the sample file and --print-config. The library inih splits lines into keys and values.
 *
 *     [section]            one struct
 *     [section name]       one struct for each name ("named" tables; letters, digits, - and _)
 *     key = value          ; a comment follows white space and a semicolon
 *
 * Every fault names file, line, section and key, says what was expected, and suggests the nearest
 * valid name for a misspelt one. A key given twice in one section is a fault.
 *
 * This header is the whole interface of hal/ini: ini.c reads files and assignments, ini_value.c
 * converts values, ini_names.c finds names, ini_sample.c writes the sample file.
 */
#ifndef INLAY_HAL_INI_H
#define INLAY_HAL_INI_H

#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>

#include "hal/base/fault.h"

#define INI_TEXT_MAX 256  /* char[INI_TEXT_MAX] holds an INI_TEXT */
#define INI_PATH_MAX 1024 /* char[INI_PATH_MAX] holds an INI_PATH */

enum ini_type {
	INI_BOOL,   /* bool: yes/no, true/false, on/off, 1/0 */
	INI_INT,    /* int */
	INI_REAL,   /* double; finite */
	INI_LEVEL,  /* struct ini_level: a number, or a percentage 0%..100% */
	INI_REALS,  /* double[count]: exactly count numbers separated by blanks or commas */
	INI_LIST,   /* double[count]: 0 to count numbers; the rest of the field becomes 0, so that
		      no number in the list may be 0 */
	INI_TEXT,   /* char[INI_TEXT_MAX] */
	INI_PATH,   /* char[INI_PATH_MAX]; a relative path starts at the folder of the file (on the
		      command line: at the current folder); empty stays empty */
	INI_CHOICE, /* int: index into choices */
};

/* A number or a percentage. */
struct ini_level {
	double value;
	bool percent;
};

struct ini_key {
	const char *name;
	enum ini_type type;
	size_t offset;	 /* of the field in the section's struct */
	unsigned count;	 /* INI_REALS, INI_LIST */
	double min, max; /* inclusive range of numbers, not of percentages; both 0: any */
	const char *const *choices; /* INI_CHOICE, NULL at the end */
	/* INI_TEXT whose text has a form of its own: 0, or -EINVAL with what is wrong and what was
	 * expected, as in "is x, expected y". NULL: any text will do. */
	int (*check)(const char *text, struct fault *why);
	const char *fallback; /* the default as a file would say it; NULL: mandatory key */
	const char *unit;     /* shown in help: "px", "deg"; NULL: none */
	const char *help;     /* one sentence */
	bool rare;	      /* files are written without it where it has its fallback */
};

#define INI_KEYS_END                                                                               \
	{                                                                                          \
		.name = NULL                                                                       \
	}

/* Several tables may share a section (a camera's own keys and those of each driver). */
struct ini_table {
	const char *section;
	bool named;
	const char *prefix; /* written before each key in the file ("sim."); NULL for none */
	const struct ini_key *keys; /* NULL: the section is for another reader, and is skipped */
	const char *help;	    /* of the section; may be NULL */
	/*
	 * Returns the struct that the keys fill, which already holds the defaults
	 * (ini_defaults()). instance is the name in a named section, else NULL. Called at least
	 * once for each section of the file, even if it holds no key. NULL: no room for one more
	 * instance, which the reader reports.
	 */
	void *(*place)(void *root, const char *instance);
	size_t part;	    /* bytes from place()'s result to the struct that the keys fill */
	const char *sample; /* names of a named section's instances in the sample file, separated by
			       blanks; the first is written in full; NULL: "NAME"; "": as a
			       comment, of a section whose keys must all be given */
};

#define INI_TABLES_END                                                                             \
	{                                                                                          \
		.section = NULL                                                                    \
	}

/* Collects the faults of a file, at most a hundred. Most callers print only the first. */
struct ini_report {
	int count;				      /* faults found */
	void (*say)(void *context, const char *text); /* called for each; may be NULL */
	void *context;
	struct fault first;
};

/* Writes every fallback into the struct; leaves mandatory keys unchanged. */
void ini_defaults(const struct ini_key *keys, void *values);

/*
 * Reads a file. All faults go to the report. Returns 0 or the first negative errno: -ENOENT... if
 * the file cannot be read, -EINVAL for its content. A mandatory key missing from a section of the
 * file is a fault at the section's line.
 */
int ini_read(const char *path, const struct ini_table *tables, void *root,
	     struct ini_report *report);

/* Reads text in memory; messages call it by name, and relative paths start at folder. */
int ini_read_memory(const char *text, size_t bytes, const char *name, const char *folder,
		    const struct ini_table *tables, void *root, struct ini_report *report);

/* Carries out one assignment of a command line: "section.key=value" or "section.name.key=value". 0
 * or negative errno. */
int ini_set(const char *assignment, const struct ini_table *tables, void *root,
	    struct ini_report *report);

/* Writes a key's value as a file would say it. Returns the length as snprintf() does. */
int ini_value_text(const struct ini_key *key, const void *values, char *text, size_t room);

/* Whether a file is written without this key: it is rare, and has its fallback. */
bool ini_left_out(const struct ini_key *key, const void *values);

/* Reads a truth value as INI_BOOL does. False: the text is none. */
bool ini_truth_read(const char *text, bool *value);

/* Reads a level: a number 0..max, or a percentage such as "1%". 0; -EINVAL: *level is unchanged. */
int ini_level_read(const char *text, double max, struct ini_level *level);

#define INI_LEVEL_TEXT_MAX 40

/* Writes a level as text: "40", "1%". */
void ini_level_text(const struct ini_level *level, char text[INI_LEVEL_TEXT_MAX]);

/* Adds a fault to the report; NULL: to none. */
void ini_report_add(struct ini_report *report, const struct fault *fault);

/* Writes the sample file: every key at its default, with help, range and unit as comments. */
void ini_write_sample(FILE *stream, const struct ini_table *tables);

/* The candidate nearest to name by edit distance; NULL: none is near. */
const char *ini_nearest(const char *name, const char *const *candidates, size_t count);

#endif
