/* SPDX-License-Identifier: MIT */
#include "bake/base/report_page.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "hal/base/log.h"
#include "hal/base/output.h"

#define TEMPORARY ".part-XXXXXX"

/* ---- folders ---- */

/* Whether a file has one of the endings of reports. No other file is ever removed. */
static bool is_report_file(const char *name)
{
	static const char *const endings[] = {".html", ".csv", ".json", ".svg", ".png", ".inlay"};
	const char *dot = strrchr(name, '.');

	for (size_t k = 0; dot && k < sizeof(endings) / sizeof(*endings); k++)
		if (!strcmp(dot, endings[k]))
			return true;
	return false;
}

static void remove_report_folder(const char *folder)
{
	DIR *dir = opendir(folder);
	const struct dirent *entry;

	if (!dir)
		return;
	while ((entry = readdir(dir)))
		if (is_report_file(entry->d_name))
			unlinkat(dirfd(dir), entry->d_name, 0);
	closedir(dir);
	if (rmdir(folder))
		log_warning("%s is left: it holds files that are no report's", folder);
}

/* 0 if the folder is missing, empty or an earlier report. */
static int check_report_folder(const char *folder, struct fault *fault)
{
	bool empty = true, report = false;
	DIR *dir = opendir(folder);
	const struct dirent *entry;

	if (!dir)
		return errno == ENOENT
			       ? 0
			       : fault_say(fault, -errno, "%s: %s", folder, strerror(errno));
	while ((entry = readdir(dir))) {
		if (!strcmp(entry->d_name, ".") || !strcmp(entry->d_name, ".."))
			continue;
		empty = false;
		report |= !strcmp(entry->d_name, REPORT_PAGE_NAME);
	}
	closedir(dir);
	if (empty || report)
		return 0;
	return fault_say(fault, -EEXIST,
			 "%s: holds files and no " REPORT_PAGE_NAME
			 ", expected a new folder, an empty one or an earlier report",
			 folder);
}

void report_page_path(const struct report_page *page, const char *name, const char *ending,
		      char path[REPORT_PATH_MAX])
{
	snprintf(path, REPORT_PATH_MAX, "%s/%s%s", page->temporary, name, ending);
}

int report_page_open(struct report_page *page, const char *folder, struct fault *fault)
{
	size_t length = strlen(folder);
	int err;

	*page = (struct report_page){.body = NULL};
	while (length > 1 && folder[length - 1] == '/')
		length--;
	snprintf(page->folder, sizeof(page->folder), "%.*s", (int)length, folder);
	err = check_report_folder(page->folder, fault);
	if (err)
		return err;
	if (snprintf(page->temporary, sizeof(page->temporary), "%s" TEMPORARY, page->folder) >=
	    (int)sizeof(page->temporary)) {
		page->temporary[0] = '\0';
		return fault_say(fault, -ENAMETOOLONG, "%s: the name is too long", folder);
	}
	if (!mkdtemp(page->temporary)) {
		err = -errno;
		page->temporary[0] = '\0';
		return fault_say(fault, err, "%s: %s", page->folder, strerror(-err));
	}
	chmod(page->temporary, 0755);
	page->body = open_memstream(&page->text, &page->bytes);
	if (!page->body) {
		report_page_abandon(page);
		return fault_say(fault, -ENOMEM, "not enough memory");
	}
	return 0;
}

void report_page_abandon(struct report_page *page)
{
	if (page->body)
		fclose(page->body);
	page->body = NULL;
	free(page->text);
	page->text = NULL;
	if (page->temporary[0])
		remove_report_folder(page->temporary);
	page->temporary[0] = '\0';
}

/* ---- parts ---- */

void report_write_escaped(FILE *to, const char *text)
{
	for (; *text; text++) {
		switch (*text) {
		case '&':
			fputs("&amp;", to);
			break;
		case '<':
			fputs("&lt;", to);
			break;
		case '>':
			fputs("&gt;", to);
			break;
		case '"':
			fputs("&quot;", to);
			break;
		default:
			fputc(*text, to);
		}
	}
}

static void __attribute__((format(printf, 2, 0)))
write_formatted(FILE *to, const char *format, va_list list)
{
	char *text;

	if (vasprintf(&text, format, list) < 0)
		return;
	report_write_escaped(to, text);
	free(text);
}

void report_heading(FILE *to, const char *format, ...)
{
	va_list list;

	va_start(list, format);
	fputs("<h2>", to);
	write_formatted(to, format, list);
	fputs("</h2>\n", to);
	va_end(list);
}

void report_paragraph(FILE *to, const char *format, ...)
{
	va_list list;

	va_start(list, format);
	fputs("<p>", to);
	write_formatted(to, format, list);
	fputs("</p>\n", to);
	va_end(list);
}

static void write_heading(const struct table_column *column, FILE *to)
{
	fputs("<th scope=\"col\">", to);
	report_write_escaped(to, column->heading);
	if (column->unit[0]) {
		fputs("<br><span class=\"unit\">", to);
		report_write_escaped(to, column->unit);
		fputs("</span>", to);
	}
	fputs("</th>", to);
}

static void write_cell(const struct table_cell *cell, FILE *to)
{
	char number[32];

	if (cell->text) {
		fputs("<td>", to);
		report_write_escaped(to, cell->text);
	} else {
		table_rounded(cell->number, number, sizeof(number));
		fprintf(to, "<td class=\"n\">%s", number);
	}
	fputs("</td>", to);
}

