#include "host/rays/camera.h"

#include "host/rays/angle.h"
#include "host/rays/vector.h"

/* The camera's own axes. */
typedef struct frame {
    hp_vector right, up, forward;
} frame;

static frame frame_of(const hp_camera *camera) {
    hp_vector eye = hp_vector_of(camera->eye);
    frame axes = {.forward = hp_vector_unit(hp_vector_sub(hp_vector_of(camera->at), eye))};
    axes.right = hp_vector_unit(hp_vector_cross(axes.forward, hp_vector_of(camera->up)));
    axes.up = hp_vector_cross(axes.right, axes.forward);
    return axes;
}

/* Wide and flat. */
static bool is_landscape(const hp_bounds *bounds) {
    double size[3];
    for (int i = 0; i < 3; i++) size[i] = bounds->high[i] - bounds->low[i];
    return size[2] < 0.15 * fmin(size[0], size[1]);
}

hp_camera hp_camera_for(const hp_bounds *bounds, size_t width, size_t height) {
    hp_camera camera = {.up = {0, 0, 1}, .fov = 30, .width = width, .height = height};
    for (int i = 0; i < 3; i++) camera.at[i] = (bounds->low[i] + bounds->high[i]) / 2;
    /* a little from the west; solid things from 24 degrees above, landscapes lower and nearer, past their edges */
    bool landscape = is_landscape(bounds);
    const hp_vector away = hp_vector_unit((hp_vector){-0.35, -1, landscape ? 0.40 : 0.48});
    camera.eye[0] = camera.at[0] + away.x;
    camera.eye[1] = camera.at[1] + away.y;
    camera.eye[2] = camera.at[2] + away.z;
    frame axes = frame_of(&camera);
    double vertical = hp_tangent(camera.fov / 2), horizontal = vertical * (double)width / (double)height, far = 0;
    for (int corner = 0; corner < 8; corner++) {
        double xyz[3];
        for (int i = 0; i < 3; i++) xyz[i] = (corner >> i & 1 ? bounds->high : bounds->low)[i] - camera.at[i];
        hp_vector v = hp_vector_of(xyz);
        double back = -hp_vector_dot(v, axes.forward);
        far = fmax(far, fabs(hp_vector_dot(v, axes.right)) / horizontal + back);
        far = fmax(far, fabs(hp_vector_dot(v, axes.up)) / vertical + back);
    }
    if (landscape) far *= 0.46;
    if (far == 0) far = 1;
    camera.eye[0] = camera.at[0] + far * away.x;
    camera.eye[1] = camera.at[1] + far * away.y;
    camera.eye[2] = camera.at[2] + far * away.z;
    return camera;
}

static const char *wrong_with(const hp_camera *camera) {
    for (int i = 0; i < 3; i++)
        if (!isfinite((float)camera->eye[i]) || !isfinite(camera->at[i]) || !isfinite(camera->up[i]))
            return "a camera coordinate is not finite";
    if (!(camera->fov > 0 && camera->fov < 180)) return "the field of view must be between 0 and 180 degrees";
    if (camera->width == 0 || camera->height == 0) return "the picture has no pixels";
    frame axes = frame_of(camera);
    if (hp_vector_dot(axes.forward, axes.forward) == 0) return "the eye is where it looks at";
    if (hp_vector_dot(axes.right, axes.right) == 0) return "the camera's up points along its view";
    return NULL;
}

hp_status hp_camera_rays(const hp_camera *camera, float *rays, hp_fault *fault) {
    const char *wrong = wrong_with(camera);
    if (wrong) return hp_fault_set(fault, HP_ERROR_USAGE, "%s", wrong);
    frame axes = frame_of(camera);
    double pixel = 2 * hp_tangent(camera->fov / 2) / (double)camera->height;
    for (size_t row = 0; row < camera->height; row++)
        for (size_t column = 0; column < camera->width; column++, rays += HP_RAY_WORDS) {
            double x = ((double)column + 0.5 - (double)camera->width / 2) * pixel;
            double y = ((double)camera->height / 2 - (double)row - 0.5) * pixel;
            hp_vector d = hp_vector_along(hp_vector_along(axes.forward, x, axes.right), y, axes.up);
            d = hp_vector_unit(d);
            for (int i = 0; i < 3; i++) rays[i] = (float)camera->eye[i];
            rays[3] = (float)d.x;
            rays[4] = (float)d.y;
            rays[5] = (float)d.z;
        }
    return HP_OK;
}
