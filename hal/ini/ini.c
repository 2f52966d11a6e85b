/* SPDX-License-Identifier: MIT */
#include "hal/ini/ini.h"

#include <ctype.h>
#include <errno.h>
#include <ini.h>
#include <limits.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include "hal/base/input.h"
#include "hal/base/plain_text.h"
#include "hal/ini/ini_names.h"
#include "hal/ini/ini_value.h"

#define FILE_BYTES_MAX (1 << 20)
#define LINE_BYTES_MAX 2048 /* with its line break and the NUL */
#define TITLE_BYTES_MAX 50  /* inih cuts a section's title at this size, with NUL */
#define TITLE_CHARACTERS "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-"
#define FAULTS_MAX 100 /* reported of one file; a file that is no INI file has thousands */
#define BYTE_ORDER_MARK "\xef\xbb\xbf"

/* Limit of a line's length in Debian's inih. Other builds fix the limit when they are compiled; the
 * symbol is weak for them. */
extern int ini_max_line __attribute__((weak));

/* A key that the file has given for a struct, or a table whose section the file has opened. */
struct mention {
	const void *what;   /* struct ini_key or struct ini_table */
	const void *values; /* the struct that it fills */
	int line;
	char title[2 * TITLE_BYTES_MAX];
};

struct mentions {
	struct mention *list;
	size_t count, room;
};

struct ini_reading {
	const char *name, *folder;
	const struct ini_table *tables;
	void *root;
	struct ini_report *report;
	int err; /* the first one */
	/* The text goes to inih line by line, so that the line of each call of the handler is
	 * known. */
	const char *at, *end;
	int line;
	const char *comment; /* in the last line fed, behind the value, without its ";" */
	int comment_bytes;   /* 0: there is none */
	bool header;	     /* the last line fed was a section's: its marker comes next */
	bool marker;	     /* the last line fed was a marker */
	bool silent;	     /* the handler has not yet been called for the last line fed */
	/* The current section: */
	char title[2 * TITLE_BYTES_MAX]; /* "camera fisheye", blanks normalised */
	char section[TITLE_BYTES_MAX];
	char instance[TITLE_BYTES_MAX];
	bool lost; /* the section was refused: its keys are skipped */
	struct mentions keys, opened;
};

/* ---- faults ---- */

void ini_report_add(struct ini_report *report, const struct fault *fault)
{
	if (!report)
		return;
	if (!report->count++)
		report->first = *fault;
	if (report->say)
		report->say(report->context, fault->text);
}

/* Reports "FILE:LINE: [title] key: what". key may be NULL, title empty; line 0: no line. */
__attribute__((format(printf, 5, 6))) static void ini_complain(struct ini_reading *r, int line,
							       const char *title, const char *key,
							       const char *format, ...)
{
	char what[FAULT_TEXT_MAX], place[INI_PATH_MAX + 16], context[256] = "";
	struct fault fault = {.text = ""};
	va_list args;

	if (!r->err)
		r->err = -EINVAL;
	if (r->report && r->report->count >= FAULTS_MAX)
		return;
	va_start(args, format);
	vsnprintf(what, sizeof(what), format, args);
	va_end(args);
	if (line)
		snprintf(place, sizeof(place), "%s:%d", r->name, line);
	else
		snprintf(place, sizeof(place), "%s", r->name);
	if (*title && key)
		snprintf(context, sizeof(context), "[%s] %s: ", title, key);
	else if (*title)
		snprintf(context, sizeof(context), "[%s] ", title);
	fault_say(&fault, -EINVAL, "%s: %s%s", place, context, what);
	ini_report_add(r->report, &fault);
}

/* ---- keys and sections met so far ---- */

static const struct mention *find_mention(const struct mentions *m, const void *what,
					  const void *values)
{
	for (size_t i = 0; i < m->count; i++) {
		if (m->list[i].what == what && m->list[i].values == values)
			return &m->list[i];
	}
	return NULL;
}

