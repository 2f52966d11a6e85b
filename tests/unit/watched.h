/* Whether a sanitizer watches: then a program takes about ten times as long. What is tried again
 * only with more of the same may be left to the build as it is delivered. */
#ifndef INLAY_TESTS_UNIT_WATCHED_H
#define INLAY_TESTS_UNIT_WATCHED_H

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define WATCHED 1
#else
#define WATCHED 0
#endif

#endif
