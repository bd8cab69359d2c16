/* Three triangles, four rays: which triangle does each ray meet first, and where?
 *
 *     cc closest.c $(pkg-config --cflags --libs hitpipe) -o closest && ./closest */
#include <hitpipe/hitpipe.h>
#include <stdio.h>

static const float triangles[][9] = {
    {-1, -1, 2, /**/ 1, -1, 2, /**/ 0, 1, 2}, /* v0, v1, v2 */
    {-1, -1, 4, /**/ 1, -1, 4, /**/ 0, 1, 4},
    {2, -1, 3, /**/ 4, -1, 3, /**/ 3, 1, 3},
};

static const float rays[][6] = {
    {0, 0, 0, /**/ 0, 0, 1}, /* origin, direction */
    {0, 0, 3, /**/ 0, 0, 2},
    {3, 0, 0, /**/ 0, 0, 1},
    {0, 0, 0, /**/ 0, 1, 0},
};

enum { TRIANGLES = sizeof triangles / sizeof triangles[0], RAYS = sizeof rays / sizeof rays[0] };

int main(void) {
    hp_device_def def = hp_default_device_def(); /* the simulated board */
    hp_query_def query = hp_default_query_def(); /* ray-triangle, closest, against all triangles */
    hp_result hits[RAYS];
    hp_device *device;
    hp_status status = hp_open(&def, &device);
    if (status == HP_OK) status = hp_upload(device, HP_TRIANGLE, triangles[0], TRIANGLES);
    if (status == HP_OK) status = hp_query(device, &query, rays[0], RAYS, hits);
    if (status != HP_OK) fprintf(stderr, "%s: %s\n", hp_status_name(status), hp_error_message(device));
    for (int i = 0; status == HP_OK && i < RAYS; i++) {
        if (hits[i].F)
            printf("ray %d meets triangle %u at t = %g: (%g, %g, %g)\n", i, (unsigned)hits[i].index,
                   (double)hits[i].T, (double)hits[i].CP[0], (double)hits[i].CP[1], (double)hits[i].CP[2]);
        else
            printf("ray %d meets nothing\n", i);
    }
    hp_close(device);
    return hp_status_exit(status);
}
