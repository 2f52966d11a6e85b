/* SPDX-License-Identifier: MIT */
/* Poses: which are in the picture, which come next, which are to be loaded. */
#include <errno.h>
#include <string.h>

#include "app/pipeline/pipeline_parts.h"

static bool is_ready(const struct pipeline *p, const struct pipeline_poses *poses)
{
	return poses->pose >= 0 && basis_pose_ready(p->basis, poses->pose) &&
	       basis_pose_ready(p->basis, poses->next);
}

/* Loads all that pictures of these poses need before they are shown, so that no picture fails for
 * want of it. A pose that cannot be loaded changes p->pose.missing only. */
static int poses_adopt(struct pipeline *p, const struct pipeline_poses *poses)
{
	const int both[] = {poses->pose, poses->next};
	int err = 0;

	for (int k = 0; k < 2 && !err; k++) {
		err = compositor_take_pose(p->compositor, both[k], &p->pose.trouble);
		if (err)
			p->pose.missing = both[k];
	}
	if (err)
		return err;
	if (poses->share > 0 && pipeline_fade_begin(p)) {
		p->pose.missing = poses->next;
		return fault_say(&p->pose.trouble, -ENOMEM, "not enough memory to fade poses");
	}
	p->pose.missing = -1;
	p->pose.shown = *poses;
	return 0;
}

/* Shows the wanted poses as soon as they are in memory. Poses that are coming are shown first, even
 * if the choice has changed: a choice that changes faster than poses load still shows some of
 * them. */
static int poses_take(struct pipeline *p, const struct pipeline_poses *wanted, bool hold)
{
	const bool wait = !hold || p->pose.shown.pose < 0;
	int err;

	if (wait || is_ready(p, wanted))
		p->pose.coming = *wanted;
	if (!wait && !is_ready(p, &p->pose.coming))
		return 0;
	err = poses_adopt(p, &p->pose.coming);
	p->pose.coming = *wanted;
	return p->pose.shown.pose < 0 ? err : 0;
}

/* Announces poses in the order of their need: those that come, those shown, then neighbours, one
 * more in the direction of the last step. */
static void poses_expect(struct pipeline *p)
{
	const int count = (int)p->basis->info.poses;
	const int now[] = {p->pose.coming.pose, p->pose.coming.next, p->pose.shown.pose,
			   p->pose.shown.next};
	const bool backwards = now[0] == p->pose.expected[0]
				       ? p->pose.backwards
				       : (now[0] + 1) % count == p->pose.expected[0];
	const int step = backwards ? count - 1 : 1;
	const int poses[] = {now[0],
			     now[1],
			     now[2],
			     now[3],
			     (now[1] + step) % count,
			     (now[1] + 2 * step) % count,
			     (now[0] + count - step) % count};

	_Static_assert(sizeof(poses) / sizeof(*poses) <= BASIS_EXPECT_MAX, "all are expected");
	if (count == 1 ||
	    (!p->pose.expect_again && memcmp(p->pose.expected, now, sizeof(now)) == 0))
		return;
	p->pose.expect_again = false;
	memcpy(p->pose.expected, now, sizeof(now));
	p->pose.backwards = backwards;
	basis_poses_expect(p->basis, poses, (int)(sizeof(poses) / sizeof(*poses)));
}

void pipeline_try_again(struct pipeline *p)
{
	p->pose.expect_again = p->pose.missing >= 0;
}

int pipeline_take_poses(struct pipeline *p, const struct pipeline_choice *choice)
{
	const struct pipeline_poses wanted = {
		.pose = choice->pose,
		.next = choice->share > 0 ? choice->next : choice->pose,
		.share = choice->share,
	};
	const int err = poses_take(p, &wanted, choice->hold);

	if (err)
		return err;
	poses_expect(p);
	p->choice.pose = p->pose.shown.pose;
	p->choice.next = p->pose.shown.next;
	p->choice.share = p->pose.shown.share;
	return 0;
}
