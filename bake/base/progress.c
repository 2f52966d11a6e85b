/* SPDX-License-Identifier: MIT */
#include "bake/base/progress.h"

#include <stdio.h>
#include <unistd.h>

#include "hal/base/clock.h"

#define BAR 30

void progress_begin(struct progress *p, const char *what, double total, bool quiet)
{
	*p = (struct progress){.what = what, .total = total, .quiet = quiet};
	p->terminal = isatty(STDERR_FILENO) == 1;
	p->start_ns = p->shown_ns = clock_now_ns();
}

static void progress_draw(const struct progress *p, double share, double rate, int left_s)
{
	char bar[BAR + 1];

	for (int k = 0; k < BAR; k++)
		bar[k] = k < share * BAR ? '#' : '.';
	bar[BAR] = '\0';
	fprintf(stderr, "\r%s [%s] %3d %%  %.1f million rays/s  %d:%02d left  ", p->what, bar,
		(int)(100 * share), rate, left_s / 60, left_s % 60);
}

void progress_show(struct progress *p, double done, uint64_t rays)
{
	const int64_t now = clock_now_ns();
	const int64_t step = p->terminal ? NS_PER_S / 5 : 10 * NS_PER_S;
	const double seconds = (double)(now - p->start_ns) / NS_PER_S;
	const double share = done / p->total;
	const int left_s = done > 0 ? (int)(seconds / done * (p->total - done)) : 0;

	if (p->quiet || now - p->shown_ns < step)
		return;
	p->shown_ns = now;
	if (p->terminal)
		progress_draw(p, share, (double)rays / seconds * 1e-6, left_s);
	else
		fprintf(stderr, "%s: %d %%, %.1f million rays/s, %d s left\n", p->what,
			(int)(100 * share), (double)rays / seconds * 1e-6, left_s);
}

double progress_end(struct progress *p)
{
	if (!p->quiet && p->terminal)
		fprintf(stderr, "\r%*s\r", 79, "");
	return (double)(clock_now_ns() - p->start_ns) / NS_PER_S;
}
