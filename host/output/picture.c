#include "host/output/picture.h"

#include "host/rays/vector.h"

typedef hp_vector colour; /* linear red, green, blue */

/* A picture, and what of all of it a pixel's colour depends on. */
typedef struct looks {
    const hp_picture *picture;
    double nearest;                   /* T of the nearest hit */
    double least_radius, most_radius; /* of solids */
} looks;

/* The sun stands in the west-north-west, 17 degrees high: from the left of the default view. */
static const hp_vector sun = {-0.88, 0.37, 0.295};
static const colour sunlight = {3.3, 2.6, 1.75}, skylight = {0.26, 0.36, 0.55};
static const colour horizon = {0.66, 0.76, 0.86}, zenith = {0.16, 0.34, 0.66};

/* Tints from the lowest to the highest point. */
static const colour tints[] = {
    {0.070, 0.165, 0.085}, {0.150, 0.270, 0.100}, {0.330, 0.380, 0.150}, {0.520, 0.430, 0.220},
    {0.420, 0.280, 0.160}, {0.400, 0.330, 0.280}, {0.800, 0.790, 0.780},
};

static colour mix(colour a, colour b, double share) {
    return hp_vector_along(a, share, hp_vector_sub(b, a));
}

static colour times(colour a, colour b) {
    return (colour){a.x * b.x, a.y * b.y, a.z * b.z};
}

static colour height_tint(const hp_bounds *bounds, double z) {
    const int last = sizeof tints / sizeof tints[0] - 1;
    double relief = bounds->high[2] - bounds->low[2];
    double place = relief > 0 ? fmin(fmax((z - bounds->low[2]) / relief, 0), 1) * last : last / 2.0;
    int below = place < last ? (int)place : last - 1;
    return mix(tints[below], tints[below + 1], place - below);
}

/* Tints of solids, from the smallest radius to the largest. */
static const colour solid_tints[] = {{0.80, 0.42, 0.10}, {0.62, 0.10, 0.06}, {0.08, 0.20, 0.34}, {0.34, 0.36, 0.38}};

/* The last word of an object: the radius of a solid. */
static double radius_of(const hp_scene *scene, size_t index) {
    unsigned words = hp_object_words(scene->object);
    return (double)scene->words[index * words + words - 1];
}

/* Radii stand as far apart in tint as their quotient says. */
static colour solid_tint(const looks *look, double radius) {
    const int last = sizeof solid_tints / sizeof solid_tints[0] - 1;
    double place = 0;
    if (look->least_radius > 0 && look->most_radius > look->least_radius)
        place = log(radius / look->least_radius) / log(look->most_radius / look->least_radius) * last;
    int below = place < last ? (int)place : last - 1;
    return mix(solid_tints[below], solid_tints[below + 1], place - below);
}

static colour tint(const looks *look, const hp_result *hit) {
    const hp_scene *scene = look->picture->scene;
    if (scene->object == HP_TRIANGLE) return height_tint(&scene->bounds, (double)hit->CP[2]);
    return solid_tint(look, radius_of(scene, hit->index));
}

static colour sky(const float *ray) {
    return mix(horizon, zenith, fmin(1, fmax(0, 2.2 * ((double)ray[5] + 0.3))));
}

static hp_vector point_of(const hp_result *hit) {
    return (hp_vector){hit->CP[0], hit->CP[1], hit->CP[2]};
}

/* The unit normal of the object that was hit, on the ray's side. */
static hp_vector normal_of(const hp_picture *picture, size_t pixel) {
    const hp_result *hit = &picture->results[pixel];
    const hp_scene *scene = picture->scene;
    const float *ray = picture->rays + pixel * HP_RAY_WORDS;
    double xyz[3];
    hp_shape_normal(scene->object, scene->words + (size_t)hit->index * hp_object_words(scene->object), hit->CP, xyz);
    hp_vector normal = hp_vector_of(xyz);
    bool away = normal.x * (double)ray[3] + normal.y * (double)ray[4] + normal.z * (double)ray[5] > 0;
    return away ? (hp_vector){-normal.x, -normal.y, -normal.z} : normal;
}

/* The normal; that of a triangle smoothed over the neighbouring pixels at about the same distance: triangles of a
 * pixel's size would glitter. */
