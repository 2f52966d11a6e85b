/* SPDX-License-Identifier: MIT */
/*
 * A window on a desktop (SDL2), for trying things out. submit() may wait for the desktop's refresh,
 * at most one. SDL has no descriptor, so a timer polls its events.
 *
 * The keys are those of the keyboard driver: up or + and down or - threshold, t the next threshold,
 * v view, p next pose, b the previous one, o object, i information, left and right split, f freeze.
 * In addition q and Escape end the program, as usual on a desktop.
 */
#include <SDL.h>
#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <sys/timerfd.h>
#include <unistd.h>

#include "drivers/drivers.h"
#include "hal/base/clock.h"
#include "hal/frame/frame.h"

#define POLL_NS (10 * NS_PER_MS)

struct window {
	bool sdl; /* video is initialised */
	SDL_Window *window;
	SDL_Renderer *renderer;
	SDL_Texture *texture;
	struct canvas canvas;
	int timer;
	struct display_event shown; /* to be reported by dispatch(), unless DISPLAY_NOTHING */
};

static const struct {
	SDL_Keycode key;
	enum action action;
} keys[] = {
	{SDLK_UP, ACTION_THRESHOLD_UP},
	{SDLK_PLUS, ACTION_THRESHOLD_UP},
	{SDLK_EQUALS, ACTION_THRESHOLD_UP},
	{SDLK_KP_PLUS, ACTION_THRESHOLD_UP},
	{SDLK_DOWN, ACTION_THRESHOLD_DOWN},
	{SDLK_MINUS, ACTION_THRESHOLD_DOWN},
	{SDLK_KP_MINUS, ACTION_THRESHOLD_DOWN},
	{SDLK_t, ACTION_THRESHOLD_NEXT},
	{SDLK_v, ACTION_VIEW_NEXT},
	{SDLK_p, ACTION_POSE_NEXT},
	{SDLK_b, ACTION_POSE_PREV},
	{SDLK_o, ACTION_OBJECT},
	{SDLK_i, ACTION_INFORMATION},
	{SDLK_LEFT, ACTION_SPLIT_LEFT},
	{SDLK_RIGHT, ACTION_SPLIT_RIGHT},
	{SDLK_f, ACTION_FREEZE},
	{SDLK_q, ACTION_QUIT},
};

static int window_refused(const char *what, struct fault *fault)
{
	return fault_say(fault, -ENODEV, "window display: cannot %s: %s", what, SDL_GetError());
}

/* Starts the timer with an immediate tick: a frame was shown, or events may be pending. */
static int tick_now(const struct window *window)
{
	const struct itimerspec every = {
		.it_interval.tv_nsec = POLL_NS,
		.it_value.tv_nsec = 1,
	};

	return timerfd_settime(window->timer, 0, &every, NULL) < 0 ? -errno : 0;
}

static int open_timer(struct window *window, struct fault *fault)
{
	int err = 0;

	window->timer = timerfd_create(CLOCK_MONOTONIC, TFD_NONBLOCK | TFD_CLOEXEC);
	if (window->timer < 0)
		err = -errno;
	else
		err = tick_now(window);
	return err ? fault_say(fault, err, "window display: no timer: %s", strerror(-err)) : 0;
}

static int open_sdl(struct window *window, int width, int height, struct fault *fault)
{
	/* The program handles SIGINT and SIGTERM itself, and a screen saver would cover the
	 * window. */
	SDL_SetHint(SDL_HINT_NO_SIGNAL_HANDLERS, "1");
	SDL_SetHint(SDL_HINT_VIDEO_ALLOW_SCREENSAVER, "0");
	if (SDL_InitSubSystem(SDL_INIT_VIDEO))
		return window_refused("start (is there a desktop?)", fault);
	window->sdl = true;
	window->window = SDL_CreateWindow("inlay", SDL_WINDOWPOS_UNDEFINED, SDL_WINDOWPOS_UNDEFINED,
					  width, height, 0);
	if (!window->window)
		return window_refused("open a window", fault);
	window->renderer = SDL_CreateRenderer(window->window, -1, SDL_RENDERER_PRESENTVSYNC);
	if (!window->renderer)
		window->renderer = SDL_CreateRenderer(window->window, -1, 0);
	if (!window->renderer)
		return window_refused("draw in its window", fault);
	/* SDL names formats by the value of a 32-bit word: B, G, R, X in memory here. */
	window->texture = SDL_CreateTexture(window->renderer, SDL_PIXELFORMAT_ARGB8888,
					    SDL_TEXTUREACCESS_STREAMING, width, height);
	if (!window->texture)
		return window_refused("make a texture", fault);
	SDL_SetTextureBlendMode(window->texture, SDL_BLENDMODE_NONE);
	return 0;
}

