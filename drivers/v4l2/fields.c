/* SPDX-License-Identifier: MIT */
#include "drivers/v4l2/v4l2.h"

const char *const v4l2_field_wish_names[] = {"driver",	  "none", "interlaced", "sequential",
					     "alternate", "top",  "bottom",	NULL};

_Static_assert(sizeof(v4l2_field_wish_names) / sizeof(v4l2_field_wish_names[0]) ==
		       V4L2_WISH_COUNT + 1,
	       "a name for each wish");

enum { FIELD_COUNTER_RUN = 4 };

static bool sends_bottom_first(v4l2_std_id standard)
{
	return standard & V4L2_STD_525_60;
}

uint32_t v4l2_field_asked(enum v4l2_field_wish wish, v4l2_std_id standard)
{
	switch (wish) {
	case V4L2_WISH_NONE:
		return V4L2_FIELD_NONE;
	case V4L2_WISH_INTERLACED:
		return V4L2_FIELD_INTERLACED;
	case V4L2_WISH_SEQUENTIAL:
		return sends_bottom_first(standard) ? V4L2_FIELD_SEQ_BT : V4L2_FIELD_SEQ_TB;
	case V4L2_WISH_ALTERNATE:
		return V4L2_FIELD_ALTERNATE;
	case V4L2_WISH_TOP:
		return V4L2_FIELD_TOP;
	case V4L2_WISH_BOTTOM:
		return V4L2_FIELD_BOTTOM;
	default:
		return V4L2_FIELD_ANY;
	}
}

struct v4l2_lines v4l2_lines_of(uint32_t field, v4l2_std_id standard)
{
	const bool usual = sends_bottom_first(standard);

	switch (field) {
	case V4L2_FIELD_INTERLACED:
		return (struct v4l2_lines){FIELDS_INTERLACED, usual, false};
	case V4L2_FIELD_INTERLACED_TB:
		return (struct v4l2_lines){FIELDS_INTERLACED, false, false};
	case V4L2_FIELD_INTERLACED_BT:
		return (struct v4l2_lines){FIELDS_INTERLACED, true, false};
	case V4L2_FIELD_SEQ_TB:
		return (struct v4l2_lines){FIELDS_TOP_BOTTOM, false, false};
	case V4L2_FIELD_SEQ_BT:
		return (struct v4l2_lines){FIELDS_BOTTOM_TOP, true, false};
	case V4L2_FIELD_ALTERNATE:
		return (struct v4l2_lines){FIELDS_PAIR, usual, true};
	case V4L2_FIELD_TOP:
		return (struct v4l2_lines){FIELDS_TOP, false, true};
	case V4L2_FIELD_BOTTOM:
		return (struct v4l2_lines){FIELDS_BOTTOM, true, true};
	case V4L2_FIELD_ANY: /* no driver should answer this; television is interlaced */
		return (struct v4l2_lines){standard ? FIELDS_INTERLACED : FIELDS_NONE, usual,
					   false};
	default:
		return (struct v4l2_lines){FIELDS_NONE, false, false};
	}
}

struct v4l2_lines v4l2_lines_of_buffer(const struct v4l2_lines *format, uint32_t field,
				       v4l2_std_id standard)
{
	if (format->one_field || field == V4L2_FIELD_ANY || V4L2_FIELD_HAS_T_OR_B(field))
		return *format;
	return v4l2_lines_of(field, standard);
}

const char *v4l2_lines_text(const struct v4l2_lines *lines)
{
	switch (lines->fields) {
	case FIELDS_INTERLACED:
		return lines->bottom_first ? "interlaced, bottom field first"
					   : "interlaced, top field first";
	case FIELDS_TOP_BOTTOM:
		return "top field above bottom field";
	case FIELDS_BOTTOM_TOP:
		return "bottom field above top field";
	case FIELDS_PAIR:
		return lines->bottom_first ? "fields in turn, bottom first"
					   : "fields in turn, top first";
	case FIELDS_TOP:
		return "top field alone";
	case FIELDS_BOTTOM:
		return "bottom field alone";
	default:
		return "progressive";
	}
}

static void pairing_learn(struct v4l2_pairing *p, uint32_t sequence, bool bottom)
{
	if (!p->waiting || p->bottom == bottom) {
		p->run = 0;
	} else if (sequence == p->sequence) {
		p->counts_frames = true;
		p->counts_fields = false;
	} else if (sequence == p->sequence + 1 && !p->counts_frames) {
		p->run++;
		p->counts_fields = p->counts_fields || p->run >= FIELD_COUNTER_RUN;
	}
}

static bool pairing_completes(const struct v4l2_pairing *p, uint32_t sequence, bool bottom,
			      bool bottom_first)
{
	if (!p->waiting || p->bottom == bottom)
		return false;
	return sequence == p->sequence ||
	       (p->counts_fields && sequence == p->sequence + 1 && p->bottom == bottom_first);
}

enum v4l2_pair v4l2_pairing_take(struct v4l2_pairing *p, uint32_t sequence, bool bottom,
				 bool bottom_first)
{
	const bool waited = p->waiting;

	pairing_learn(p, sequence, bottom);
	if (pairing_completes(p, sequence, bottom, bottom_first)) {
		p->waiting = false;
		return V4L2_PAIR_SECOND;
	}
	p->waiting = true;
	p->bottom = bottom;
	p->sequence = sequence;
	return waited ? V4L2_PAIR_ORPHAN : V4L2_PAIR_FIRST;
}
