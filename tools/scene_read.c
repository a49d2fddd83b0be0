/*
 * Reads files by assimp; see scene_read.h.
 *
 * SPDX-License-Identifier: MIT
 */
#include "scene_read.h"

#include <assimp/cimport.h>
#include <assimp/scene.h>

#include <math.h>
#include <stdio.h>
#include <string.h>

/* An affine map: rows of x, y, z; the last column is the translation. */
typedef struct affine {
    double m[3][4];
} affine;

/* A walk over the meshes that the nodes of a scene show. */
typedef struct scene_walk {
    const struct aiScene *scene;
    polygon_mesh *mesh;
    bool is_moved;      /* some node has a transform that may round */
    const char *reason; /* why the scene is of no use, or NULL */
} scene_walk;

static affine affine_from_node(const struct aiNode *node)
{
    const struct aiMatrix4x4 *t = &node->mTransformation;
    const affine result = {{{(double)t->a1, (double)t->a2, (double)t->a3, (double)t->a4},
                            {(double)t->b1, (double)t->b2, (double)t->b3, (double)t->b4},
                            {(double)t->c1, (double)t->c2, (double)t->c3, (double)t->c4}}};
    return result;
}

/* first after second */
static affine affine_multiply(const affine *first, const affine *second)
{
    affine result;
    for (int row = 0; row < 3; row++) {
        for (int column = 0; column < 4; column++) {
            double sum = column == 3 ? first->m[row][3] : 0.0;
            for (int k = 0; k < 3; k++) sum += first->m[row][k] * second->m[k][column];
            result.m[row][column] = sum;
        }
    }
    return result;
}

static bool affine_is_identity(const affine *map)
{
    for (int row = 0; row < 3; row++) {
        for (int column = 0; column < 4; column++) {
            if (map->m[row][column] != (row == column ? 1.0 : 0.0)) return false;
        }
    }
    return true;
}

/* Whether a map does no more than exchange axes and turn them round, as some of assimp's readers
   have it done: that rounds nothing. */
static bool affine_is_exact(const affine *map)
{
    for (int row = 0; row < 3; row++) {
        int ones = 0;
        for (int column = 0; column < 4; column++) {
            const double entry = map->m[row][column];
            if (entry != 0.0 && (column == 3 || fabs(entry) != 1.0)) return false;
            ones += entry != 0.0;
        }
        if (ones != 1) return false;
    }
    return true;
}

static bool add_positions(scene_walk *walk, const struct aiMesh *mesh, const affine *map)
{
    const bool identity = affine_is_identity(map);
    if (!polygon_mesh_reserve_vertices(walk->mesh, mesh->mNumVertices)) return false;
    for (uint32_t i = 0; i < mesh->mNumVertices; i++) {
        const struct aiVector3D *v = &mesh->mVertices[i];
        const double in[3] = {(double)v->x, (double)v->y, (double)v->z};
        double out[3];
        for (int row = 0; row < 3; row++) {
            const double *m = map->m[row];
            out[row] = identity ? in[row] : m[0] * in[0] + m[1] * in[1] + m[2] * in[2] + m[3];
        }
        if (!polygon_mesh_add_vertex(walk->mesh, out)) return false;
    }
    if (!affine_is_exact(map)) walk->is_moved = true;
    return true;
}

static bool add_faces(scene_walk *walk, const struct aiMesh *mesh, uint32_t base)
{
    for (uint32_t f = 0; f < mesh->mNumFaces; f++) {
        const struct aiFace *face = &mesh->mFaces[f];
        for (uint32_t k = 0; k < face->mNumIndices; k++) {
            if (face->mIndices[k] >= mesh->mNumVertices)
                walk->reason = "a face names a vertex that does not exist; is the file truncated?";
            else if (!polygon_mesh_add_corner(walk->mesh, k, base + face->mIndices[k]))
                return false;
        }
        if (walk->reason) return true;
        if (!polygon_mesh_end_face(walk->mesh, face->mNumIndices)) return false;
    }
    return true;
}

