/* A board on the bus of usbfs.h, a scene, rays, and what the model answers them: what the tests of the USB transport
 * have in common. Everything fails by cmocka where a test cannot go on. */
#ifndef TESTBENCH_USB_RIG_H
#define TESTBENCH_USB_RIG_H

#include "testbench/support/random.h"
#include "usbfs.h"
#include <hitpipe/hitpipe.h>

enum { RIG_RAYS = 60, RIG_TRIANGLES = 27, RIG_PACKET = 8, RIG_BUFFERS = 3, RIG_LANES = 3 };

/* What happens to which packets: to `count` of a direction from number `from` on, or to one in `rate` of any. */
typedef struct rig_plan {
    hpt_fault fault;
    bool in;
    unsigned from, count;
    unsigned rate; /* 0: none at random */
    hpt_random random;
    hpt_fault_kind kinds[HPT_FAULT_KINDS]; /* to choose from at random */
    unsigned kind_count;
    unsigned faults; /* that happened */
    unsigned of_kind[HPT_FAULT_KINDS];
} rig_plan;

/* Records of mode all, as they come. */
typedef struct rig_tally {
    unsigned times[RIG_RAYS][RIG_TRIANGLES];
    unsigned total, wrong;
} rig_tally;

typedef struct rig {
    hp_config config;    /* of the board */
    hpt_device_def plug; /* filled in by rig_new but for what a test changes before rig_plug */
    hpt_device *board;
    hp_device_def def; /* to open it with */
    hp_device *device;
    rig_plan plan;
    float rays[RIG_RAYS][6], triangles[RIG_TRIANGLES][9];
    hp_result closest[RIG_RAYS];            /* the truth */
    hp_result all[RIG_RAYS][RIG_TRIANGLES]; /* the same, mode all without separation */
} rig;

/* A rig whose cable is faulty, with a plan of no faults, or straight. `records`: most in a RESULT packet. */
rig *rig_new(hp_usb_speed speed, unsigned records, bool faulty);
void rig_free(rig *r); /* closes and discards what there is */

void rig_plug(rig *r, const char *serial);
hp_status rig_open(rig *r); /* the target is def's */
void rig_close(rig *r);

/* Plugs in, opens and uploads. */
void rig_begin(rig *r);
hp_status rig_upload(rig *r);

/* Lets a fault happen to `count` packets of a direction, from the one behind the next `skip` on. */
void rig_fault(rig *r, hpt_fault_kind kind, unsigned argument, bool in, unsigned skip, unsigned count);
/* Lets one packet in `rate`, of either direction, suffer one of these, with a random argument. */
void rig_random_faults(rig *r, uint64_t seed, unsigned rate, const hpt_fault_kind *kinds, unsigned count);
void rig_no_faults(rig *r);

hp_status rig_ask_closest(rig *r, hp_result *results); /* RIG_RAYS of them, filled with rubbish before */
hp_status rig_ask_all(rig *r, rig_tally *tally);

/* The first `count` results are true. */
void rig_check_closest(const rig *r, const hp_result *results, size_t count);
/* Each record came once, and was true. */
void rig_check_all(const rig *r, const rig_tally *tally);
/* No record came twice or was wrong, and those of the first `primaries` came. */
void rig_check_some(const rig *r, const rig_tally *tally, size_t primaries);
/* Both kinds of question, without faults, are answered truly. */
void rig_check_usable(rig *r);

/* The message of the last error holds these words. */
void rig_says(const hp_device *device, const char *words);

#endif
