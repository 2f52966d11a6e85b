/* SPDX-License-Identifier: MIT */

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "bake/base/picture_file.h"
#include "bake/mesh/formats/soup.h"

#define BLUE_LEAST 32 /* of 255: what a map of normals has more of blue than of red, on the mean */

/* ---- pictures ---- */

static int texture_lack(const struct textures *textures)
{
	return fault_say(textures->fault, -ENOMEM, "%s: out of memory", textures->mesh_path);
}

static int texture_find(const struct textures *textures, const struct texture_name *name,
			char path[PATH_MAX])
{
	path[0] = '\0';
	if (!name || !name->by || beside_find(name->by, name->name, path) ||
	    beside_find(textures->mesh_path, name->name, path))
		return 0;
	return fault_say(
		textures->fault, -ENOENT,
		"%s:%d: there is no picture %s, expected it there or, by its bare name, beside this file",
		name->by, name->line, name->name);
}

/* Reads a picture, if there is a path. */
static int read_picture(const char *path, struct image *image, struct fault *fault)
{
	*image = (struct image){.width = 0};
	return path[0] ? picture_file_read(path, image, fault) : 0;
}

/* Value of a channel, 0..255. */
static uint8_t image_code(const struct image *image, size_t pixel, int channel)
{
	const size_t at = 3 * pixel + (size_t)channel;

	if (image->f32)
		return (uint8_t)(255 * fminf(image->f32[at], 1) + 0.5f);
	if (image->u16)
		return (uint8_t)((image->u16[at] + 128) / 257);
	return image->u8[at];
}

/* Stretches n values of a row to more. */
static void *stretch(const void *from, size_t size, int w, int h, int width, int height)
{
	const char *values = from;
	char *out = values ? malloc((size_t)width * (size_t)height * size) : NULL;

	for (int y = 0; y < height && out; y++)
		for (int x = 0; x < width; x++) {
			const size_t at = (size_t)((int64_t)y * h / height) * (size_t)w +
					  (size_t)((int64_t)x * w / width);

			memcpy(out + ((size_t)y * (size_t)width + (size_t)x) * size,
			       values + at * size, size);
		}
	return out;
}

/* Enlarges a picture by repeating pixels. */
static bool image_stretch(struct image *image, int width, int height)
{
	const int w = image->width, h = image->height;
	struct image large = {.width = width, .height = height};

	if (w == width && h == height)
		return true;
	large.u8 = stretch(image->u8, 3, w, h, width, height);
	large.u16 = stretch(image->u16, 3 * sizeof(uint16_t), w, h, width, height);
	large.f32 = stretch(image->f32, 3 * sizeof(float), w, h, width, height);
	large.alpha = stretch(image->alpha, 1, w, h, width, height);
	if (!image->u8 != !large.u8 || !image->u16 != !large.u16 || !image->f32 != !large.f32 ||
	    !image->alpha != !large.alpha) {
		image_free(&large);
		return false;
	}
	image_free(image);
	*image = large;
	return true;
}

/* Brings two pictures to the size of the larger one. One that is missing is white. */
static bool same_size(struct image picture[2])
{
	int width = 1, height = 1;

	for (int k = 0; k < 2; k++) {
		if (!picture[k].width) {
			if (image_create_u8(&picture[k], 1, 1) < 0)
				return false;
			memset(picture[k].u8, 255, 3);
		}
		width = picture[k].width > width ? picture[k].width : width;
		height = picture[k].height > height ? picture[k].height : height;
	}
	return image_stretch(&picture[0], width, height) &&
	       image_stretch(&picture[1], width, height);
}

/* The second is the coverage of the first. */
static int image_cover(struct image picture[2])
{
	struct image *image = &picture[0], *coverage = &picture[1];
	size_t pixels;

	if (!same_size(picture))
		return -ENOMEM;
	pixels = (size_t)image->width * (size_t)image->height;
	free(image->alpha);
	image->alpha = malloc(pixels);
	if (!image->alpha)
		return -ENOMEM;
	for (size_t k = 0; k < pixels; k++)
		image->alpha[k] = coverage->alpha ? coverage->alpha[k] : image_code(coverage, k, 1);
	return 0;
}

/* ---- textures ---- */

/* Finds a texture that is made of the same; else adds an empty one, in *added. */
static int textures_take(struct textures *textures, char path[2][PATH_MAX], enum texture_kind kind,
			 enum texture_wrap wrap, const struct texture **texture,
			 struct texture **added)
{
	struct mesh *mesh = textures->mesh;
	const size_t count = (size_t)mesh->texture_count;
	char key[2 * PATH_MAX + 64];
	struct texture **grown;
	char **keys;

