/* SPDX-License-Identifier: MIT */
/* The colours of the toy cow's coat. */
#ifndef INLAY_BAKE_DEMO_COW_COAT_H
#define INLAY_BAKE_DEMO_COW_COAT_H

/* sRGB code values 0..1 of a point on the coat, in the coordinates of cow_shape.h. */
void cow_colour(const double p[3], double rgb[3]);

#endif
