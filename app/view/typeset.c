/* SPDX-License-Identifier: MIT */
#include "app/view/typeset.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "hal/base/utf8.h"

#define LEAST_PX 9     /* smallest letters that can be read */
#define UNBROKEN_PX 14 /* smallest letters to which a text is shrunk to stay on one line */
#define SEPARATOR "\u00b7"

int typeset_run(struct typeset *set, cairo_t *cairo, int text)
{
	struct typeset_run *run = &set->run;
	cairo_glyph_t *glyphs = run->glyph;
	int room = PANEL_TEXT_MAX + 1;
	int length = (int)utf8_copy(run->text, PANEL_TEXT_MAX, set->texts[text]);
	cairo_status_t status;

	run->count = 0;
	for (int at = 0; at < length; at += utf8_bytes(run->text + at))
		run->at[run->count++] = at;
	/* The position of a blank behind the text is the end of the text. */
	memcpy(run->text + length, " ", 2);
	status = cairo_scaled_font_text_to_glyphs(cairo_get_scaled_font(cairo), 0, 0, run->text,
						  length + 1, &glyphs, &room, NULL, NULL, NULL);
	if (glyphs != run->glyph)
		cairo_glyph_free(glyphs);
	return status || glyphs != run->glyph || room != run->count + 1 ? -ENOMEM : 0;
}

static double run_width(const struct typeset_run *run, int first, int count)
{
	return run->glyph[first + count].x - run->glyph[first].x;
}

static bool is_blank_at(const struct typeset_run *run, int i)
{
	return i < run->count && run->text[run->at[i]] == ' ';
}

static bool is_separator(const struct typeset_run *run, int i)
{
	return i < run->count && !strncmp(run->text + run->at[i], SEPARATOR, strlen(SEPARATOR));
}

/* Number of glyphs from first on that fit into a line. */
static int line_count(const struct typeset_run *run, int first, double room)
{
	int count = 0, word = 0, part = 0;

	for (; first + count < run->count; count++) {
		if (count && is_blank_at(run, first + count)) {
			word = count;
			if (is_separator(run, first + count + 1))
				part = count;
		}
		if (run_width(run, first, count + 1) > room)
			return part ? part : word ? word : count ? count : 1;
	}
	return count;
}

/* Breaks one text into lines. */
static int set_text(struct typeset *set, cairo_t *cairo, int text)
{
	const struct typeset_run *run = &set->run;
	int err = typeset_run(set, cairo, text), first = 0;

	if (err)
		return err;
	set->widest = fmax(set->widest, run_width(run, 0, run->count));
	while (first < run->count && set->count < TYPESET_LINES_MAX) {
		int count = line_count(run, first, set->line_room);

		set->lines[set->count++] = (struct typeset_line){text, first, count,
								 run_width(run, first, count)};
		first += count;
		/* A separator is left out where a line ends. */
		while (is_blank_at(run, first) || is_separator(run, first))
			first++;
	}
	return 0;
}

static int set_lines(struct typeset *set, cairo_t *cairo, int size_px)
{
	cairo_font_extents_t font;
	int err = 0;

	cairo_set_font_size(cairo, size_px);
	cairo_font_extents(cairo, &font);
	set->size_px = size_px;
	set->line_px = (int)ceil(font.height);
	set->ascent_px = (int)ceil(font.ascent);
	set->pad = (size_px + 1) / 3;
	set->indent = set->marked ? size_px * 3 / 2 : 0;
	set->line_room = set->room.width - set->indent - 4 * set->pad;
	set->widest = set->count = 0;
	for (int i = 0; i < set->text_count && !err; i++)
		err = set_text(set, cairo, i);
	return err;
}

int typeset_height_px(const struct typeset *set)
{
	return set->count * set->line_px + 2 * set->pad;
}

static bool is_too_high(const struct typeset *set)
{
	return typeset_height_px(set) > set->room.height;
}

/* Sets each text on a line of its own, in letters at least two thirds as large as wanted. -ERANGE:
 * they do not fit. */
static int set_unbroken(struct typeset *set, cairo_t *cairo)
{
	int size = set->room.size_px, least = size * 2 / 3, err;

	while (size >= least && size >= UNBROKEN_PX) {
		err = set_lines(set, cairo, size);
		if (err)
			return err;
		if (set->widest <= set->line_room && !is_too_high(set))
			return 0;
		size = (int)fmin(size - 1, size * (set->line_room / set->widest) + 1);
	}
	return -ERANGE;
}

static int set_broken(struct typeset *set, cairo_t *cairo)
{
	for (int size = set->room.size_px; size >= LEAST_PX; size--) {
		int err = set_lines(set, cairo, size);

		if (err)
			return err;
		if (!is_too_high(set))
			return 0;
	}
	return -ERANGE;
}

/* Sets as many texts as fit, and a line that counts the others. */
static int set_some(struct typeset *set, cairo_t *cairo)
{
	int all = set->text_count, err;

	for (int shown = all - 1; shown >= 1; shown--) {
		snprintf(set->more, sizeof(set->more), "and %d more", all - shown);
		set->texts[shown] = set->more;
		set->text_count = shown + 1;
		set->marked = set->marked ? shown : 0;
		err = set_lines(set, cairo, LEAST_PX);
		if (err || !is_too_high(set))
			return err;
	}
	return -ERANGE;
}

/* Sets as much of the first text as fits. */
static int set_part(struct typeset *set, cairo_t *cairo)
{
	int err;

	set->text_count = 1;
	err = set_lines(set, cairo, LEAST_PX);
	while (set->count && is_too_high(set))
		set->count--;
	return err;
}

/* Sets the texts in the last size and in no more lines, so that a strip stands still while its
 * figures change. */
static int set_again(struct typeset *set, cairo_t *cairo)
{
	int lines = set->count;
	int err = set_lines(set, cairo, set->size_px);

	return err ? err : set->count > lines ? -ERANGE : 0;
}

int typeset(struct typeset *set, cairo_t *cairo, bool again)
{
	int err = again ? set_again(set, cairo) : -ERANGE;

	if (err == -ERANGE)
		err = set_unbroken(set, cairo);
	if (err == -ERANGE)
		err = set_broken(set, cairo);
	if (err == -ERANGE)
		err = set_some(set, cairo);
	if (err == -ERANGE)
		err = set_part(set, cairo);
	return err;
}
