/* Loads over time: the tables of a model, or what they are steered along. */

typedef struct {
  const double *time, *value;
  whole rows;
} table;

static table table_of(const ltcgear_run *run, whole which) {
  const course *steered = run->courses + which;
  const ltcgear_table *given = run->model->tables + which;
  if (steered->rows) return (table){steered->time, steered->value, steered->rows};
  return (table){given->time, given->value, given->rows};
}

/* The number of rows that lie before a time, or up to it. */
static whole rows_before(const table *t, double time, int up_to) {
  whole low = 0, high = t->rows;
  while (low < high) {
    whole middle = (low + high) / 2;
    if (t->time[middle] < time || (up_to && t->time[middle] == time)) low = middle + 1;
    else high = middle;
  }
  return low;
}

/* The slope after a time, or before it; zero beyond the ends. */
static double slope_at(const table *t, double time, int after) {
  whole i = rows_before(t, time, after);
  if (i == 0 || i == t->rows) return 0;
  return (t->value[i] - t->value[i - 1]) / (t->time[i] - t->time[i - 1]);
}

static double value_at(const table *t, double time) {
  whole i = rows_before(t, time, 1);
  if (i == 0) return t->value[0];
  if (i == t->rows) return t->value[i - 1];
  return t->value[i - 1] + slope_at(t, time, 1) * (time - t->time[i - 1]);
}

/* Write the load signals at a time, slopes those after it or before it. */
static void signals_at(const ltcgear_run *run, double time, int after, double *out) {
  for (whole i = 0; i < run->model->n_signals; ++i) {
    table t = table_of(run, run->model->signal_table[i]);
    out[i] = run->model->signal_slope[i] ? slope_at(&t, time, after) : value_at(&t, time);
  }
}

/* Write their rates after a time; that of a slope is zero between knots. */
static void signal_rates(const ltcgear_run *run, double time, double *out) {
  for (whole i = 0; i < run->model->n_signals; ++i) {
    table t = table_of(run, run->model->signal_table[i]);
    out[i] = run->model->signal_slope[i] ? 0.0 : slope_at(&t, time, 1);
  }
}

/* The first row of any table after a time, infinite where none is left. */
static double knot_after(const ltcgear_run *run, double time) {
  double first = INFINITY;
  for (whole i = 0; i < run->model->n_tables; ++i) {
    table t = table_of(run, i);
    whole row = rows_before(&t, time, 1);
    if (row < t.rows) first = smaller(first, t.time[row]);
  }
  return first;
}

int ltcgear_steer(ltcgear_run *run, ltcgear_whole which, double from, double to, double until) {
  const double now = run->m.time;
  if (which < 0 || which >= run->model->n_tables) return NO_SUCH;
  if (!isfinite(from) || !isfinite(to) || !isfinite(until)) return NOT_A_NUMBER;
  course *c = run->courses + which;
  c->rows = 0;
  if (until > now) c->time[c->rows] = now, c->value[c->rows++] = from;
  if (until > now && from * to < 0) { /* no speed may turn back within an arc */
    double zero = now + (until - now) * (from / (from - to));
    if (now < zero && zero < until) c->time[c->rows] = zero, c->value[c->rows++] = 0;
  }
  c->time[c->rows] = until, c->value[c->rows++] = to;
  return DONE;
}
