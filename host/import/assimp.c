#include "host/import/vertices.h"

#include <assimp/cimport.h>
#include <assimp/scene.h>

/* Where in the scene a node's meshes go: row-major 3x4, or NULL for unmoved, so that bits stay as they are in the
 * file. */
typedef struct placement {
    struct aiMatrix4x4 matrix;
    bool moved;
} placement;

/* Exactly; assimp's own test takes a shift of 0.01 for none. */
static bool identity(const struct aiMatrix4x4 *matrix) {
    struct aiMatrix4x4 one;
    aiIdentityMatrix4(&one);
    return aiMatrix4AreEqual(matrix, &one);
}

static placement place_in(const placement *parent, const struct aiNode *node) {
    placement child = *parent;
    if (identity(&node->mTransformation)) return child;
    aiMultiplyMatrix4(&child.matrix, &node->mTransformation);
    child.moved = true;
    return child;
}

static hp_status take_vertices(const struct aiMesh *in, const placement *where, hp_vertices *out, const char *path,
                               hp_fault *fault) {
    for (unsigned i = 0; i < in->mNumVertices; i++) {
        struct aiVector3D v = in->mVertices[i];
        if (where->moved) aiTransformVecByMatrix4(&v, &where->matrix);
        const float xyz[3] = {v.x, v.y, v.z};
        const char *wrong = hp_vertex_fault(xyz);
        if (wrong)
            return hp_fault_set(fault, HP_ERROR_INPUT, "%s: mesh '%s', vertex %u: %s", path, in->mName.data, i,
                                wrong);
        if (!hp_vertices_add(out, xyz)) return hp_fault_set(fault, HP_ERROR_MEMORY, "%s: out of memory", path);
    }
    return HP_OK;
}

static hp_status take_faces(const struct aiMesh *in, const hp_vertices *vertices, hp_mesh *out, const char *path,
                            hp_fault *fault) {
    for (unsigned i = 0; i < in->mNumFaces; i++) {
        const struct aiFace *face = &in->mFaces[i];
        hp_fan fan = {0};
        for (unsigned k = 0; k < face->mNumIndices; k++) {
            if (face->mIndices[k] >= vertices->count)
                return hp_fault_set(fault, HP_ERROR_INPUT, "%s: mesh '%s', face %u: vertex index %u is out of range",
                                    path, in->mName.data, i, face->mIndices[k]);
            if (!hp_fan_corner(&fan, out, vertices->xyz[face->mIndices[k]]))
                return hp_fault_set(fault, HP_ERROR_MEMORY, "%s: out of memory", path);
        }
    }
    return HP_OK;
}

/* The meshes of a node and of those below it, in the scene's order. */
static hp_status take_node(const struct aiScene *scene, const struct aiNode *node, const placement *parent,
                           hp_mesh *out, const char *path, hp_fault *fault) {
    placement where = place_in(parent, node);
    hp_status status = HP_OK;
    for (unsigned i = 0; i < node->mNumMeshes && status == HP_OK; i++) {
        const struct aiMesh *mesh = scene->mMeshes[node->mMeshes[i]];
        hp_vertices vertices = {0};
        status = take_vertices(mesh, &where, &vertices, path, fault);
        if (status == HP_OK) status = take_faces(mesh, &vertices, out, path, fault);
        hp_vertices_free(&vertices);
    }
    for (unsigned i = 0; i < node->mNumChildren && status == HP_OK; i++)
        status = take_node(scene, node->mChildren[i], &where, out, path, fault);
    return status;
}

hp_status hp_mesh_read_assimp(const char *path, hp_mesh *mesh, hp_fault *fault) {
    /* no post-processing at all: it would join, sort or drop */
    const struct aiScene *scene = aiImportFile(path, 0);
    if (!scene) return hp_fault_set(fault, HP_ERROR_INPUT, "%s: %s", path, aiGetErrorString());
    placement root = {.moved = false};
    aiIdentityMatrix4(&root.matrix);
    hp_status status = HP_OK;
    if (scene->mRootNode) status = take_node(scene, scene->mRootNode, &root, mesh, path, fault);
    aiReleaseImport(scene);
    return status;
}
