/* SPDX-License-Identifier: MIT */
#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "hal/basis/basis.h"
#include "hal/basis/basis_names.h"

#define DIGITS "0123456789"
#define ALLOWED DIGITS "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ-_"

static bool is_name(const struct basis_pose_name *name)
{
	const size_t length = strnlen(name->text, sizeof(name->text));

	for (size_t i = length; i < sizeof(name->text); i++)
		if (name->text[i])
			return false;
	return length < sizeof(name->text) && strspn(name->text, ALLOWED) == length &&
	       (length == 0 || strspn(name->text, DIGITS) != length);
}

static int by_text(const void *a, const void *b)
{
	return strcmp(((const struct basis_pose_name *)a)->text,
		      ((const struct basis_pose_name *)b)->text);
}

int basis_names_check(const struct basis_pose_name *names, uint32_t count)
{
	struct basis_pose_name *sorted = calloc(count, sizeof(*sorted));
	int ret = 0;

	if (!sorted)
		return -ENOMEM;
	for (uint32_t p = 0; ret == 0 && p < count; p++)
		ret = is_name(&names[p]) ? 0 : -EINVAL;
	if (ret == 0) {
		memcpy(sorted, names, count * sizeof(*sorted));
		qsort(sorted, count, sizeof(*sorted), by_text);
	}
	for (uint32_t p = 1; ret == 0 && p < count; p++)
		if (sorted[p].text[0] && !by_text(&sorted[p - 1], &sorted[p]))
			ret = -EINVAL;
	free(sorted);
	return ret;
}

const char *basis_pose_name(const struct basis *basis, int pose)
{
	return basis->names ? basis->names[pose].text : "";
}

int basis_find_pose(const struct basis *basis, const char *text, struct fault *fault)
{
	const int count = (int)basis->info.poses;
	const bool digits = *text && strspn(text, DIGITS) == strlen(text);
	const long number = digits && strlen(text) < 7 ? atol(text) : count;

	for (int p = 0; p < count; p++)
		if (digits ? p == number : *text && !strcmp(text, basis_pose_name(basis, p)))
			return p;
	return fault_say(fault, -EINVAL,
			 "the basis has no pose \"%.40s\", expected a number 0..%d%s", text,
			 count - 1, basis->names ? " or a name that it has" : "");
}
