/* inlay-bake render: a scene file to a basis file. */
#include <getopt.h>
#include <stdio.h>
#include <stdlib.h>

#include "bake/options.h"
#include "bake/render.h"
#include "hal/log.h"
#include "hal/optics/dome.h"

enum { FREQUENCY = 1, DIVISION, SIZE, SAMPLES, NOISE, SEED, THREADS, QUIET, SAMPLE_FILE };

static const struct option options[] = {
	{"output", required_argument, NULL, 'o'},
	{"frequency", required_argument, NULL, FREQUENCY},
	{"division", required_argument, NULL, DIVISION},
	{"size", required_argument, NULL, SIZE},
	{"samples", required_argument, NULL, SAMPLES},
	{"noise", required_argument, NULL, NOISE},
	{"seed", required_argument, NULL, SEED},
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
	double noise;
	bool quiet;
};

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
	s->threads = c->threads;
	s->quiet = c->quiet;
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
		printf("%s: rays %llu (%.2f million/s), time %.1f s, noise %.2f levels, object "
		       "error %.2g, ratio error %.2g\n",
		       c->output, (unsigned long long)report.rays,
		       (double)report.rays / report.seconds * 1e-6, report.seconds,
		       report.noise_levels, report.object_error, report.ratio_error);
	return EXIT_SUCCESS;
}

static int run(const struct command *command, int argc, char **argv)
{
	struct choices c = {
		.frequency = -1, .division = -1, .samples = -1, .seed = -1, .noise = -1};
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
		 "           [--samples S | --noise LEVELS] [--seed K] [--threads T] [--quiet]",
	.summary = "bake a scene: all its light transport, to a basis file",
	.help = "\n"
		"  -o FILE         the basis file; appears when it is whole\n"
		"  --frequency F   of the dome, 1 to 64; 9 makes 406 lights\n"
		"  --division D    angles or chords\n"
		"  --size WxH      of the picture\n"
		"  --samples S     camera rays a pixel\n"
		"  --noise LEVELS  as many as bring the estimated standard error below this,\n"
		"                  in 8-bit levels under a uniform sky\n"
		"  --seed K        of all random numbers; the same file whatever the threads\n"
		"  --threads T     default: one for each processor\n"
		"  --quiet         print nothing but errors\n"
		"  --print-scene   a scene file with every key, its default and its meaning\n"
		"\n"
		"Options go before the scene file. bake/README.md describes the format.\n",
	.run = run,
};
