/* The secondary DDR: what it holds, and its controller's rules.
 *
 * Objects lie one after another. An object takes whole beats of 9 words; the addresses of the controller count beats.
 */
#ifndef HITPIPE_DDR_H
#define HITPIPE_DDR_H

#include <hitpipe/config.h>

/* The scene. The image grows with what is uploaded; memory never written is never taken from the host. */
typedef struct hp_ddr {
    float *words;
    size_t room; /* floats */
} hp_ddr;

/* Makes room for `objects` objects. HP_ERROR_MEMORY: the image stays as it was. */
hp_status hp_ddr_reserve(hp_ddr *ddr, hp_object object, uint64_t objects);
void hp_ddr_free(hp_ddr *ddr);

/* Object number `index`. */
static inline const float *hp_ddr_object(const hp_ddr *ddr, hp_object object, uint64_t index) {
    return ddr->words + index * hp_object_words(object);
}

/* Most objects of this type that the memory holds. */
uint64_t hp_ddr_capacity(const hp_config *config, hp_object object);

/* What the controller does in a clock. */
typedef enum hp_ddr_state { HP_DDR_IDLE, HP_DDR_BEAT, HP_DDR_ROW, HP_DDR_REFRESH } hp_ddr_state;

#define HP_NO_ROW UINT64_MAX

#endif
