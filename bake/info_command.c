/* inlay-bake info: what a basis file holds. */
#include <getopt.h>
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "bake/options.h"
#include "hal/basis/basis.h"
#include "hal/image/image.h"
#include "hal/log.h"
#include "hal/optics/dome.h"

enum { JSON = 1, MAP };

static const struct option options[] = {
	{"json", no_argument, NULL, JSON},
	{"map", required_argument, NULL, MAP},
	OPTIONS_OF_ALL,
	{NULL, 0, NULL, 0},
};

static const char *const kind_names[BASIS_KIND_COUNT] = {"T", "V", "D", "U"};
static const char *const kind_meanings[BASIS_KIND_COUNT] = {
	"object", "shadow on shared ground", "change of own surfaces", "light of own surfaces"};

struct kind_sum {
	long blocks, pixels;
	uint64_t bytes;
	double lights; /* summed over pixels */
};

struct summary {
	struct kind_sum kind[BASIS_KIND_COUNT];
	long tiles, tiles_used, covered;
	uint64_t bytes;
};

static struct summary summarise(const struct basis *basis)
{
	struct summary s = {.tiles = 0};
	const long pixels = (long)basis->info.width * basis->info.height;

	s.bytes = basis->map_bytes;
	for (uint32_t p = 0; p < basis->info.poses; p++) {
		const struct basis_pose *pose = &basis->poses[p];

		for (int t = 0; t < basis->tiles_across * basis->tiles_down; t++) {
			s.tiles++;
			s.tiles_used += pose->tiles[t].block_count > 0;
		}
		for (int b = 0; b < pose->block_count; b++) {
			const struct basis_block *block = &pose->blocks[b];
			struct kind_sum *sum = &s.kind[block->kind];

			sum->blocks++;
			sum->pixels += block->pixels;
			sum->bytes += block->bytes;
			sum->lights += (double)block->pixels * block->lights;
		}
		for (long i = 0; i < pixels; i++)
			s.covered += pose->coverage[i] > 0;
	}
	return s;
}

static const char *division_name(const struct basis *basis)
{
	return basis->info.dome_division < DOME_DIVISION_COUNT
		       ? dome_division_names[basis->info.dome_division]
		       : "unknown";
}

static void print_text(const struct basis *basis, const struct summary *s, const char *path)
{
	const struct basis_info_chunk *info = &basis->info;

	printf("%s: %u x %u, %u lights (dome frequency %u, %s), %u pose%s, %.2f MB\n", path,
	       info->width, info->height, info->lights, info->dome_frequency, division_name(basis),
	       info->poses, info->poses == 1 ? "" : "s", (double)s->bytes * 1e-6);
	printf("tiles: %ld of %ld hold something; the object covers %ld pixels\n", s->tiles_used,
	       s->tiles, s->covered);
	for (int k = 0; k < BASIS_KIND_COUNT; k++)
		if (s->kind[k].blocks)
			printf("%s (%s): %ld blocks, %ld pixels, %.1f lights a pixel, %.2f MB\n",
			       kind_names[k], kind_meanings[k], s->kind[k].blocks,
			       s->kind[k].pixels, s->kind[k].lights / (double)s->kind[k].pixels,
			       (double)s->kind[k].bytes * 1e-6);
	printf("declared errors: object %.3g of the lights' sum, ratio %.3g, noise %.3g levels\n",
	       info->object_error, info->ratio_error, info->noise_levels);
	printf("%s%s", basis->camera, basis->provenance);
}

/* Text as a JSON string. */
static void print_string(const char *text)
{
	putchar('"');
	for (const unsigned char *c = (const unsigned char *)text; *c; c++)
		if (*c == '"' || *c == '\\')
			printf("\\%c", *c);
		else if (*c < 0x20 || *c >= 0x7f)
			printf("\\u%04x", *c);
		else
			putchar(*c);
	putchar('"');
}

