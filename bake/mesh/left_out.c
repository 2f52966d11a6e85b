/* SPDX-License-Identifier: MIT */
#include "bake/mesh/left_out.h"

#include <stdbool.h>
#include <stdio.h>
#include <string.h>

#include "hal/base/log.h"

static bool same_word(const char *kept, const char *word)
{
	return strncmp(kept, word, LEFT_OUT_WORD - 1) == 0;
}

static struct left_out_item *find_item(struct left_out *out, const char *what, const char *of)
{
	for (int k = 0; k < out->count; k++)
		if (same_word(out->item[k].what, what) && same_word(out->item[k].of, of))
			return &out->item[k];
	return NULL;
}

void left_out_add(struct left_out *out, const char *what, const char *of)
{
	struct left_out_item *item = find_item(out, what, of);

	if (!item && out->count >= LEFT_OUT_MAX - 1) {
		what = "other things";
		of = "part";
		item = find_item(out, what, of);
	}
	if (!item) {
		item = &out->item[out->count++];
		snprintf(item->what, sizeof(item->what), "%s", what);
		snprintf(item->of, sizeof(item->of), "%s", of);
	}
	item->times++;
}

static const char *plural_of(const char *word)
{
	const size_t length = strlen(word);

	return length && strchr("hs", word[length - 1]) ? "es" : "s";
}

/* Items of the same kind follow each other; the first of them names it. */
const char *left_out_text(const struct left_out *out, const char *path, char *text, size_t room)
{
	size_t used = 0;

	text[0] = '\0';
	for (int first = 0; first < out->count; first++) {
		const char *of = out->item[first].of;
		bool said = false;

		for (int k = 0; k < first && !said; k++)
			said = strcmp(out->item[k].of, of) == 0;
		for (int k = first; k < out->count && !said; k++) {
			const struct left_out_item *item = &out->item[k];

			if (strcmp(item->of, of) != 0 || used >= room)
				continue;
			used += (size_t)snprintf(
				text + used, room - used, "%s%s%s of %d", used ? "" : path,
				used ? ", " : ": left out: ", item->what, item->times);
			if (k == first && used < room)
				used += (size_t)snprintf(text + used, room - used, " %s%s", of,
							 item->times == 1 ? "" : plural_of(of));
		}
	}
	return text;
}

void left_out_say(const struct left_out *out, const char *path)
{
	char text[1024];

	if (left_out_text(out, path, text, sizeof(text))[0])
		log_warning_once("%s", text);
}