static double refresh_hz(SDL_Window *window)
{
	SDL_DisplayMode mode;
	const int display = SDL_GetWindowDisplayIndex(window);

	return display >= 0 && !SDL_GetCurrentDisplayMode(display, &mode) ? mode.refresh_rate : 0;
}

static int window_open(struct display *display, struct fault *fault)
{
	struct window *window;
	int err;

	err = display_free_size(display, &display->width, &display->height, fault);
	if (err)
		return err;
	window = calloc(1, sizeof(*window));
	if (!window)
		return fault_say(fault, -ENOMEM, "window display: not enough memory");
	display->state = window;
	err = open_timer(window, fault);
	if (!err)
		err = open_sdl(window, display->width, display->height, fault);
	if (err)
		return err;
	err = canvas_create(&window->canvas, display->width, display->height);
	if (err)
		return fault_say(fault, err, "window display: no memory for %d x %d pixels",
				 display->width, display->height);
	display->rate_hz = refresh_hz(window->window);
	return 0;
}

static int window_descriptor(struct display *display)
{
	return ((struct window *)display->state)->timer;
}

static int window_acquire(struct display *display, struct display_buffer *buffer)
{
	const struct window *window = display->state;

	if (window->shown.kind != DISPLAY_NOTHING)
		return -EAGAIN;
	*buffer = (struct display_buffer){
		.pixels = window->canvas.pixels,
		.stride = window->canvas.stride,
		.width = window->canvas.width,
		.height = window->canvas.height,
	};
	return 0;
}

static int window_submit(struct display *display, struct display_buffer *buffer, int64_t token,
			 struct fault *fault)
{
	struct window *window = display->state;

	if (SDL_UpdateTexture(window->texture, NULL, buffer->pixels, (int)buffer->stride) ||
	    SDL_RenderCopy(window->renderer, window->texture, NULL, NULL))
		return window_refused("draw", fault);
	SDL_RenderPresent(window->renderer);
	window->shown = (struct display_event){
		.kind = DISPLAY_SHOWN,
		.time_ns = clock_now_ns(),
		.token = token,
	};
	return tick_now(window);
}

static bool window_translate(const SDL_Event *from, struct display_event *to)
{
	if (from->type == SDL_QUIT ||
	    (from->type == SDL_KEYDOWN && from->key.keysym.sym == SDLK_ESCAPE)) {
		to->kind = DISPLAY_CLOSED;
		to->time_ns = clock_now_ns();
		return true;
	}
	if (from->type != SDL_KEYDOWN)
		return false;
	for (size_t i = 0; i < sizeof(keys) / sizeof(keys[0]); i++)
		if (from->key.keysym.sym == keys[i].key &&
		    (!from->key.repeat || action_repeats(keys[i].action))) {
			to->kind = DISPLAY_ACTION;
			to->action = keys[i].action;
			to->time_ns = clock_now_ns();
			return true;
		}
	return false;
}

static int window_dispatch(struct display *display, struct display_event *event,
			   struct fault *fault)
{
	struct window *window = display->state;
	SDL_Event from;
	uint64_t ticks;

	if (read(window->timer, &ticks, sizeof(ticks)) < 0 && errno != EAGAIN) {
		const int err = -errno;

		return fault_say(fault, err, "window display: timer: %s", strerror(-err));
	}
	if (window->shown.kind != DISPLAY_NOTHING) {
		*event = window->shown;
		window->shown.kind = DISPLAY_NOTHING;
		return 0;
	}
	while (SDL_PollEvent(&from))
		if (window_translate(&from, event))
			return 0;
	return 0;
}

static int window_close(struct display *display, struct fault *fault)
{
	struct window *window = display->state;

	(void)fault;
	if (!window)
		return 0;
	if (window->texture)
		SDL_DestroyTexture(window->texture);
	if (window->renderer)
		SDL_DestroyRenderer(window->renderer);
	if (window->window)
		SDL_DestroyWindow(window->window);
	if (window->sdl)
		SDL_QuitSubSystem(SDL_INIT_VIDEO);
	if (window->timer >= 0)
		close(window->timer);
	canvas_free(&window->canvas);
	free(window);
	display->state = NULL;
	return 0;
}

const struct display_ops display_window = {
	.name = "window",
	.description = "a window on a desktop (SDL2)",
	.open = window_open,
	.descriptor = window_descriptor,
	.acquire = window_acquire,
	.submit = window_submit,
	.dispatch = window_dispatch,
	.close = window_close,
};
