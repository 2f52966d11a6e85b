/* SPDX-License-Identifier: MIT */
/*
 * Messages to whoever runs the program: stderr, one line each, "inlay: text". Where stderr leads to
 * the system's journal, which knows the program, a level goes before the text instead: "<4>text",
 * as sd-daemon(3) has it.
 *
 * Thread-safe. A caller that would repeat itself every frame says it once, when it changes.
 */
#ifndef INLAY_HAL_BASE_LOG_H
#define INLAY_HAL_BASE_LOG_H

enum log_level { LOG_LEVEL_ERROR, LOG_LEVEL_WARNING, LOG_LEVEL_INFO, LOG_LEVEL_DEBUG };

/* Program name before each message ("inlay", "inlay-bake") and the least urgent level shown. Called
 * before other threads start; without it: "inlay", LOG_LEVEL_INFO, and no journal. */
void log_setup(const char *program, enum log_level most);

/* Control characters become "?": one message is one line, whatever it repeats of a file. */
void log_say(enum log_level level, const char *format, ...) __attribute__((format(printf, 2, 3)));

/* The same, but once for each text while the program runs: for what a device gets wrong time after
 * time, whoever opens it again or asks it again. Of many texts the oldest are forgotten. */
void log_say_once(enum log_level level, const char *format, ...)
	__attribute__((format(printf, 2, 3)));

#define log_error(...) log_say(LOG_LEVEL_ERROR, __VA_ARGS__)
#define log_warning(...) log_say(LOG_LEVEL_WARNING, __VA_ARGS__)
#define log_warning_once(...) log_say_once(LOG_LEVEL_WARNING, __VA_ARGS__)
#define log_info(...) log_say(LOG_LEVEL_INFO, __VA_ARGS__)
#define log_debug(...) log_say(LOG_LEVEL_DEBUG, __VA_ARGS__)

#endif
