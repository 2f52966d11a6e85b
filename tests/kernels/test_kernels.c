/* SPDX-License-Identifier: MIT */
/*
 * Every table of kernels that the processor supports against the specification, bit by bit; the
 * specification against wider integers and double precision; and the comparison itself against
 * tables that are wrong in one small thing each.
 *
 *     test_kernels [--rounds N] [--need NAME]... [--choose NAME]
 *
 * --need: that table must be there and supported. --choose: it must be the one that is taken when
 * nobody asks for another.
 */
#include <getopt.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "tests/kernels/compare.h"
#include "tests/kernels/faults.h"
#include "tests/support/chance.h"

#define NEEDED_MAX 8

struct kernels_run {
	uint64_t seed;
	int rounds;
	const char *needed[NEEDED_MAX];
	int needed_count;
	const char *chosen;
	int tests, failed;
};

static void result(struct kernels_run *run, bool passed, const char *name, const char *what,
		   const char *why)
{
	run->tests++;
	run->failed += !passed;
	if (!passed)
		printf("# %s\n", why);
	printf("%s %d - %s: %s\n", passed ? "ok" : "not ok", run->tests, name, what);
	fflush(stdout);
}

static void test_table(struct kernels_run *run, const struct kernels *table)
{
	for (int f = 0; f < FUNCTIONS; f++) {
		struct comparison *c = comparison_create(run->seed);
		char why[256];
		const bool same = comparison_run(c, (enum kernel_function)f, run->rounds,
						 &kernels_c, table, why);

		result(run, same, table->name, kernel_function_names[f], why);
		comparison_free(c);
	}
}

static void test_faults(struct kernels_run *run)
{
	for (int i = 0; i < faulty_count; i++) {
		const struct faulty f = faulty_table(i);
		struct comparison *c = comparison_create(run->seed);
		char why[256];
		const bool caught = !comparison_run(c, f.function, run->rounds, &kernels_c,
						    &f.table, why);

		result(run, caught, "a wrong table is caught", f.fault, "it was not");
		comparison_free(c);
	}
}

/* ---- the specification ---- */

static int random_between(int low, int high)
{
	return low + (int)(random() % (high - low + 1));
}

/* Against the weights put together again, in 128-bit integers. */
static void test_sums(struct kernels_run *run)
{
	enum { LINES = 96, STEP = 3 * KERNEL_LINE16 };
	static int16_t lines[LINES * STEP] __attribute__((aligned(64)));
	static int16_t digit[LINES / 2][3][KERNEL_DIGITS][2];
	static int64_t start = INT64_C(1000000007), sum[3][KERNEL_LINE16];
	uint32_t line[LINES];
	const struct kernel_weights w = {
		.count = LINES,
		.digits = KERNEL_DIGITS,
		.shift = 3,
		.line = line,
		.step = STEP * sizeof(*lines),
		.channel = KERNEL_LINE_BYTES,
		.digit = &digit[0][0][0][0],
	};
	bool same = true;

	for (int i = 0; i < LINES * STEP; i++)
		lines[i] = (int16_t)random_between(-200, 200);
	for (int i = 0; i < LINES * 3 * KERNEL_DIGITS; i++)
		(&digit[0][0][0][0])[i] = (int16_t)random_between(-2048, 2047);
	for (uint32_t k = 0; k < LINES; k++)
		line[k] = k * 7 % LINES;
	for (int i = 0; i < 3 * KERNEL_LINE16; i++)
		sum[i / KERNEL_LINE16][i % KERNEL_LINE16] = i * start;
	kernels_c.sums16(lines, &w, (int64_t *const[3]){sum[0], sum[1], sum[2]});
	for (int i = 0; i < 3 * KERNEL_LINE16; i++) {
		const int c = i / KERNEL_LINE16, p = i % KERNEL_LINE16;
		__int128 whole = i * start;

		for (int k = 0; k < LINES; k++) {
			__int128 weight = 0;

			for (int d = KERNEL_DIGITS - 1; d >= 0; d--)
				weight = weight * 4096 + digit[k / 2][c][d][k % 2];
			whole += 8 * weight * lines[line[k] * STEP + (uint32_t)i];
		}
		same = same && whole == sum[c][p];
	}
	result(run, same, "c", "sums16 is what 128 bits give", "it is not");
}

