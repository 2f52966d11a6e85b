/* SPDX-License-Identifier: MIT */
/*
 * INI files by table: each key is declared once, and the table drives parsing, ranges, defaults,
 * help, the sample file and --print-config. Tokenising is inih's.
 *
 *     [section]            one struct
 *     [section name]       one struct for each name ("named" tables; letters, digits, - and _)
 *     key = value          ; a comment follows white space and a semicolon
 *
 * Every fault names file, line, section and key, says what was expected, and offers the nearest
 * valid name for a misspelt one. A key given twice in one section is a fault.
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
	INI_BOOL,  /* bool: yes/no, true/false, on/off, 1/0 */
	INI_INT,   /* int */
	INI_REAL,  /* double; finite */
	INI_LEVEL, /* struct ini_level: a number, or a percentage 0%..100% */
	INI_REALS, /* double[count]: exactly count numbers separated by blanks or commas */
	INI_LIST,  /* double[count]: at most count of them, or none; what is not said is 0, which no
		      number may be */
	INI_TEXT,  /* char[INI_TEXT_MAX] */
	INI_PATH,  /* char[INI_PATH_MAX]; a relative one is taken from the file's own folder (from
		      the current one on the command line); empty stays empty */
	INI_CHOICE, /* int: index into choices */
};

/* A level in either of two units. */
struct ini_level {
	double value;
	bool percent;
};

struct ini_key {
	const char *name;
	enum ini_type type;
	size_t offset;		    /* of the field in the section's struct */
	unsigned count;		    /* INI_REALS, INI_LIST */
	double min, max;	    /* INT, REAL, REALS, LEVEL's number, inclusive; both 0: any */
	const char *const *choices; /* INI_CHOICE, NULL at the end */
	const char *fallback;	    /* the default as it would be written; NULL: must be given */
	const char *unit;	    /* for people: "px", "deg"; NULL for none */
	const char *help;	    /* one sentence */
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
	const struct ini_key *keys;
	const char *help; /* of the section; may be NULL */
	/*
	 * Where the struct that the keys fill is, already holding defaults (ini_defaults()).
	 * instance is the name in a named section, else NULL. Called once or more for each section
	 * met, including those that hold no key. NULL: no room for one more instance (a fault says
	 * so).
	 */
	void *(*place)(void *root, const char *instance);
	size_t part;	    /* bytes from what place() returns to the struct that the keys fill */
	const char *sample; /* names of a named section's instances in the sample file, separated by
			       blanks; the first is written in full; NULL: "NAME" */
};

#define INI_TABLES_END                                                                             \
	{                                                                                          \
		.section = NULL                                                                    \
	}

/* Collects everything that is wrong with a file (the first hundred faults of one that is no INI
 * file at all); the first is what most callers print. */
struct ini_report {
	int count;				      /* faults found */
	void (*say)(void *context, const char *text); /* called for each; may be NULL */
	void *context;
	struct fault first;
};

/* Writes every fallback into the struct (mandatory keys are left alone). */
void ini_defaults(const struct ini_key *keys, void *values);

/*
 * Reads a file. Returns 0, or the first negative errno: -ENOENT and its like when the file cannot
 * be read, -EINVAL for what it says; all faults go to the report. Mandatory keys that are missing
 * from a section that the file has are faults at that section's line.
 */
int ini_read(const char *path, const struct ini_table *tables, void *root,
	     struct ini_report *report);

/* The same for text in memory; name stands for the file in messages, folder for its folder. */
int ini_read_memory(const char *text, size_t bytes, const char *name, const char *folder,
		    const struct ini_table *tables, void *root, struct ini_report *report);

/* One assignment from a command line: "section.key=value" or "section.name.key=value". */
int ini_set(const char *assignment, const struct ini_table *tables, void *root,
	    struct ini_report *report);

/* A key's value as the file would write it. Returns text's length, as snprintf. */
int ini_value_text(const struct ini_key *key, const void *values, char *text, size_t room);

/* yes, no and their like, as INI_BOOL takes them; false: it is neither. */
bool ini_truth_read(const char *text, bool *value);

/* A level of at least 0: a number of at most max, or "1%". -EINVAL, and level is left alone. */
int ini_level_read(const char *text, double max, struct ini_level *level);

#define INI_LEVEL_TEXT_MAX 40

/* "40", "1%". */
void ini_level_text(const struct ini_level *level, char text[INI_LEVEL_TEXT_MAX]);

/* The sample file: every key at its default with its help, range and unit as comments. */
void ini_write_sample(FILE *stream, const struct ini_table *tables);

/* The candidate nearest to name by edit distance, or NULL when none is near. */
const char *ini_nearest(const char *name, const char *const *candidates, size_t count);

#endif
