/* SPDX-License-Identifier: MIT */
#include "bake/calibrate/estimate/verdict.h"

#include <stdarg.h>
#include <stdio.h>

#include "hal/base/json.h"
#include "hal/base/log.h"

void verdict_begin(struct verdict *verdict)
{
	*verdict = (struct verdict){.trusted = true};
}

void verdict_doubt(struct verdict *verdict, const char *remedy, const char *reason, ...)
{
	va_list args;

	if (!verdict->trusted)
		return;
	verdict->trusted = false;
	va_start(args, reason);
	vsnprintf(verdict->reason, sizeof(verdict->reason), reason, args);
	va_end(args);
	snprintf(verdict->remedy, sizeof(verdict->remedy), "%s", remedy);
}

void verdict_sentence(const struct verdict *verdict, char *text, int room)
{
	if (verdict->trusted)
		snprintf(text, (size_t)room, "trusted");
	else
		snprintf(text, (size_t)room, "%s; %s", verdict->reason, verdict->remedy);
}

void verdict_write_json(struct json *json, const struct verdict *verdict)
{
	char sentence[VERDICT_SENTENCE_MAX];

	verdict_sentence(verdict, sentence, sizeof(sentence));
	json_object(json, "verdict");
	json_bool(json, "trusted", verdict->trusted);
	json_text(json, "sentence", sentence);
	json_text(json, "reason", verdict->reason);
	json_text(json, "remedy", verdict->remedy);
	json_end(json);
}

int verdict_end(const struct verdict *verdict)
{
	char sentence[VERDICT_SENTENCE_MAX];

	if (verdict->trusted)
		return 0;
	verdict_sentence(verdict, sentence, sizeof(sentence));
	log_error("%s", sentence);
	return 1;
}
