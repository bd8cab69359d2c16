/* Cameras and flights: where rays start, where they point, and that they are the same bits on every machine. */
#include "host/rays/angle.h"
#include "host/rays/camera.h"
#include "host/rays/flight.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

static double length(const float *v) {
    return sqrt((double)v[0] * v[0] + (double)v[1] * v[1] + (double)v[2] * v[2]);
}

/* FNV-1a over words, little endian first. */
static uint64_t hash_words(uint64_t hash, const float *words, size_t n) {
    for (size_t i = 0; i < n; i++) {
        uint32_t bits;
        memcpy(&bits, &words[i], sizeof bits);
        for (int byte = 0; byte < 4; byte++) hash = (hash ^ (bits >> 8 * byte & 255)) * 0x100000001B3;
    }
    return hash;
}

static void angles_agree_with_the_c_library(void **state) {
    (void)state;
    for (double degrees = -360; degrees <= 360; degrees += 0.37) {
        double x = degrees * (acos(-1) / 180);
        assert_true(fabs(hp_sine(degrees) - sin(x)) < 2e-15);
        assert_true(fabs(hp_cosine(degrees) - cos(x)) < 2e-15);
    }
    assert_true(fabs(hp_tangent(60) - sqrt(3)) < 1e-14);
}

static void rays_go_through_pixel_centres(void **state) {
    (void)state;
    /* 90 degrees, 4 x 2 pixels: the upper left centre is at x -1.5, y 0.5 of a plane half as high as far */
    hp_camera camera = {.eye = {1, 2, 3}, .at = {1, 12, 3}, .up = {0, 0, 1}, .fov = 90, .width = 4, .height = 2};
    float rays[8 * HP_RAY_WORDS];
    hp_fault fault;
    assert_int_equal(hp_camera_rays(&camera, rays, &fault), HP_OK);
    for (int i = 0; i < 8; i++) {
        const float *ray = rays + HP_RAY_WORDS * i;
        double x = -1.5 + i % 4, z = i < 4 ? 0.5 : -0.5, n = sqrt(x * x + 1 + z * z);
        assert_true(ray[0] == 1 && ray[1] == 2 && ray[2] == 3);
        assert_true(fabs((double)ray[3] - x / n) < 1e-7);
        assert_true(fabs((double)ray[4] - 1 / n) < 1e-7);
        assert_true(fabs((double)ray[5] - z / n) < 1e-7);
        assert_true(fabs(length(ray + 3) - 1) < 1e-7);
    }
}

static void impossible_cameras_are_refused(void **state) {
    (void)state;
    const hp_camera good = {.at = {0, 1, 0}, .up = {0, 0, 1}, .fov = 40, .width = 1, .height = 1};
    float ray[HP_RAY_WORDS];
    hp_fault fault;
    assert_int_equal(hp_camera_rays(&good, ray, &fault), HP_OK);
    hp_camera bad[6] = {good, good, good, good, good, good};
    bad[0].at[1] = 0;
    bad[1].up[1] = 1, bad[1].up[2] = 0;
    bad[2].fov = 0;
    bad[3].fov = 180;
    bad[4].eye[0] = NAN;
    bad[5].width = 0;
    for (int i = 0; i < 6; i++)
        if (hp_camera_rays(&bad[i], ray, &fault) != HP_ERROR_USAGE) fail_msg("camera %d", i);
}

/* Solid things are seen whole: every corner of their box is between the outermost rays. */
static void the_default_camera_sees_the_scene(void **state) {
    (void)state;
    const hp_bounds bounds = {{-1, -2, -3}, {4, 2, 5}};
    hp_camera camera = hp_camera_for(&bounds, 64, 48);
    float *rays = malloc(64 * 48 * HP_RAY_WORDS * sizeof *rays);
    hp_fault fault;
    assert_int_equal(hp_camera_rays(&camera, rays, &fault), HP_OK);
    for (int corner = 0; corner < 8; corner++) {
        double best = -1, d[3], n = 0;
        for (int k = 0; k < 3; k++) {
            d[k] = (corner >> k & 1 ? bounds.high : bounds.low)[k] - camera.eye[k];
            n += d[k] * d[k];
        }
        for (int i = 0; i < 64 * 48; i++) {
            const float *v = rays + HP_RAY_WORDS * i + 3;
            best = fmax(best, (d[0] * (double)v[0] + d[1] * (double)v[1] + d[2] * (double)v[2]) / sqrt(n));
        }
        assert_true(best > cos(0.012)); /* a pixel is 0.011 wide */
    }
    free(rays);
}

