/* The right-hand side of the scene rig-2mw, written by hand: the floor under the time of one call.
 *
 * Deviations from the rigid motion, in the stages' frames; laws as in docs/method.md: involute meshes of two levels,
 * pins, bearings in the housing, torsional couplings, a held speed and a torque. Bodies are (x, y, u) in a row, planets
 * are loops, masses come as reciprocals, and what does not change from call to call is worked out beforehand.
 */
#include <math.h>

enum { LSP = 4, HSP = 3 };
enum { L_RING, L_SUN, L_PLANET, H_CARRIER = L_PLANET + LSP, H_SUN, H_PLANET, P_INPUT = H_PLANET + HSP, P_OUTPUT, BODIES };
enum { COUPLINGS = 5 };

typedef struct { double x, y, u; } Triple;
typedef struct { double r1, r2, flank, inv0, k1, k2, c; } Mesh;
typedef struct { double k, c; } Spring;
typedef struct { double x, y; } Place;
typedef struct { double mass, inertia; } Reciprocal;

typedef struct {
  Mesh l_sun, l_ring, h_sun, h_ring, pair;
  Spring l_pin, h_pin, l_ring_bearing, h_sun_bearing, input_bearing, output_bearing;
  Spring coupling[COUPLINGS]; /* input shaft, LSP to HSP, HSP to PSH, output shaft, flange */
  Reciprocal body[BODIES];
  Place place[BODIES], towards[BODIES]; /* from the frame's origin; the same as a unit vector */
  double shaft_inertia, generator_inertia; /* reciprocals */
  double speed, frame_speed, torque;
} Rig;

/* One mesh; sigma is +1 outside and -1 inside, e the nominal direction from body 1 to body 2. */
static inline void mesh(const Mesh *m, double sigma, double level, Place e, Triple a, Triple va, Triple b, Triple vb,
                        Triple *fa, Triple *fb) {
  const double s = m->flank, c = m->r1 + sigma * m->r2, k = m->k1 + (m->k2 - m->k1) * level;
  const double dx = b.x - a.x, dy = b.y - a.y, square = dx * dx + dy * dy;
  const double h = sqrt(square - c * c), per = 1.0 / square;
  const double across = e.x * dy - e.y * dx, along = e.x * dx + e.y * dy;
#ifdef MERGED /* pressure angle less sigma s times the turn of the line of centres, as the angle of a product */
  const double arc = atan((h * along - sigma * s * c * across) / (c * along + sigma * s * h * across));
  const double w = m->r1 * a.u + sigma * m->r2 * b.u;
#else
  const double arc = atan(h / c), turned = atan2(across, along);
  const double w = m->r1 * (a.u - turned) + sigma * m->r2 * (b.u - turned);
#endif
  const double delta = s * w - sigma * (h - c * (arc + m->inv0));
  const double nx = (sigma * h * dx - s * c * dy) * per, ny = (sigma * h * dy + s * c * dx) * per;
  const double rate = s * (m->r1 * va.u + sigma * m->r2 * vb.u) - nx * (vb.x - va.x) - ny * (vb.y - va.y);
  const double force = k * delta + m->c * rate;
  fa->x -= force * nx;
  fa->y -= force * ny;
  fa->u -= s * m->r1 * force;
  fb->x += force * nx;
  fb->y += force * ny;
  fb->u -= sigma * s * m->r2 * force;
}

/* A bearing in the housing, seen from a frame that turns. */
static inline void bearing(Spring b, double turn, Triple q, Triple v, Triple *f) {
  f->x -= b.k * q.x + b.c * (v.x - turn * q.y);
  f->y -= b.k * q.y + b.c * (v.y + turn * q.x);
}

static inline double twist(Spring c, double u, double v) { return c.k * u + c.c * v; }

