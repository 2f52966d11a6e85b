/* inlay-bake render: a scene file to a basis file. */
#include <getopt.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "bake/options.h"
#include "bake/render.h"
#include "hal/log.h"
#include "hal/optics/dome.h"

enum {
	FREQUENCY = 1,
	DIVISION,
	SIZE,
	SAMPLES,
	NOISE,
	SEED,
	THREADS,
	QUIET,
	SAMPLE_FILE,
	ERROR,
	CELL_ERROR,
	COLUMN_CUT,
	COARSE,
	EXACT
};

static const struct option options[] = {
	{"output", required_argument, NULL, 'o'},
	{"frequency", required_argument, NULL, FREQUENCY},
	{"division", required_argument, NULL, DIVISION},
	{"size", required_argument, NULL, SIZE},
	{"samples", required_argument, NULL, SAMPLES},
	{"noise", required_argument, NULL, NOISE},
	{"seed", required_argument, NULL, SEED},
	{"error", required_argument, NULL, ERROR},
	{"cell-error", required_argument, NULL, CELL_ERROR},
	{"column-cut", required_argument, NULL, COLUMN_CUT},
	{"coarse", required_argument, NULL, COARSE},
	{"exact", no_argument, NULL, EXACT},
	{"threads", required_argument, NULL, THREADS},
	{"quiet", no_argument, NULL, QUIET},
	{"print-scene", no_argument, NULL, SAMPLE_FILE},
	OPTIONS_OF_ALL,
	{NULL, 0, NULL, 0},
};

/* What the command line says; -1 where it says nothing. */
struct choices {
	const char *output;
	int frequency, division, width, height, samples, seed, threads;
	int coarse;
	double noise, error, error_max, cell_error, column_cut;
	bool exact, quiet;
};

#define LEVELS_MIN 1e-3
#define LEVELS_MAX 255

/* RMS[,MAX] */
static int take_error(struct choices *c, char *text, struct fault *fault)
{
	char *comma = strchr(text, ',');
	int err = 0;

	if (comma) {
		*comma = '\0';
		err = option_real("--error", comma + 1, LEVELS_MIN, LEVELS_MAX, &c->error_max,
				  fault);
	}
	return err ? err : option_real("--error", text, LEVELS_MIN, LEVELS_MAX, &c->error, fault);
}

static int take(struct choices *c, int option, struct fault *fault)
{
	switch (option) {
	case 'o':
		c->output = optarg;
		return 0;
	case FREQUENCY:
		return option_int("--frequency", optarg, 1, DOME_FREQUENCY_MAX, &c->frequency,
				  fault);
	case DIVISION:
		return option_choice("--division", optarg, dome_division_names, &c->division,
				     fault);
	case SIZE:
		return option_size("--size", optarg, &c->width, &c->height, fault);
	case SAMPLES:
		return option_int("--samples", optarg, 1, 65536, &c->samples, fault);
	case NOISE:
		return option_real("--noise", optarg, 1e-3, 255, &c->noise, fault);
	case SEED:
		return option_int("--seed", optarg, 0, 2147483647, &c->seed, fault);
	case THREADS:
		return option_int("--threads", optarg, 1, 1024, &c->threads, fault);
	case ERROR:
		return take_error(c, optarg, fault);
	case CELL_ERROR:
		return option_real("--cell-error", optarg, LEVELS_MIN, LEVELS_MAX, &c->cell_error,
				   fault);
	case COLUMN_CUT:
		return option_real("--column-cut", optarg, 0, 0.1, &c->column_cut, fault);
	case COARSE:
		return option_int("--coarse", optarg, 1, DOME_FREQUENCY_MAX, &c->coarse, fault);
	case EXACT:
		c->exact = true;
		return 0;
	default:
		c->quiet = true;
		return 0;
	}
}

static void override(struct render_settings *s, const struct choices *c)
{
	if (c->frequency >= 0)
		s->frequency = c->frequency;
	if (c->division >= 0)
		s->division = c->division;
	if (c->samples >= 0) {
		s->samples = c->samples;
		s->noise_levels = 0;
	}
	if (c->noise >= 0)
		s->noise_levels = c->noise;
	if (c->seed >= 0)
		s->seed = c->seed;
	if (c->error >= 0) {
		s->target.rms = c->error;
		s->target.max = c->error_max > 0 ? c->error_max : 0;
	}
	if (c->cell_error >= 0)
		s->target.cell = c->cell_error;
	if (c->column_cut >= 0)
		s->column_cut = c->column_cut;
	if (c->coarse >= 0)
		s->coarse = c->coarse;
	s->exact |= c->exact;
	s->threads = c->threads;
	s->quiet = c->quiet;
}

