/* A board configuration: every knob of config.def as a struct field, presets, and setting by key.
 *
 * A plain value: copy it freely. The functions keep no state and may be called from any thread on different structs.
 */
#ifndef HITPIPE_CONFIG_H
#define HITPIPE_CONFIG_H

#include <hitpipe/types.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Operators of a datapath. The first seven have a latency of their own in the operator table; AND, OR are gates in
 * the shadow of a comparator and NOT, NEG, ABS are wires: none of them takes a clock. MIN and MAX are a comparator
 * and a multiplexer. */
typedef enum hp_operator {
    HP_OP_ADD,
    HP_OP_SUB,
    HP_OP_MUL,
    HP_OP_DIV,
    HP_OP_SQRT,
    HP_OP_COMPARE,
    HP_OP_SELECT,
    HP_OP_TIMED, /* how many of them the table times */
    HP_OP_MIN = HP_OP_TIMED,
    HP_OP_MAX,
    HP_OP_AND,
    HP_OP_OR,
    HP_OP_NOT,
    HP_OP_NEG,
    HP_OP_ABS,
    HP_OP_COUNT
} hp_operator;

typedef struct hp_config {
    char name[32];  /* what the board calls itself */
    uint32_t pipes; /* resident pipes: bit CODE of pairs.def */
    uint64_t clock_hz, lanes, loop_order, subnormals;
    uint64_t packet_primaries, packet_buffers, packet_results;
    uint64_t decoder_clocks, selector_clocks;
    uint64_t operator_clocks[HP_OP_TIMED];
    uint64_t ddr_bytes, ddr_row_beats, ddr_row_clocks, ddr_latency, ddr_refresh_interval, ddr_refresh_clocks;
    uint64_t secondary_depth, sram_records;
    uint64_t link_duplex, link_to_board_rate, link_to_host_rate, link_turnaround_ns;
} hp_config;

#define HP_CONFIG_MESSAGE 256 /* bytes that always suffice for a message below */

/* The preset of that name ("usb3", "wscg2007", "ideal"). HP_ERROR_CONFIG for another name; *config stays untouched.
 */
hp_status hp_config_preset(hp_config *config, const char *name);

/* Name of preset number i, or NULL past the last. */
const char *hp_config_preset_name(unsigned i);

/* Sets one knob from text: a decimal whole number, or one of the words of a choice; "name" takes any text under 32
 * bytes and "pipes" a list of pair names with commas between, "all" or "none". HP_ERROR_CONFIG for an unknown key or
 * a value out of range: `message` (HP_CONFIG_MESSAGE bytes) then names the key and what it allows, *config stays
 * untouched.
 */
hp_status hp_config_set(hp_config *config, const char *key, const char *value, char *message);

/* The value of a knob as hp_config_set takes it. Writes at most `room` bytes, always terminated. False: no such key.
 */
bool hp_config_get(const hp_config *config, const char *key, char *text, size_t room);

/* Key number i of config.def ("name" and "pipes" come first), or NULL past the last; its meaning and range in words.
 */
const char *hp_config_key(unsigned i);
const char *hp_config_meaning(unsigned i);
void hp_config_range(unsigned i, char *text, size_t room);

/* Rules between knobs (a refresh must be shorter than its interval). Message as for hp_config_set. */
hp_status hp_config_check(const hp_config *config, char *message);

#ifdef __cplusplus
}
#endif
#endif