void floor_rhs(const double *x, const double *level, const Rig *g, double *xdot) {
  const Triple *q = (const Triple *)(x + 3), *v = (const Triple *)(x + 44);
  const double shaft = x[1], generator = x[2], shaft_rate = x[42], generator_rate = x[43], turn = g->frame_speed;
  const Triple ground = {0, 0, 0};
  Triple f[BODIES] = {{0, 0, 0}};
  Triple held = {0, 0, 0};

  for (int i = 0; i < LSP; i++) {
    const int n = L_PLANET + i;
    const Place place = g->place[n], e = g->towards[n];
    const Triple d = q[n], vp = v[n], p = {place.x + d.x, place.y + d.y, d.u};
    Triple *fp = &f[n];
    mesh(&g->l_sun, 1.0, level[2 * i], e, q[L_SUN], v[L_SUN], p, vp, &f[L_SUN], fp);
    mesh(&g->l_ring, -1.0, level[2 * i + 1], e, q[L_RING], v[L_RING], p, vp, &f[L_RING], fp);
    fp->x -= g->l_pin.k * d.x + g->l_pin.c * vp.x;
    fp->y -= g->l_pin.k * d.y + g->l_pin.c * vp.y;
  }
  bearing(g->l_ring_bearing, 0.0, q[L_RING], v[L_RING], &f[L_RING]);

  const Triple carrier = q[H_CARRIER], vc = v[H_CARRIER];
  const double cosine = cos(carrier.u), sine = sin(carrier.u);
  for (int i = 0; i < HSP; i++) {
    const int n = H_PLANET + i;
    const Place place = g->place[n], e = g->towards[n];
    const Triple d = q[n], vp = v[n], p = {place.x + d.x, place.y + d.y, d.u};
    Triple *fp = &f[n], *fc = &f[H_CARRIER];
    mesh(&g->h_sun, 1.0, level[2 * LSP + i], e, q[H_SUN], v[H_SUN], p, vp, &f[H_SUN], fp);
    mesh(&g->h_ring, -1.0, 0.0, e, ground, ground, p, vp, &held, fp);
    const double ax = place.x * cosine - place.y * sine, ay = place.x * sine + place.y * cosine;
    const double rx = p.x - carrier.x, ry = p.y - carrier.y;
    const double kx = g->h_pin.k * (rx - ax), ky = g->h_pin.k * (ry - ay);
    const double cx = g->h_pin.c * (vp.x - vc.x + vc.u * ry), cy = g->h_pin.c * (vp.y - vc.y - vc.u * rx);
    fp->x -= kx + cx;
    fp->y -= ky + cy;
    fc->x += kx + cx;
    fc->y += ky + cy;
    fc->u += ax * ky - ay * kx + rx * cy - ry * cx;
  }
  bearing(g->h_sun_bearing, turn, q[H_SUN], v[H_SUN], &f[H_SUN]);

  const Triple output = {g->place[P_OUTPUT].x + q[P_OUTPUT].x, g->place[P_OUTPUT].y + q[P_OUTPUT].y, q[P_OUTPUT].u};
  mesh(&g->pair, 1.0, level[2 * LSP + HSP], g->towards[P_OUTPUT], q[P_INPUT], v[P_INPUT], output, v[P_OUTPUT],
       &f[P_INPUT], &f[P_OUTPUT]);
  bearing(g->input_bearing, 0.0, q[P_INPUT], v[P_INPUT], &f[P_INPUT]);
  bearing(g->output_bearing, 0.0, q[P_OUTPUT], v[P_OUTPUT], &f[P_OUTPUT]);

  const Spring *c = g->coupling;
  f[L_RING].u -= twist(c[0], q[L_RING].u, v[L_RING].u);
  const double between = twist(c[1], q[L_SUN].u - carrier.u, v[L_SUN].u - vc.u);
  f[L_SUN].u -= between;
  f[H_CARRIER].u += between;
  const double further = twist(c[2], q[H_SUN].u - q[P_INPUT].u, v[H_SUN].u - v[P_INPUT].u);
  f[H_SUN].u -= further;
  f[P_INPUT].u += further;
  const double out = twist(c[3], q[P_OUTPUT].u - shaft, v[P_OUTPUT].u - shaft_rate);
  f[P_OUTPUT].u -= out;
  const double last = twist(c[4], shaft - generator, shaft_rate - generator_rate);

  xdot[0] = g->speed;
  for (int i = 1; i < 42; i++) xdot[i] = x[41 + i];
  xdot[42] = (out - last) * g->shaft_inertia;
  xdot[43] = (last + g->torque) * g->generator_inertia;
  Triple *a = (Triple *)(xdot + 44);
  for (int i = 0; i < BODIES; i++) {
    const double w = i >= H_CARRIER && i < P_INPUT ? turn : 0.0;
    a[i].x = f[i].x * g->body[i].mass + w * (2.0 * v[i].y + w * (g->place[i].x + q[i].x));
    a[i].y = f[i].y * g->body[i].mass + w * (-2.0 * v[i].x + w * (g->place[i].y + q[i].y));
    a[i].u = f[i].u * g->body[i].inertia;
  }
}
