/* SPDX-License-Identifier: MIT */
#include "drivers/libcamera/parts.h"

#include <errno.h>
#include <float.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "hal/base/log.h"
#include "hal/base/number.h"

/* Cameras apply controls some frames after the request that carries them. */
enum { FRAMES_TO_SETTLE = 12 };

/* ---- values ---- */

void libcamera_value_unpack(struct libcamera_value *value, enum libcamera_kind kind, int count,
			    const void *elements)
{
	*value = (struct libcamera_value){.kind = kind};
	if (kind != LIBCAMERA_OTHER)
		value->count = count < LIBCAMERA_NUMBERS_MAX ? count : LIBCAMERA_NUMBERS_MAX;
	for (int i = 0; i < value->count; i++)
		value->numbers[i] = kind == LIBCAMERA_INT32 ? ((const int32_t *)elements)[i]
				    : kind == LIBCAMERA_INT64
					    ? (double)((const int64_t *)elements)[i]
				    : kind == LIBCAMERA_FLOAT ? (double)((const float *)elements)[i]
							      : ((const uint8_t *)elements)[i];
}

void libcamera_value_pack(const struct libcamera_value *value, void *elements)
{
	for (int i = 0; i < value->count; i++)
		switch (value->kind) {
		case LIBCAMERA_BOOL:
		case LIBCAMERA_BYTE:
			((uint8_t *)elements)[i] = (uint8_t)value->numbers[i];
			break;
		case LIBCAMERA_INT32:
			((int32_t *)elements)[i] = (int32_t)value->numbers[i];
			break;
		case LIBCAMERA_INT64:
			((int64_t *)elements)[i] = (int64_t)value->numbers[i];
			break;
		case LIBCAMERA_FLOAT:
			((float *)elements)[i] = (float)value->numbers[i];
			break;
		case LIBCAMERA_OTHER:
			break;
		}
}

void libcamera_value_text(const struct libcamera_value *value, char text[LIBCAMERA_VALUE_TEXT_MAX])
{
	size_t used = 0;

	text[0] = '\0';
	for (int i = 0; i < value->count && used < LIBCAMERA_VALUE_TEXT_MAX; i++) {
		const char *blank = i > 0 ? " " : "";
		const double number = value->numbers[i];
		char *end = text + used;
		const size_t room = LIBCAMERA_VALUE_TEXT_MAX - used;

		used += (size_t)(value->kind == LIBCAMERA_BOOL
					 ? snprintf(end, room, "%s%s", blank,
						    number != 0 ? "yes" : "no")
					 : snprintf(end, room, "%s%.9g", blank, number));
	}
}

/* Whether the type of this kind can hold the number. */
static bool kind_holds(enum libcamera_kind kind, double number)
{
	switch (kind) {
	case LIBCAMERA_BOOL:
		return number >= 0 && number <= 1;
	case LIBCAMERA_BYTE:
		return number >= 0 && number <= UINT8_MAX;
	case LIBCAMERA_INT32:
		return number >= INT32_MIN && number <= INT32_MAX;
	case LIBCAMERA_INT64:
		return fabs(number) <= 0x1p53;
	case LIBCAMERA_FLOAT:
		return fabs(number) <= (double)FLT_MAX;
	default:
		return false;
	}
}

/* Equal limits mean "not known" for some cameras. */
static bool has_limits(const struct libcamera_control *control)
{
	return control->least.count > 0 && control->most.count > 0 &&
	       control->least.numbers[0] < control->most.numbers[0];
}

/* An array may have one limit for all its elements. */
static double control_limit(const struct libcamera_value *limits, int element)
{
	return limits->numbers[element < limits->count ? element : limits->count - 1];
}

static bool control_allows(const struct libcamera_control *control, int element, double number)
{
	return has_limits(control) ? number >= control_limit(&control->least, element) &&
					     number <= control_limit(&control->most, element)
				   : kind_holds(control->kind, number);
}