static void write_table(const struct table *t, FILE *to)
{
	const int rows = table_rows(t);

	fprintf(to, "<table id=\"%s\">\n<thead><tr>", t->name);
	for (int c = 0; c < t->columns; c++)
		if (t->column[c].heading[0])
			write_heading(&t->column[c], to);
	fputs("</tr></thead>\n<tbody>\n", to);
	for (int r = 0; r < rows; r++) {
		fputs(r == t->marked ? "<tr class=\"used\">" : "<tr>", to);
		for (int c = 0; c < t->columns; c++)
			if (t->column[c].heading[0])
				write_cell(&t->cell[r * t->columns + c], to);
		fputs("</tr>\n", to);
	}
	fputs("</tbody>\n</table>\n", to);
	fprintf(to, "<p class=\"source\"><a href=\"%s.csv\">%s.csv</a>%s</p>\n", t->name, t->name,
		t->marked >= 0 ? "; the setting in use is shaded" : "");
}

static int write_csv(const struct report_page *page, const struct table *table, struct fault *fault)
{
	struct output out = {.stream = NULL};
	char path[REPORT_PATH_MAX];
	int err;

	if (table->err)
		return fault_say(fault, table->err, "table %s: %s", table->name,
				 strerror(-table->err));
	report_page_path(page, table->name, ".csv", path);
	err = output_open(&out, path, fault);
	if (err)
		return err;
	table_write_csv(table, out.stream);
	err = output_commit(&out, fault);
	output_abandon(&out);
	return err;
}

int report_page_table(struct report_page *page, struct table *table, struct fault *fault)
{
	const int err = write_csv(page, table, fault);

	if (!err)
		write_table(table, page->body);
	table_free(table);
	return err;
}

void report_page_show(struct report_page *page, const char *name, const char *caption)
{
	fprintf(page->body, "<figure><img src=\"%s.png\" alt=\"", name);
	report_write_escaped(page->body, caption);
	fputs("\"><figcaption>", page->body);
	report_write_escaped(page->body, caption);
	fputs("</figcaption></figure>\n", page->body);
}

int report_page_picture(struct report_page *page, const char *name, const struct image *picture,
			const char *caption, struct fault *fault)
{
	char path[REPORT_PATH_MAX];
	int err;

	report_page_path(page, name, ".png", path);
	err = image_write(path, picture, fault);
	if (!err)
		report_page_show(page, name, caption);
	return err;
}

/* ---- the whole ---- */

static const char style[] =
	"body{font:16px/1.45 sans-serif;color:#1a1a1a;background:#fff;max-width:62em;margin:2em auto;padding:0 1em}\n"
	"h1{font-size:1.7em;margin:0 0 .4em}h2{font-size:1.25em;margin:2.2em 0 .4em;border-top:1px solid #bbb;padding-top:.8em}\n"
	"p{max-width:46em;margin:.5em 0}.source,figcaption{font-size:.85em;color:#555}\n"
	"table{border-collapse:collapse;font-size:.85em;margin:.8em 0 .2em}\n"
	"th{text-align:right;vertical-align:bottom;border-bottom:2px solid #888;padding:.2em .6em}th:first-child{text-align:left}.unit{font-weight:normal;color:#555}\n"
	"td{padding:.15em .6em;border-bottom:1px solid #ddd;vertical-align:top}td.n{text-align:right;font-variant-numeric:tabular-nums}\n"
	"tr.used td{background:#dcebf7;font-weight:bold}\n"
	"pre{background:#f1f1ec;border-left:3px solid #e69f00;padding:.5em .9em;margin:.4em 0}figure{margin:.8em 0}img{max-width:100%;display:block;width:100%;image-rendering:pixelated}\n"
	"@media print{body{max-width:none;margin:0;font-size:11px}h2{page-break-after:avoid}figure,table{page-break-inside:avoid}}\n";

static int write_page(struct report_page *page, const char *title, struct fault *fault)
{
	struct output out = {.stream = NULL};
	char path[REPORT_PATH_MAX];
	int err;

	/* a memory stream that has failed has no text */
	if (fflush(page->body) || ferror(page->body))
		return fault_say(fault, -ENOMEM, "not enough memory for the page");
	report_page_path(page, REPORT_PAGE_NAME, "", path);
	err = output_open(&out, path, fault);
	if (err)
		return err;
	fputs("<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n<title>",
	      out.stream);
	report_write_escaped(out.stream, title);
	fprintf(out.stream, "</title>\n<style>\n%s</style>\n</head>\n<body>\n<h1>", style);
	report_write_escaped(out.stream, title);
	fputs("</h1>\n", out.stream);
	fwrite(page->text, 1, page->bytes, out.stream);
	fputs("</body>\n</html>\n", out.stream);
	err = output_commit(&out, fault);
	output_abandon(&out);
	return err;
}

/* Renames the new folder to its place. An earlier report is exchanged with it atomically: its files
 * then have the temporary name, and report_page_abandon() removes them. */
static int take_place(struct report_page *page)
{
	if (!rename(page->temporary, page->folder)) {
		page->temporary[0] = '\0';
		return 0;
	}
	if (errno != ENOTEMPTY && errno != EEXIST)
		return -errno;
	if (renameat2(AT_FDCWD, page->temporary, AT_FDCWD, page->folder, RENAME_EXCHANGE))
		return -errno;
	return 0;
}

int report_page_commit(struct report_page *page, const char *title, struct fault *fault)
{
	int err = write_page(page, title, fault);

	if (!err) {
		err = take_place(page);
		if (err)
			fault_say(fault, err, "%s: %s", page->folder, strerror(-err));
	}
	report_page_abandon(page);
	return err;
}