static int mentions_add(struct mentions *m, const void *what, const void *values, int line,
			const char *title)
{
	struct mention *entry;

	if (m->count == m->room) {
		size_t room = m->room ? 2 * m->room : 64;
		struct mention *list = realloc(m->list, room * sizeof(*list));

		if (!list)
			return -ENOMEM;
		m->list = list;
		m->room = room;
	}
	entry = &m->list[m->count++];
	*entry = (struct mention){.what = what, .values = values, .line = line};
	snprintf(entry->title, sizeof(entry->title), "%s", title);
	return 0;
}

/* ---- names ---- */

static void ini_complain_unknown(struct ini_reading *r, const char *title, const char *key,
				 const char *near)
{
	ini_complain(r, r->line, title, key, "unknown %s%s%s%s", key ? "key" : "section",
		     *near ? ", did you mean \"" : "", near, *near ? "\"?" : "");
}

/* Splits "camera  fisheye" into section "camera" and instance "fisheye". */
static void split_title(struct ini_reading *r, const char *title)
{
	const char *at = title + strspn(title, " \t");
	size_t length = strcspn(at, " \t");

	snprintf(r->section, sizeof(r->section), "%.*s", (int)length, at);
	at += length;
	at += strspn(at, " \t");
	length = strlen(at);
	while (length && isblank((unsigned char)at[length - 1]))
		length--;
	snprintf(r->instance, sizeof(r->instance), "%.*s", (int)length, at);
	/* Both parts and the blank are from one title, so they fit. */
	stpcpy(stpcpy(stpcpy(r->title, r->section), *r->instance ? " " : ""), r->instance);
}

static void *table_place(const struct ini_reading *r, const struct ini_table *table)
{
	void *place = table->place(r->root, table->named ? r->instance : NULL);

	return place ? (char *)place + table->part : NULL;
}

/* ---- sections and keys ---- */

static int open_tables(struct ini_reading *r)
{
	for (const struct ini_table *t = r->tables; t->section; t++) {
		const void *values;
		int err;

		if (strcmp(t->section, r->section) != 0)
			continue;
		values = table_place(r, t);
		if (!values) {
			ini_complain(r, r->line, r->title, NULL,
				     "is one section [%s NAME] more than there is room for",
				     r->section);
			return -ENOSPC;
		}
		if (find_mention(&r->opened, t, values))
			continue;
		err = mentions_add(&r->opened, t, values, r->line, r->title);
		if (err) {
			r->err = err;
			return err;
		}
	}
	return 0;
}

static void begin_section(struct ini_reading *r, const char *title)
{
	const struct ini_table *table;
	char near[INI_NAME_MAX];

	split_title(r, title);
	r->lost = true;
	table = ini_table_of(r->tables, r->section);
	if (!table) {
		ini_nearest_section(r->tables, r->section, near);
		ini_complain_unknown(r, r->title, NULL, near);
		return;
	}
	if (!table->keys)
		return;
	if (table->named && !*r->instance) {
		ini_complain(r, r->line, r->title, NULL, "has no name, expected [%s NAME]",
			     r->section);
		return;
	}
	if (!table->named && *r->instance) {
		ini_complain(r, r->line, r->title, NULL, "takes no name, expected [%s]",
			     r->section);
		return;
	}
	r->lost = open_tables(r) != 0;
}

/* Whether the comment behind a value of a form of its own goes on with it: "mon-fri 9-18 ; sat
 * 10-14" would lose Saturday without a word. */
static bool value_is_cut(const struct ini_reading *r, const struct ini_key *key, const char *value)
{
	char whole[2 * LINE_BYTES_MAX];

	if (!key->check || !r->comment_bytes)
		return false;
	snprintf(whole, sizeof(whole), "%s, %.*s", value, r->comment_bytes, r->comment);
	return key->check(whole, NULL) == 0;
}