static hp_vector smooth_normal(const hp_picture *picture, size_t pixel) {
    if (picture->scene->object != HP_TRIANGLE) return normal_of(picture, pixel);
    size_t row = pixel / picture->width, column = pixel % picture->width;
    double distance = (double)picture->results[pixel].T;
    hp_vector sum = {0};
    for (size_t i = row > 0 ? row - 1 : 0; i <= row + 1 && i < picture->height; i++)
        for (size_t j = column > 0 ? column - 1 : 0; j <= column + 1 && j < picture->width; j++) {
            size_t near = i * picture->width + j;
            bool same =
                picture->results[near].F && fabs((double)picture->results[near].T - distance) < 0.03 * distance;
            if (same) sum = hp_vector_along(sum, i == row && j == column ? 2 : 1, normal_of(picture, near));
        }
    return hp_vector_unit(sum);
}

static double diagonal(const hp_bounds *bounds) {
    hp_vector across = hp_vector_sub(hp_vector_of(bounds->high), hp_vector_of(bounds->low));
    return sqrt(hp_vector_dot(across, across));
}

size_t hp_picture_shadow_rays(const hp_picture *picture, float *rays, uint32_t *pixels) {
    double lift = 1e-4 * diagonal(&picture->scene->bounds);
    size_t n = 0;
    for (size_t i = 0; i < picture->width * picture->height; i++) {
        if (!picture->results[i].F) continue;
        hp_vector normal = normal_of(picture, i);
        if (hp_vector_dot(normal, sun) <= 0) continue; /* turned away: dark without asking */
        hp_vector from = hp_vector_along(point_of(&picture->results[i]), lift, normal);
        const double words[HP_RAY_WORDS] = {from.x, from.y, from.z, sun.x, sun.y, sun.z};
        for (int k = 0; k < HP_RAY_WORDS; k++) rays[n * HP_RAY_WORDS + (size_t)k] = (float)words[k];
        pixels[n++] = (uint32_t)i;
    }
    return n;
}

/* The share of the horizon's colour at a distance: none at the nearest hit. */
static double haze(const hp_picture *picture, double distance, double nearest) {
    double scale = diagonal(&picture->scene->bounds), far = scale > 0 ? (distance - nearest) / scale : 0;
    return 1 - exp(-0.55 * far * far);
}

static colour shade(const looks *look, size_t pixel) {
    const hp_picture *picture = look->picture;
    const hp_result *hit = &picture->results[pixel];
    const float *ray = picture->rays + pixel * HP_RAY_WORDS;
    if (!hit->F) return sky(ray);
    hp_vector normal = smooth_normal(picture, pixel);
    bool dark = picture->shadows && picture->shadows[pixel];
    double sunny = dark ? 0 : fmax(0, hp_vector_dot(normal, sun)), open = 0.6 + 0.4 * normal.z;
    colour light = hp_vector_along(times(sunlight, (colour){sunny, sunny, sunny}), open, skylight);
    return mix(times(tint(look, hit), light), horizon, haze(picture, (double)hit->T, look->nearest));
}

/* IEC 61966-2-1 */
static uint8_t srgb(double linear) {
    double c = fmin(fmax(linear, 0), 1);
    double coded = c <= 0.0031308 ? 12.92 * c : 1.055 * pow(c, 1 / 2.4) - 0.055;
    return (uint8_t)(255 * coded + 0.5);
}

static looks look_at(const hp_picture *picture) {
    looks look = {picture, INFINITY, INFINITY, 0};
    for (size_t i = 0; i < picture->width * picture->height; i++)
        if (picture->results[i].F) look.nearest = fmin(look.nearest, (double)picture->results[i].T);
    for (size_t i = 0; i < picture->scene->count; i++) {
        look.least_radius = fmin(look.least_radius, radius_of(picture->scene, i));
        look.most_radius = fmax(look.most_radius, radius_of(picture->scene, i));
    }
    return look;
}

void hp_picture_shade(const hp_picture *picture, uint8_t *rgb) {
    looks look = look_at(picture);
    for (size_t i = 0; i < picture->width * picture->height; i++) {
        colour c = shade(&look, i);
        *rgb++ = srgb(c.x);
        *rgb++ = srgb(c.y);
        *rgb++ = srgb(c.z);
    }
}