static void print_report(const char *path, const struct render_report *report)
{
	const struct basis_info_chunk *info = &report->info;

	printf("%s: rays %llu (%.2f million/s), time %.1f s, noise %.2f levels, ", path,
	       (unsigned long long)report->rays, (double)report->rays / report->seconds * 1e-6,
	       report->seconds, info->noise_levels);
	printf("encoded in %.2f MB", (double)report->shown_bytes * 1e-6);
	if (report->exact_bytes)
		printf(" (exact layer %.2f MB)", (double)report->exact_bytes * 1e-6);
	printf(", error in levels RMS / most: skies %.2f / %.1f, cells %.2f / %.1f\n",
	       info->sky_rms, info->sky_max, info->cell_rms, info->cell_max);
}

static int bake(const char *path, const struct choices *c)
{
	struct fault fault = {.text = ""};
	struct render_report report = {.rays = 0};
	struct render_settings settings;
	struct scene *scene;
	int err = scene_open(&scene, path, c->width, c->height, &fault);

	if (!err) {
		settings = render_settings_of(scene);
		override(&settings, c);
		err = render_run(scene, &settings, c->output, &report, &fault);
		scene_close(scene);
	}
	if (err) {
		log_error("%s", fault.text);
		return EXIT_FAILURE;
	}
	if (!report.object_seen)
		log_warning("%s: the camera sees no object; expected one in the picture: look at "
			    "[camera], and at position, scale and up of [object]",
			    path);
	if (!c->quiet)
		print_report(c->output, &report);
	return EXIT_SUCCESS;
}

static int run(const struct command *command, int argc, char **argv)
{
	struct choices c = {.frequency = -1,
			    .division = -1,
			    .samples = -1,
			    .seed = -1,
			    .coarse = -1,
			    .noise = -1,
			    .error = -1,
			    .error_max = -1,
			    .cell_error = -1,
			    .column_cut = -1};
	struct fault fault = {.text = ""};
	int option, err = 0;

	while (!err && (option = getopt_long(argc, argv, "o:", options, NULL)) != -1) {
		if (option == OPTION_HELP || option == OPTION_VERSION || option == '?')
			return command_answer(command, option);
		if (option == SAMPLE_FILE) {
			scene_file_write_sample(stdout);
			return EXIT_SUCCESS;
		}
		err = take(&c, option, &fault);
	}
	if (err)
		return command_wrong(command, "%s", fault.text);
	if (c.samples >= 0 && c.noise >= 0)
		return command_wrong(command, "--samples and --noise exclude each other");
	if (optind + 1 != argc)
		return command_wrong(command, "expected one scene file");
	if (!c.output)
		return command_wrong(command, "-o OUT.inlay is missing");
	return bake(argv[optind], &c);
}

const struct command render_command = {
	.name = "render",
	.usage = "SCENE -o OUT.inlay [--frequency F] [--division D] [--size WxH]\n"
		 "           [--samples S | --noise LEVELS] [--error RMS[,MAX]] [--cell-error "
		 "LEVELS]\n"
		 "           [--column-cut X] [--coarse F] [--exact] [--seed K] [--threads T] "
		 "[--quiet]",
	.summary = "bake a scene: all its light transport, to a basis file",
	.help = "\n"
		"  -o FILE         the basis file; appears when it is whole\n"
		"  --frequency F   of the dome, 1 to 64; 9 makes 406 lights\n"
		"  --division D    angles or chords\n"
		"  --size WxH      of the picture\n"
		"  --samples S     camera rays a pixel\n"
		"  --noise LEVELS  as many as bring the estimated standard error below this,\n"
		"                  in 8-bit levels under a uniform sky\n"
		"  --error R[,M]   what the encoding may be off by under a sky, in each tile:\n"
		"                  RMS and any pixel, in 8-bit levels; M: twice R\n"
		"  --cell-error L  what any pixel may be off by where one cell gives all light\n"
		"  --column-cut X  what a light's own correction may change, as linear light,\n"
		"                  and yet be left out of a frame\n"
		"  --coarse F      frequency of the dome over which smooth light is gathered\n"
		"  --exact         store every light in 16 bits as well, for the exact mode\n"
		"  --seed K        of all random numbers; the same file whatever the threads\n"
		"  --threads T     default: one for each processor\n"
		"  --quiet         print nothing but errors\n"
		"  --print-scene   a scene file with every key, its default and its meaning\n"
		"\n"
		"Options go before the scene file. bake/README.md describes the format.\n",
	.run = run,
};
