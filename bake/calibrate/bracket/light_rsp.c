/* SPDX-License-Identifier: MIT */
#include "bake/calibrate/bracket/light_rsp.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "hal/base/number.h"
#include "hal/base/text_file.h"

#define ORDER_MAX 10
#define LAST (TRANSFER_KNOTS - 1)

struct polynomial {
	int order;
	double c[ORDER_MAX + 1]; /* of u^k */
};

static double polynomial_at(const struct polynomial *p, double u)
{
	double sum = 0;

	for (int k = p->order; k >= 0; k--)
		sum = sum * u + p->c[k];
	return sum;
}

static int read_polynomial(const struct text_file *file, struct polynomial *p, struct fault *fault)
{
	const char *at = file->line;
	double number[ORDER_MAX + 2] = {0};
	int count = 0;

	for (at += strspn(at, " \t\r"); *at && *at != '#'; at += strspn(at, " \t\r"))
		if (count == ORDER_MAX + 2 || number_read(&at, &number[count++]))
			return fault_say(
				fault, -EINVAL,
				"%s:%d: expected the order of a polynomial, up to %d, and its coefficients",
				file->path, file->number, ORDER_MAX);
	p->order = count > 0 && number[0] >= 1 && number[0] <= ORDER_MAX ? (int)number[0] : 0;
	if (count && (p->order != number[0] || count != p->order + 2))
		return fault_say(
			fault, -EINVAL,
			"%s:%d: %d numbers, expected an order and one coefficient more than it",
			file->path, file->number, count);
	for (int k = 0; count && k <= p->order; k++)
		p->c[p->order - k] = number[1 + k];
	return count > 0;
}

static int read_channels(const char *path, struct polynomial channel[3], struct fault *fault)
{
	struct text_file file;
	int count = 0, err = text_file_open(&file, path, fault);

	if (err)
		return err;
	while (!err && (err = text_file_next(&file, fault)) > 0) {
		struct polynomial p;

		err = read_polynomial(&file, &p, fault);
		if (err > 0 && count < 3)
			channel[count++] = p;
		err = err < 0 ? err : 0;
	}
	if (!err && count != 3)
		err = fault_say(fault, -EINVAL, "%s: holds %d polynomials, expected R, G and B",
				path, count);
	text_file_close(&file);
	return err;
}

int light_rsp_read(const char *path, struct transfer_curve *curve, double *apart,
		   struct fault *fault)
{
	struct polynomial channel[3];
	struct fault why = {.text = ""};
	int err = read_channels(path, channel, fault);

	*curve = (struct transfer_curve){.measured = true};
	*apart = 0;
	for (int k = 1; !err && k <= LAST; k++)
		for (int c = 0; c < 3; c++)
			curve->knot[k] += polynomial_at(&channel[c], (double)k / LAST) /
					  polynomial_at(&channel[c], 1) / 3;
	for (int k = LAST / 10; !err && k <= LAST * 9 / 10; k++)
		for (int c = 0; c < 3; c++)
			*apart = fmax(*apart,
				      fabs(polynomial_at(&channel[c], (double)k / LAST) /
						   polynomial_at(&channel[c], 1) / curve->knot[k] -
					   1));
	curve->knot[LAST] = 1;
	/* Polynomials of a few terms dip below 0 at the dark end, where they mean nothing. */
	for (int k = LAST - 1; !err && k > 0; k--)
		if (k < LAST / 8 && !(curve->knot[k] > 0 && curve->knot[k] < curve->knot[k + 1]))
			curve->knot[k] = curve->knot[k + 1] * k / (k + 1);
	if (!err && transfer_curve_check(curve, &why))
		err = fault_say(fault, -EINVAL, "%s: %s", path, why.text);
	return err;
}
