/* What is timed: a packet of primaries against secondaries that stay, all of them against all, half of which hit.
 *
 * Sizes are those of class random (pair_cases.h), 0.2 to 1; places are drawn from a cube whose size is searched for
 * until half of the pairs hit. So neither side has an easy time of it: early exits cannot be foretold, and of
 * hitpipe's wide lanes there are always some with a hit. The same scene for the same pair on every machine. */
#ifndef TESTBENCH_PEERS_SCENE_H
#define TESTBENCH_PEERS_SCENE_H

#include <hitpipe/types.h>

enum { SCENE_PRIMARIES = HP_PACKET_PRIMARIES, SCENE_SECONDARIES = 512 };

typedef struct scene {
    hp_pair pair;
    float
        primaries[SCENE_PRIMARIES * HP_OBJECT_WORDS_MAX]; /* one after another, as many words each as the type has */
    float secondaries[SCENE_SECONDARIES * HP_OBJECT_WORDS_MAX];
    size_t hits; /* of SCENE_PRIMARIES * SCENE_SECONDARIES, by hitpipe */
} scene;

void scene_make(scene *scene, hp_pair pair);

#endif
