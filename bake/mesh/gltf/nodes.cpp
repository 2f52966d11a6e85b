/* SPDX-License-Identifier: MIT */
#include "bake/mesh/gltf/gltf_parts.hpp"

#include <algorithm>
#include <cerrno>
#include <cmath>

#include "bake/mesh/gltf/document.hpp"

namespace gltf
{

/* ---- matrices ---- */

Matrix operator*(const Matrix &a, const Matrix &b)
{
	Matrix out;

	for (int i = 0; i < 3; i++)
		for (int j = 0; j < 4; j++)
			out.m[i][j] = a.m[i][0] * b.m[0][j] + a.m[i][1] * b.m[1][j] +
				      a.m[i][2] * b.m[2][j] + (j == 3 ? a.m[i][3] : 0);
	return out;
}

/* Element i, j of the matrix that is the inverse, transposed and times the determinant. */
static double cofactor(const Matrix &a, int i, int j)
{
	const int i1 = (i + 1) % 3, i2 = (i + 2) % 3, j1 = (j + 1) % 3, j2 = (j + 2) % 3;

	return a.m[i1][j1] * a.m[i2][j2] - a.m[i1][j2] * a.m[i2][j1];
}

double determinant(const Matrix &a)
{
	return a.m[0][0] * cofactor(a, 0, 0) + a.m[0][1] * cofactor(a, 0, 1) +
	       a.m[0][2] * cofactor(a, 0, 2);
}

void move_point(const Matrix &a, const float from[3], float to[3])
{
	float moved[3];

	for (int i = 0; i < 3; i++)
		moved[i] = static_cast<float>(a.m[i][0] * static_cast<double>(from[0]) +
					      a.m[i][1] * static_cast<double>(from[1]) +
					      a.m[i][2] * static_cast<double>(from[2]) + a.m[i][3]);
	std::copy_n(moved, 3, to);
}

void move_direction(const Matrix &a, const float from[3], float to[3])
{
	Matrix turned = a;

	for (auto &row : turned.m)
		row[3] = 0;
	move_point(turned, from, to);
}

void move_normal(const Matrix &a, const float from[3], float to[3])
{
	const double side = determinant(a) < 0 ? -1 : 1;
	double moved[3], length;

	for (int i = 0; i < 3; i++)
		moved[i] = side * (cofactor(a, i, 0) * static_cast<double>(from[0]) +
				   cofactor(a, i, 1) * static_cast<double>(from[1]) +
				   cofactor(a, i, 2) * static_cast<double>(from[2]));
	length = std::hypot(moved[0], moved[1], moved[2]);
	for (int i = 0; i < 3; i++)
		to[i] = length > 0 ? static_cast<float>(moved[i] / length) : 0;
}

Matrix matrix_of(const double t[3], const double r[4], const double s[3])
{
	const double length = std::sqrt(r[0] * r[0] + r[1] * r[1] + r[2] * r[2] + r[3] * r[3]);
	const double k = length > 0 ? 1 / length : 0;
	const double x = r[0] * k, y = r[1] * k, z = r[2] * k, w = r[3] * k;
	const double turn[3][3] = {
		{1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)},
		{2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)},
		{2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)},
	};
	Matrix out;

	for (int i = 0; i < 3; i++) {
		for (int j = 0; j < 3; j++)
			out.m[i][j] = turn[i][j] * s[j];
		out.m[i][3] = t[i];
	}
	return out;
}

/* A file has the 16 numbers column by column. */
template <typename T> static Matrix matrix_of_columns(const T *column)
{
	Matrix out;

	for (int i = 0; i < 3; i++)
		for (int j = 0; j < 4; j++)
			out.m[i][j] = static_cast<double>(column[4 * j + i]);
	return out;
}

static Matrix local_matrix(const Json &node)
{
	double t[3] = {0, 0, 0}, r[4] = {0, 0, 0, 1}, s[3] = {1, 1, 1}, columns[16];

	if (numbers(node, "matrix", columns, 16))
		return matrix_of_columns(columns);
	numbers(node, "translation", t, 3);
	numbers(node, "rotation", r, 4);
	numbers(node, "scale", s, 3);
	return matrix_of(t, r, s);
}

/* ---- the tree ---- */

void Nodes::find_globals(const Document &document)
{
	const size_t count = parent.size();
	std::vector<bool> known(count, false);
	std::vector<size_t> path;

	for (size_t node = 0; node < count; node++) {
		/* up to a node that is known or has no parent, then down again */
		for (size_t at = node; !known[at] && path.size() <= count; at = parent[at]) {
			path.push_back(at);
			if (parent[at] == at)
				break;
		}
		if (path.size() > count)
			fail_at(document.item("nodes", node), -EBADMSG,
				"it is its own ancestor, expected a tree");
		for (; !path.empty(); path.pop_back()) {
			const size_t at = path.back();
			const Matrix local = local_matrix(document.item("nodes", at));

			global[at] = parent[at] == at ? local : global[parent[at]] * local;
			known[at] = true;
		}
	}
}

