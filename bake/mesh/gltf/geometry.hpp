/* SPDX-License-Identifier: MIT */
/* Vertices and triangles of a primitive, in the coordinates of its mesh, at its default morph. */
#ifndef INLAY_BAKE_MESH_GLTF_GEOMETRY_HPP
#define INLAY_BAKE_MESH_GLTF_GEOMETRY_HPP

#include "bake/mesh/gltf/accessor.hpp"

namespace gltf
{

/* The joints that move each vertex, and their weights: each * vertices of both. */
struct Influences {
	size_t each = 0;
	std::vector<float> joint, weight;
};

struct Geometry {
	size_t vertices;
	std::vector<float> position; /* 3 */
	std::vector<float> normal;   /* 3; empty: none */
	std::vector<float> tangent;  /* 4; empty: none */
	std::vector<float> uv[2];    /* 2, v upwards; empty: none */
	std::vector<float> colour;   /* 4; empty: none */
	Influences influences;
	std::vector<uint32_t> corners; /* 3 each triangle, in range */
};

enum Mode : size_t { TRIANGLES = 4, TRIANGLE_STRIP = 5, TRIANGLE_FAN = 6, MODE_MOST = 6 };

/* weights: of the morph targets. sets: which texture coordinates become uv. The primitive's mode
 * has triangles. */
Geometry read_geometry(Document &document, const Json &primitive,
		       const std::vector<double> &weights, const size_t sets[2]);

} // namespace gltf

#endif
