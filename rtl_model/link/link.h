/* The link as the board sees it: how long a transfer takes and which direction goes next. */
#ifndef HITPIPE_LINK_H
#define HITPIPE_LINK_H

#include <hitpipe/config.h>

typedef enum hp_direction { HP_TO_BOARD, HP_TO_HOST, HP_DIRECTIONS } hp_direction;

/* Clocks of its channel that a transfer of n bytes takes, its turnaround included; at least 1. */
uint64_t hp_link_clocks(const hp_config *config, hp_direction direction, size_t n);

/* Which directions may start a transfer in this clock: `waits` says which have one to send, `busy` which are sending.
 * On a half-duplex link both share a channel, and the host is served first. */
void hp_link_grant(const hp_config *config, const bool waits[HP_DIRECTIONS], const bool busy[HP_DIRECTIONS],
                   bool grant[HP_DIRECTIONS]);

#endif
