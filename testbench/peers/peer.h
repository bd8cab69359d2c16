/* Another library's answer to hitpipe's pairs. Each function of a library that can tell whether two of hitpipe's
 * objects meet is one row of that library's list, in its own file (fcl.cc, ode.cc, bullet.cc, ccd.cc); a pair of
 * types that it does not know has no row. The programs that compare and time them know nothing else of the libraries.
 *
 * Objects are made of hitpipe's words once, outside what is timed, as the library's user would keep them. */
#ifndef TESTBENCH_PEERS_PEER_H
#define TESTBENCH_PEERS_PEER_H

#include <hitpipe/types.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct peer_answer {
    bool F;
    bool failed; /* the library says that it could not tell, or throws */
    double T;    /* as design's table has it; NaN where the function does not say */
} peer_answer;

typedef struct peer {
    hp_pair pair;
    const char *library, *function;
    const char *answers; /* what the function answers, where that differs from hitpipe's table: for the reader */
    bool depth;          /* it answers T of a hit */
    bool distance;       /* it answers T of a miss */

    /* n objects, one after another in words; never NULL. What *_free takes. */
    void *(*make_primaries)(const float *words, size_t n);
    void *(*make_secondaries)(const float *words, size_t n);
    void (*free_primaries)(void *primaries);
    void (*free_secondaries)(void *secondaries);

    /* Primary i against secondary i. */
    void (*zip)(const void *primaries, const void *secondaries, size_t n, peer_answer *answers);
    /* Secondary by secondary against every primary: how many hit. */
    size_t (*all)(const void *primaries, size_t n, const void *secondaries, size_t m);
} peer;

typedef struct peer_list {
    const peer *peers;
    size_t n;
} peer_list;

peer_list peers_fcl(void);
peer_list peers_ode(void);
peer_list peers_bullet(void);
peer_list peers_ccd(void);

#ifdef __cplusplus
}
#endif
#endif