static int control_read_number(const struct libcamera_control *control, const char *word,
			       double *number, struct fault *fault)
{
	bool truth;

	if (control->kind == LIBCAMERA_BOOL && ini_truth_read(word, &truth)) {
		*number = truth;
		return 0;
	}
	if (control->number_of && control->number_of(control->theirs, word, number))
		return 0;
	if (number_of(word, number) < 0)
		return fault_say(fault, -EINVAL, "\"%s\" is no value for it", word);
	if (control->kind != LIBCAMERA_FLOAT && *number != floor(*number))
		return fault_say(fault, -EINVAL, "it takes whole numbers, not %s", word);
	return 0;
}

static int out_of_range(const struct libcamera_control *control, const char *word,
			struct fault *fault)
{
	char least[LIBCAMERA_VALUE_TEXT_MAX], most[LIBCAMERA_VALUE_TEXT_MAX];

	libcamera_value_text(&control->least, least);
	libcamera_value_text(&control->most, most);
	return fault_say(fault, -ERANGE, "%s is out of its range %s..%s", word, least, most);
}

int libcamera_value_read(const struct libcamera_control *control, const char *text,
			 struct libcamera_value *value, struct fault *fault)
{
	const int expected = control->elements > 0 ? control->elements : 1;
	char words[INI_TEXT_MAX], *rest = NULL;
	int count = 0;

	if (control->kind == LIBCAMERA_OTHER || expected > LIBCAMERA_NUMBERS_MAX)
		return fault_say(fault, -EINVAL, "its kind cannot be set from a configuration");
	*value = (struct libcamera_value){.kind = control->kind, .count = expected};
	snprintf(words, sizeof(words), "%s", text);
	for (char *word = strtok_r(words, " \t", &rest); word;
	     word = strtok_r(NULL, " \t", &rest)) {
		double number;
		int err = control_read_number(control, word, &number, fault);

		if (err)
			return err;
		if (!control_allows(control, count, number))
			return out_of_range(control, word, fault);
		if (count < expected)
			value->numbers[count] = number;
		count++;
	}
	if (count != expected)
		return fault_say(fault, -EINVAL, "expected %d %s, not %d", expected,
				 expected > 1 ? "values with blanks between" : "value", count);
	return 0;
}

/* Compares to 2 %: sensors have steps, like the time of a line or a fraction of a gain. */
static bool nearly_equal(const struct libcamera_value *a, const struct libcamera_value *b)
{
	for (int i = 0; i < a->count && a->count == b->count; i++)
		if (fabs(a->numbers[i] - b->numbers[i]) > 0.02 * fabs(a->numbers[i]))
			return false;
	return a->count == b->count;
}

/* ---- wishes ---- */

static const struct libcamera_control *control_find(const struct libcamera_control *known,
						    int count, const char *name)
{
	for (int i = 0; i < count; i++)
		if (strcasecmp(known[i].name, name) == 0)
			return &known[i];
	return NULL;
}

static int read_wish(struct libcamera_wishes *w, const struct libcamera_control *control,
		     const char *text, struct fault *fault)
{
	int err;

	if (!control)
		return fault_say(fault, -ENOENT, "the camera has no such control");
	if (w->count == LIBCAMERA_WISHES_MAX - 1) /* the last place is for the rate */
		return fault_say(fault, -E2BIG, "more than %d", LIBCAMERA_WISHES_MAX - 1);
	err = libcamera_value_read(control, text, &w->list[w->count].value, fault);
	if (err)
		return err;
	w->list[w->count++].control = control;
	return 0;
}

/* Sets both limits of the frame duration to one value, which holds the rate. */
static double want_rate(struct libcamera_wishes *w, const struct libcamera_control *control,
			double rate_hz)
{
	double wanted_us;

	if (rate_hz <= 0 || !control)
		return 0;
	wanted_us = round(1e6 / rate_hz);
	if (has_limits(control))
		wanted_us = fmin(fmax(wanted_us, control->least.numbers[0]),
				 control->most.numbers[0]);
	w->list[w->count++] = (struct libcamera_wish){
		.control = control,
		.value = {LIBCAMERA_INT64, 2, {wanted_us, wanted_us}},
	};
	return 1e6 / wanted_us;
}