	*added = NULL;
	snprintf(key, sizeof(key), "%d %d %s\n%s", (int)kind, (int)wrap, path[0], path[1]);
	for (size_t k = 0; k < count; k++)
		if (strcmp(textures->key[k], key) == 0) {
			*texture = mesh->textures[k];
			return 0;
		}
	grown = realloc(mesh->textures, (count + 1) * sizeof(*grown));
	if (grown)
		mesh->textures = grown;
	keys = realloc(textures->key, (count + 1) * sizeof(*keys));
	if (keys)
		textures->key = keys;
	if (!grown || !keys)
		return texture_lack(textures);
	keys[count] = strdup(key);
	grown[count] = calloc(1, sizeof(**grown));
	if (!keys[count] || !grown[count]) {
		free(keys[count]);
		free(grown[count]);
		return texture_lack(textures);
	}
	grown[count]->wrap[0] = grown[count]->wrap[1] = wrap;
	mesh->texture_count++;
	*texture = *added = grown[count];
	return 0;
}

static int image_pack(struct image *packed, struct image picture[2])
{
	size_t pixels;

	if (!same_size(picture) || image_create_u8(packed, picture[0].width, picture[0].height) < 0)
		return -ENOMEM;
	pixels = (size_t)packed->width * (size_t)packed->height;
	for (size_t k = 0; k < pixels; k++) {
		packed->u8[3 * k] = 255;
		packed->u8[3 * k + 1] = image_code(&picture[0], k, 0);
		packed->u8[3 * k + 2] = image_code(&picture[1], k, 0);
	}
	return 0;
}

/* Makes a texture of two pictures. -ENOMEM. */
static int texture_fill(struct texture *texture, enum texture_kind kind, struct image picture[2])
{
	if (kind == TEXTURE_OF_COLOURS)
		texture_prepare(texture);
	else
		texture_prepare_data(texture);
	if (kind == TEXTURE_OF_SURFACES)
		return image_pack(&texture->image, picture);
	if (picture[1].width && image_cover(picture) < 0)
		return -ENOMEM;
	texture->image = picture[0];
	picture[0] = (struct image){.width = 0};
	return picture_file_decode(&texture->image, kind == TEXTURE_OF_DATA);
}

/* Reads the pictures of a texture that has just been added, and takes the memory of one as large as
 * both. A file of several textures counts once. */
static int textures_read(struct textures *textures, const char path[2][PATH_MAX],
			 struct image picture[2])
{
	double width = 0, height = 0, pixel = 4;
	struct stat about;
	int err = 0;

	for (int k = 0; k < 2 && !err; k++) {
		bool known = !path[k][0];

		for (int other = 0; other + 1 < textures->mesh->texture_count && !known; other++)
			known = strstr(textures->key[other], path[k]);
		if (!known && stat(path[k], &about) == 0)
			textures->budget.file_bytes += (uint64_t)about.st_size;
		err = read_picture(path[k], &picture[k], textures->fault);
		width = fmax(width, picture[k].width);
		height = fmax(height, picture[k].height);
		pixel = picture[k].u8 || !picture[k].width ? pixel : 3 * sizeof(float) + 1;
	}
	return err ? err
		   : budget_take(&textures->budget, width * height * pixel, textures->mesh_path,
				 textures->fault);
}

int textures_get(struct textures *textures, enum texture_kind kind,
		 const struct texture_name *first, const struct texture_name *second,
		 enum texture_wrap wrap, const struct texture **texture)
{
	char path[2][PATH_MAX];
	struct image picture[2] = {{.width = 0}, {.width = 0}};
	struct texture *added = NULL;
	int err = texture_find(textures, first, path[0]);

	if (!err)
		err = texture_find(textures, second, path[1]);
	if (!err)
		err = textures_take(textures, path, kind, wrap, texture, &added);
	if (added && !err)
		err = textures_read(textures, path, picture);
	if (added && !err && texture_fill(added, kind, picture) < 0)
		err = texture_lack(textures);
	image_free(&picture[0]);
	image_free(&picture[1]);
	return err;
}

bool texture_has_normals(const struct texture *texture)
{
	const struct image *image = &texture->image;
	const size_t pixels = (size_t)image->width * (size_t)image->height;
	double sum = 0;

	for (size_t k = 0; k < pixels; k++)
		sum += image_code(image, k, 2) - image_code(image, k, 0);
	return sum > BLUE_LEAST * (double)pixels;
}

void textures_free(struct textures *textures)
{
	for (int k = 0; textures->key && k < textures->mesh->texture_count; k++)
		free(textures->key[k]);
	free(textures->key);
	textures->key = NULL;
}
