/* The interface between hapgrid and a model, in C, so that a model can be written in C, C++,
 * Fortran or Rust. A plug-in is a shared object NAME.so that exports one function,
 * hapgrid_model_plugin(), which returns a table that lives as long as the object is loaded.
 * C++ models derive from the class in plugin.hpp instead of filling the table themselves.
 *
 * Shapes and units. A position or shift is double[3] in the model's unit of length; a state is
 * double[n], n = state_size, in whatever units the model has; a force is double[3] in newtons.
 *
 * Ownership. The caller owns every array that is passed, in and out; nothing is kept after a call.
 *
 * Threads. A model (what create() returned) is used by one thread at a time. A program that
 * computes in parallel creates one model a thread, all from the same parameters, and expects the
 * same bits from each: convert() must depend on its arguments and the parameters alone. Where a
 * library cannot bear that, info.processes = 1 says so: then one thread asks one model. create()
 * is called by one thread at a time, so that it may read files with libraries that are not
 * thread-safe; all other functions are called while create() may run.
 *
 * Errors. A function that can fail returns 0 for success and anything else for failure, and then
 * has written one line into `error` (at most `error_size` bytes, with the final NUL). No C++
 * exception may leave a plug-in.
 *
 * Real time. force(), energy(), own_energy() and shape() are called inside the haptic loop: no
 * allocation, no lock, no input or output. Those that info.stored names are called by expand
 * alone, and may.
 */
#ifndef HAPGRID_MODEL_PLUGIN_H
#define HAPGRID_MODEL_PLUGIN_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Raised by every change that a compiled plug-in would notice. */
#define HAPGRID_MODEL_INTERFACE 5

enum hapgrid_parameter_type {
  HAPGRID_BOOLEAN = 0, /* numbers[0] is 0 or 1 */
  HAPGRID_NUMBER = 1,
  HAPGRID_TEXT = 2,
  HAPGRID_NUMBERS = 3,
  HAPGRID_TEXTS = 4
};

/* One entry of [model.parameters]; tables are flattened ("probe.radius"). */
typedef struct hapgrid_parameter {
  const char* key;
  int32_t type;             /* enum hapgrid_parameter_type */
  size_t count;             /* 1 for the first three types */
  const double* numbers;    /* double[count], NULL for text */
  const char* const* texts; /* NUL-terminated strings [count], NULL for numbers */
} hapgrid_parameter;

/* Bits of hapgrid_model_info.stored: what takes too long for the haptic loop. expand evaluates it
 * once for each state that it finds, the grid carries it, and play interpolates it without the
 * model (Sect. 2.2 of the paper). */
enum hapgrid_stored { HAPGRID_STORE_FORCE = 1, HAPGRID_STORE_SHAPE = 2, HAPGRID_STORE_ENERGY = 4 };

/* What hapgrid_model_table.periods() writes for the components of an orientation. */
#define HAPGRID_ROTATION (-1.0)

/* Texts are NUL-terminated UTF-8. The table's caller has set everything to zero before info(). */
typedef struct hapgrid_model_info {
  uint32_t state_size; /* n >= 1 */
  uint32_t stored;     /* bits of enum hapgrid_stored */
  double d_max;        /* convert() is defined for |d| <= d_max (Sect. 2.1, condition a) */
  double tolerance;    /* the bound that equal() applies; for messages and the shard's header */
  char tolerance_unit[16];
  char length_unit[16]; /* of positions, for people: "angstrom"; may be empty */
  char energy_unit[16]; /* of energy(), for people: "kJ/mol"; may be empty */
  char version[32];     /* may be empty. The grid keeps it, and a model of another version does not
                         * go on with the grid: change it with whatever changes an answer */
  double force_scale;   /* newtons that one energy unit per length unit is on the device: along a
                         * smooth branch, force = -force_scale * gradient of energy; with energy() */
  double hip_radius;    /* of the ball that the HIP moves, for pictures; 0 when it is none */
  uint32_t spheres;     /* how many spheres show a state; 0 without spheres() and shape() */
  uint32_t torsions;    /* how many torsions people watch; 0 without torsions() */
  uint32_t processes;   /* 1: one process each, because models in one process share data; 0: any
                         * number of models may work side by side */
} hapgrid_model_info;