/* A node's name, or that of its mesh. */
static bool add_name(scene_walk *walk, const struct aiNode *node)
{
    const struct aiString *name = &node->mName;
    if (name->length == 0) name = &walk->scene->mMeshes[node->mMeshes[0]]->mName;
    return polygon_mesh_mark(walk->mesh, 'o', name->data, name->length);
}

/* False if there is no memory. */
static bool walk_node(scene_walk *walk, const struct aiNode *node, const affine *parent)
{
    if (!node) { /* assimp's reader of RAW files leaves out nodes */
        walk->reason = "cannot be read as a mesh: assimp gives a scene with missing nodes";
        return true;
    }
    const affine own = affine_from_node(node);
    const affine map = affine_multiply(parent, &own);
    if (node->mNumMeshes && !add_name(walk, node)) return false;
    for (uint32_t i = 0; i < node->mNumMeshes && !walk->reason; i++) {
        const struct aiMesh *mesh = walk->scene->mMeshes[node->mMeshes[i]];
        const size_t base = walk->mesh->vertex_count;
        if (base + mesh->mNumVertices >= UINT32_MAX)
            walk->reason = "too many vertices";
        else if (!add_positions(walk, mesh, &map) || !add_faces(walk, mesh, (uint32_t)base))
            return false;
    }
    for (uint32_t i = 0; i < node->mNumChildren && !walk->reason; i++) {
        if (!walk_node(walk, node->mChildren[i], &map)) return false;
    }
    return true;
}

/* The ending of a name without .gz. */
static void find_ending(const char *path, char ending[16])
{
    size_t length = strlen(path);
    if (length > 3 && strcmp(path + length - 3, ".gz") == 0) length -= 3;
    size_t start = length;
    while (start > 0 && path[start - 1] != '.' && path[start - 1] != '/') start--;
    ending[0] = '\0';
    if (start > 0 && path[start - 1] == '.' && length - start < 16)
        snprintf(ending, 16, "%.*s", (int)(length - start), path + start);
}

/* Whether a format has nothing but floats for positions, which assimp hands out as they are. Not so
   3DS, of whose floats assimp subtracts others. */
static bool has_floats(const char *path)
{
    static const char *const endings[] = {"gltf", "glb", "vrm"};
    char ending[16];
    find_ending(path, ending);
    for (size_t i = 0; i < sizeof endings / sizeof *endings; i++) {
        const char *a = ending, *b = endings[i];
        while (*a && (*a | 0x20) == *b) a++, b++;
        if (!*a && !*b) return true;
    }
    return false;
}

bool scene_read_knows(const char *path)
{
    char ending[16], dotted[17];
    find_ending(path, ending);
    snprintf(dotted, sizeof dotted, ".%s", ending);
    return ending[0] && aiIsExtensionSupported(dotted) == AI_TRUE;
}

bool scene_read(polygon_mesh *mesh, const char *path, const char *data, size_t size, char *error,
                size_t error_size)
{
    const affine identity = {{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}}};
    memset(mesh, 0, sizeof *mesh);
    char ending[16];
    find_ending(path, ending);
    /* as it is: no post-processing */
    const struct aiScene *scene = !data ? aiImportFile(path, 0)
                                  : size < UINT32_MAX
                                      ? aiImportFileFromMemory(data, (unsigned)size, 0, ending)
                                      : NULL;
    if (!scene) {
        snprintf(error, error_size, "%s: cannot be read as a mesh: %s", path, aiGetErrorString());
        return false;
    }
    scene_walk walk = {scene, mesh, false, NULL};
    if (!polygon_mesh_init(mesh) ||
        (scene->mRootNode && !walk_node(&walk, scene->mRootNode, &identity)) ||
        !polygon_mesh_name_objects(mesh, 'o', false))
        walk.reason = "out of memory";
    mesh->has_animation = scene->mNumAnimations > 0;
    mesh->rounded = walk.is_moved || !has_floats(path);
    aiReleaseImport(scene);
    if (!walk.reason) return true;
    snprintf(error, error_size, "%s: %s", path, walk.reason);
    polygon_mesh_free(mesh);
    return false;
}
