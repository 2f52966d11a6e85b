/* SPDX-License-Identifier: MIT */
/*
 * Messages for the person who runs the program: one line each on stderr, "inlay: text". Where
 * stderr leads to the system's journal, which knows the program's name, the level stands before the
 * text instead: "<4>text", as in sd-daemon(3).
 *
 * Thread-safe. A caller that would repeat a message every frame logs only changes.
 */
#ifndef INLAY_HAL_BASE_LOG_H
#define INLAY_HAL_BASE_LOG_H

enum log_level { LOG_LEVEL_ERROR, LOG_LEVEL_WARNING, LOG_LEVEL_INFO, LOG_LEVEL_DEBUG };

/* Sets the program's name before each message ("inlay", "inlay-bake") and the least urgent level
 * that is shown. Call it before other threads start. Without it: "inlay", LOG_LEVEL_INFO, no
 * journal. */
void log_setup(const char *program, enum log_level most);

/* Writes one message. Control characters become "?": a message stays one line even when it quotes
 * a file. */
void log_say(enum log_level level, const char *format, ...) __attribute__((format(printf, 2, 3)));

/* Writes each text only once while the program runs: for errors that a device repeats whenever it
 * is opened or asked again. Remembers the last 256 texts. */
void log_say_once(enum log_level level, const char *format, ...)
	__attribute__((format(printf, 2, 3)));

/* For what may come again and again, such as the troubles of a device that comes and goes: the
 * first few of a text are written, later ones are counted (log_pace.h). */
void log_say_paced(enum log_level level, const char *format, ...)
	__attribute__((format(printf, 2, 3)));

/* Writes the counts that are due. A program that runs for long calls it once a second. */
void log_tick(void);

#define log_error(...) log_say(LOG_LEVEL_ERROR, __VA_ARGS__)
#define log_warning(...) log_say(LOG_LEVEL_WARNING, __VA_ARGS__)
#define log_warning_once(...) log_say_once(LOG_LEVEL_WARNING, __VA_ARGS__)
#define log_warning_paced(...) log_say_paced(LOG_LEVEL_WARNING, __VA_ARGS__)
#define log_info_paced(...) log_say_paced(LOG_LEVEL_INFO, __VA_ARGS__)
#define log_info(...) log_say(LOG_LEVEL_INFO, __VA_ARGS__)
#define log_debug(...) log_say(LOG_LEVEL_DEBUG, __VA_ARGS__)

#endif
