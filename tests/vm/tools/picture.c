/* SPDX-License-Identifier: MIT */
/*
 * Pictures for the simulated cameras, and the comparison of what came out of them.
 *
 *     picture chart fisheye|background WIDTH HEIGHT OUT.png [SQUASH]
 *                                            SQUASH: height of a pixel over its width
 *     picture compose WIDTH HEIGHT OUT.png [IN.png X Y upright|vflip|hflip|rotate180]...
 *                                            pictures side by side on black, as a composer does it
 *     picture raw FORMAT IN.png OUT.raw      as a V4L2 device takes it; Y'CbCr is BT.601 limited
 *     picture compare EXPECTED ACTUAL [x=X] [y=Y] [within=LEVELS]
 *                                            EXPECTED against the part of ACTUAL that starts at
 *                                            (X, Y); names the worst pixel; exit 1 beyond LEVELS
 *     picture colour PICTURE X Y WIDTH HEIGHT    smallest and largest R, G, B in that part
 *
 * A chart is made of blocks of 2x2 equal pixels, so that 4:2:2 and 4:2:0 lose nothing but rounding.
 * ACTUAL may be a PPM (QEMU's screendump). This is written apart from the code under test:
 * nothing but the PNG reader is shared with it.
 */
#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "hal/image/image.h"

static void need(int err, const struct fault *fault)
{
	if (err) {
		fprintf(stderr, "picture: %s\n", fault->text[0] ? fault->text : strerror(-err));
		exit(2);
	}
}

static struct image read_ppm(const char *path)
{
	struct fault fault = {""};
	struct image image = {0};
	int width = 0, height = 0;
	FILE *f = fopen(path, "rb");

	if (!f || fscanf(f, "P6 %d %d 255", &width, &height) != 2 || fgetc(f) != '\n')
		need(fault_say(&fault, -EBADMSG, "%s: not a PPM picture", path), &fault);
	need(image_create_u8(&image, width, height), &fault);
	const size_t bytes = (size_t)width * (size_t)height * 3;
	if (fread(image.u8, 1, bytes, f) != bytes)
		need(fault_say(&fault, -EBADMSG, "%s: cut short", path), &fault);
	fclose(f);
	return image;
}

static struct image read_picture(const char *path)
{
	struct fault fault = {""};
	struct image image = {0};
	const char *dot = strrchr(path, '.');

	if (dot && !strcmp(dot, ".ppm"))
		return read_ppm(path);
	need(image_read(path, &image, &fault), &fault);
	if (!image.u8)
		need(fault_say(&fault, -EINVAL, "%s: not 8 bits a channel", path), &fault);
	return image;
}

static uint8_t clamp_u8(double v)
{
	return v <= 0 ? 0 : v >= 255 ? 255 : (uint8_t)lround(v);
}

/* A soft sky inside the circle, bluish on one side, with one small bright lamp; black outside. */
static void fisheye_colour(double x, double y, double rgb[3])
{
	const double r = hypot(x, y), lamp = hypot(x - 0.45, y + 0.3);
	rgb[0] = r > 1 ? 0 : 70 + 40 * x;
	rgb[1] = r > 1 ? 0 : 80 + 10 * y;
	rgb[2] = r > 1 ? 0 : 95 - 45 * x;
	if (lamp < 0.12)
		rgb[0] = rgb[1] = rgb[2] = 255;
}

/* Every level in one channel across, in another down, and a checkerboard of dark squares, so that
 * neither a shift nor a mirror image nor swapped channels can pass. */
static void background_colour(double x, double y, double rgb[3])
{
	const int square = ((int)floor((x + 1) * 9) + (int)floor((y + 1) * 7)) & 1;
	const double dark = square ? 0.6 : 1.0;
	rgb[0] = dark * 255 * (x + 1) / 2;
	rgb[1] = dark * 255 * (y + 1) / 2;
	rgb[2] = dark * 255 * (2 - x - y) / 4;
}

static void chart(const char *kind, int width, int height, double squash, const char *path)
{
	struct fault fault = {""};
	struct image image;
	const int small = width < height ? width : height;

	need(image_create_u8(&image, width, height), &fault);
	for (int y = 0; y < height; y++)
		for (int x = 0; x < width; x++) {
			uint8_t *to = image.u8 + ((size_t)y * width + x) * 3;
			const double bx = x / 2 * 2 + 1, by = y / 2 * 2 + 1;
			double rgb[3];
			if (!strcmp(kind, "fisheye"))
				fisheye_colour((2 * bx - width) / (small * squash),
					       (2 * by - height) / small, rgb);
			else
				background_colour(2 * bx / width - 1, 2 * by / height - 1, rgb);
			for (int c = 0; c < 3; c++)
				to[c] = clamp_u8(rgb[c]);
		}
	need(image_write(path, &image, &fault), &fault);
	image_free(&image);
}

