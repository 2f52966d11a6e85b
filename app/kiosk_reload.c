/* SIGHUP: another configuration while the pictures go on. */
#include <errno.h>

#include "app/kiosk_parts.h"
#include "app/pipeline_config.h"
#include "app/reload.h"
#include "hal/clock.h"
#include "hal/log.h"

/* What only the running kiosk can tell of a configuration. */
static int check(const struct kiosk *k, const struct config *fresh, struct fault *fault)
{
	struct fisheye lens;

	if ((uint32_t)fresh->basis.pose >= k->basis.info.poses)
		return fault_say(fault, -EINVAL, "%s: [basis] pose: is %d, expected 0..%u",
				 fresh->name, fresh->basis.pose, k->basis.info.poses - 1);
	if (fresh->screen->show == SHOW_SCENE && !k->eyes.scene.source)
		return fault_say(fault, -EINVAL,
				 "%s: [screen] show: is scene, whose camera is not open",
				 fresh->name);
	if (!k->pipeline.lens_width)
		return 0;
	return fisheye_prepare(&lens, &fresh->fisheye.lens, k->pipeline.lens_width,
			       k->pipeline.lens_height, fault);
}

/* A camera's radiance is encoded as its views expect it. */
static void encode(struct kiosk *k)
{
	for (int i = 0; i < k->source_count; i++) {
		const struct transfer_curve curve = kiosk_curve_for(k->config,
								    k->sources[i].settings.name);

		source_encode_as(&k->sources[i], &curve);
	}
}

static int apply_light(struct kiosk *k, struct fault *fault)
{
	struct pipeline_settings settings = pipeline_settings_of(k->config);

	encode(k);
	return pipeline_relight(&k->pipeline, &settings, fault);
}

static int apply_pipeline(struct kiosk *k, struct fault *fault)
{
	struct pipeline_settings settings = pipeline_settings_of(k->config);
	bool other_threads = settings.threads != k->pipeline.settings.threads;
	int err = pipeline_change(&k->pipeline, &settings, fault);

	if (err)
		return err;
	if (other_threads) {
		show_free(&k->show); /* its scalers have room for so many threads */
		k->show = (struct show){.after = {.width = 0}};
	}
	encode(k);
	return 0;
}

static void apply(struct kiosk *k, unsigned effects)
{
	const struct config *config = k->config;
	struct fault fault = {.text = ""};

	if (effects & RELOAD_PIPELINE && apply_pipeline(k, &fault))
		log_error("reload: %s", fault.text);
	if (effects & RELOAD_LIGHT && apply_light(k, &fault))
		log_error("reload: %s", fault.text);
	if (effects & RELOAD_THRESHOLD)
		k->choice.threshold = config->lights.threshold;
	if (effects & RELOAD_POSE)
		kiosk_take_pose(k, config->basis.pose);
	if (effects & RELOAD_POSES)
		kiosk_take_pose(k, k->choice.pose);
	if (effects & RELOAD_VIEW)
		k->what = (enum config_show)config->screen->show;
	if (effects & RELOAD_SPLIT)
		k->split = config->screen->split;
	if (effects & RELOAD_INFORMATION)
		k->information = config->screen->information;
	if (effects & RELOAD_STATE)
		state_move(k->state, &config->state);
	if (effects & (RELOAD_THRESHOLD | RELOAD_POSE | RELOAD_VIEW))
		kiosk_keep_state(k);
	/* First: no. From here on everything is waited for. */
	(void)kiosk_control_open(k, false, NULL);
	(void)kiosk_buttons_open(k, false, NULL);
	kiosk_text(k);
	k->redraw |= (effects & RELOAD_DRAWING) != 0;
}

static int reload(struct kiosk *k)
{
	const struct kiosk_settings *settings = k->settings;
	struct ini_report report = {.count = 0};
	struct fault fault = {.text = ""};
	struct config *fresh;
	unsigned effects;
	int err = settings->reread(settings->context, &fresh, &report);

	if (err)
		return err; /* every fault is said */
	err = check(k, fresh, &fault);
	if (err) {
		log_error("%s", fault.text);
		config_destroy(fresh);
		return err;
	}
	effects = reload_compare(k->config, fresh);
	/* What drivers have borrowed must not change under them. */
	if (effects & RELOAD_BUTTONS)
		kiosk_buttons_close(k);
	if (effects & RELOAD_CONTROL)
		kiosk_control_close(k);
	reload_adopt(k->config, fresh);
	config_destroy(fresh);
	apply(k, effects);
	return 0;
}

void kiosk_reload(struct kiosk *k)
{
	service_reloading(&k->service, clock_now_ns());
	if (reload(k))
		log_error("the configuration is wrong; the old one stays");
	else
		log_info("the configuration has been read again");
	service_reloaded(&k->service);
}
