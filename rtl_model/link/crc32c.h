/* CRC-32C, one function a way of computing it, so that tests can hold them against each other. hp_crc32c (packet.h)
 * picks the fastest that this processor has. Pure functions; any thread.
 *
 * Source: RFC 3720 (iSCSI) appendix B.4; polynomial 0x1EDC6F41, reflected 0x82F63B78 (Castagnoli 1993). */
#ifndef HITPIPE_CRC32C_H
#define HITPIPE_CRC32C_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* A byte a step, any processor. */
uint32_t hp_crc32c_table(uint32_t crc, const void *bytes, size_t n);

/* Whether this processor has a CRC-32C instruction (SSE4.2, ARMv8 crc) and this build knows it. */
bool hp_crc32c_has_instruction(void);

/* Eight bytes a step, and 24 of what is longer than 12 KiB. Only where hp_crc32c_has_instruction is true. */
uint32_t hp_crc32c_instruction(uint32_t crc, const void *bytes, size_t n);

#endif
