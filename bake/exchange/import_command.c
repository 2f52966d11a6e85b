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

enum {
	OBJECT = 1,
	GROUND,
	ALONE,
	COVERAGE,
	MASK,
	MSI,
	RATE,
	ANGLES,
	TRANSFER,
	SCALE,
	RECEIVERS,
	THREADS,
	QUIET
};

static const struct option options[] = {
	{"output", required_argument, NULL, 'o'},
	{"object", required_argument, NULL, OBJECT},
	{"ground", required_argument, NULL, GROUND},
	{"alone", required_argument, NULL, ALONE},
	{"coverage", required_argument, NULL, COVERAGE},
	{"mask", required_argument, NULL, MASK},
	{"msi", required_argument, NULL, MSI},
	{"rate", required_argument, NULL, RATE},
	{"angles", required_argument, NULL, ANGLES},
	{"transfer", required_argument, NULL, TRANSFER},
	{"scale", required_argument, NULL, SCALE},
	{"receivers", required_argument, NULL, RECEIVERS},
	{"threads", required_argument, NULL, THREADS},
	{"quiet", no_argument, NULL, QUIET},
	ENCODING_OPTIONS,
	OPTIONS_OF_ALL,
	{NULL, 0, NULL, 0},
};

struct import_choices {
	const char *output, *msi, *angles;
	struct import_pictures_settings pictures;
	int transfer, receivers;
	bool of_pictures; /* options of pictures alone were given */
	double rate;	  /* 0: not given */
	struct encoding_choices encoding;
	struct import_settings import;
};

static int take_pictures(struct import_choices *c, int option, struct fault *fault)
{
	c->of_pictures = true;
	switch (option) {
	case OBJECT:
		c->pictures.object = optarg;
		return picture_pattern_check(optarg, "--object", fault);
	case GROUND:
		c->pictures.ground = optarg;
		return picture_pattern_check(optarg, "--ground", fault);
	case ALONE:
		c->pictures.alone = optarg;
		return picture_pattern_check(optarg, "--alone", fault);
	case COVERAGE:
		c->pictures.coverage = optarg;
		return 0;
	case MASK:
		c->pictures.mask = optarg;
		return 0;
	case TRANSFER:
		return option_choice("--transfer", optarg, transfer_names, &c->transfer, fault);
	case SCALE:
		return option_real("--scale", optarg, 1e-12, 1e12, &c->pictures.scale, fault);
	default:
		return option_choice("--receivers", optarg, import_receivers_names, &c->receivers,
				     fault);
	}
}

static int import_command_take(void *choices, int option, struct fault *fault)
{
	struct import_choices *c = choices;

	switch (option) {
	case 'o':
		c->output = optarg;
		return 0;
	case OBJECT:
	case GROUND:
	case ALONE:
	case COVERAGE:
	case MASK:
	case TRANSFER:
	case SCALE:
	case RECEIVERS:
		return take_pictures(c, option, fault);
	case MSI:
		c->msi = optarg;
		return 0;
	case RATE:
		return option_real("--rate", optarg, 1e-9, 1e9, &c->rate, fault);
	case ANGLES:
		c->angles = optarg;
		return 0;
	case THREADS:
		return option_int("--threads", optarg, 1, 1024, &c->import.threads, fault);
	case QUIET:
		c->import.quiet = true;
		return 0;
	default:
		return encoding_option_parse(&c->encoding, option, optarg, fault);
	}
}

static int import_pictures(const struct import_choices *c, const struct dome *dome,
			   const int *place, struct assembly_report *report, struct fault *fault)
{
	struct import_pictures_settings settings = c->pictures;
	char *folder = strdup(c->output);
	struct import_pictures pictures;
	int err;

	if (!folder)
		return fault_say(fault, -ENOMEM, "out of memory");
	settings.transfer = (enum transfer)c->transfer;
	settings.receivers = (enum import_receivers)c->receivers;
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

static int import_command_run(const struct bake_command *command, int argc, char **argv)
{
	struct import_choices c = {.pictures = {.scale = 1}, .encoding = ENCODING_UNCHOSEN};
	struct fault fault = {.text = ""};
	struct assembly_report report;
	const int status = command_options(command, argc, argv, options, import_command_take, &c);

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

const struct bake_command import_command = {
	.name = "import",
	.usage =
		"--angles A.txt -o OUT.inlay\n"
		"           (--object 'o%03d.hdr' --ground 'g%03d.hdr' [--alone 'a%03d.hdr'] (--coverage C.png | --mask M.png) |\n"
		"            --msi F.msi [--rate R])\n"
		"           [--transfer T] [--scale X] [--receivers auto|flat|own]\n"
		"           " ENCODING_USAGE " [--threads T] [--quiet]",
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
