/* SPDX-License-Identifier: MIT */
#include "bake/mesh/mesh_import.h"

#include <errno.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <assimp/cimport.h>
#include <assimp/material.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include "bake/mesh/gltf/gltf.h"
#include "bake/mesh/mesh_files.h"
#include "bake/mesh/mesh_mtl.h"
#include "bake/mesh/mesh_normals.h"
#include "bake/mesh/mesh_ply.h"
#include "bake/mesh/plain_file.h"
#include "hal/optics/vec.h"

#define TRIANGLES_MAX (64 << 20)

static void *import_allocate(size_t count, size_t size)
{
	return calloc(count ? count : 1, size);
}

/* ---- geometry ---- */

static int import_part(struct mesh_part *part, const struct aiMesh *from, double crease_deg,
		       const char *path, struct fault *fault)
{
	const size_t vertices = from->mNumVertices;

	if (from->mNumVertices > INT_MAX / 4 || from->mNumFaces > TRIANGLES_MAX)
		return fault_say(fault, -EFBIG, "%s: %u triangles, expected at most %d", path,
				 from->mNumFaces, TRIANGLES_MAX);
	part->material = (int)from->mMaterialIndex;
	part->vertices = (int)from->mNumVertices;
	part->position = import_allocate(vertices, sizeof(*part->position));
	part->normal = import_allocate(vertices, sizeof(*part->normal));
	part->index = import_allocate(from->mNumFaces, sizeof(*part->index));
	if (from->mTextureCoords[0])
		part->uv = import_allocate(vertices, sizeof(*part->uv));
	if (!part->position || !part->normal || !part->index ||
	    (from->mTextureCoords[0] && !part->uv))
		return fault_say(fault, -ENOMEM, "%s: out of memory", path);
	for (size_t i = 0; i < vertices; i++) {
		part->position[i][0] = from->mVertices[i].x;
		part->position[i][1] = from->mVertices[i].y;
		part->position[i][2] = from->mVertices[i].z;
		if (from->mNormals &&
		    isfinite(from->mNormals[i].x + from->mNormals[i].y + from->mNormals[i].z))
			part->normal[i] = v3_unit(v3_make(from->mNormals[i].x, from->mNormals[i].y,
							  from->mNormals[i].z));
		if (part->uv && isfinite(from->mTextureCoords[0][i].x) &&
		    isfinite(from->mTextureCoords[0][i].y)) {
			part->uv[i][0] = from->mTextureCoords[0][i].x;
			part->uv[i][1] = from->mTextureCoords[0][i].y;
		}
	}
	for (unsigned f = 0; f < from->mNumFaces; f++) {
		const struct aiFace *face = &from->mFaces[f];

		if (face->mNumIndices != 3)
			continue;
		memcpy(part->index[part->triangles++], face->mIndices, sizeof(*part->index));
	}
	if (!from->mNormals && mesh_smooth(part, crease_deg) < 0)
		return fault_say(fault, -ENOMEM, "%s: out of memory", path);
	return 0;
}

/* ---- materials ---- */

/* Joins the folder of the mesh and a texture's name, which may have backslashes. */
static int texture_path(const char *mesh_path, const char *name, char out[PATH_MAX])
{
	const char *slash = strrchr(mesh_path, '/');
	const int folder = name[0] != '/' && slash ? (int)(slash - mesh_path) + 1 : 0;
	const int n = snprintf(out, PATH_MAX, "%.*s%s", folder, mesh_path, name);

	if (n < 0 || n >= PATH_MAX)
		return -ENAMETOOLONG;
	for (char *c = out + folder; *c; c++)
		if (*c == '\\')
			*c = '/';
	return 0;
}

static int import_image(struct image *image, const struct aiScene *scene, const char *name,
			const char *mesh_path, struct fault *fault)
{
	const struct aiTexture *inside = NULL;
	char path[PATH_MAX];
	FILE *file;
	int err;

	if (name[0] == '*') {
		const unsigned long at = strtoul(name + 1, NULL, 10);

		if (at < scene->mNumTextures)
			inside = scene->mTextures[at];
	}
	if (inside && !inside->mHeight)
		return image_read_memory((const uint8_t *)inside->pcData, inside->mWidth, mesh_path,
					 image, fault);
	if (inside)
		return fault_say(fault, -ENOTSUP,
				 "%s: a texture of bare texels, expected PNG or JPEG inside",
				 mesh_path);
	err = texture_path(mesh_path, name, path);
	if (err)
		return fault_say(fault, err, "%s: the texture's path is too long", mesh_path);
	err = plain_file_open(&file, path, PLAIN_FILE_MAX, fault);
	if (err)
		return err;
	fclose(file);
	return image_read(path, image, fault);
}

