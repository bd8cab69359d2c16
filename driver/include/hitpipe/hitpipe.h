/* hitpipe: collision and intersection queries on a board, real or simulated.
 *
 *     hp_device_def def = hp_default_device_def();        // target "model", board preset "usb3", quick engine
 *     hp_device *device;
 *     hp_status status = hp_open(&def, &device);
 *     hp_upload(device, HP_TRIANGLE, triangles, count);   // 9 floats a triangle, once
 *     hp_query_def query = hp_default_query_def();        // ray-triangle, mode closest, all secondaries
 *     hp_query(device, &query, rays, n, results);         // 6 floats a ray; any n
 *     hp_close(device);
 *
 * Units: T of a ray pair counts lengths of the ray's own direction; every other length is in the units of the input.
 * Threads: a device is used by one thread at a time; different devices are independent. The library starts threads
 * only for the simulated board's arithmetic (hp_device_def.threads), prints nothing and shares no state.
 * Errors: every call returns an hp_status (status.def: each with its cause); hp_error_message says place and cause in
 * words. After any error but HP_ERROR_DISCONNECTED the device can be used again; after
 * that one, too, with reconnect_ms: the next call waits for the board once more. */
#ifndef HITPIPE_HITPIPE_H
#define HITPIPE_HITPIPE_H

#include <hitpipe/config.h>
#include <hitpipe/counters.h>
#include <hitpipe/types.h>