double libcamera_wishes_read(struct libcamera_wishes *w, const char *camera,
			     const struct libcamera_control *known, int count, const char *text,
			     double rate_hz)
{
	struct camera_control said;
	struct fault fault;
	int got;

	*w = (struct libcamera_wishes){.camera = camera, .settling = FRAMES_TO_SETTLE};
	while ((got = camera_controls_next(&text, &said, &fault)) != 0) {
		if (got < 0)
			log_warning_once("libcamera: %s: %s", camera, fault.text);
		else if (read_wish(w, control_find(known, count, said.name), said.value, &fault))
			log_warning_once("libcamera: %s: control %s is not set: %s", camera,
					 said.name, fault.text);
	}
	return want_rate(w, control_find(known, count, "FrameDurationLimits"), rate_hz);
}

int libcamera_wishes_change(struct libcamera_wishes *w, const struct libcamera_control *known,
			    int count, const char *name, const char *value, struct fault *fault)
{
	const struct libcamera_control *control = control_find(known, count, name);
	struct libcamera_value read;
	struct fault why;
	int at = 0, err;

	if (!control)
		return fault_say(fault, -EINVAL, "the camera has no control \"%s\"", name);
	err = libcamera_value_read(control, value, &read, &why);
	if (err)
		return fault_say(fault, err, "control %s: %s", name, why.text);
	while (at < w->count && w->list[at].control != control)
		at++;
	if (at == LIBCAMERA_WISHES_MAX)
		return fault_say(fault, -E2BIG, "more than %d controls", LIBCAMERA_WISHES_MAX);
	if (at == w->count)
		w->count++;
	/* The wish keeps its place, because requests under way refer to wishes by index. The wishes
	 * behind it are sent again too. */
	w->list[at] = (struct libcamera_wish){.control = control, .value = read};
	w->next = at < w->next ? at : w->next;
	return 0;
}

struct libcamera_load libcamera_wishes_next(struct libcamera_wishes *w)
{
	const int left = w->count - w->next;
	const struct libcamera_load load = {w->next, w->alone && left > 1 ? 1 : left};

	w->next += load.count;
	return load;
}

void libcamera_wishes_refused(struct libcamera_wishes *w, struct libcamera_load load)
{
	const struct libcamera_wish *wish = &w->list[load.first];
	char text[LIBCAMERA_VALUE_TEXT_MAX];

	if (load.count > 1) {
		w->alone = true;
		w->next = 0;
	} else if (load.count == 1) {
		libcamera_value_text(&wish->value, text);
		log_warning_paced("libcamera: %s: control %s: the camera refused %s", w->camera,
				  wish->control->name, text);
	}
}

void libcamera_wishes_compare(struct libcamera_wishes *w,
			      bool (*get)(const void *context, const void *theirs,
					  struct libcamera_value *value),
			      const void *context)
{
	char asked[LIBCAMERA_VALUE_TEXT_MAX], used[LIBCAMERA_VALUE_TEXT_MAX];

	if (w->settling == 0)
		return;
	w->settling--;
	for (struct libcamera_wish *wish = w->list; wish < w->list + w->count; wish++) {
		struct libcamera_value value;

		if (wish->granted || !get(context, wish->control->theirs, &value))
			continue;
		wish->granted = nearly_equal(&wish->value, &value);
		if (wish->granted || w->settling > 0)
			continue;
		libcamera_value_text(&wish->value, asked);
		libcamera_value_text(&value, used);
		log_warning_paced("libcamera: %s: control %s: asked for %s, it uses %s", w->camera,
				  wish->control->name, asked, used);
	}
}