static int import_texture(struct mesh *mesh, struct material *material, const struct aiScene *scene,
			  const char *name, const char *path, struct fault *fault)
{
	struct texture **grown = realloc(mesh->textures,
					 ((size_t)mesh->texture_count + 1) * sizeof(*grown));
	struct texture *texture = calloc(1, sizeof(*texture));
	int err;

	if (grown)
		mesh->textures = grown;
	if (!grown || !texture) {
		free(texture);
		return fault_say(fault, -ENOMEM, "%s: out of memory", path);
	}
	err = import_image(&texture->image, scene, name, path, fault);
	if (err) {
		free(texture);
		return err;
	}
	texture_prepare(texture);
	mesh->textures[mesh->texture_count++] = texture;
	material->texture = texture;
	return 0;
}

static struct rgb clamp_colour(struct aiColor4D c)
{
	const float raw[3] = {c.r, c.g, c.b};
	struct rgb out;

	for (int k = 0; k < 3; k++)
		out.c[k] = raw[k] > 0 ? fminf(raw[k], 1) : 0;
	return out;
}

/* Sets metal and roughness by glTF's model: a metal's colour is its reflectance, and it has no
 * diffuse base. */
static void set_metallic(struct material *m, float metallic, float roughness)
{
	metallic = fminf(fmaxf(metallic, 0), 1);
	m->kind = MATERIAL_GLOSSY;
	m->roughness = fminf(fmaxf(roughness, 0), 1);
	m->metal = rgb_scale(m->colour, metallic);
	for (int c = 0; c < 3; c++)
		m->specular.c[c] = 0.04f * (1 - metallic) + m->metal.c[c];
	m->colour = rgb_scale(m->colour, 1 - metallic);
}

/* Turns an exponent n of Phong's model into the GGX alpha of the same width:
 *     alpha^2 = 2 / (n + 2) */
static void set_phong(struct material *m, struct rgb specular, float exponent)
{
	m->kind = MATERIAL_GLOSSY;
	m->specular = specular;
	m->roughness = sqrtf(sqrtf(2 / (exponent + 2)));
	/* Kd + Ks above 1 would create energy */
	for (int c = 0; c < 3; c++)
		m->specular.c[c] = fminf(specular.c[c], 1 - m->colour.c[c]);
}

/* Tells whether assimp has invented this material, a grey that differs between formats, because the
 * file has none. A glTF's default, which is a metal, is what that format prescribes. */
static bool is_made_up(const struct aiMaterial *from)
{
	struct aiString name = {.length = 0};
	ai_real metallic;

	return aiGetMaterialFloat(from, AI_MATKEY_METALLIC_FACTOR, &metallic) != AI_SUCCESS &&
	       (aiGetMaterialString(from, AI_MATKEY_NAME, &name) != AI_SUCCESS || !name.length ||
		strcmp(name.data, AI_DEFAULT_MATERIAL_NAME) == 0);
}

/* Multiplies glTF's factors by the means of their texture (roughness in green, metal in blue). The
 * factors are mostly 1, and the texture has the real values. */
static int take_surface_means(const struct aiScene *scene, const struct aiMaterial *from,
			      ai_real *metallic, ai_real *roughness, const char *path,
			      struct fault *fault)
{
	double green = 0, blue = 0;
	struct aiString name;
	struct image image;
	size_t pixels;
	int err;

	if (aiGetMaterialTexture(from, aiTextureType_UNKNOWN, 0, &name, NULL, NULL, NULL, NULL,
				 NULL, NULL) != AI_SUCCESS)
		return 0;
	err = import_image(&image, scene, name.data, path, fault);
	if (err)
		return err;
	pixels = (size_t)image.width * (size_t)image.height;
	for (size_t k = 0; k < pixels; k++) {
		green += image.u8 ? image.u8[3 * k + 1] / 255.0 : (double)image.f32[3 * k + 1];
		blue += image.u8 ? image.u8[3 * k + 2] / 255.0 : (double)image.f32[3 * k + 2];
	}
	*roughness *= (ai_real)(green / (double)pixels);
	*metallic *= (ai_real)(blue / (double)pixels);
	image_free(&image);
	return 0;
}

static int import_material(struct mesh *mesh, struct material *m, const struct aiScene *scene,
			   const struct aiMaterial *from, const char *path, struct fault *fault)
{
	struct aiColor4D colour = {0.8f, 0.8f, 0.8f, 1}, specular = {0, 0, 0, 1};
	ai_real metallic, roughness = 1, exponent = 0;
	struct aiString name;

	if (!is_made_up(from)) {
		aiGetMaterialColor(from, AI_MATKEY_COLOR_DIFFUSE, &colour);
		aiGetMaterialColor(from, AI_MATKEY_COLOR_SPECULAR, &specular);
	}
	m->colour = clamp_colour(colour);
	m->ior = 1.5f;
	if (aiGetMaterialFloat(from, AI_MATKEY_METALLIC_FACTOR, &metallic) == AI_SUCCESS) {
		int err;

		aiGetMaterialFloat(from, AI_MATKEY_ROUGHNESS_FACTOR, &roughness);
		err = take_surface_means(scene, from, &metallic, &roughness, path, fault);
		if (err)
			return err;
		set_metallic(m, metallic, roughness);
	} else if (aiGetMaterialFloat(from, AI_MATKEY_SHININESS, &exponent) == AI_SUCCESS &&
		   exponent > 0 && rgb_peak(clamp_colour(specular)) > 0) {
		set_phong(m, clamp_colour(specular), exponent);
	}
	if (aiGetMaterialTextureCount(from, aiTextureType_DIFFUSE) > 0 &&
	    aiGetMaterialTexture(from, aiTextureType_DIFFUSE, 0, &name, NULL, NULL, NULL, NULL,
				 NULL, NULL) == AI_SUCCESS)
		return import_texture(mesh, m, scene, name.data, path, fault);
	return 0;
}

