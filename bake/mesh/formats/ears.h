/* SPDX-License-Identifier: MIT */
/*
 * Cuts a polygon into triangles, by ears (Meisters 1975). A corner is looked at again only when a
 * neighbour of it has been cut off, and a grid finds the corners that stand in an ear: n corners of
 * a polygon that does not cross itself take about n log n.
 */
#ifndef INLAY_BAKE_MESH_FORMATS_EARS_H
#define INLAY_BAKE_MESH_FORMATS_EARS_H

#include <stdbool.h>

/* Corners in the plane, counter-clockwise. */
bool ears_convex(const double (*at)[2], int count);

/* Writes count - 2 triangles of corner numbers, of the polygon's winding. Corners at one place do
 * not stand in each other's ears: bridges to holes have them. A polygon that crosses itself or has
 * no area is cut anywhere where there is no ear. count >= 3. 0 or -ENOMEM. */
int ears_cut(const double (*at)[2], int count, int (*triangle)[3]);

#endif