static void print_json(const struct basis *basis, const struct summary *s)
{
	const struct basis_info_chunk *info = &basis->info;

	printf("{\"width\": %u, \"height\": %u, \"lights\": %u, \"dome_frequency\": %u, "
	       "\"dome_division\": \"%s\", \"poses\": %u, \"grounds\": %u, \"bytes\": %" PRIu64
	       ", \"tiles\": %ld, \"tiles_used\": %ld, \"covered_pixels\": %ld, \"blocks\": {",
	       info->width, info->height, info->lights, info->dome_frequency, division_name(basis),
	       info->poses, info->grounds, s->bytes, s->tiles, s->tiles_used, s->covered);
	for (int k = 0; k < BASIS_KIND_COUNT; k++)
		printf("%s\"%s\": {\"blocks\": %ld, \"pixels\": %ld, \"lights\": %.0f, \"bytes\": "
		       "%" PRIu64 "}",
		       k ? ", " : "", kind_names[k], s->kind[k].blocks, s->kind[k].pixels,
		       s->kind[k].lights, s->kind[k].bytes);
	printf("}, \"object_error\": %.9g, \"ratio_error\": %.9g, \"noise_levels\": %.9g, "
	       "\"camera\": ",
	       info->object_error, info->ratio_error, info->noise_levels);
	print_string(basis->camera);
	printf(", \"provenance\": ");
	print_string(basis->provenance);
	printf("}\n");
}

/* ---- maps ---- */

/* Coverage in green over the number of lights that a pixel's receiver blocks hold, in red, and
 * bytes of its tile in blue, each against its largest. */
static int write_map(const struct basis *basis, const char *path, struct fault *fault)
{
	const int width = (int)basis->info.width, height = (int)basis->info.height;
	const struct basis_pose *pose = &basis->poses[0];
	const int tiles = basis->tiles_across * basis->tiles_down;
	struct image image;
	size_t most = 1;
	int err = image_create_u8(&image, width, height);

	if (err)
		return fault_say(fault, err, "%s: out of memory", path);
	for (int t = 0; t < tiles; t++)
		most = pose->tiles[t].bytes > most ? pose->tiles[t].bytes : most;
	for (int t = 0; t < tiles; t++) {
		const struct basis_tile *tile = &pose->tiles[t];

		for (int y = tile->y; y < tile->y + tile->height; y++)
			for (int x = tile->x; x < tile->x + tile->width; x++) {
				const size_t at = (size_t)y * (size_t)width + (size_t)x;

				image.u8[3 * at + 1] = (uint8_t)(pose->coverage[at] >> 8);
				image.u8[3 * at + 2] = (uint8_t)(255 * tile->bytes / most);
			}
		for (int b = 0; b < tile->block_count; b++) {
			const struct basis_block *block = &tile->blocks[b];

			if (block->kind != BASIS_KIND_V && block->kind != BASIS_KIND_D)
				continue;
			for (int p = 0; p < block->pixels; p++) {
				const int x = tile->x + block->pixel[p] % BASIS_TILE;
				const int y = tile->y + block->pixel[p] / BASIS_TILE;

				image.u8[3 * ((size_t)y * (size_t)width + (size_t)x)] =
					(uint8_t)(255 * (long)block->lights /
						  (long)basis->info.lights);
			}
		}
	}
	err = image_write(path, &image, fault);
	image_free(&image);
	return err;
}

static int run(const struct command *command, int argc, char **argv)
{
	struct fault fault = {.text = ""};
	const char *map = NULL;
	struct summary summary;
	struct basis basis;
	int option, json = 0, err;

	while ((option = getopt_long(argc, argv, "", options, NULL)) != -1)
		switch (option) {
		case JSON:
			json = 1;
			break;
		case MAP:
			map = optarg;
			break;
		default:
			return command_answer(command, option);
		}
	if (optind + 1 != argc)
		return command_wrong(command, "expected one basis file");
	err = basis_open(&basis, argv[optind], &fault);
	if (!err && map)
		err = write_map(&basis, map, &fault);
	if (err) {
		log_error("%s", fault.text);
		basis_close(&basis);
		return EXIT_FAILURE;
	}
	summary = summarise(&basis);
	if (json)
		print_json(&basis, &summary);
	else
		print_text(&basis, &summary, argv[optind]);
	basis_close(&basis);
	return EXIT_SUCCESS;
}

const struct command info_command = {
	.name = "info",
	.usage = "FILE [--json] [--map OUT.png]",
	.summary = "say what a basis file holds",
	.help = "\n"
		"  --json      everything, for programs\n"
		"  --map F     a picture: coverage in green, lights stored for real surfaces in "
		"red,\n"
		"              bytes of each tile in blue\n",
	.run = run,
};