static void paste(struct image *image, char **argv)
{
	struct image part = read_picture(argv[0]);
	const int x0 = atoi(argv[1]), y0 = atoi(argv[2]);
	const int hflip = !strcmp(argv[3], "hflip") || !strcmp(argv[3], "rotate180");
	const int vflip = !strcmp(argv[3], "vflip") || !strcmp(argv[3], "rotate180");

	if (x0 < 0 || y0 < 0 || x0 + part.width > image->width ||
	    y0 + part.height > image->height) {
		fprintf(stderr, "picture: %s does not fit at (%d, %d)\n", argv[0], x0, y0);
		exit(2);
	}
	for (int y = 0; y < part.height; y++)
		for (int x = 0; x < part.width; x++) {
			const int from_x = hflip ? part.width - 1 - x : x;
			const int from_y = vflip ? part.height - 1 - y : y;
			memcpy(image->u8 + ((size_t)(y0 + y) * image->width + x0 + x) * 3,
			       part.u8 + ((size_t)from_y * part.width + from_x) * 3, 3);
		}
	image_free(&part);
}

static void compose(int argc, char **argv)
{
	struct fault fault = {""};
	struct image image;
	const int width = atoi(argv[2]), height = atoi(argv[3]);

	need(image_create_u8(&image, width, height), &fault);
	memset(image.u8, 0, (size_t)width * (size_t)height * 3);
	for (int i = 5; i + 3 < argc; i += 4)
		paste(&image, argv + i);
	need(image_write(argv[4], &image, &fault), &fault);
	image_free(&image);
}

/* BT.601, limited range. */
static void to_ycbcr(const uint8_t *rgb, uint8_t ycc[3])
{
	const double r = rgb[0] / 255.0, g = rgb[1] / 255.0, b = rgb[2] / 255.0;
	const double luma = 0.299 * r + 0.587 * g + 0.114 * b;
	ycc[0] = clamp_u8(16 + 219 * luma);
	ycc[1] = clamp_u8(128 + 224 * (b - luma) / 1.772);
	ycc[2] = clamp_u8(128 + 224 * (r - luma) / 1.402);
}

/* Writes pixels x and x + 1 in a packed format; returns the number of bytes. */
static int pack_pair(const char *format, const uint8_t *rgb, uint8_t *out)
{
	uint8_t a[3], b[3];
	to_ycbcr(rgb, a);
	to_ycbcr(rgb + 3, b);
	if (!strcmp(format, "YUYV")) {
		const uint8_t bytes[4] = {a[0], a[1], b[0], a[2]};
		memcpy(out, bytes, 4);
		return 4;
	}
	if (!strcmp(format, "UYVY")) {
		const uint8_t bytes[4] = {a[1], a[0], a[2], b[0]};
		memcpy(out, bytes, 4);
		return 4;
	}
	if (!strcmp(format, "GREY")) {
		out[0] = a[0];
		out[1] = b[0];
		return 2;
	}
	if (!strcmp(format, "RGB24")) {
		memcpy(out, rgb, 6);
		return 6;
	}
	if (!strcmp(format, "BGR24")) {
		const uint8_t bytes[6] = {rgb[2], rgb[1], rgb[0], rgb[5], rgb[4], rgb[3]};
		memcpy(out, bytes, 6);
		return 6;
	}
	if (!strcmp(format, "BGRX")) {
		const uint8_t bytes[8] = {rgb[2], rgb[1], rgb[0], 0, rgb[5], rgb[4], rgb[3], 0};
		memcpy(out, bytes, 8);
		return 8;
	}
	fprintf(stderr, "picture: format %s is not known\n", format);
	exit(2);
}

static void write_nv12(const struct image *image, FILE *f)
{
	uint8_t ycc[3];
	for (int i = 0; i < image->width * image->height; i++) {
		to_ycbcr(image->u8 + 3 * (size_t)i, ycc);
		fputc(ycc[0], f);
	}
	for (int y = 0; y < image->height; y += 2)
		for (int x = 0; x < image->width; x += 2) {
			to_ycbcr(image->u8 + ((size_t)y * image->width + x) * 3, ycc);
			fputc(ycc[1], f);
			fputc(ycc[2], f);
		}
}