/* Against double precision: linear light, encoded without a table. */
static void test_mix(struct kernels_run *run, const struct transfer_curve *from,
		     const struct transfer_curve *to, const char *what, double dark, double bright)
{
	static struct kernel_curves curves;
	double worst[2] = {0}, off; /* below 1 / 1020 of white, and above */
	bool unchanged = true;
	char why[128];

	kernel_curves_fill(&curves, from, to);
	for (int i = 0; i < 400000; i++) {
		const int32_t object = random_between(0, 3) ? random_between(-1000, 1 << 24) >>
								      random_between(0, 20)
							    : 0;
		const int32_t taken = random_between(0, 1) ? random_between(-(1 << 24), 1 << 24)
							   : random_between(-16 * (1 << 24), 0);
		const uint16_t coverage = (uint16_t)(random_between(0, 1) ? random_between(0, 65535)
									  : 0);
		const uint8_t in[4] = {(uint8_t)random(), 0, 0, 0};
		const struct kernel_row row = {1,
					       1,
					       {&object, &object, &object},
					       {&taken, &taken, &taken},
					       &coverage,
					       in,
					       &curves,
					       (uint8_t[4]){0},
					       0,
					       0,
					       0,
					       0};
		const double linear = ldexp(object, -24) + (1 - coverage / 65535.0) *
								   fmin(1 - ldexp(taken, -24), 16) *
								   curves.decode[in[0]] / 65535;

		kernels_c.mix(&row);
		off = fabs(row.out[0] - 255 * transfer_curve_encode(to, linear));
		worst[linear * 1020 > 1] = fmax(worst[linear * 1020 > 1], off);
	}
	for (int i = 0; i < 256; i++)
		unchanged = unchanged && (from != to ||
					  fabs((double)curves.recode[i] - i) <= floor(dark + 0.01));
	snprintf(why, sizeof(why), "%.4f, in the dark %.4f levels from double precision%s",
		 worst[1], worst[0], unchanged ? "" : "; an unchanged pixel comes out changed");
	printf("# %s: at most %.4f, in the dark %.4f levels from double precision\n", what,
	       worst[1], worst[0]);
	result(run, unchanged && worst[0] <= dark && worst[1] <= bright, "c", what, why);
}

static bool mix_keeps(const struct kernel_curves *curves, int code, int32_t taken)
{
	static const int32_t none;
	static const uint16_t clear;
	const uint8_t in[4] = {(uint8_t)code, 0, 0, 0};
	uint8_t out[4];
	const struct kernel_row row = {.count = 1,
				       .rows = 1,
				       .object = {&none, &none, &none},
				       .taken = {&taken, &taken, &taken},
				       .coverage = &clear,
				       .background = in,
				       .curves = curves,
				       .out = out};

	kernels_c.mix(&row);
	return out[0] == curves->recode[code];
}

/* kernel_curves.steady: no code up to v changes up to it, and one of them does beyond it. */
static void test_steady(struct kernels_run *run, const struct transfer_curve *from,
			const struct transfer_curve *to, const char *what)
{
	static struct kernel_curves curves;
	bool kept = true, close = true;

	kernel_curves_fill(&curves, from, to);
	for (int v = 0; v < 256; v += 5) {
		const int32_t most = curves.steady[v];
		bool beyond = most == KERNEL_FAINT - 1;

		for (int w = 0; w <= v; w++) {
			const int32_t some = (int32_t)random_between(-most, most);

			kept = kept && mix_keeps(&curves, w, most) &&
			       mix_keeps(&curves, w, -most) && mix_keeps(&curves, w, some);
			beyond = beyond || !mix_keeps(&curves, w, most + 1) ||
				 !mix_keeps(&curves, w, -most - 1);
		}
		close = close && beyond;
	}
	result(run, kept && close, "c", what,
	       kept ? "steady is less than it may be" : "a steady code changes");
}

/* The cubic of grain, against the curve. */
static void test_light(struct kernels_run *run, const struct transfer_curve *from, const char *what,
		       double most)
{
	static struct kernel_curves curves;
	const float *light = curves.light;
	double worst = 0;
	char why[64];

	kernel_curves_fill(&curves, from, from);
	for (int i = 0; i < 256; i++) {
		const float code = (float)i;
		const float is = light[0] + code * (light[1] + code * (light[2] + code * light[3]));
		const double off = fabs((double)is - curves.decode[i] / 65535.0);

		worst = off > worst ? off : worst;
	}
	snprintf(why, sizeof(why), "off by %.4f of white", worst);
	printf("# %s: at most %.4f of white off\n", what, worst);
	result(run, worst <= most, "c", what, why);
}

static void test_named_curves(struct kernels_run *run)
{
	struct transfer_curve curves[TRANSFER_COUNT];
	char what[64];

	for (int t = 0; t < TRANSFER_COUNT; t++)
		curves[t] = (struct transfer_curve){.named = (enum transfer)t};
	for (int from = 0; from < TRANSFER_COUNT; from++) {
		snprintf(what, sizeof(what), "light of %s", transfer_names[from]);
		test_light(run, &curves[from], what, 0.004);
		for (int to = 0; to < TRANSFER_COUNT; to++) {
			snprintf(what, sizeof(what), "mix from %s to %s", transfer_names[from],
				 transfer_names[to]);
			test_mix(run, &curves[from], &curves[to], what, 0.52, 0.52);
			test_steady(run, &curves[from], &curves[to], what);
		}
	}
}