static void key_assign(struct ini_reading *r, const char *name, const char *value)
{
	const struct ini_table *table;
	const struct ini_key *key = ini_key_of(r->tables, r->section, name, &table);
	const struct mention *earlier;
	char why[INI_WHY_MAX], near[INI_NAME_MAX];
	void *values;
	int err;

	if (!key && text_oddity(name, true)) {
		ini_complain(r, r->line, r->title, NULL, "the key \"%.60s\" %s", name,
			     text_oddity(name, true));
		return;
	}
	if (!key) {
		ini_nearest_key(r->tables, r->section, name, near);
		ini_complain_unknown(r, r->title, name, near);
		return;
	}
	values = table_place(r, table);
	earlier = find_mention(&r->keys, key, values);
	if (earlier) {
		ini_complain(r, r->line, r->title, name,
			     "is given twice, first in line %d; expected once", earlier->line);
		return;
	}
	err = mentions_add(&r->keys, key, values, r->line, r->title);
	if (err) {
		r->err = err;
		return;
	}
	err = ini_value_read(key, value, r->folder, values, why);
	if (err)
		ini_complain(r, r->line, r->title, name, "%s", why);
	else if (value_is_cut(r, key, value))
		ini_complain(r, r->line, r->title, name,
			     "goes on behind \";\", where a comment begins; expected a comma");
}

/* inih calls this for each key. inih does not pass its line number; r->line is the line. */
static int line_handle(void *user, const char *section, const char *name, const char *value)
{
	struct ini_reading *r = user;

	r->silent = false;
	if (r->marker) {
		r->marker = false;
		begin_section(r, section);
		return 1;
	}
	if (r->lost)
		return 1;
	if (!*name)
		ini_complain(r, r->line, r->title, NULL,
			     "has \"=\" without a key, expected key = value");
	else if (!*r->section)
		ini_complain(r, r->line, "", NULL,
			     "key \"%.60s\" stands before the first section, expected [section]",
			     name);
	else
		key_assign(r, name, value);
	return 1;
}

/* ---- lines ---- */

static bool header_is_sound(struct ini_reading *r, const char *line)
{
	size_t length = strspn(line + 1, TITLE_CHARACTERS " \t");
	const char *rest = line + 1 + length;

	if (*rest != ']' && text_oddity(line, true)) {
		ini_complain(r, r->line, "", NULL, "the section's title %s",
			     text_oddity(line, true));
		return false;
	}
	if (*rest != ']') {
		ini_complain(
			r, r->line, "", NULL,
			"not a section, expected [section] or [section name] of letters, digits, \"-\" and \"_\"");
		return false;
	}
	if (length >= TITLE_BYTES_MAX) {
		ini_complain(r, r->line, "", NULL,
			     "the section's title is too long, expected at most %d bytes",
			     TITLE_BYTES_MAX - 1);
		return false;
	}
	rest++;
	if (*rest && !isspace((unsigned char)*rest)) {
		ini_complain(r, r->line, "", NULL,
			     "text follows the section's \"]\", expected nothing");
		return false;
	}
	rest += strspn(rest, " \t\r\n");
	if (*rest && *rest != ';' && *rest != '#') {
		ini_complain(r, r->line, "", NULL,
			     "text follows the section's \"]\", expected nothing");
		return false;
	}
	return true;
}

/* Whether the line has no control characters, which are binary data or escape sequences for the
 * reader's terminal. */
static bool line_is_text(const char *line, size_t length)
{
	for (size_t i = 0; i < length; i++) {
		unsigned char c = (unsigned char)line[i];
		bool line_end = c == '\r' && i + 1 == length;

		if ((c < 0x20 && c != '\t' && !line_end) || c == 0x7f)
			return false;
	}
	return true;
}

/* Finds what inih leaves out: the text behind the first ";" that follows a blank. */
static void find_comment(struct ini_reading *r, const char *line, size_t length)
{
	const char *end = line + length, *at = line;

	while (at < end && !(*at == ';' && isblank((unsigned char)at[-1])))
		at++;
	r->comment = at < end ? at + 1 : end;
	while (end > r->comment && isspace((unsigned char)end[-1]))
		end--;
	r->comment_bytes = (int)(end - r->comment);
}

/* Finds the next line, without its break and leading blanks. False at the end of the text. */
static bool next_line(struct ini_reading *r, const char **line, size_t *length)
{
	const char *end;

	if (r->at >= r->end)
		return false;
	end = memchr(r->at, '\n', (size_t)(r->end - r->at));
	if (!end)
		end = r->end;
	*line = r->at;
	*length = (size_t)(end - r->at);
	r->at = end < r->end ? end + 1 : end;
	r->line++;
	while (*length && isblank((unsigned char)**line)) {
		(*line)++;
		(*length)--;
	}
	return true;
}

