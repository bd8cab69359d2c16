/* The messages of USB/IP 1.1.1, as the Linux kernel's usbip_protocol.rst has them. Pure functions over bytes. All
 * numbers are big endian.
 *
 *   OP_REQ_DEVLIST  op                              CMD_SUBMIT  urb head, then the bytes of an urb to the device
 *   OP_REP_DEVLIST  op, count, devices ...          RET_SUBMIT  urb head, then the bytes of one to the host
 *   OP_REQ_IMPORT   op, bus id                      CMD_UNLINK  urb head
 *   OP_REP_IMPORT   op, device unless refused       RET_UNLINK  urb head
 */
#ifndef HITPIPE_USBIP_WIRE_H
#define HITPIPE_USBIP_WIRE_H

#include "driver/gadget/gadget.h"

enum {
    HP_USBIP_VERSION = 0x0111,
    HP_USBIP_OP_BYTES = 8,
    HP_USBIP_BUSID_BYTES = 32,
    HP_USBIP_IMPORT_BYTES = HP_USBIP_OP_BYTES + HP_USBIP_BUSID_BYTES,
    HP_USBIP_COUNT_BYTES = 4,
    HP_USBIP_DEVICE_BYTES = 312,
    HP_USBIP_INTERFACE_BYTES = 4,
    HP_USBIP_URB_BYTES = 48
};

typedef enum hp_usbip_code {
    HP_OP_REQ_DEVLIST = 0x8005,
    HP_OP_REP_DEVLIST = 0x0005,
    HP_OP_REQ_IMPORT = 0x8003,
    HP_OP_REP_IMPORT = 0x0003
} hp_usbip_code;

typedef enum hp_usbip_outcome { /* status of an op */
                                HP_USBIP_OK = 0,
                                HP_USBIP_BUSY = 2,
                                HP_USBIP_NO_DEVICE = 4
} hp_usbip_outcome;

typedef enum hp_usbip_command {
    HP_CMD_SUBMIT = 1,
    HP_CMD_UNLINK = 2,
    HP_RET_SUBMIT = 3,
    HP_RET_UNLINK = 4
} hp_usbip_command;

enum { /* of transfer_flags, those that mean something to a device */
       HP_USBIP_SHORT_NOT_OK = 0x01,
       HP_USBIP_ZERO_PACKET = 0x40
};

typedef struct hp_usbip_op {
    unsigned version, code;
    uint32_t status;
} hp_usbip_op;

/* Any message to the server behind the import. */
typedef struct hp_usbip_urb {
    uint32_t command, seqnum, devid, direction, endpoint; /* direction: 1 to the host */
    uint32_t flags, length, packets;                      /* CMD_SUBMIT; packets: of isochronous urbs */
    uint8_t setup[8];
    uint32_t unlinked; /* CMD_UNLINK: seqnum of the urb */
} hp_usbip_urb;

/* A board as clients see it. */
typedef struct hp_usbip_place {
    char busid[HP_USBIP_BUSID_BYTES]; /* "1-1" */
    unsigned busnum, devnum;
} hp_usbip_place;

hp_usbip_op hp_usbip_read_op(const uint8_t bytes[HP_USBIP_OP_BYTES]);
void hp_usbip_write_op(uint8_t bytes[HP_USBIP_OP_BYTES], hp_usbip_code code, hp_usbip_outcome outcome);
void hp_usbip_write_count(uint8_t bytes[HP_USBIP_COUNT_BYTES], uint32_t count);

/* The device without its interfaces, and one of them. */
void hp_usbip_write_device(uint8_t bytes[HP_USBIP_DEVICE_BYTES], const hp_gadget *gadget,
                           const hp_usbip_place *place);
void hp_usbip_write_interface(uint8_t bytes[HP_USBIP_INTERFACE_BYTES], const hp_gadget *gadget, unsigned number);
unsigned hp_usbip_interfaces(const hp_gadget *gadget);

hp_usbip_urb hp_usbip_read_urb(const uint8_t bytes[HP_USBIP_URB_BYTES]);

/* RET_SUBMIT, RET_UNLINK. `status` as hp_usbip_status gives it. */
void hp_usbip_write_return(uint8_t bytes[HP_USBIP_URB_BYTES], hp_usbip_command command, uint32_t seqnum,
                           uint32_t status, uint32_t moved);

/* How an urb ended, as a negative errno of Linux in two's complement. `cut`: it brought less than it had room for and
 * must not. */
uint32_t hp_usbip_status(hp_urb_status status, bool cut);

#endif
