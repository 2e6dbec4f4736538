/* Linear equations of which some motions may meet no stiffness: Gaussian elimination with complete pivoting. */

/* Equations a x = b of a size, and how their rows and columns were exchanged; ``rank`` pivots differ from rounding. */
typedef struct {
  whole size, rank;
  double *a, *b, *x, *bound, *combination;
  whole *row, *column;
} equations;

static double *entry(const equations *e, whole i, whole j) { return e->a + e->row[i] * e->size + e->column[j]; }

static void exchange(whole *list, whole i, whole j) {
  whole kept = list[i];
  list[i] = list[j], list[j] = kept;
}

/* Eliminate in place: multipliers below the pivots, what is left above. */
static void eliminate(equations *e) {
  const whole n = e->size;
  double first = 0;
  for (whole i = 0; i < n; ++i) e->row[i] = e->column[i] = i;
  for (e->rank = 0; e->rank < n; ++e->rank) {
    const whole k = e->rank;
    whole at = k, to = k;
    for (whole i = k; i < n; ++i)
      for (whole j = k; j < n; ++j)
        if (fabs(*entry(e, i, j)) > fabs(*entry(e, at, to))) at = i, to = j;
    exchange(e->row, k, at), exchange(e->column, k, to);
    const double pivot = *entry(e, k, k);
    if (k == 0) first = fabs(pivot);
    if (!(fabs(pivot) > LOOSENESS * (double)n * first)) return;
    for (whole i = k + 1; i < n; ++i) {
      double part = *entry(e, i, k) /= pivot;
      if (part != 0)
        for (whole j = k + 1; j < n; ++j) *entry(e, i, j) -= part * *entry(e, k, j);
    }
  }
}

/* Say whether b pushes along a loose motion by more than the bounds of its entries allow. */
static int pushes(const equations *e) {
  for (whole loose = e->rank; loose < e->size; ++loose) {
    double push = e->b[e->row[loose]], bound = e->bound[e->row[loose]];
    for (whole i = e->rank - 1; i >= 0; --i) {
      double sum = *entry(e, loose, i);
      for (whole j = i + 1; j < e->rank; ++j) sum += e->combination[j] * *entry(e, j, i);
      e->combination[i] = -sum;
      push += e->combination[i] * e->b[e->row[i]];
      bound += fabs(e->combination[i]) * e->bound[e->row[i]];
    }
    if (fabs(push) > bound) return 1;
  }
  return 0;
}

/* Find x from the pivots' equations, the loose entries of x given. */
static void substitute(const equations *e, double *x) {
  for (whole i = e->rank - 1; i >= 0; --i) {
    double sum = x[e->column[i]];
    for (whole j = i + 1; j < e->size; ++j) sum -= *entry(e, i, j) * x[e->column[j]];
    x[e->column[i]] = sum / *entry(e, i, i);
  }
}

static double product(whole n, const double *one, const double *two) {
  double sum = 0;
  for (whole i = 0; i < n; ++i) sum += one[i] * two[i];
  return sum;
}

/* Take from a vector its part along another one. */
static void take_part(whole n, double *from, const double *along) {
  double part = product(n, from, along) / product(n, along, along);
  for (whole i = 0; i < n; ++i) from[i] -= part * along[i];
}

/* Solve, with the smallest x where motions are loose. ``basis`` has room for one vector per loose motion. */
static void solve(equations *e, double *basis) {
  const whole n = e->size, loose = n - e->rank;
  for (whole i = 0; i < e->rank; ++i) {
    double sum = e->b[e->row[i]];
    for (whole j = 0; j < i; ++j) sum -= *entry(e, i, j) * e->x[e->column[j]];
    e->x[e->column[i]] = sum;
  }
  for (whole i = e->rank; i < n; ++i) e->x[e->column[i]] = 0;
  substitute(e, e->x);
  for (whole k = 0; k < loose; ++k) {
    double *motion = basis + k * n;
    for (whole i = 0; i < n; ++i) motion[i] = 0;
    motion[e->column[e->rank + k]] = 1;
    substitute(e, motion);
    for (whole j = 0; j < k; ++j) take_part(n, motion, basis + j * n);
    take_part(n, e->x, motion);
  }
}