static void raw(const char *format, const char *from, const char *to)
{
	struct fault fault = {""};
	struct image image = read_picture(from);
	FILE *f = fopen(to, "wb");
	uint8_t pair[8];

	if (!f)
		need(fault_say(&fault, -EIO, "%s: cannot be written", to), &fault);
	if (!strcmp(format, "NV12"))
		write_nv12(&image, f);
	else
		for (int i = 0; i + 1 < image.width * image.height; i += 2)
			fwrite(pair, 1, (size_t)pack_pair(format, image.u8 + 3 * (size_t)i, pair),
			       f);
	if (fclose(f))
		need(fault_say(&fault, -EIO, "%s: cannot be written", to), &fault);
	image_free(&image);
}

static int option(int argc, char **argv, const char *name, int fallback)
{
	const size_t length = strlen(name);
	for (int i = 4; i < argc; i++)
		if (!strncmp(argv[i], name, length) && argv[i][length] == '=')
			return atoi(argv[i] + length + 1);
	return fallback;
}

static int compare(int argc, char **argv)
{
	struct image expected = read_picture(argv[2]), actual = read_picture(argv[3]);
	const int x0 = option(argc, argv, "x", 0), y0 = option(argc, argv, "y", 0);
	const int within = option(argc, argv, "within", 0);
	int worst = -1, worst_x = 0, worst_y = 0;
	long beyond = 0;
	double squares = 0;

	if (x0 + expected.width > actual.width || y0 + expected.height > actual.height) {
		printf("%dx%d at (%d, %d) does not fit into %dx%d\n", expected.width,
		       expected.height, x0, y0, actual.width, actual.height);
		return 1;
	}
	for (int y = 0; y < expected.height; y++)
		for (int x = 0; x < expected.width; x++) {
			const uint8_t *e = expected.u8 + ((size_t)y * expected.width + x) * 3;
			const uint8_t *a = actual.u8 +
					   ((size_t)(y + y0) * actual.width + x + x0) * 3;
			int off = 0;
			for (int c = 0; c < 3; c++) {
				const int d = abs(e[c] - a[c]);
				off = d > off ? d : off;
				squares += d * d;
			}
			beyond += off > within;
			if (off > worst) {
				worst = off;
				worst_x = x;
				worst_y = y;
			}
		}
	const uint8_t *e = expected.u8 + ((size_t)worst_y * expected.width + worst_x) * 3;
	const uint8_t *a = actual.u8 + ((size_t)(worst_y + y0) * actual.width + worst_x + x0) * 3;
	printf("largest difference %d at (%d, %d): expected %d %d %d, is %d %d %d; RMS %.4f; %ld pixels beyond %d\n",
	       worst, worst_x, worst_y, e[0], e[1], e[2], a[0], a[1], a[2],
	       sqrt(squares / (3.0 * expected.width * expected.height)), beyond, within);
	image_free(&expected);
	image_free(&actual);
	return worst > within;
}

static int colour(char **argv)
{
	struct image image = read_picture(argv[2]);
	const int x0 = atoi(argv[3]), y0 = atoi(argv[4]);
	const int x1 = x0 + atoi(argv[5]), y1 = y0 + atoi(argv[6]);
	int low[3] = {255, 255, 255}, high[3] = {0, 0, 0};

	if (x0 < 0 || y0 < 0 || x1 > image.width || y1 > image.height) {
		fprintf(stderr, "picture: outside the picture\n");
		return 2;
	}
	for (int y = y0; y < y1; y++)
		for (int x = x0; x < x1; x++)
			for (int c = 0; c < 3; c++) {
				const int v = image.u8[((size_t)y * image.width + x) * 3 + c];
				low[c] = v < low[c] ? v : low[c];
				high[c] = v > high[c] ? v : high[c];
			}
	printf("%d %d %d %d %d %d\n", low[0], low[1], low[2], high[0], high[1], high[2]);
	image_free(&image);
	return 0;
}

int main(int argc, char **argv)
{
	if ((argc == 6 || argc == 7) && !strcmp(argv[1], "chart")) {
		chart(argv[2], atoi(argv[3]), atoi(argv[4]), argc == 7 ? atof(argv[6]) : 1,
		      argv[5]);
		return 0;
	}
	if (argc >= 5 && !strcmp(argv[1], "compose")) {
		compose(argc, argv);
		return 0;
	}
	if (argc == 5 && !strcmp(argv[1], "raw")) {
		raw(argv[2], argv[3], argv[4]);
		return 0;
	}
	if (argc >= 4 && !strcmp(argv[1], "compare"))
		return compare(argc, argv);
	if (argc == 7 && !strcmp(argv[1], "colour"))
		return colour(argv);
	fprintf(stderr, "usage: picture chart|compose|raw|compare|colour ... (see picture.c)\n");
	return 2;
}