/* Linear light of a code of a camera with a toe and a shoulder. */
static double film_decode(double code)
{
	double low = 0, high = 1;

	for (int i = 0; i < 60; i++) {
		const double x = (low + high) / 2, g = transfer_encode(TRANSFER_SRGB, x);

		if (0.4 * g + 0.6 * g * g * (3 - 2 * g) < code)
			low = x;
		else
			high = x;
	}
	return low;
}

static double power_decode(double code)
{
	return pow(code, 2.2);
}

static double srgb_decode(double code)
{
	return transfer_decode(TRANSFER_SRGB, code);
}

/* A measured curve has no formula. The first parabola holds what is below 1 / 1020 of white, and is
 * a poor one for a curve that is as steep as a power there: it costs a level, and an unchanged
 * pixel may become one level brighter or darker. */
static void test_measured_curves(struct kernels_run *run)
{
	static const struct {
		const char *what, *light;
		double (*decode)(double code);
		double dark, bright;
	} cases[] = {
		{"mix by a measured sRGB", "light of a measured sRGB", srgb_decode, 0.52, 0.52},
		{"mix by a measured film", "light of a measured film", film_decode, 0.52, 0.56},
		{"mix by a measured power of 2.2", "light of a measured power of 2.2", power_decode,
		 1.75, 0.52},
	};

	for (int i = 0; i < 3; i++) {
		struct transfer_curve curve = {.measured = true};

		for (int k = 0; k < TRANSFER_KNOTS; k++)
			curve.knot[k] = cases[i].decode((double)k / (TRANSFER_KNOTS - 1));
		test_light(run, &curve, cases[i].light, 0.07);
		test_mix(run, &curve, &curve, cases[i].what, cases[i].dark, cases[i].bright);
		test_steady(run, &curve, &curve, cases[i].what);
	}
}

/* ---- which there are ---- */

static void test_needed(struct kernels_run *run)
{
	for (int i = 0; i < run->needed_count; i++) {
		const struct kernels *k = kernels_choose(run->needed[i]);

		result(run, k && strcmp(k->name, run->needed[i]) == 0, run->needed[i],
		       "is there and supported", "it is not");
	}
}

static void test_choice(struct kernels_run *run)
{
	const struct kernels *k;

	unsetenv("INLAY_KERNEL");
	k = kernels_choose(NULL);
	if (run->chosen)
		result(run, k && strcmp(k->name, run->chosen) == 0, run->chosen,
		       "is taken of itself", k ? k->name : "none is");
	result(run, k == kernels_choose("auto"), "choice", "auto is the fastest", "it is not");
	result(run, kernels_choose("c") == &kernels_c, "choice", "c by its name", "it is not");
	result(run, !kernels_choose("mmx"), "choice", "an unknown name gives none", "it does");
	setenv("INLAY_KERNEL", "c", 1);
	result(run, kernels_choose("auto") == &kernels_c && kernels_choose(NULL) == &kernels_c,
	       "choice", "the environment in place of auto", "it is not");
	result(run, kernels_choose(k->name) == k, "choice", "a name before the environment",
	       "it is not");
	setenv("INLAY_KERNEL", "mmx", 1);
	result(run, !kernels_choose(NULL), "choice", "an unknown name in the environment", "taken");
	unsetenv("INLAY_KERNEL");
}

static int usage(void)
{
	fputs("usage: test_kernels [--rounds N] [--need NAME]... [--choose NAME]\n", stderr);
	return 2;
}

static int options(struct kernels_run *run, int argc, char **argv)
{
	static const struct option known[] = {{"rounds", required_argument, NULL, 'r'},
					      {"need", required_argument, NULL, 'n'},
					      {"choose", required_argument, NULL, 'c'},
					      {NULL, 0, NULL, 0}};
	int o;

	while ((o = getopt_long(argc, argv, "", known, NULL)) != -1) {
		switch (o) {
		case 'r':
			run->rounds = atoi(optarg);
			break;
		case 'n':
			if (run->needed_count == NEEDED_MAX)
				return usage();
			run->needed[run->needed_count++] = optarg;
			break;
		case 'c':
			run->chosen = optarg;
			break;
		default:
			return usage();
		}
	}
	return optind < argc ? usage() : 0;
}

int main(int argc, char **argv)
{
	struct kernels_run run = {.rounds = 2000};
	struct chance chance;

	if (options(&run, argc, argv) != 0)
		return 2;
	chance = chance_begin("kernels");
	run.seed = chance_bits(&chance);
	srandom((unsigned)run.seed);
	test_needed(&run);
	test_choice(&run);
	for (int i = 0; kernels_all[i]; i++) {
		if (kernels_all[i]->supported())
			test_table(&run, kernels_all[i]);
		else
			printf("# %s: not supported by this processor\n", kernels_all[i]->name);
	}
	test_faults(&run);
	test_sums(&run);
	test_named_curves(&run);
	test_measured_curves(&run);
	printf("1..%d\n", run.tests);
	return run.failed != 0;
}
