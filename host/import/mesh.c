#include "host/import/mesh.h"

#include <stdlib.h>
#include <string.h>
#include <strings.h>

/* Adds x to the sum held exactly in n doubles, least significant first (grow-expansion of Shewchuk, "Adaptive
 * precision floating-point arithmetic", 1997, figure 6): each step keeps the rounding error of an addition as a term
 * of its own. */
static void add_exactly(double *terms, int n, double x) {
    for (int i = 0; i < n; i++) {
        double sum = x + terms[i];
        double part = sum - x;
        terms[i] = (x - (sum - part)) + (terms[i] - part);
        x = sum;
    }
    terms[n] = x;
}

/* Whether the projections of three points to the plane of axes i and j lie on a line: six products of two floats,
 * each exact in a double, whose sum is twice the signed area. */
static bool flat(const float *a, const float *b, const float *c, int i, int j) {
    const double products[6] = {
        (double)a[i] * b[j],  -(double)a[j] * b[i], (double)b[i] * c[j],
        -(double)b[j] * c[i], (double)c[i] * a[j],  -(double)c[j] * a[i],
    };
    double terms[6];
    for (int n = 0; n < 6; n++) add_exactly(terms, n, products[n]);
    for (int n = 0; n < 6; n++)
        if (terms[n] != 0) return false;
    return true;
}

bool hp_triangle_degenerate(const float *words) {
    const float *a = words, *b = words + 3, *c = words + 6;
    return flat(a, b, c, 0, 1) && flat(a, b, c, 1, 2) && flat(a, b, c, 2, 0);
}

bool hp_mesh_reserve(hp_mesh *mesh, size_t count) {
    if (count > SIZE_MAX / (HP_TRIANGLE_WORDS * sizeof(float))) return false;
    float *words = realloc(mesh->words, count * HP_TRIANGLE_WORDS * sizeof(float));
    if (!words) return false;
    mesh->words = words;
    mesh->room = count;
    return true;
}

bool hp_mesh_add(hp_mesh *mesh, const float *v0, const float *v1, const float *v2) {
    if (!hp_grow((void **)&mesh->words, &mesh->room, mesh->count, HP_TRIANGLE_WORDS * sizeof(float))) return false;
    float *words = mesh->words + mesh->count * HP_TRIANGLE_WORDS;
    memcpy(words, v0, 3 * sizeof(float));
    memcpy(words + 3, v1, 3 * sizeof(float));
    memcpy(words + 6, v2, 3 * sizeof(float));
    mesh->count++;
    mesh->degenerate += hp_triangle_degenerate(words);
    return true;
}

void hp_mesh_free(hp_mesh *mesh) {
    free(mesh->words);
    *mesh = (hp_mesh){0};
}

typedef hp_status mesh_reader(const hp_bytes *bytes, hp_mesh *mesh, hp_fault *fault);

/* The reader of a file's extension, or NULL: assimp's. */
static mesh_reader *reader_of(const char *path) {
    static const struct {
        const char *extension;
        mesh_reader *read;
    } readers[] = {{".obj", hp_mesh_read_obj}, {".ply", hp_mesh_read_ply}, {".stl", hp_mesh_read_stl}};
    const char *extension = strrchr(path, '.');
    for (size_t i = 0; extension && i < sizeof readers / sizeof readers[0]; i++)
        if (strcasecmp(extension, readers[i].extension) == 0) return readers[i].read;
    return NULL;
}

hp_status hp_mesh_load(const char *path, hp_mesh *mesh, hp_fault *fault) {
    *mesh = (hp_mesh){0};
    hp_bytes bytes;
    hp_status status = hp_bytes_read(path, &bytes, fault);
    if (status != HP_OK) return status;
    mesh_reader *read = reader_of(path);
    status = read ? read(&bytes, mesh, fault) : hp_mesh_read_assimp(path, mesh, fault);
    hp_bytes_free(&bytes);
    if (status == HP_OK && mesh->count == 0)
        status = hp_fault_set(fault, HP_ERROR_INPUT, "%s: the mesh has no triangles", path);
    if (status != HP_OK) hp_mesh_free(mesh);
    return status;
}
