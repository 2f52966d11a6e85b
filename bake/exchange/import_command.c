/* SPDX-License-Identifier: MIT */
/* inlay-bake import: pictures of other renderers, and the thesis's files, to a basis file. */
#include <errno.h>
#include <getopt.h>
#include <libgen.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "bake/base/angles.h"
#include "bake/base/commands.h"
#include "bake/encode/encoding_options.h"
#include "bake/exchange/import_pictures.h"
#include "bake/exchange/msi.h"
#include "bake/exchange/pictures.h"
#include "bake/scene/scene_file.h"
#include "hal/base/log.h"
#include "hal/base/output.h"

struct import_choices {
	const char *output, *msi, *angles;
	struct import_pictures_settings pictures;
	bool of_pictures; /* options of pictures alone were given */
	double rate;	  /* 0: not given */
	struct encoding_choices encoding;
	struct import_settings import;
};

#define AT(field) .place = offsetof(struct import_choices, field)
#define OF_PICTURES .given = offsetof(struct import_choices, of_pictures)

static const struct option_row options[] = {
	{"output", OPTION_TEXT, AT(output)},
	{"object", OPTION_OTHER, AT(pictures.object), .take = picture_pattern_take, OF_PICTURES},
	{"ground", OPTION_OTHER, AT(pictures.ground), .take = picture_pattern_take, OF_PICTURES},
	{"alone", OPTION_OTHER, AT(pictures.alone), .take = picture_pattern_take, OF_PICTURES},
	{"coverage", OPTION_TEXT, AT(pictures.coverage), OF_PICTURES},
	{"mask", OPTION_TEXT, AT(pictures.mask), OF_PICTURES},
	{"msi", OPTION_TEXT, AT(msi)},
	{"rate", OPTION_REAL, AT(rate), .min = 1e-9, .max = 1e9},
	{"angles", OPTION_TEXT, AT(angles)},
	{"transfer", OPTION_CHOICE, AT(pictures.transfer), .choices = transfer_names, OF_PICTURES},
	{"scale", OPTION_REAL, AT(pictures.scale), .min = 1e-12, .max = 1e12, OF_PICTURES},
	{"receivers", OPTION_CHOICE, AT(pictures.receivers), .choices = import_receivers_names,
	 OF_PICTURES},
	{"threads", OPTION_INT, AT(import.threads), .min = 1, .max = 1024},
	{"quiet", OPTION_FLAG, AT(import.quiet)},
	ENCODING_ROWS,
	{.name = NULL},
};

static int import_pictures(const struct import_choices *c, const struct dome *dome,
			   const int *place, struct assembly_report *report, struct fault *fault)
{
	struct import_pictures_settings settings = c->pictures;
	char *folder = strdup(c->output);
	struct import_pictures pictures;
	int err;

	if (!folder)
		return fault_say(fault, -ENOMEM, "out of memory");
	settings.folder = dirname(folder);
	settings.quiet = c->import.quiet;
	err = import_pictures_read(&pictures, dome, place, &settings, fault);
	if (!err) {
		const struct import_source source = {
			.width = pictures.with.width,
			.height = pictures.with.height,
			.dome = dome,
			.ground = pictures.flat ? pictures.ground : NULL,
			.provenance = "source = pictures\n",
			.fill = import_pictures_fill,
			.context = &pictures,
		};

		err = import_run(&source, &c->import, c->output, report, fault);
		import_pictures_free(&pictures);
	}
	free(folder);
	return err;
}

static int import_msi(const struct import_choices *c, const struct dome *dome, const int *place,
		      struct assembly_report *report, struct fault *fault)
{
	struct msi_source from;
	struct msi msi;
	int err = msi_open(&msi, c->msi, fault);

	if (err)
		return err;
	if (msi.lights != dome->count)
		err = fault_say(fault, -EINVAL, "%s: %d lights, expected %d as in %s", c->msi,
				msi.lights, dome->count, c->angles);
	else if (msi_source_create(&from, &msi, dome, place, c->rate > 0 ? c->rate : 1))
		err = fault_say(fault, -ENOMEM, "%s: out of memory", c->msi);
	if (!err) {
		const struct import_source source = {
			.width = msi.width,
			.height = msi.height,
			.dome = dome,
			.ground = from.ground,
			.provenance = "source = msi\n",
			.fill = msi_fill,
			.context = &from,
		};

		err = import_run(&source, &c->import, c->output, report, fault);
		msi_source_free(&from);
	}
	msi_close(&msi);
	return err;
}

