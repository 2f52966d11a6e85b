#include "hal/lights/lights_file.h"

#include <ctype.h>
#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "hal/output.h"

/* Three numbers and nothing else, or -1. */
static int parse_colour(const char *text, float rgb[3])
{
	for (int c = 0; c < 3; c++) {
		char *end;

		rgb[c] = strtof(text, &end);
		if (end == text || !(rgb[c] >= 0) || !isfinite(rgb[c]))
			return -1;
		if (*end && !isspace((unsigned char)*end))
			return -1;
		text = end;
	}
	while (isspace((unsigned char)*text))
		text++;
	return *text ? -1 : 0;
}

/* Cuts the comment and the white space around; what remains. */
static char *strip(char *line)
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

static int read_stream(FILE *stream, const char *path, float (*radiance)[3], int count,
		       struct fault *fault)
{
	char *line = NULL;
	size_t room = 0;
	ssize_t length;
	int found = 0, number = 0, ret = 0;

	while (ret == 0 && (errno = 0, length = getline(&line, &room, stream)) >= 0) {
		const char *text;

		number++;
		if (strlen(line) != (size_t)length) {
			ret = fault_say(fault, -EINVAL, "%s:%d: holds a zero byte, expected text",
					path, number);
			break;
		}
		text = strip(line);
		if (!*text)
			continue;
		if (found == count)
			ret = fault_say(fault, -EINVAL,
					"%s:%d: more than the %d lights of the dome", path, number,
					count);
		else if (parse_colour(text, radiance[found]) < 0)
			ret = fault_say(fault, -EINVAL,
					"%s:%d: \"%.60s\" is not a colour, expected three finite "
					"numbers of at least 0: r g b",
					path, number, text);
		else
			found++;
	}
	if (ret == 0 && ferror(stream)) {
		ret = errno ? -errno : -EIO;
		fault_say(fault, ret, "%s: cannot be read: %s", path, strerror(-ret));
	} else if (ret == 0 && found < count) {
		ret = fault_say(fault, -EINVAL,
				"%s:%d: ends after %d lights, expected %d lines of r g b", path,
				number, found, count);
	}
	free(line);
	return ret;
}

int lights_file_read(const char *path, float (*radiance)[3], int count, struct fault *fault)
{
	FILE *stream = fopen(path, "re");
	int ret;

	if (!stream) {
		ret = -errno;
		return fault_say(fault, ret, "%s: cannot open: %s", path, strerror(-ret));
	}
	ret = read_stream(stream, path, radiance, count, fault);
	fclose(stream);
	return ret;
}

/* Nine digits bring every float back to the bit. */
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