/*
 * inih calls this in place of fgets(). It refuses lines that inih would cut or misread. It removes
 * leading blanks, because inih takes an indented line for a continuation of the line before. After
 * a section's line it inserts a marker, an assignment without a name, because inih does not report
 * a section that has no keys.
 */
static char *line_feed(char *text, int room, void *stream)
{
	struct ini_reading *r = stream;
	const char *line;
	size_t length;

	if (r->silent && !r->lost)
		ini_complain(r, r->line, r->title, NULL, "not understood, expected key = value");
	r->silent = false;
	if (r->header) {
		r->header = false;
		r->marker = true;
		return strcpy(text, "=\n");
	}
	while (next_line(r, &line, &length)) {
		if (!line_is_text(line, length)) {
			ini_complain(r, r->line, "", NULL,
				     "holds a control character, expected a text file");
			return NULL;
		}
		if (!length || *line == ';' || *line == '#' || *line == '\r')
			continue;
		if (length + 2 > (size_t)room) {
			ini_complain(r, r->line, "", NULL,
				     "the line is too long (%zu bytes), expected at most %d",
				     length, room - 2);
			continue;
		}
		memcpy(text, line, length);
		text[length] = '\n';
		text[length + 1] = '\0';
		if (*line == '[') {
			r->header = header_is_sound(r, text);
			r->lost = !r->header;
			if (r->lost)
				continue;
			return text;
		}
		r->silent = true;
		find_comment(r, line, length);
		return text;
	}
	return NULL;
}

/* ---- whole files ---- */

static void check_mandatory(struct ini_reading *r)
{
	for (size_t i = 0; i < r->opened.count; i++) {
		const struct mention *m = &r->opened.list[i];
		const struct ini_table *table = m->what;

		for (const struct ini_key *key = table->keys; key->name; key++) {
			char name[INI_NAME_MAX], expected[INI_WHY_MAX];

			if (key->fallback || find_mention(&r->keys, key, m->values))
				continue;
			snprintf(name, sizeof(name), "%s%s", ini_prefix(table), key->name);
			ini_value_expected(key, expected, sizeof(expected));
			ini_complain(r, m->line, m->title, name, "is missing, expected %s",
				     expected);
		}
	}
}

/* The line that a text's first zero is in. */
static int zero_line(const char *text)
{
	int line = 1;

	while (*text)
		line += *text++ == '\n';
	return line;
}

int ini_read_memory(const char *text, size_t bytes, const char *name, const char *folder,
		    const struct ini_table *tables, void *root, struct ini_report *report)
{
	struct ini_reading r = {
		.name = name,
		.folder = folder,
		.tables = tables,
		.root = root,
		.report = report,
		.at = text,
		.end = text + bytes,
	};

	if (text_is_utf16(text, bytes)) {
		ini_complain(&r, 0, "", NULL,
			     "is UTF-16, expected UTF-8: save it in that encoding");
		return r.err;
	}
	/* A binary file may begin with what looks like lines, so zeros are looked for first. */
	if (memchr(text, '\0', bytes)) {
		ini_complain(&r, zero_line(text), "", NULL,
			     "holds a control character, expected a text file");
		return r.err;
	}
	if (bytes >= strlen(BYTE_ORDER_MARK) &&
	    !memcmp(text, BYTE_ORDER_MARK, strlen(BYTE_ORDER_MARK)))
		r.at += strlen(BYTE_ORDER_MARK);
	if (&ini_max_line)
		ini_max_line = LINE_BYTES_MAX;
	/* inih returns the first line that it did not understand; line_feed() has reported it. */
	(void)ini_parse_stream(line_feed, &r, line_handle, &r);
	check_mandatory(&r);
	free(r.keys.list);
	free(r.opened.list);
	return r.err;
}

static int fail_file(struct ini_report *report, int err, const char *path, const char *what)
{
	struct fault fault = {.text = ""};

	fault_say(&fault, err, "%s: %s", path, what);
	ini_report_add(report, &fault);
	return err;
}

static void folder_of(const char *path, char folder[INI_PATH_MAX])
{
	const char *slash = strrchr(path, '/');
	size_t length = slash ? (size_t)(slash - path) : 0;

	if (slash == path)
		length = 1;
	if (length >= INI_PATH_MAX)
		length = 0;
	memcpy(folder, path, length);
	folder[length] = '\0';
}

