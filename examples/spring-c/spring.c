/* A model in plain C11, which `hapgrid init --lang c` copies as the start of your own. It includes
 * <hapgrid/plugin.h>, which explains each function of the table. It links the mathematical
 * library and nothing of hapgrid.
 *
 * A bead slides on a rail along x and rests in one of two wells. The HIP pulls it by a spring that
 * weakens with the HIP's distance from the rail. The state s is the bead's place, in
 * mm. With the HIP at p = (x, y, z) and q = y^2 + z^2,
 *
 *   E(p, s) = b/4 (s^2 - a^2)^2 + k(q)/2 (x - s)^2      k(q) = k0 / (1 + q/R^2)
 *   dE/ds = 0:  s^3 + P s - Q = 0                       P = k/b - a^2,  Q = k/b x
 *
 * With m = sqrt(-P/3), there are two stable roots, s < -m and s > m, when P < 0 and |Q| < 2 m^3;
 * otherwise there is one. So the bead remembers nothing but its side: the sign of s.
 */
#include <hapgrid/plugin.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { kBeads = 3 }; /* the spheres that show a state: the bead, and the two wells */

enum { STATE_SIZE = 1 };

struct hapgrid_model {
  double wells, depth, stiffness, reach, strength, tolerance; /* the parameters */
  double b;                                                   /* N/mm^3 */
};

/* k(q). */
static double stiffness(const hapgrid_model* m, double q) {
  return m->stiffness / (1 + q / (m->reach * m->reach));
}

/* The bead's place with the HIP at p when it comes from the given side (the sign of s). */
static double settle(const hapgrid_model* m, const double* p, int right) {
  const double k = stiffness(m, p[1] * p[1] + p[2] * p[2]) / m->b;
  const double P = (k - m->wells * m->wells) / 3; /* a third of the P above */
  const double Q = k * p[0] / 2;                  /* and half of the Q */
  const double D = Q * Q + P * P * P;
  if (D < 0) { /* two stable roots; |Q| / sqrt(-P^3) < 1 */
    const double towards = right ? Q : -Q;
    const double root = 2 * sqrt(-P) * cos(acos(towards / sqrt(-P * P * P)) / 3);
    return right ? root : -root;
  }
  /* Cardano's formula u - P/u, written so that nothing cancels. */
  const double u = cbrt(fabs(Q) + sqrt(D));
  return u > 0 ? 2 * Q / (u * u + P + P / u * (P / u)) : 0;
}

static double stretch(const double* p, double s) {
  return sqrt((p[0] - s) * (p[0] - s) + p[1] * p[1] + p[2] * p[2]);
}

/* Reads one parameter. When it is refused, this returns 0 and writes a message. */
static int take(hapgrid_model* m, const hapgrid_parameter* p, char* error, size_t error_size) {
  const struct {
    const char* key;
    double* value;
  } known[] = {{"wells", &m->wells}, {"depth", &m->depth},       {"stiffness", &m->stiffness},
               {"reach", &m->reach}, {"strength", &m->strength}, {"tolerance", &m->tolerance}};
  for (size_t k = 0; k < sizeof known / sizeof *known; ++k) {
    if (strcmp(known[k].key, p->key) != 0) continue;
    if (p->type != HAPGRID_NUMBER) {
      snprintf(error, error_size, "parameter %s must be a number", p->key);
      return 0;
    }
    if (!(p->numbers[0] > 0 && isfinite(p->numbers[0]))) {
      snprintf(error, error_size, "parameter %s is %g, it must be positive", p->key, p->numbers[0]);
      return 0;
    }
    *known[k].value = p->numbers[0];
    return 1;
  }
  snprintf(error, error_size,
           "unknown parameter %s (known: wells, depth, stiffness, reach, strength, tolerance)",
           p->key);
  return 0;
}

static void destroy(hapgrid_model* m) { free(m); }

static hapgrid_model* create(const hapgrid_parameter* parameters, size_t count, char* error,
                             size_t error_size) {
  hapgrid_model* m = malloc(sizeof *m);
  if (!m) {
    snprintf(error, error_size, "out of memory");
    return NULL;
  }
  *m = (hapgrid_model){
      .wells = 10, .depth = 5, .stiffness = 0.25, .reach = 10, .strength = 60, .tolerance = 1e-6};
  for (size_t i = 0; i < count; ++i) {
    if (take(m, &parameters[i], error, error_size)) continue;
    destroy(m);
    return NULL;
  }
  m->b = 4 * m->depth / pow(m->wells, 4);
  return m;
}

