/* The binary protocol between play and an adapter, in C, so that an adapter can be written in any
 * language. This header needs no other of hapgrid. examples/devices/README.md explains the
 * protocol.
 *
 * An adapter is a program that drives one device, mostly through its maker's library. Its standard
 * input and output are one end of a socket that keeps the boundaries of messages (AF_UNIX,
 * SOCK_SEQPACKET): one read() takes a whole message, one write() sends one. Numbers are
 * little-endian; doubles are IEEE 754. The structs have no padding.
 *
 * The adapter says the greeting once its device is ready. Then play speaks first: for each force
 * the adapter applies it, measures, and answers with one state. The adapter applies zero force when
 * it hears nothing for HAPGRID_DEVICE_SILENCE seconds, and when the socket is closed or SIGTERM
 * comes; after these two it ends.
 *
 * In place of a greeting or a state, an adapter that has to end can send HAPGRID_DEVICE_ERROR and
 * the reason, a line of text.
 *
 * With the argument --release behind all others, the adapter finds its device, sends it zero force,
 * and exits with 0. It does so after an adapter was killed.
 */
#ifndef HAPGRID_DEVICE_PROCESS_PROTOCOL_H
#define HAPGRID_DEVICE_PROCESS_PROTOCOL_H

#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

#define HAPGRID_DEVICE_MAGIC "hapgrid"
#define HAPGRID_DEVICE_VERSION 3
#define HAPGRID_DEVICE_ERROR "error: "

/* Seconds. When one side hears nothing from the other for so long, it takes the force off the hand.
 */
#define HAPGRID_DEVICE_SILENCE 0.1

/* Bits of hapgrid_device_greeting.flags. */
enum hapgrid_device_ability {
  HAPGRID_DEVICE_RELEASES = 1, /* the argument --release is known */
  HAPGRID_DEVICE_STEERS = 2,   /* no positions: a deflection sets the speed of the probe */
  HAPGRID_DEVICE_SHARES = 4    /* the adapter sleeps until a force comes, so that it can share the
                                  processor of play's loop: a force then reaches it sooner */
};

/* Axes: x to the right, y away from the user, z up. */
typedef struct hapgrid_device_greeting {
  char magic[8];    /* HAPGRID_DEVICE_MAGIC with its NUL */
  uint32_t version; /* HAPGRID_DEVICE_VERSION */
  uint32_t flags;   /* enum hapgrid_device_ability */
  double low[3];    /* the handle's range, m; low = high on an axis that is missing. If the device
                       steers: -1 and 1, which are full deflection */
  double high[3];
  double max_force; /* the largest magnitude that the device can hold for long, N; 0: no motors */
  double rate;      /* forces a second that the adapter can take, Hz */
  char name[48];    /* for people, UTF-8, filled with NULs */
} hapgrid_device_greeting;

/* Bits of hapgrid_device_state.flags. */
enum hapgrid_device_button {
  HAPGRID_DEVICE_CLUTCH = 1,  /* held: the handle moves without the HIP, and without a force */
  HAPGRID_DEVICE_RESET = 2,   /* pressed: the force may come back after a fault */
  HAPGRID_DEVICE_STALLED = 4, /* the device has been silent for too long: the position is old */
  HAPGRID_DEVICE_NEXT = 8     /* pressed: the model goes on to the next level at this place */
};

/* From the adapter. */
typedef struct hapgrid_device_state {
  double time;        /* when it was measured, s; never goes back, nor stands still for long */
  double position[3]; /* m, or the deflection */
  uint32_t flags;     /* enum hapgrid_device_button */
  uint32_t number;    /* of the force that it answers */
} hapgrid_device_state;

/* Bits of hapgrid_device_force.flags. */
enum hapgrid_device_request {
  HAPGRID_DEVICE_END = 1, /* the last message, of zero force. Apply it, answer, close the device */
  HAPGRID_DEVICE_SNAP = 2 /* the model jumps with this force: a device that rumbles can show it */
};

/* To the adapter. */
typedef struct hapgrid_device_force {
  double force[3]; /* N */
  uint32_t number; /* the answer repeats it; 0: apply the force and do not answer */
  uint32_t flags;  /* enum hapgrid_device_request */
} hapgrid_device_force;

#ifdef __cplusplus
}
#endif

#endif
