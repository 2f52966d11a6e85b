/* A background to composite into: the same one everywhere, with gradients, edges and texture, from
 * black to white. For bench alone. */
#ifndef INLAY_APP_BENCH_PICTURE_H
#define INLAY_APP_BENCH_PICTURE_H

#include "hal/frame.h"

void bench_picture_fill(struct canvas *canvas);

#endif