static void info(const hapgrid_model* m, hapgrid_model_info* info) {
  info->state_size = STATE_SIZE;
  info->d_max = m->reach;
  info->tolerance = m->tolerance;
  snprintf(info->tolerance_unit, sizeof info->tolerance_unit, "mm");
  snprintf(info->length_unit, sizeof info->length_unit, "mm");
  snprintf(info->energy_unit, sizeof info->energy_unit, "N mm");
  info->force_scale = 1;
  info->spheres = kBeads;
}

/* All states are known: one for each side, or a single one. */
static int known_states(hapgrid_model* m, const double* x, double* states, size_t capacity,
                        size_t* count, char* error, size_t error_size) {
  (void)error, (void)error_size;
  const double known[2] = {settle(m, x, 0), settle(m, x, 1)};
  *count = known[0] < 0 && known[1] > 0 ? 2 : 1;
  for (size_t i = 0; i < *count && i < capacity; ++i) states[i] = known[i];
  return 0;
}

/* The HIP walks in substeps that are short against the reach of the spring. Where there is one
 * root, the bead follows it and may change sides. */
static int convert(hapgrid_model* m, const double* s, const double* x, const double* d,
                   double* result, char* error, size_t error_size) {
  const double length = sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
  const double steps = ceil(length / (m->reach / 64));
  *result = *s;
  for (double k = 1; k <= steps; ++k) {
    const double f = k / steps;
    const double p[3] = {x[0] + f * d[0], x[1] + f * d[1], x[2] + f * d[2]};
    *result = settle(m, p, *result >= 0);
    if (!(stretch(p, *result) <= m->strength)) {
      snprintf(error, error_size, "the spring broke: stretched to %g mm, its strength is %g mm",
               stretch(p, *result), m->strength);
      return 1;
    }
  }
  return 0;
}

static int equal(const hapgrid_model* m, const double* a, const double* b) {
  for (int k = 0; k < STATE_SIZE; ++k)
    if (!(fabs(a[k] - b[k]) <= m->tolerance)) return 0;
  return 1;
}

/* -dE/dp at fixed s. As dE/ds = 0, it is also the slope along the branch. */
static void force(hapgrid_model* m, const double* x, const double* s, double* force) {
  const double k = stiffness(m, x[1] * x[1] + x[2] * x[2]);
  const double u = x[0] - *s;
  const double sideways = u * u * k * k / (m->stiffness * m->reach * m->reach); /* -k'(q) u^2 */
  force[0] = -k * u;
  force[1] = sideways * x[1];
  force[2] = sideways * x[2];
}

static double energy(hapgrid_model* m, const double* x, const double* s) {
  const double well = *s * *s - m->wells * m->wells;
  const double u = x[0] - *s;
  return m->b / 4 * well * well + stiffness(m, x[1] * x[1] + x[2] * x[2]) / 2 * u * u;
}

static void spheres(const hapgrid_model* m, hapgrid_sphere* spheres) {
  const hapgrid_sphere bead = {(float)(m->wells / 5), {0.9F, 0.9F, 0.3F}, ""};
  const hapgrid_sphere well = {(float)(m->wells / 20), {0.4F, 0.4F, 0.9F}, ""};
  spheres[0] = bead, spheres[1] = well, spheres[2] = well;
}

static void shape(hapgrid_model* m, const double* x, const double* s, float* centres) {
  (void)x;
  memset(centres, 0, 3 * kBeads * sizeof *centres);
  centres[0] = (float)*s;
  centres[3] = (float)-m->wells;
  centres[6] = (float)m->wells;
}

const hapgrid_model_table* hapgrid_model_plugin(void) {
  static const hapgrid_model_table table = {
      .interface_version = HAPGRID_MODEL_INTERFACE,
      .summary = "a bead between two wells, pulled by a spring (C)",
      .create = create,
      .destroy = destroy,
      .info = info,
      .known_states = known_states,
      .convert = convert,
      .equal = equal,
      .force = force,
      .energy = energy,
      .spheres = spheres,
      .shape = shape,
  };
  return &table;
}