#ifdef __cplusplus
extern "C" {
#endif

#define HITPIPE_VERSION "0.1.0"

typedef struct hp_device hp_device;

/* Called during long calls, from the calling thread, at most some tens of times a second, also while a board is
 * waited for: `done` of `total` units (bytes of an upload, primaries of a query; 0 of 0 while a board is opened).
 * Returning false stops the call with HP_ERROR_CANCELLED; the board stays usable. */
typedef bool hp_progress(void *context, uint64_t done, uint64_t total);

/* A file descriptor that a board's link waits for, with `events` as poll(2) takes them. */
typedef struct hp_wait_file {
    int fd;
    short events;
} hp_wait_file;

/* Waits in the driver's stead, on the thread of the call, so that a program can run its own loop during long calls:
 * until one of the files is ready, or timeout_ms have passed. Coming back early is fine: it is called again. It must
 * not use the device that waits. `files` lives for the call; there may be none (a board is awaited to come back). */
typedef void hp_wait(void *context, const hp_wait_file *files, size_t count, unsigned timeout_ms);

/* Takes a line of libusb's log: a libusb_log_cb. From any thread that libusb is used on, its own included. `level` is
 * that of libusb: 1 errors, 2 warnings, 3 information, 4 everything. */
struct libusb_context;
typedef void hp_usb_log(struct libusb_context *context, unsigned level, const char *text);

/* How to open a device. Always begin with hp_default_device_def. */
typedef struct hp_device_def {
    uint32_t cookie;    /* set by hp_default_device_def: a def without it is refused with HP_ERROR_USAGE */
    const char *target; /* "model" (default), "usb" (the only board on USB), "usb:SERIAL" or "null" */
    hp_config board;    /* model: the board to simulate; default the preset "usb3" */
    bool clocked;       /* model: the clocked engine instead of the quick one; same answers, same counts */
    const char *isa;    /* model: "avx512", "avx2", "sse2", "neon", "plain"; NULL: environment HP_ISA or the best */
    unsigned threads;   /* model: threads of the arithmetic; 0: one per processor */
    void (*vcd)(void *context, const char *text, size_t n); /* model, clocked: takes the waveform; NULL: none */
    void *vcd_context;
    unsigned timeout_ms; /* longest wait for anything new from the board, at least 1; default 10000 */
    unsigned retries;    /* how often a damaged or lost packet is sent again; default 3 */
    bool unchecked;      /* send objects and matrices as they are, NaN, infinities and zero directions too, which
                          * hp_upload, hp_transform and hp_query refuse otherwise: for bring-up and replay of golden
                          * vectors. A board answers F 0 to such a pair. Default false */
    unsigned in_flight;  /* most packets under way; 0: as many as the board gives credits for */
    /* usb: how long a call waits for a board that is lost or reset in its midst to be back. The board of the same
     * serial number then gets scene and matrix again, of which the device keeps a copy, and the call goes on with
     * what is not answered: nothing is lost, nothing comes twice. A board that is lost again and again, more than
     * `retries` times without getting on, is given up. 0 (default): such a call ends in HP_ERROR_DISCONNECTED, or
     * HP_ERROR_SEQUENCE for a reset */
    unsigned reconnect_ms;
    hp_progress *progress; /* NULL: none */
    void *progress_context;
    hp_wait *wait; /* NULL: the driver waits itself. The model waits for nothing */
    void *wait_context;
    unsigned usb_vendor, usb_product; /* usb: identifiers to look for; default those of usb.def, 1209:0001 */
    unsigned usb_depth;    /* usb: transfers under way in each direction, 1 to HP_USB_DEPTH_MAX; default 4 */
    unsigned usb_transfer; /* usb: most bytes of one transfer, a multiple of 1024 up to HP_USB_TRANSFER_MAX. Default
                            * 0: as many as a packet has, which saves a copy; less needs less memory in the kernel */
    /* usb: a context of libusb's to use, which must outlive the device; another thread may handle its events. Its log
     * is left alone. NULL: one of its own */
    struct libusb_context *usb_context;
    /* usb: takes the log of the device's own context, errors and warnings unless the environment's LIBUSB_DEBUG asks
     * for more. libusb's log handler of the whole process is then set to one that drops. NULL (default): no log */
    hp_usb_log *usb_log;
} hp_device_def;

enum { HP_USB_DEPTH_MAX = 32, HP_USB_TRANSFER_MAX = 16 * 1024 * 1024 };

hp_device_def hp_default_device_def(void);

/* Opens the target and says HELLO. On success *device is the caller's to close; else *device is NULL.
 * HP_ERROR_USAGE (def without cookie, no timeout, unknown ISA, vcd without clocked), HP_ERROR_CONFIG,
 * HP_ERROR_NO_DEVICE (no such target; usb: no board, several, no permission, or another program has it),
 * HP_ERROR_VERSION, HP_ERROR_TIMEOUT (a board that never answers: target "null" does this),
 * HP_ERROR_MEMORY. */
hp_status hp_open(const hp_device_def *def, hp_device **device);

/* Cancels what is under way and frees the device. NULL is fine. */
void hp_close(hp_device *device);

/* What the board said of itself in HELLO. Lives as long as the device. */
typedef struct hp_identity {
    char name[33];
    char serial[64]; /* usb: serial number; "" otherwise */
    unsigned version, lanes, packet_primaries, packet_buffers;
    uint64_t clock_hz, ddr_bytes;
    uint32_t pairs; /* bit CODE of pairs.def: resident */
    hp_loop_order loop_order;
    hp_subnormals subnormals;
    const char *target; /* "model", "usb" */
    const char *engine; /* "quick", "clocked"; "hardware" for a real board */
    const char *isa;    /* of a model; "" otherwise */
} hp_identity;
const hp_identity *hp_identify(const hp_device *device);

/* Makes `count` objects, hp_object_words(object) floats each, the resident secondaries, numbered from 0. `words` is
 * only read, and not kept. Waits until the board has them all. HP_ERROR_INPUT: an object that hp_object_fault
 * refuses, the message names its index, nothing is sent and the old scene stays. HP_ERROR_CAPACITY: more than the
 * board's DDR holds; the old scene stays. Link errors, HP_ERROR_CANCELLED: there is no scene until the next upload
 * that succeeds. */
hp_status hp_upload(hp_device *device, hp_object object, const float *words, size_t count);

/* Sets the transformer: secondaries are moved by the 3x4 row-major matrix in all later queries. NULL: not moved.
 * HP_ERROR_INPUT for a NaN or an infinity; a query refuses a matrix that the type of its secondaries cannot carry
 * (hp_transform_fault), with the same status. */
hp_status hp_transform(hp_device *device, const float matrix[12]);

/* Whether the distance of a miss is computed. AUTO: where the query shows it, in modes all and zip and with
 * `nearest`.
 */
typedef enum hp_separation { HP_SEPARATION_AUTO = 0, HP_SEPARATION_OFF, HP_SEPARATION_ON } hp_separation;

/* What to ask. Always begin with hp_default_query_def. */
typedef struct hp_query_def {
    uint32_t cookie;
    hp_pair pair;             /* default HP_PAIR_RAY_TRIANGLE */
    hp_mode mode;             /* default HP_MODE_CLOSEST */
    size_t first, count;      /* which secondaries; count 0: all from `first` on (mode zip: one a primary) */
    const uint32_t *stencil;  /* bit i%32 of word i/32: primary i takes part; NULL: all do */
    size_t packet;            /* primaries in a packet; 0: as many as the board takes */
    hp_separation separation; /* T of a miss: its distance, or +inf; default HP_SEPARATION_AUTO */
    bool nearest;             /* mode closest: a primary without a hit keeps its nearest miss, F 0 with T and index */
} hp_query_def;
hp_query_def hp_default_query_def(void);

/* Asks for n primaries, hp_object_words(hp_pair_primary(pair)) floats each, in modes closest, any and zip. Splits
 * them into packets and keeps several under way. results[i] answers primary i; a primary that the stencil masks gets
 * a miss with stencil 0. `results` is written only for primaries whose answer came; on error, the message says how
 * many. HP_ERROR_INPUT (message names the primary), HP_ERROR_USAGE (mode all; nearest in another mode
 * than closest), HP_ERROR_CAPACITY (secondaries past
 * the scene), HP_ERROR_NOT_RESIDENT, HP_ERROR_CANCELLED, link errors after the retries. */
hp_status hp_query(hp_device *device, const hp_query_def *def, const float *primaries, size_t n, hp_result *results);

/* Takes `count` records of mode all: record i answers primary primary[i] with secondary secondary[i]. The arrays live
 * for the call. Returning false stops the query with HP_ERROR_CANCELLED. */
typedef bool hp_records_taker(void *context, const uint32_t *primary, const uint32_t *secondary,
                              const hp_result *records, size_t count);

/* Mode all: a record for each pair that the stencil lets take part. Whatever the board's loop order, records come
 * packet by packet, each exactly once. Memory use does not grow with the number of records. Errors as hp_query. */
hp_status hp_query_all(hp_device *device, const hp_query_def *def, const float *primaries, size_t n,
                       hp_records_taker *take, void *context);

/* Reads the board's counter registers, and sets them to 0 if `clear`. Counts are those before this call's own answer.
 */
hp_status hp_read_counters(hp_device *device, bool clear, hp_counters *counters);

/* How many primaries of the last hp_query or hp_query_all were answered, from the first on: all when it succeeded,
 * fewer after any error. Their results, or records, are complete. */
size_t hp_completed(const hp_device *device);

/* How often since hp_open the board was lost or reset and came back (hp_device_def.reconnect_ms). Counters are the
 * board's own, and begin anew each time. */
unsigned hp_reconnections(const hp_device *device);

/* Words on why the last call on this device failed, with the place: "primary 17: direction is zero". Empty when it
 * did not. With NULL: the same of this thread's last hp_open. Valid until the next call. */
const char *hp_error_message(const hp_device *device);

#ifdef __cplusplus
}
#endif
#endif
