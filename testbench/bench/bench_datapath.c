/* The bare datapath: millions of ray-triangle tests a second on every instruction set, against the classic scalar
 * code of 1997 in the same run and against what the execution ports allow.
 *
 * Two scenes: a terrain and a packet of 256 rays from a camera above it; and scattered triangles with rays from
 * anywhere to anywhere, which scalar code with its early exits finds harder, for its processor cannot foretell them.
 * In both, few vectors of tests survive the decision on u and v, as in any scene of more than a handful of triangles.
 * Preparing the blocks of 512 triangles is inside the figures.
 *
 * The bound. To the decision on u and v a vector of tests takes, with the edges prepared,
 *
 *   s 3 sub | p, q 2 (6 mul, 3 sub) | det, u, v 3 (3 mul, 2 add) | u + v 1 add | min, max 2 | 4 compares      = 43
 *
 * operations, each of which needs a floating-point port: on the two ports of x86 cores from Haswell to Sapphire
 * Rapids 21.5 clocks for 4, 8 or 16 tests. Mask operations, branches, loads, preparing and the tests that go on to t
 * are not in it. What the ports give is measured, not assumed: after each block a loop of independent multiplications
 * and additions of the same width runs for a while, so that clock frequency and a busy neighbour on the same core
 * weigh on both alike. For the same reason the columns take turns within a round, and time is processor time.
 *
 * Median and best of the rounds are shown, best against best: a neighbour on the other thread of a core leaves half
 * of the reorder buffer, which costs the datapath, with its chains of operations, more than the loop that measures
 * the ports. */
#include "rtl_model/pipes/wide.h"
#include "testbench/support/random.h"
#include <hitpipe/pipe.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum {
    SIDE = 182,
    TRIANGLES = 2 * SIDE * SIDE,
    RAYS = HP_PACKET_PRIMARIES,
    CLASSIC_RAYS = 8,
    TURN = 32 * HP_BLOCK,
    ROUNDS = 9,
    COLUMNS_MAX = 8
};

static const double operations = 43;

static float triangles[TRIANGLES][9];
static float rays[RAYS][6];

