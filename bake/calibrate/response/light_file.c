/* SPDX-License-Identifier: MIT */
#include "bake/calibrate/response/light_file.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "hal/base/output.h"

static const char head[] = "; What a camera's code values mean: inlay-calibrate light.\n";

int light_file_read(const char *path, struct response *response, struct fault *fault)
{
	struct ini_report report = {.count = 0};
	int err;

	response_begin(response);
	if (access(path, F_OK) != 0)
		return 0;
	err = response_read(response, path, &report);
	return err ? fault_say(fault, err, "%s", report.first.text) : 0;
}

/* The lines since the last key: the comments of a key, and the key. */
struct light_block {
	char *text;
	size_t bytes;
	FILE *stream;
};

static int block_begin(struct light_block *b)
{
	b->text = NULL;
	b->stream = open_memstream(&b->text, &b->bytes);
	return b->stream ? 0 : -ENOMEM;
}

static void block_write(struct light_block *b, FILE *to)
{
	fflush(b->stream);
	if (b->bytes)
		fprintf(to, "\n%s", b->text);
}

static void block_end(struct light_block *b)
{
	if (b->stream)
		fclose(b->stream);
	free(b->text);
	b->stream = NULL;
	b->text = NULL;
}

/* Whether a line sets the key, or is the comment in its place. */
static bool is_of(const char *line, const char *key)
{
	const char *at = line + strspn(line, "; \t");

	return !strncmp(at, key, strlen(key)) && strchr(" \t=:", at[strlen(key)]) &&
	       (strchr(at, '=') || *line == ';');
}

/* Whether a block ends here: with the line of a key. */
static bool ends_block(const char *line)
{
	return *line != ';' && strchr(line, '=');
}

static bool is_skipped(const char *line)
{
	return line[strspn(line, " \t\r\n")] == 0 || *line == '[' || !strcmp(line, head);
}

/* Copies the old file without the key's block. Comments at its end go into rest, to be written
 * after the new block, so that they do not become part of it. */
static int copy_others(FILE *from, FILE *to, const char *key, struct light_block *rest)
{
	char *line = NULL;
	size_t room = 0;
	int err = block_begin(rest);

	while (!err && getline(&line, &room, from) >= 0) {
		if (is_skipped(line))
			continue;
		fputs(line, rest->stream);
		if (!ends_block(line))
			continue;
		if (!is_of(line, key))
			block_write(rest, to);
		block_end(rest);
		err = block_begin(rest);
	}
	free(line);
	return err;
}

static void write_own(FILE *to, const char *key, const char *text, const char *comment)
{
	fputc('\n', to);
	while (comment && *comment) {
		const size_t length = strcspn(comment, "\n");

		fprintf(to, "; %.*s\n", (int)length, comment);
		comment += length + (comment[length] == '\n');
	}
	if (text)
		fprintf(to, "%s = %s\n", key, text);
}

int light_file_set(const char *path, const char *key, const char *text, const char *comment,
		   struct fault *fault)
{
	struct output out = {.stream = NULL};
	struct light_block rest = {.stream = NULL};
	struct response before;
	FILE *old;
	int err = light_file_read(path, &before, fault);

	if (err)
		return err;
	err = output_open(&out, path, fault);
	if (err)
		return err;
	fprintf(out.stream, "%s[light]\n", head);
	old = fopen(path, "r");
	if (old) {
		err = copy_others(old, out.stream, key, &rest);
		fclose(old);
	}
	if (text || comment)
		write_own(out.stream, key, text, comment);
	if (rest.stream)
		block_write(&rest, out.stream);
	block_end(&rest);
	if (err) {
		output_abandon(&out);
		return fault_say(fault, err, "%s: not enough memory", path);
	}
	return output_commit(&out, fault);
}