/* What stays the same of a sphere, whatever the state. */
typedef struct hapgrid_sphere {
  float radius;    /* the model's unit of length */
  float colour[3]; /* red, green, blue in [0, 1] */
  char label[8];   /* of an atom its element's symbol; NUL-terminated, may be empty */
} hapgrid_sphere;

/* The angle between two planes, through the first three and the last three of four spheres. */
typedef struct hapgrid_torsion {
  uint32_t spheres[4]; /* numbers of spheres, from 0 */
  char name[24];       /* NUL-terminated */
} hapgrid_torsion;

typedef struct hapgrid_model hapgrid_model; /* the plug-in's own */

typedef struct hapgrid_model_table {
  /* HAPGRID_MODEL_INTERFACE; looked at before anything else, so it stays first. */
  uint32_t interface_version;
  const char* summary; /* one line for people */

  /* A key that the model does not know, a missing one or a value out of range is an error. */
  hapgrid_model* (*create)(const hapgrid_parameter* parameters, size_t count, char* error,
                           size_t error_size);
  void (*destroy)(hapgrid_model* model);
  void (*info)(const hapgrid_model* model, hapgrid_model_info* info);

  /* The states known a priori at x (seed states, Sect. 2.1): writes at most `capacity` states,
   * row after row, and sets *count to how many it knows, which can be 0 or more than capacity. */
  int (*known_states)(hapgrid_model* model, const double* x, double* states, size_t capacity,
                      size_t* count, char* error, size_t error_size);

  /* The conversion function C(s, x, d): the state reached when the HIP moves from x, where the
   * model is in state s, straight to x + d. */
  int (*convert)(hapgrid_model* model, const double* s, const double* x, const double* d,
                 double* result, char* error, size_t error_size);

  /* The tolerance function (Sect. 2.3): nonzero when a and b count as the same state.
   * Reflexive and symmetric; no force and no allocation needed, it is called very often. */
  int (*equal)(const hapgrid_model* model, const double* a, const double* b);

  /* Optional (NULL): the force on the HIP at x in state s, F(x, s), in newtons. */
  void (*force)(hapgrid_model* model, const double* x, const double* s, double* force);

  /* Optional (NULL): the energy of state s with the HIP at x, in info.energy_unit. */
  double (*energy)(hapgrid_model* model, const double* x, const double* s);

  /* Optional (NULL, both or none): the info.spheres spheres that show a state. spheres() writes
   * what stays the same, shape() the centres in state s with the HIP at x:
   * float[3 * info.spheres], x y z by sphere, in the model's unit of length. */
  void (*spheres)(const hapgrid_model* model, hapgrid_sphere* spheres);
  void (*shape)(hapgrid_model* model, const double* x, const double* s, float* centres);

  /* Optional (NULL): the energy of state s by itself, in info.energy_unit: without the HIP, and
   * without what only holds the model in its place. */
  double (*own_energy)(hapgrid_model* model, const double* s);

  /* Optional (NULL): writes the info.torsions torsions that pictures name and follow. */
  void (*torsions)(const hapgrid_model* model, hapgrid_torsion* torsions);

  /* Optional (NULL): what is wrong with parameters that create() takes. check-model asks for it, so
   * it may take seconds. Calls tell() with `context` once for each problem, which is a plain line
   * that says what to do. */
  void (*check)(hapgrid_model* model, void (*tell)(void* context, const char* line), void* context);

  /* Optional (NULL): what the components of a state are, periods[info.state_size], all 0 before: 0
   * for a plain number; the period of an angle; HAPGRID_ROTATION for each of six components in a
   * row that are the first two columns of a rotation matrix. Between two records play turns an
   * angle on the shorter way, and makes the columns orthonormal. */
  void (*periods)(const hapgrid_model* model, double* periods);
} hapgrid_model_table;

/* The one symbol that a plug-in exports. */
const hapgrid_model_table* hapgrid_model_plugin(void);

#ifdef __cplusplus
}
#endif

#endif