static double now(void) {
    struct timespec t;
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/* ---- the classic code: one ray, one triangle, in double, dividing early and leaving at the first "no", as scalar
 * code after Moller and Trumbore 1997, figure of section 4, does ---- */

typedef struct point {
    double x, y, z;
} point;

static point minus(point a, point b) {
    return (point){a.x - b.x, a.y - b.y, a.z - b.z};
}

static point times(point a, point b) {
    return (point){a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

static double along(point a, point b) {
    return a.x * b.x + a.y * b.y + a.z * b.z;
}

static bool classic_hit(const point ray[2], const point corner[3], double *t) {
    point first = minus(corner[1], corner[0]), second = minus(corner[2], corner[0]);
    point normal = times(ray[1], second);
    double volume = along(first, normal);
    if (fabs(volume) < 1e-6) return false;
    double scale = 1 / volume;
    point reach = minus(ray[0], corner[0]);
    double u = along(reach, normal) * scale;
    if (u < 0 || u > 1) return false;
    point other = times(reach, first);
    double v = along(ray[1], other) * scale;
    if (v < 0 || u + v > 1) return false;
    *t = along(second, other) * scale;
    return true;
}

/* ---- one column of the table ---- */

typedef struct column {
    const char *name;
    const hp_wide_pipe *pipe; /* NULL: the classic code */
    double tests, seconds;    /* of this round */
    double peak_operations, peak_seconds;
    double rate[ROUNDS], bound[ROUNDS]; /* tests a second: measured, and what the ports would give */
    hp_best best;
} column;

static hp_lanes lanes;
static point classic_rays[RAYS][2], classic_triangles[TRIANGLES][3];

static void run_classic(column *c, uint32_t first, uint32_t n) {
    for (unsigned r = 0; r < CLASSIC_RAYS; r++) {
        const point *ray = classic_rays[r * (RAYS / CLASSIC_RAYS)];
        double t;
        for (uint32_t i = first; i < first + n; i++)
            if (classic_hit(ray, classic_triangles[i], &t) && t >= 0 && t < c->best.T[r])
                c->best.T[r] = (float)t, c->best.index[r] = i;
    }
    c->tests += (double)CLASSIC_RAYS * n;
}

static void run_wide(column *c, uint32_t first, uint32_t n, bool flush) {
    static _Alignas(64) float prepared[HP_BLOCK * HP_TRIANGLE_WORDS];
    c->pipe->prepare(triangles[first], n, NULL, flush, prepared);
    c->pipe->closest(&lanes, 0, RAYS, prepared, n, first, flush, &c->best);
    c->tests += (double)RAYS * n;
}

/* Independent operations on vectors of a column's width: how many; 0 where there is no such loop. */
static double run_peak(const char *isa) {
    enum { TURNS = 2500 };
#if defined __x86_64__
#define EIGHT(v)                                                                                                     \
    "vmulps %%" v "0, %%" v "0, %%" v "1\n\tvaddps %%" v "0, %%" v "0, %%" v "2\n\t"                                 \
    "vmulps %%" v "0, %%" v "0, %%" v "3\n\tvaddps %%" v "0, %%" v "0, %%" v "4\n\t"                                 \
    "vmulps %%" v "0, %%" v "0, %%" v "5\n\tvaddps %%" v "0, %%" v "0, %%" v "6\n\t"                                 \
    "vmulps %%" v "0, %%" v "0, %%" v "7\n\tvaddps %%" v "0, %%" v "0, %%" v "8\n\t"
#define PEAK(v)                                                                                                      \
    for (unsigned i = 0; i < TURNS; i++)                                                                             \
    __asm__ volatile("vpxor %%xmm0, %%xmm0, %%xmm0\n\t" EIGHT(v) EIGHT(v)                                            \
                     :                                                                                               \
                     :                                                                                               \
                     : "xmm0", "xmm1", "xmm2", "xmm3", "xmm4", "xmm5", "xmm6", "xmm7", "xmm8")
    if (strcmp(isa, "avx512") == 0)
        PEAK("zmm");
    else if (strcmp(isa, "avx2") == 0)
        PEAK("ymm");
    else
        return 0;
    __asm__ volatile("vzeroupper"); /* else the columns of narrower code would wait for the upper halves */
    return 16 * TURNS;
#else
    (void)isa;
    (void)TURNS;
    return 0;
#endif
}

/* ---- scene, table ---- */

static float height(unsigned i, unsigned j) {
    return 6 * sinf(0.07f * (float)i) * cosf(0.05f * (float)j) + sinf(0.31f * (float)i + 0.17f * (float)j);
}

static void put_vertex(float *to, unsigned i, unsigned j) {
    to[0] = (float)j, to[1] = (float)i, to[2] = height(i, j);
}

static void put_points(const float *words, unsigned n, point *points) {
    for (unsigned i = 0; i < n; i++, words += 3) points[i] = (point){words[0], words[1], words[2]};
}

static void put_ray(unsigned i, const float ray[6]) {
    memcpy(rays[i], ray, sizeof rays[i]);
    for (unsigned w = 0; w < 6; w++) lanes.word[w][i] = ray[w];
}

/* Rays of one camera over one terrain: what one ray does, the next does too. */
static void make_terrain(void) {
    float(*t)[9] = triangles;
    for (unsigned i = 0; i < SIDE; i++)
        for (unsigned j = 0; j < SIDE; j++, t += 2) {
            put_vertex(t[0], i, j), put_vertex(t[0] + 3, i, j + 1), put_vertex(t[0] + 6, i + 1, j);
            put_vertex(t[1], i, j + 1), put_vertex(t[1] + 3, i + 1, j + 1), put_vertex(t[1] + 6, i + 1, j);
        }
    for (unsigned i = 0; i < RAYS; i++) {
        float x = (float)(i % 16) / 16 - 0.5f, y = (float)(i / 16) / 16 - 0.5f;
        float ray[6] = {SIDE / 2, -40, 60, 1.1f * x, 1, y - 0.75f};
        put_ray(i, ray);
    }
}

static float between(hpt_random *random, float low, float high) {
    return (float)hpt_random_between(random, low, high);
}

/* Rays from anywhere to anywhere among scattered triangles: what a test finds says nothing of the next. */
static void make_scattered(void) {
    hpt_random random = hpt_random_seed(1997);
    for (unsigned i = 0; i < TRIANGLES; i++) {
        float middle[3];
        for (unsigned axis = 0; axis < 3; axis++) middle[axis] = between(&random, -1, 1);
        for (unsigned w = 0; w < 9; w++) triangles[i][w] = middle[w % 3] + between(&random, -0.05f, 0.05f);
    }
    for (unsigned i = 0; i < RAYS; i++) {
        float ray[6];
        for (unsigned w = 0; w < 6; w++) ray[w] = between(&random, -1, 1);
        put_ray(i, ray);
    }
}

/* The same in double for the classic code. */
static void make_classic(void) {
    put_points(rays[0], 2 * RAYS, classic_rays[0]);
    put_points(triangles[0], 3 * TRIANGLES, classic_triangles[0]);
}

static int by_value(const void *a, const void *b) {
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static double median(double *values) {
    qsort(values, ROUNDS, sizeof *values, by_value);
    return values[ROUNDS / 2];
}

static double lanes_of(const char *isa) {
    return strcmp(isa, "avx512") == 0 ? 16 : 8;
}

static void run_block(column *c, uint32_t first, uint32_t n, bool flush) {
    double begin = now();
    if (c->pipe)
        run_wide(c, first, n, flush);
    else
        run_classic(c, first, n);
    double middle = now();
    c->peak_operations += run_peak(c->name);
    c->seconds += middle - begin;
    c->peak_seconds += now() - middle;
}

/* Some milliseconds at a stretch: a core takes a while to settle when the width of its vectors changes. */
static void run_turn(column *c, uint32_t first, bool flush) {
    for (uint32_t end = first + TURN; first < end && first < TRIANGLES; first += HP_BLOCK) {
        uint32_t left = TRIANGLES - first;
        run_block(c, first, left < HP_BLOCK ? left : HP_BLOCK, flush);
    }
}

static void run_round(column *columns, unsigned n, unsigned round, bool flush) {
    for (unsigned i = 0; i < n; i++) {
        column *c = &columns[i];
        c->tests = c->seconds = c->peak_operations = c->peak_seconds = 0;
        for (unsigned r = 0; r < RAYS; r++) c->best.T[r] = INFINITY, c->best.index[r] = HP_NO_INDEX;
    }
    for (uint32_t first = 0; first < TRIANGLES; first += TURN)
        for (unsigned i = 0; i < n; i++) run_turn(&columns[i], first, flush);
    for (unsigned i = 0; i < n; i++) {
        column *c = &columns[i];
        c->rate[round] = c->tests / c->seconds;
        c->bound[round] = c->peak_operations / c->peak_seconds / operations * lanes_of(c->name);
    }
}

static void print_table(column *columns, unsigned n) {
    double classic = median(columns[0].rate), classic_best = columns[0].rate[ROUNDS - 1];
    printf("%-10s %14s %10s %10s | %14s %10s %10s\n", "isa", "median: M/s", "x classic", "% of bound", "best: M/s",
           "x classic", "% of bound");
    for (unsigned i = 0; i < n; i++) {
        column *c = &columns[i];
        double rate = i ? median(c->rate) : classic, bound = median(c->bound); /* sorted from here on */
        double best = c->rate[ROUNDS - 1], best_bound = c->bound[ROUNDS - 1];
        printf("%-10s %14.1f %10.1f", c->name, rate * 1e-6, rate / classic);
        bound > 0 ? printf(" %10.1f", 100 * rate / bound) : printf(" %10s", "");
        printf(" | %14.1f %10.1f", best * 1e-6, best / classic_best);
        bound > 0 ? printf(" %10.1f\n", 100 * best / best_bound) : printf("\n");
    }
}

static void bench(const char *scene, void (*make)(void), bool flush) {
    static column columns[COLUMNS_MAX];
    columns[0] = (column){.name = "classic"};
    unsigned n = 1;
    for (unsigned i = 0; hp_isa_name(i) && n < COLUMNS_MAX; i++, n++)
        columns[n] = (column){.name = hp_isa_name(i), .pipe = hp_wide_pipe_of(hp_isa_name(i), HP_PAIR_RAY_TRIANGLE)};
    make();
    make_classic();
    for (unsigned round = 0; round < ROUNDS; round++) run_round(columns, n, round, flush);
    printf("ray-triangle, closest, %s, %d rays x %d triangles, %s, %d rounds\n", scene, RAYS, TRIANGLES,
           flush ? "flush" : "gradual", ROUNDS);
    print_table(columns, n);
}

int main(void) {
    bench("terrain", make_terrain, false);
    bench("terrain", make_terrain, true);
    bench("scattered", make_scattered, false);
    return 0;
}
