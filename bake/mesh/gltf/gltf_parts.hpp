/* SPDX-License-Identifier: MIT */
/* The parts of a reader of glTF. */
#ifndef INLAY_BAKE_MESH_GLTF_GLTF_PARTS_HPP
#define INLAY_BAKE_MESH_GLTF_GLTF_PARTS_HPP

#include <map>
#include <memory>
#include <tuple>
#include <utility>

#include "bake/mesh/gltf/document.hpp"

extern "C" {
#include "bake/mesh/left_out.h"
#include "bake/mesh/mesh.h"
}

namespace draco
{
class Mesh;
}

namespace gltf
{

/* Vertices and triangles that Draco has compressed. */
class Compressed
{
      public:
	/* extension: the object of the primitive's extension */
	Compressed(Document &document, const Json &extension);
	~Compressed();

	/* Whether an attribute, such as "POSITION", is in the compressed data. */
	bool has(const std::string &attribute) const;
	/* accessor: of the attribute; NULL: it has none. */
	Values values(const std::string &attribute, const Json *accessor) const;
	std::vector<uint32_t> corners() const; /* of triangles */

      private:
	const Json &attributes;
	std::unique_ptr<draco::Mesh> mesh;
};

/* ---- vertices and triangles of a primitive, in the coordinates of its mesh, at its default
 * morph ---- */

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

namespace gltf
{

/* A material of the mesh. Its textures use two sets of coordinates, whatever their numbers. */
struct Used {
	int material;
	size_t sets[2];
	bool textured[2]; /* which of them textures use */
	bool one_sided;
	/* Where a texture says how much light passes: what the surface is made of where that is
	 * little, in red times the share; -1: there is no such texture. */
	int dull;
	texture_use passing;
	float share;
};

class Materials
{
      public:
	/* Materials and textures are added to the mesh, which owns them. read: whether there are
	 * any; if not, all materials are the mesh's first. */
	Materials(Document &from, mesh *to, left_out *missing, bool read);

	/* The material of a primitive, which is read when it is first used. scale: of lengths from
	 * the mesh to the world, which a volume's thickness has too. */
	Used use(const Json &primitive, double scale);

      private:
	/* Image, wrap modes, nearest, data. */
	using TextureKey = std::tuple<size_t, texture_wrap, texture_wrap, bool, bool>;

	int add(const Json &from, Used &used);
	void read(const Json &from, material &to, Used &used);
	void read_metallic(const Json &from, material &to, Used &used);
	void read_glossiness(const Json &from, material &to, Used &used);
	void read_coat(const Json &from, material &to);
	void read_glass(const Json &from, material &to, Used &used);
	double thickness_of(const Json &from, Used &used);
	void read_alpha(const Json &from, material &to);
	void leave_out(const Json &from);
	void set_colour(const Json *info, material &to, Used &used);
	texture_use read_use(const Json &info, bool data, Used &used);
	const texture *read_texture(const Json &info, bool data);
	const texture *load_texture(const TextureKey &key);

	Document &document;
	mesh *into;
	left_out *missing;
	bool wanted;
	double to_world = 1; /* scale of the material that is read */
	bool dull = false;   /* glass is left out of it */
	/* by index in the file, whose count is the default, and scale if it matters */
	std::map<std::pair<size_t, double>, Used> known;
	std::map<TextureKey, const texture *> textures;
};

/* ---- the tree of nodes: where each stands, which of them the scene shows, and how skins move
 * ---- */

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
