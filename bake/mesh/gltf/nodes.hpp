/* SPDX-License-Identifier: MIT */
/* The tree of nodes: where each stands, which of them the scene shows, and how skins move. */
#ifndef INLAY_BAKE_MESH_GLTF_NODES_HPP
#define INLAY_BAKE_MESH_GLTF_NODES_HPP

#include "bake/mesh/gltf/document.hpp"

namespace gltf
{

/* Three rows of four numbers: p' = M p + t. */
struct Matrix {
	double m[3][4];
};

constexpr Matrix matrix_identity = {{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}}};

Matrix operator*(const Matrix &a, const Matrix &b);
double determinant(const Matrix &a);
void move_point(const Matrix &a, const float from[3], float to[3]);
void move_direction(const Matrix &a, const float from[3],
		    float to[3]); /* without the translation */
/* Moves a normal, which stays perpendicular to its surface and on the same side of it. It need not
 * be unit before, and is not afterwards. */
void move_normal(const Matrix &a, const float from[3], float to[3]);

/* Translation, rotation (a quaternion x y z w, of any length) and scale. */
Matrix matrix_of(const double translation[3], const double rotation[4], const double scale[3]);

class Nodes
{
      public:
	explicit Nodes(const Document &document);

	std::vector<Matrix> global;  /* of each node */
	std::vector<size_t> visible; /* the nodes of the scene, parents before children */

      private:
	void find_globals(const Document &document);
	void find_visible(const Document &document);

	std::vector<size_t> parent; /* of each node; itself: none */
};

/* What each joint of a skin does to vertices at rest. */
std::vector<Matrix> skin_matrices(Document &document, const Nodes &nodes, const Json &skin);

/* The copies of a node by EXT_mesh_gpu_instancing; empty: there is no such extension. */
std::vector<Matrix> instance_matrices(Document &document, const Json &node);

} // namespace gltf

#endif
