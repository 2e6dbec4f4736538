/* Parts of ltcgear.c against closed forms. Returns the line that failed. */
#include "ltcgear.c"
#include <stdio.h>

#define CHECK(true) \
  do { \
    if (!(true)) return printf("line %d\n", __LINE__), 1; \
  } while (0)

static int near(double one, double two) { return fabs(one - two) <= 1e-14 * larger(fabs(two), 1); }

/* Solve for n unknowns; say whether b pushes along a loose motion. */
static int solved(whole n, double *a, double *b, double *x, double allowed, whole *rank) {
  double bound[4], combination[4], basis[16];
  whole row[4], column[4];
  for (whole i = 0; i < n; ++i) bound[i] = allowed;
  equations e = {n, 0, a, b, x, bound, combination, row, column};
  eliminate(&e);
  *rank = e.rank;
  if (pushes(&e)) return 1;
  solve(&e, basis);
  return 0;
}

static int test_equations(void) {
  double x[4];
  whole rank;
  /* All is held: 2 x + y = 3, x + 3 y = 5. */
  CHECK(!solved(2, (double[]){2, 1, 1, 3}, (double[]){3, 5}, x, 0, &rank));
  CHECK(rank == 2 && near(x[0], 0.8) && near(x[1], 1.4));
  /* A first pivot of zero. */
  CHECK(!solved(2, (double[]){0, 1, 2, 0}, (double[]){3, 5}, x, 0, &rank));
  CHECK(rank == 2 && near(x[0], 2.5) && near(x[1], 3));
  /* Two discs on a spring of 4 that turn together: the smallest answer leaves their mean where it is. */
  CHECK(!solved(2, (double[]){4, -4, -4, 4}, (double[]){1, -1}, x, 1e-15, &rank));
  CHECK(rank == 1 && near(x[0], 0.125) && near(x[1], -0.125));
  CHECK(solved(2, (double[]){4, -4, -4, 4}, (double[]){1, -0.9}, x, 1e-3, &rank));
  CHECK(!solved(2, (double[]){4, -4, -4, 4}, (double[]){1, -0.9}, x, 0.051, &rank));
  /* Three on two springs, 1 and 2, and one alone: a chain turns freely, the last is not held. */
  CHECK(!solved(4, (double[]){1, -1, 0, 0, -1, 3, -2, 0, 0, -2, 2, 0, 0, 0, 0, 0}, (double[]){3, 0, -3, 0}, x, 1e-14, &rank));
  CHECK(rank == 2 && near(x[0] - x[1], 3) && near(x[1] - x[2], 1.5) && near(x[0] + x[1] + x[2], 0) && x[3] == 0);
  CHECK(solved(4, (double[]){1, -1, 0, 0, -1, 3, -2, 0, 0, -2, 2, 0, 0, 0, 0, 0}, (double[]){3, 0, -3, 1}, x, 0.5, &rank));
  /* Nothing is held. */
  CHECK(!solved(2, (double[]){0, 0, 0, 0}, (double[]){0, 0}, x, 0, &rank) && rank == 0 && x[0] == 0 && x[1] == 0);
  return 0;
}

static int test_radius(void) {
  double square[9];
  CHECK(fabs(spectral_radius(2, (double[]){0, 1, -9e8, -60}, square) / 3e4 - 1) < 0.02);  /* s^2 + 60 s + 9e8 */
  CHECK(fabs(spectral_radius(2, (double[]){-5, 1e3, 0, -4}, square) / 5 - 1) < 0.02);     /* far from normal */
  CHECK(fabs(spectral_radius(3, (double[]){2, 0, 0, 0, 0, 7, 0, -7, 0}, square) / 7 - 1) < 0.02);
  CHECK(spectral_radius(2, (double[]){0, 1, 0, 0}, square) == 0);
  return 0;
}

/* Nodes and weights read any polynomial of their degree, and tell its last coefficients. */
static int test_nodes(void) {
  double points[COUNT + 1], weights[COUNT + 1], last[2 * (COUNT + 1)], fine[(FINE + 1) * (COUNT + 1)], path[COUNT + 1];
  march m = {.n = 1, .n_holds = 1, .points = points, .weights = weights, .last_terms = last, .fine = fine, .path = path};
  double one = 0, two = 0, z;
  set_nodes(&m);
  for (whole j = 0; j <= COUNT; ++j) {
    double angle = acos(1 - 2 * points[j]);
    path[j] = 3 * cos(COUNT * angle) - 2 * cos((COUNT - 1) * angle) + points[j];
  }
  for (whole j = 0; j <= COUNT; ++j) one += last[j] * path[j], two += last[COUNT + 1 + j] * path[j];
  CHECK(points[0] == 0 && points[COUNT] == 1 && fabs(one + 2) < 1e-12 && fabs(two - 3) < 1e-12);
  for (whole r = 0; r <= FINE; ++r) {
    double part = (double)r / FINE, angle = acos(1 - 2 * part), read = 0;
    double due = 3 * cos(COUNT * angle) - 2 * cos((COUNT - 1) * angle) + part;
    for (whole j = 0; j <= COUNT; ++j) read += fine[r * (COUNT + 1) + j] * path[j];
    CHECK(!read_path(&m, part, &z) && fabs(z - due) < 1e-12 && fabs(read - due) < 1e-12);
  }
  return 0;
}

int main(void) { return test_equations() || test_radius() || test_nodes(); }
