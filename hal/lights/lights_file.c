/* SPDX-License-Identifier: MIT */
#include "hal/lights/lights_file.h"

#include <ctype.h>
#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "hal/base/number.h"
#include "hal/base/output.h"
#include "hal/base/text_file.h"

/* Reads text that is three numbers and nothing else. 0 or -1. */
static int parse_colour(const char *text, float rgb[3])
{
	for (int c = 0; c < 3; c++) {
		double value;

		if (number_read(&text, &value))
			return -1;
		rgb[c] = (float)value;
		if (!(rgb[c] >= 0) || !isfinite(rgb[c]))
			return -1;
		if (*text && !isspace((unsigned char)*text))
			return -1;
		while (isspace((unsigned char)*text))
			text++;
	}
	return *text ? -1 : 0;
}

/* Cuts off the comment and the white space around. Returns the rest of the line. */
static char *line_strip(char *line)
{
	size_t length;

	line[strcspn(line, "#")] = '\0';
	while (isspace((unsigned char)*line))
		line++;
	length = strlen(line);
	while (length > 0 && isspace((unsigned char)line[length - 1]))
		line[--length] = '\0';
	return line;
}

static int lights_read_lines(struct text_file *file, float (*radiance)[3], int count,
			     struct fault *fault)
{
	int found = 0, ret;

	while ((ret = text_file_next(file, fault)) > 0) {
		const char *text = line_strip(file->line);

		if (!*text)
			continue;
		if (found == count)
			return fault_say(fault, -EINVAL,
					 "%s:%d: more than the %d lights of the dome", file->path,
					 file->number, count);
		if (parse_colour(text, radiance[found]) < 0)
			return fault_say(
				fault, -EINVAL,
				"%s:%d: \"%.60s\" is not a colour, expected three finite numbers of at least 0: r g b",
				file->path, file->number, text);
		found++;
	}
	if (ret < 0 || found == count)
		return ret;
	if (!found)
		return fault_say(fault, -EINVAL, "%s: holds no lights, expected %d lines of r g b",
				 file->path, count);
	return fault_say(fault, -EINVAL, "%s:%d: ends after %d lights, expected %d lines of r g b",
			 file->path, file->number, found, count);
}

int lights_file_read(const char *path, float (*radiance)[3], int count, struct fault *fault)
{
	struct text_file file;
	int ret = text_file_open(&file, path, fault);

	if (ret < 0)
		return ret;
	ret = lights_read_lines(&file, radiance, count, fault);
	text_file_close(&file);
	return ret;
}

/* Nine digits reproduce every float to the bit. */
int lights_file_write(const char *path, const float (*radiance)[3], int count, struct fault *fault)
{
	struct output out;
	int ret = output_open(&out, path, fault);

	if (ret < 0)
		return ret;
	fprintf(out.stream, "# %d lights: linear radiance r g b, in the order of the dome\n",
		count);
	for (int i = 0; i < count; i++)
		fprintf(out.stream, "%.9g %.9g %.9g\n", (double)radiance[i][0],
			(double)radiance[i][1], (double)radiance[i][2]);
	return output_commit(&out, fault);
}