/* ---- all of it ---- */

static int import_scene(struct mesh *mesh, const struct aiScene *scene, const char *path,
			double crease_deg, bool materials, struct fault *fault)
{
	int err = 0;

	mesh->parts = import_allocate(scene->mNumMeshes, sizeof(*mesh->parts));
	mesh->materials = import_allocate(scene->mNumMaterials, sizeof(*mesh->materials));
	if (!mesh->parts || !mesh->materials)
		return fault_say(fault, -ENOMEM, "%s: out of memory", path);
	for (unsigned k = 0; k < scene->mNumMeshes && !err; k++) {
		if (!(scene->mMeshes[k]->mPrimitiveTypes & aiPrimitiveType_TRIANGLE))
			continue;
		err = import_part(&mesh->parts[mesh->part_count++], scene->mMeshes[k], crease_deg,
				  path, fault);
	}
	if (!materials)
		return err;
	for (unsigned k = 0; k < scene->mNumMaterials && !err; k++)
		err = import_material(mesh, &mesh->materials[mesh->material_count++], scene,
				      scene->mMaterials[k], path, fault);
	return err;
}

static int check_mesh(const struct aiMesh *mesh, const char *path, struct fault *fault)
{
	for (unsigned v = 0; v < mesh->mNumVertices; v++) {
		const struct aiVector3D *p = &mesh->mVertices[v];

		if (!isfinite(p->x) || !isfinite(p->y) || !isfinite(p->z))
			return fault_say(fault, -EDOM,
					 "%s: vertex %u is not finite, expected numbers", path,
					 v + 1);
	}
	for (unsigned f = 0; f < mesh->mNumFaces; f++) {
		if (mesh->mFaces[f].mNumIndices == 0)
			return fault_say(fault, -EBADMSG,
					 "%s: face %u has no vertices, expected 3 or more", path,
					 f + 1);
		for (unsigned i = 0; i < mesh->mFaces[f].mNumIndices; i++)
			if (mesh->mFaces[f].mIndices[i] >= mesh->mNumVertices)
				return fault_say(fault, -EBADMSG,
						 "%s: face %u names vertex %u, expected less "
						 "than %u: damaged or cut short",
						 path, f + 1, mesh->mFaces[f].mIndices[i],
						 mesh->mNumVertices);
	}
	return 0;
}

/* Checks the scene as it is in the file: assimp's processing steps trust indices, do not expect
 * NaN, and abort on a face without vertices. */
static int check_scene(const struct aiScene *scene, const char *path, struct fault *fault)
{
	unsigned faces = 0;
	int err = 0;

	for (unsigned k = 0; k < scene->mNumMeshes && !err; k++) {
		faces |= scene->mMeshes[k]->mNumFaces;
		err = check_mesh(scene->mMeshes[k], path, fault);
	}
	if (!err && !faces)
		err = fault_say(fault, -ENODATA,
				"%s: no faces, expected a mesh of triangles or polygons", path);
	return err;
}

static int import_open(const struct aiScene **scene, const char *path, unsigned steps,
		       struct fault *fault)
{
	struct aiFileIO files = mesh_files();

	*scene = aiImportFileEx(path, steps, &files);
	return *scene ? 0
		      : fault_say(fault, -EBADMSG,
				  "%s: no mesh that can be read (%s), expected OBJ, PLY or glTF",
				  path, aiGetErrorString());
}

/*
 * Reads the file twice: first without processing steps, to check it, then with them, as assimp 5.2
 * crashes when a step that is run later fails. Generating normals is not among the steps: assimp
 * smooths as if no two faces of a file shared a vertex, but those of PLY and glTF do.
 */
int mesh_import(struct mesh *mesh, const char *path, double crease_deg, bool materials,
		struct fault *fault)
{
	const unsigned steps = aiProcess_Triangulate | aiProcess_JoinIdenticalVertices |
			       aiProcess_PreTransformVertices;
	const struct aiScene *scene;
	int err;

	if (gltf_is(path))
		return gltf_read(mesh, path, crease_deg, materials, fault);
	err = materials ? mesh_mtl_check(path, fault) : 0;
	if (!err)
		err = mesh_ply_check(path, fault);
	if (!err)
		err = import_open(&scene, path, 0, fault);
	if (err)
		return err;
	err = check_scene(scene, path, fault);
	aiReleaseImport(scene);
	if (!err)
		err = import_open(&scene, path, steps, fault);
	if (err)
		return err;
	err = import_scene(mesh, scene, path, crease_deg, materials, fault);
	aiReleaseImport(scene);
	return err;
}
