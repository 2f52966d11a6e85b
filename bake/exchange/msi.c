/* SPDX-License-Identifier: MIT */
#include "bake/exchange/msi.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include "hal/base/input.h"
#include "hal/base/output.h"

#define INTS 3
#define LONG_BYTES 8 /* as written: of a long of today's Linux */
#define ALBEDO 0.5   /* assumed for flat ground, which the file does not tell */
#define FLAT_BYTES 2 /* tolerance for the rounding of two bytes and of their scale */

static const struct msi_variant variants[] = {{false, 4}, {false, 8}, {true, 4}, {true, 8}};

#define VARIANTS (sizeof(variants) / sizeof(*variants))

/* ---- reading ---- */

static uint64_t number_at(const uint8_t *data, int bytes, bool big_endian)
{
	uint64_t value = 0;

	for (int k = 0; k < bytes; k++)
		value = value << 8 | data[big_endian ? k : bytes - 1 - k];
	return value;
}

/* Why a file does not have this variant, and how far reading it came. */
struct msi_verdict {
	size_t reached;
	char text[160];
};

static size_t header_bytes(const struct msi_variant *variant)
{
	return INTS * 4 + (size_t)variant->long_bytes;
}

static bool msi_read_header(struct msi *msi, const struct msi_variant *variant,
			    struct msi_verdict *why)
{
	uint64_t number[INTS], size;

	if (msi->bytes < header_bytes(variant)) {
		snprintf(why->text, sizeof(why->text), "ends in its header");
		return false;
	}
	for (int k = 0; k < INTS; k++)
		number[k] = number_at(msi->data + 4 * k, 4, variant->big_endian);
	size = number_at(msi->data + 4 * INTS, variant->long_bytes, variant->big_endian);
	if (number[0] < 1 || number[0] > BASIS_SIDE_MAX || number[1] < 1 ||
	    number[1] > BASIS_SIDE_MAX || number[2] < 1 || number[2] > BASIS_LIGHTS_MAX) {
		snprintf(why->text, sizeof(why->text), "has no size and count of lights");
		return false;
	}
	msi->width = (int)number[0];
	msi->height = (int)number[1];
	msi->lights = (int)number[2];
	msi->variant = *variant;
	why->reached = size ? 2 : 1; /* a 0 may be half of another variant's 8 bytes */
	if (size == msi->bytes || size == msi->bytes - header_bytes(variant))
		return true;
	snprintf(why->text, sizeof(why->text), "has %zu bytes, expected %llu as it says itself",
		 msi->bytes, (unsigned long long)size);
	return false;
}

/* Finds the offset of each pixel. */
static bool msi_find_pixels(struct msi *msi, struct msi_verdict *why)
{
	const size_t pixels = (size_t)msi->width * (size_t)msi->height;
	size_t at = header_bytes(&msi->variant);

	for (size_t p = 0; p < pixels; p++) {
		if (at >= msi->bytes || msi->data[at] > THESIS_SHADOW) {
			why->reached = 3 + p;
			if (at >= msi->bytes)
				snprintf(why->text, sizeof(why->text),
					 "ends at pixel %zu, expected %zu", p, pixels);
			else
				snprintf(why->text, sizeof(why->text),
					 "pixel %zu is of type %d, expected 0, 1 or 2", p,
					 msi->data[at]);
			return false;
		}
		msi->start[p] = at;
		at += 1 + (size_t)msi->data[at] * 3 * (size_t)msi->lights;
	}
	if (at == msi->bytes)
		return true;
	why->reached = 3 + pixels;
	snprintf(why->text, sizeof(why->text),
		 at < msi->bytes ? "goes on for %zu bytes after its last pixel"
				 : "ends %zu bytes too early",
		 at < msi->bytes ? msi->bytes - at : at - msi->bytes);
	return false;
}

