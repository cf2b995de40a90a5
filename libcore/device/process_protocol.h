/* The binary protocol between play and an adapter of `play --device process:CMD`, in C, so that an
 * adapter can be written in any language. This header needs no other of hapgrid.
 * examples/devices/README.md explains the protocol.
 *
 * An adapter drives one device, mostly through its maker's library. Its standard input and output
 * are one end of a socket that keeps the boundaries of messages (AF_UNIX, SOCK_SEQPACKET): one
 * read() takes a whole message, one write() sends one. Numbers are little-endian; doubles are IEEE
 * 754. The structs have no padding.
 *
 * The adapter says the greeting once its device is ready. Then play speaks first: for each force
 * the adapter applies it, measures, and answers with one state. When no force came for
 * HAPGRID_DEVICE_SILENCE seconds, or the socket is closed, the adapter applies zero force.
 */
#ifndef HAPGRID_DEVICE_PROCESS_PROTOCOL_H
#define HAPGRID_DEVICE_PROCESS_PROTOCOL_H

#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

#define HAPGRID_DEVICE_MAGIC "hapgrid"
#define HAPGRID_DEVICE_VERSION 1

/* Seconds. When one side hears nothing from the other for so long, it takes the force off the hand.
 */
#define HAPGRID_DEVICE_SILENCE 0.1

/* Axes: x to the right, y away from the user, z up. */
typedef struct hapgrid_device_greeting {
  char magic[8];    /* HAPGRID_DEVICE_MAGIC with its NUL */
  uint32_t version; /* HAPGRID_DEVICE_VERSION */
  uint32_t axes;    /* degrees of freedom: how many axes have low < high; 1 to 3 */
  double low[3];    /* the handle's range, m; low = high on an axis that is missing */
  double high[3];
  double max_force; /* the largest magnitude that the device can hold for long, N */
  double rate;      /* forces a second that the adapter can take, Hz */
  char name[48];    /* for people, UTF-8, filled with NULs */
} hapgrid_device_greeting;

/* Bits of hapgrid_device_state.buttons. */
enum hapgrid_device_button {
  HAPGRID_DEVICE_CLUTCH = 1, /* held: the handle moves without the HIP, and without a force */
  HAPGRID_DEVICE_RESET = 2   /* pressed: the force may come back after a fault */
};

/* From the adapter. */
typedef struct hapgrid_device_state {
  double time;        /* when it was measured, s; never goes back, nor stands still for long */
  double position[3]; /* m */
  double velocity[3]; /* m/s; 0 from a device that does not measure it */
  uint32_t buttons;   /* enum hapgrid_device_button */
  uint32_t number;    /* of the force that it answers */
} hapgrid_device_state;

/* To the adapter. */
typedef struct hapgrid_device_force {
  double force[3]; /* N */
  uint32_t number; /* not 0; the answer repeats it */
  uint32_t end; /* 1: the last message, of zero force. Apply it, answer, close the device, exit */
} hapgrid_device_force;

#ifdef __cplusplus
}
#endif

#endif