int ini_read(const char *path, const struct ini_table *tables, void *root,
	     struct ini_report *report)
{
	char folder[INI_PATH_MAX], *text = NULL;
	size_t bytes;
	struct fault fault = {.text = ""};
	FILE *file;
	int err = input_stream(path, &file, &fault);

	if (err) {
		ini_report_add(report, &fault);
		return err;
	}
	text = malloc(FILE_BYTES_MAX + 1);
	if (!text) {
		err = fail_file(report, -ENOMEM, path, strerror(ENOMEM));
		goto close_file;
	}
	bytes = fread(text, 1, FILE_BYTES_MAX + 1, file);
	if (ferror(file)) {
		err = -errno;
		err = fail_file(report, err, path, strerror(-err));
		goto free_text;
	}
	if (bytes > FILE_BYTES_MAX) {
		err = fail_file(report, -EFBIG, path,
				"is larger than 1 MiB, expected a configuration file");
		goto free_text;
	}
	folder_of(path, folder);
	err = ini_read_memory(text, bytes, path, folder, tables, root, report);
free_text:
	free(text);
close_file:
	fclose(file);
	return err;
}

/* ---- one assignment ---- */

/* Splits "section.key" or "section.name.key"; the table of the section says which of the two. */
static int split_assignment(struct ini_reading *r, const char *left, const char **key)
{
	const char *dot = strchr(left, '.');
	const struct ini_table *table;
	char title[2 * TITLE_BYTES_MAX], near[INI_NAME_MAX];
	size_t length;

	if (!dot || (size_t)(dot - left) >= TITLE_BYTES_MAX) {
		ini_complain(r, 0, "", NULL, "expected section.key=value");
		return r->err;
	}
	snprintf(title, sizeof(title), "%.*s", (int)(dot - left), left);
	split_title(r, title);
	table = ini_table_of(r->tables, r->section);
	if (!table) {
		ini_nearest_section(r->tables, r->section, near);
		ini_complain_unknown(r, r->title, NULL, near);
		return r->err;
	}
	*key = dot + 1;
	if (!table->named)
		return 0;
	length = strcspn(*key, ".");
	if (!length || length >= TITLE_BYTES_MAX || (*key)[length] != '.' ||
	    strspn(*key, TITLE_CHARACTERS) != length) {
		ini_complain(
			r, 0, r->title, NULL,
			"has named sections, expected %s.NAME.key=value, NAME of letters, digits, \"-\" and \"_\"",
			r->section);
		return r->err;
	}
	snprintf(title, sizeof(title), "%s %.*s", r->section, (int)length, *key);
	split_title(r, title);
	*key += length + 1;
	return 0;
}

int ini_set(const char *assignment, const struct ini_table *tables, void *root,
	    struct ini_report *report)
{
	char name[INI_PATH_MAX + 8], text[LINE_BYTES_MAX];
	struct ini_reading r = {.name = name, .tables = tables, .root = root, .report = report};
	const char *key = NULL, *value;
	char *left = text, *equals;
	size_t length = strlen(assignment);

	snprintf(name, sizeof(name), "--set %.200s", assignment);
	if (length >= sizeof(text) || !line_is_text(assignment, length)) {
		ini_complain(&r, 0, "", NULL, "expected section.key=value in fewer than %d bytes",
			     LINE_BYTES_MAX);
		return r.err;
	}
	memcpy(text, assignment, length + 1);
	while (length && isblank((unsigned char)text[length - 1]))
		text[--length] = '\0';
	left += strspn(left, " \t");
	equals = strchr(left, '=');
	if (!equals) {
		ini_complain(&r, 0, "", NULL, "expected section.key=value");
		return r.err;
	}
	value = equals + 1 + strspn(equals + 1, " \t");
	do
		*equals-- = '\0';
	while (equals > left && isblank((unsigned char)*equals));
	if (split_assignment(&r, left, &key) || open_tables(&r))
		goto out;
	key_assign(&r, key, value);
out:
	free(r.keys.list);
	free(r.opened.list);
	return r.err;
}