/* 0; -EBADMSG, and why says what is wrong; -ENOMEM. */
static int try_variant(struct msi *msi, const struct msi_variant *variant, struct msi_verdict *why)
{
	*why = (struct msi_verdict){.reached = 0};
	if (!msi_read_header(msi, variant, why))
		return -EBADMSG;
	if ((size_t)msi->width * (size_t)msi->height > msi->bytes) {
		why->reached = 3;
		snprintf(why->text, sizeof(why->text), "has %zu bytes, too few for %d x %d pixels",
			 msi->bytes, msi->width, msi->height);
		return -EBADMSG;
	}
	msi->start = malloc((size_t)msi->width * (size_t)msi->height * sizeof(*msi->start));
	if (!msi->start)
		return -ENOMEM;
	if (msi_find_pixels(msi, why))
		return 0;
	free(msi->start);
	msi->start = NULL;
	return -EBADMSG;
}

static int map_file(struct msi *msi, const char *path, struct fault *fault)
{
	struct stat about;
	void *map;
	int err = 0, fd = input_open(path, fault);

	if (fd < 0)
		return fd;
	if (fstat(fd, &about)) {
		err = -errno;
	} else if (!S_ISREG(about.st_mode) || !about.st_size) {
		close(fd);
		return fault_say(fault, -EBADMSG, "%s: is empty or no file, expected an .msi",
				 path);
	} else {
		map = mmap(NULL, (size_t)about.st_size, PROT_READ, MAP_PRIVATE, fd, 0);
		err = map == MAP_FAILED ? -errno : 0;
		if (!err) {
			msi->data = map;
			msi->bytes = (size_t)about.st_size;
		}
	}
	close(fd);
	return err ? fault_say(fault, err, "%s: cannot be opened: %s", path, strerror(-err)) : 0;
}

int msi_open(struct msi *msi, const char *path, struct fault *fault)
{
	struct msi_verdict nearest = {.text = ""};
	int err;

	*msi = (struct msi){.data = NULL};
	err = map_file(msi, path, fault);
	if (err)
		return err;
	for (size_t k = 0; k < VARIANTS; k++) {
		struct msi_verdict why;

		err = try_variant(msi, &variants[k], &why);
		if (!err)
			return 0;
		if (err == -ENOMEM)
			break;
		if (!*nearest.text || why.reached > nearest.reached)
			nearest = why;
	}
	msi_close(msi);
	if (err == -ENOMEM)
		return fault_say(fault, err, "%s: out of memory", path);
	return fault_say(fault, err, "%s: %s: no .msi, or damaged", path, nearest.text);
}

void msi_close(struct msi *msi)
{
	if (msi->data)
		munmap((void *)(uintptr_t)msi->data, msi->bytes);
	free(msi->start);
	*msi = (struct msi){.data = NULL};
}

/* ---- as a source ---- */

/* Largest value of a pixel in shadow without the object, to which its row is scaled. */
static int most_of(const uint8_t *row, int lights)
{
	int most = 0;

	for (int i = 0; i < lights; i++)
		for (int c = 0; c < 3; c++)
			most = row[6 * i + c] > most ? row[6 * i + c] : most;
	return most;
}

/* Whether two rows without the object are equal up to a factor. */
static bool rows_alike(const uint8_t *a, const uint8_t *b, int lights)
{
	const double scale = (double)most_of(a, lights) / most_of(b, lights);

	for (int i = 0; i < lights; i++)
		for (int c = 0; c < 3; c++)
			if (fabs(a[6 * i + c] - scale * b[6 * i + c]) > FLAT_BYTES * fmax(scale, 1))
				return false;
	return true;
}

static bool is_flat(const struct msi *msi)
{
	const size_t pixels = (size_t)msi->width * (size_t)msi->height;
	const uint8_t *first = NULL;

	for (size_t p = 0; p < pixels; p++) {
		const uint8_t *row = msi->data + msi->start[p] + 1;

		if (row[-1] != THESIS_SHADOW || !most_of(row, msi->lights))
			continue;
		if (!first)
			first = row;
		else if (!rows_alike(first, row, msi->lights))
			return false;
	}
	return first;
}