/* Sets the encoding: the defaults of a scene's [render], changed by the options. */
static void set_encoding(struct import_choices *c)
{
	struct scene_render_values scene;
	struct import_settings *s = &c->import;

	scene_render_defaults(&scene);
	s->target = (struct encode_target){
		.rms = scene.error_rms, .max = scene.error_max, .cell = scene.error_cell};
	s->column_cut = scene.column_cut;
	s->coarse = scene.coarse;
	s->exact = scene.exact;
	encoding_choices_apply(&c->encoding, &s->target, &s->column_cut, &s->coarse, &s->exact);
}

static int run_import(const struct import_choices *c, struct assembly_report *report,
		      struct fault *fault)
{
	struct dome dome;
	int *place;
	const char *const read[] = {c->angles, c->msi, c->pictures.mask};
	int err = output_check(&c->output, 1, read, 3, fault);

	if (!err)
		err = angles_read(c->angles, &dome, &place, fault);
	if (err)
		return err;
	err = c->msi ? import_msi(c, &dome, place, report, fault)
		     : import_pictures(c, &dome, place, report, fault);
	free(place);
	dome_free(&dome);
	return err;
}

/* What is missing or contradictory in the options, or NULL. */
static const char *wrong_usage(const struct import_choices *c)
{
	const struct import_pictures_settings *p = &c->pictures;

	if (!c->output)
		return "-o OUT.inlay is missing";
	if (!c->angles)
		return "--angles FILE is missing";
	if (c->msi && c->of_pictures)
		return "--msi and options of pictures exclude each other";
	if (c->rate > 0 && !c->msi)
		return "--rate is of --msi";
	if (!c->msi && (!p->object || !p->ground))
		return "expected --object and --ground, or --msi";
	if (!c->msi && !p->coverage == !p->mask)
		return "expected one of --coverage and --mask";
	return NULL;
}

static int import_command_run(const struct command *command, int argc, char **argv)
{
	struct import_choices c = {.pictures = {.scale = 1}, .encoding = ENCODING_UNCHOSEN};
	struct fault fault = {.text = ""};
	struct assembly_report report;
	const int status = command_read(command, argc, argv, options, &c);

	if (status != COMMAND_GOES_ON)
		return status;
	if (optind != argc)
		return command_wrong(command, "\"%s\" is one argument too many", argv[optind]);
	if (wrong_usage(&c))
		return command_wrong(command, "%s", wrong_usage(&c));
	set_encoding(&c);
	if (run_import(&c, &report, &fault)) {
		log_error("%s", fault.text);
		return EXIT_FAILURE;
	}
	return assembly_conclude(&report.miss, c.output);
}

const struct command import_command = {
	.name = "import",
	.usage =
		"--angles A.txt -o OUT.inlay [options]\n"
		"           (--object 'o%03d.hdr' --ground 'g%03d.hdr' (--coverage C.png | --mask M.png) | --msi F.msi)",
	.summary = "make a basis of other renderers' pictures, or of an .msi",
	.help = "\n"
		"  --angles FILE       the lights, one a line: theta phi in radians, a dome's in any order\n"
		"  --object PATTERN    objects and ground under each light, in the order of the angles\n"
		"  --ground PATTERN    ground alone\n"
		"  --alone PATTERN     what is seen of the objects, over black; without it, what their edge\n"
		"                      shows of the ground is taken from beside it\n"
		"  --coverage FILE     the objects' share of each pixel, black to white\n"
		"  --mask FILE         the same without shares: at least half white is object\n"
		"  --transfer T        of 8-bit pictures: srgb, bt709, linear\n"
		"  --scale X           multiplies all pictures: to lights of radiance 1\n"
		"  --receivers R       flat: level ground, lit alike; own: each pixel by itself; auto: as the\n"
		"                      pictures show it\n"
		"  --msi FILE          the thesis's format, of either byte order and size of long\n"
		"  --rate R            its light rate: light that 255 of an object stands for; 1\n"
		"  -o FILE             the basis file; appears when it is whole\n" ENCODING_HELP
		"  --threads T         default: one for each processor\n"
		"  --quiet             print nothing but errors\n\n"
		"Pictures are .hdr, .pfm, .exr, .png or .jpg. Each light is its cell of the dome, of radiance\n"
		"1, and nothing else shines. Exit code 3: done, but some tile is off by more than was asked\n"
		"for; the file is kept.\n",
	.run = import_command_run,
};