static void a_flight_is_closed_smooth_and_above(void **state) {
    (void)state;
    const hp_bounds bounds = {{0, -300, 10}, {400, 0, 50}};
    enum { FRAMES = 1000 };
    float first[HP_RAY_WORDS], ray[HP_RAY_WORDS], last[HP_RAY_WORDS], step[3] = {0};
    double up = 0;
    hp_flight_ray(&bounds, 0, FRAMES, first);
    memcpy(last, first, sizeof last);
    for (size_t i = 1; i <= FRAMES; i++) {
        hp_flight_ray(&bounds, i, FRAMES, ray);
        assert_true(ray[0] > 0 && ray[0] < 400 && ray[1] > -300 && ray[1] < 0 && ray[2] > 50);
        assert_true(fabs(length(ray + 3) - 1) < 1e-7);
        for (int k = 0; k < 3; k++) {
            float now = ray[k] - last[k];
            assert_true(fabsf(now) < 4 && (i == 1 || fabsf(now - step[k]) < 0.1f)); /* neither jumps nor kinks */
            step[k] = now;
        }
        memcpy(last, ray, sizeof last);
        up += (double)ray[5] / FRAMES;
    }
    assert_memory_equal(last, first, 3 * sizeof(float)); /* closed */
    assert_true(fabs(up) < 0.06);                        /* no direction is preferred */
}

static void the_terrain_moves_rigidly(void **state) {
    (void)state;
    const hp_bounds bounds = {{0, -300, 10}, {400, 0, 50}};
    float m[12], first[12], after[12];
    for (size_t i = 0; i < 100; i++) {
        hp_flight_motion(&bounds, i, 100, m);
        for (int a = 0; a < 3; a++)
            for (int b = 0; b < 3; b++) {
                double dot = 0;
                for (int k = 0; k < 3; k++) dot += (double)m[4 * a + k] * (double)m[4 * b + k];
                assert_true(fabs(dot - (a == b)) < 1e-6);
            }
    }
    hp_flight_motion(&bounds, 0, 100, first);
    hp_flight_motion(&bounds, 100, 100, after);
    assert_memory_equal(first, after, sizeof first);
    hp_flight_motion(&bounds, 25, 100, m);
    assert_true(m[1] < -0.1f); /* and it does move */
}

/* Committed: machines, compilers and C libraries must agree. */
static void rays_are_the_same_bits_everywhere(void **state) {
    (void)state;
    const hp_bounds bounds = {{0, -30870, 236}, {28944, 0, 1076}};
    const hp_camera camera = {{-9e3, -5e4, 2e4}, {1.4e4, -1.5e4, 650}, {0.1, 0, 1}, 31, 160, 90};
    float *rays = malloc(160 * 90 * HP_RAY_WORDS * sizeof *rays), flight[HP_RAY_WORDS], matrix[12];
    hp_fault fault;
    assert_int_equal(hp_camera_rays(&camera, rays, &fault), HP_OK);
    uint64_t hash = hash_words(0xCBF29CE484222325, rays, 160 * 90 * HP_RAY_WORDS);
    free(rays);
    for (size_t i = 0; i < 1000; i++) {
        hp_flight_ray(&bounds, i, 1000, flight);
        hp_flight_motion(&bounds, i, 1000, matrix);
        hash = hash_words(hash_words(hash, flight, HP_RAY_WORDS), matrix, 12);
    }
    const uint64_t committed = 0xC7F856AC5664D675;
    if (hash != committed) fail_msg("hash 0x%016llX", (unsigned long long)hash);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(angles_agree_with_the_c_library),     cmocka_unit_test(rays_go_through_pixel_centres),
        cmocka_unit_test(impossible_cameras_are_refused),      cmocka_unit_test(the_default_camera_sees_the_scene),
        cmocka_unit_test(a_flight_is_closed_smooth_and_above), cmocka_unit_test(the_terrain_moves_rigidly),
        cmocka_unit_test(rays_are_the_same_bits_everywhere),
    };
    return cmocka_run_group_tests_name("camera", tests, NULL, NULL);
}