int msi_source_create(struct msi_source *source, const struct msi *msi, const struct dome *dome,
		      const int *place, double rate)
{
	const int n = dome->count;

	*source = (struct msi_source){.msi = msi, .place = place, .rate = rate};
	if (!is_flat(msi))
		return 0;
	source->ground = calloc(3 * (size_t)n, sizeof(*source->ground));
	if (!source->ground)
		return -ENOMEM;
	for (int k = 0; k < 3 * n; k++)
		source->ground[k] = ALBEDO / M_PI * dome->projected_sr[k % n];
	return 0;
}

void msi_source_free(struct msi_source *source)
{
	free(source->ground);
	*source = (struct msi_source){.msi = NULL};
}

static void fill_shadow(const struct msi_source *source, const uint8_t *value, float *without,
			float *with)
{
	const int n = source->msi->lights;

	for (int k = 0; k < n; k++) {
		for (int c = 0; c < 3; c++) {
			const int at = c * n + source->place[k];
			const float bright = value[6 * k + c], left = value[6 * k + 3 + c];

			if (source->ground) {
				without[at] = (float)source->ground[at];
				with[at] = bright > 0 ? without[at] * left / bright : without[at];
			} else {
				without[at] = bright / 255;
				with[at] = left / 255;
			}
		}
	}
}

static void fill_object(const struct msi_source *source, const uint8_t *value, float *object)
{
	const int n = source->msi->lights;

	for (int k = 0; k < n; k++)
		for (int c = 0; c < 3; c++)
			object[c * n + source->place[k]] =
				(float)(source->rate / 255 * value[3 * k + c]);
}

void msi_fill(const void *context, struct import_tile *tile)
{
	const struct msi_source *source = context;
	const struct msi *msi = source->msi;

	for (int v = 0; v < tile->height; v++)
		for (int u = 0; u < tile->width; u++) {
			const size_t at = (size_t)(tile->y + v) * (size_t)msi->width +
					  (size_t)(tile->x + u);
			const uint8_t *row = msi->data + msi->start[at];
			const int p = v * BASIS_TILE + u;
			const size_t to = (size_t)p * 3 * (size_t)msi->lights;

			tile->coverage[p] = *row == THESIS_OBJECT;
			tile->receiver[p] = *row == THESIS_SHADOW;
			if (*row == THESIS_OBJECT)
				fill_object(source, row + 1, tile->object + to);
			else if (*row == THESIS_SHADOW)
				fill_shadow(source, row + 1, tile->without + to, tile->with + to);
		}
}

/* ---- writing ---- */

/* Puts a number in the byte order of most machines, little-endian. */
static void put_number(FILE *to, uint64_t value, int bytes)
{
	for (int k = 0; k < bytes; k++)
		putc((int)(value >> 8 * k & 255), to);
}

int msi_write(const char *path, const struct thesis *thesis, int width, int height, int lights,
	      struct fault *fault)
{
	struct output out = {.stream = NULL};
	uint64_t bytes = INTS * 4 + LONG_BYTES;
	const uint8_t *row;
	int err = output_open(&out, path, fault);

	if (err)
		return err;
	for (int p = 0; p < width * height; p++)
		bytes += 1 +
			 3 * (uint64_t)lights * thesis_pixel(thesis, p % width, p / width, &row);
	put_number(out.stream, (uint64_t)width, 4);
	put_number(out.stream, (uint64_t)height, 4);
	put_number(out.stream, (uint64_t)lights, 4);
	put_number(out.stream, bytes, LONG_BYTES);
	for (int p = 0; p < width * height; p++) {
		const enum thesis_role role = thesis_pixel(thesis, p % width, p / width, &row);

		putc((int)role, out.stream);
		if (role)
			fwrite(row, 3 * (size_t)role, (size_t)lights, out.stream);
	}
	return output_commit(&out, fault);
}
