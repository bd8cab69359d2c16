#include "testbench/support/pair_extremes.h"
#include "testbench/support/plain_objects.h"
#include <math.h>
#include <string.h>

static void draw_legal(hpt_random *random, hp_object type, bool whole, float *words) {
    do hpt_draw_plain_object(random, type, whole, words);
    while (hp_object_fault(type, words));
}

void hpt_whole_pair(hpt_random *random, hp_pair pair, unsigned i, float *primary, float *secondary) {
    (void)i;
    draw_legal(random, hp_pair_primary(pair), true, primary);
    draw_legal(random, hp_pair_secondary(pair), true, secondary);
}

/* Takes from an object a dimension, or two or three, by i. Rays and planes have none to lose. */
static void flatten(hp_object type, unsigned i, float *words) {
    switch (type) {
    case HP_TRIANGLE:
        for (unsigned axis = 0; axis < 3; axis++) {
            if (i % 3 == 0) words[6 + axis] = words[3 + axis];
            if (i % 3 == 1) words[6 + axis] = 2 * words[3 + axis] - words[axis];
            if (i % 3 == 2) words[6 + axis] = words[3 + axis] = words[axis];
        }
        break;
    case HP_SPHERE:
        words[3] = 0;
        break;
    case HP_AABB:
        for (unsigned axis = 0; axis < 3; axis++)
            if ((i % 7 + 1) >> axis & 1) words[3 + axis] = words[axis];
        break;
    case HP_OBB:
        for (unsigned axis = 0; axis < 3; axis++)
            if ((i % 7 + 1) >> axis & 1) words[3 + axis] = 0;
        break;
    case HP_CYLINDER:
        words[6] = 0;
        break;
    case HP_RAY:
    case HP_PLANE:
        break;
    }
}

void hpt_flat_objects(hpt_random *random, hp_pair pair, unsigned i, float *primary, float *secondary) {
    hpt_whole_pair(random, pair, i, primary, secondary);
    if (i % 3 != 1) flatten(hp_pair_primary(pair), i / 3, primary);
    if (i % 3 != 0) flatten(hp_pair_secondary(pair), i / 3, secondary);
}

static void shrink(hp_object type, int by, float *words) {
    for (unsigned w = 0; w < hp_object_words(type); w++)
        if (hpt_is_length(type, w)) words[w] = ldexpf(words[w], -by);
}

void hpt_small_pair(hpt_random *random, hp_pair pair, unsigned i, float *primary, float *secondary) {
    static const int factors[] = {30, 50, 62, 64, 75, 100, 122, 126, 130, 140};
    int by = factors[i % (sizeof factors / sizeof *factors)];
    do {
        draw_legal(random, hp_pair_primary(pair), i & 1, primary);
        draw_legal(random, hp_pair_secondary(pair), i & 1, secondary);
        shrink(hp_pair_primary(pair), by, primary);
        shrink(hp_pair_secondary(pair), by, secondary);
    } while (hp_object_fault(hp_pair_primary(pair), primary) || hp_object_fault(hp_pair_secondary(pair), secondary));
}

void hpt_nonfinite_word(hpt_random *random, hp_pair pair, unsigned i, float *primary, float *secondary) {
    static const uint32_t odd[] = {0x7FC00000, 0x7F800001, 0x7F800000, 0xFF800000};
    unsigned p = hp_object_words(hp_pair_primary(pair)), s = hp_object_words(hp_pair_secondary(pair)),
             w = i / 4 % (p + s);
    draw_legal(random, hp_pair_primary(pair), false, primary);
    draw_legal(random, hp_pair_secondary(pair), false, secondary);
    memcpy(w < p ? primary + w : secondary + (w - p), &odd[i % 4], sizeof odd[0]);
}

/* Makes an object what the host refuses. False: nothing but NaN and infinity is refused of its type. */
static bool spoil(hp_object type, unsigned i, float *words) {
    switch (type) {
    case HP_RAY:
        words[3] = words[4] = words[5] = i & 1 ? -0.0f : 0;
        return true;
    case HP_SPHERE:
        words[3] = -words[3] - 0.5f;
        return true;
    case HP_AABB:
        words[i % 3] = words[3 + i % 3] + 0.5f;
        return true;
    case HP_OBB:
        words[3 + i % 3] = -words[3 + i % 3] - 0.5f;
        return true;
    case HP_CYLINDER:
        if (i & 1)
            words[6] = -words[6] - 0.5f;
        else
            memcpy(words + 3, words, 3 * sizeof *words);
        return true;
    case HP_TRIANGLE:
    case HP_PLANE:
        return false;
    }
    return false;
}

/* Close to each other, so that the objects would meet if they were legal. */
void hpt_illegal_object(hpt_random *random, hp_pair pair, unsigned i, float *primary, float *secondary) {
    hp_object first = hp_pair_primary(pair), second = hp_pair_secondary(pair);
    draw_legal(random, first, false, primary);
    draw_legal(random, second, false, secondary);
    bool spoilt = i % 2 ? spoil(second, i / 2, secondary) : spoil(first, i / 2, primary);
    if (!spoilt) spoilt = i % 2 ? spoil(first, i / 2, primary) : spoil(second, i / 2, secondary);
    if (!spoilt) primary[0] = NAN;
}