void Nodes::find_visible(const Document &document)
{
	const size_t count = parent.size();
	std::vector<size_t> next;
	std::vector<bool> seen(count, false);

	if (document.count("scenes")) {
		const size_t scene = whole(*document.root, "scene", document.count("scenes") - 1,
					   0);

		for (const Json *node : elements(document.item("scenes", scene), "nodes"))
			next.push_back(document.index(*node, "nodes"));
	} else {
		for (size_t node = 0; node < count; node++)
			if (parent[node] == node)
				next.push_back(node);
	}
	std::reverse(next.begin(), next.end());
	while (!next.empty()) {
		const size_t at = next.back();
		const Json &node = document.item("nodes", at);
		const Json *shown = find_extension(node, "KHR_node_visibility");

		next.pop_back();
		if (seen[at] || (shown && !truth(*shown, "visible", true)))
			continue;
		seen[at] = true;
		visible.push_back(at);

		const std::vector<const Json *> children = elements(node, "children");

		for (size_t k = children.size(); k-- > 0;)
			next.push_back(document.index(*children[k], "nodes"));
	}
}

Nodes::Nodes(const Document &document)
{
	const size_t count = document.count("nodes");

	global.resize(count);
	for (size_t node = 0; node < count; node++)
		parent.push_back(node);
	for (size_t node = 0; node < count; node++)
		for (const Json *child : elements(document.item("nodes", node), "children")) {
			const size_t at = document.index(*child, "nodes");

			if (parent[at] != at || at == node)
				fail_at(*child, -EBADMSG,
					"node " + std::to_string(at) +
						" has two parents, expected a tree");
			parent[at] = node;
		}
	find_globals(document);
	find_visible(document);
}

/* ---- skins and instances ---- */

std::vector<Matrix> skin_matrices(Document &document, const Nodes &nodes, const Json &skin)
{
	const std::vector<const Json *> joints = elements(skin, "joints");
	const Json *inverse = find(skin, "inverseBindMatrices");
	std::vector<Matrix> out;
	Values bind = {0, 0, {}};

	if (inverse) {
		bind = read_values(document, document.index(*inverse, "accessors"));
		if (bind.components != 16 || bind.count < joints.size())
			fail_at(*inverse, -EBADMSG,
				std::to_string(bind.count) + " matrices of " +
					std::to_string(bind.components) + " numbers, expected " +
					std::to_string(joints.size()) + " of 16");
	}
	for (size_t k = 0; k < joints.size(); k++) {
		const size_t joint = document.index(*joints[k], "nodes");

		out.push_back(inverse ? nodes.global[joint] * matrix_of_columns(&bind.value[16 * k])
				      : nodes.global[joint]);
	}
	return out;
}

std::vector<Matrix> instance_matrices(Document &document, const Json &node)
{
	static const struct {
		const char *name;
		size_t components;
		double values[4];
	} kinds[] = {{"TRANSLATION", 3, {0, 0, 0, 0}},
		     {"ROTATION", 4, {0, 0, 0, 1}},
		     {"SCALE", 3, {1, 1, 1, 0}}};
	const Json *instancing = find_extension(node, "EXT_mesh_gpu_instancing");
	std::vector<Matrix> out;
	Values given[3];
	size_t count = 0;

	if (!instancing)
		return out;

	const Json &attributes = needed(*instancing, "attributes");

	for (int k = 0; k < 3; k++) {
		if (!find(attributes, kinds[k].name))
			continue;
		given[k] = read_values(
			document, document.index(needed(attributes, kinds[k].name), "accessors"));
		if (given[k].components != kinds[k].components ||
		    (count && given[k].count != count))
			fail_at(attributes, -EBADMSG,
				std::string(kinds[k].name) + ": " + std::to_string(given[k].count) +
					" elements of " + std::to_string(given[k].components) +
					" numbers");
		count = given[k].count;
	}
	document.lend(static_cast<double>(count * sizeof(Matrix)));
	for (size_t i = 0; i < count; i++) {
		double values[3][4];

		for (int k = 0; k < 3; k++)
			for (size_t c = 0; c < kinds[k].components; c++)
				values[k][c] =
					given[k].value.empty()
						? kinds[k].values[c]
						: static_cast<double>(
							  given[k].value[given[k].components * i +
									 c]);
		out.push_back(matrix_of(values[0], values[1], values[2]));
	}
	return out;
}

} // namespace gltf
