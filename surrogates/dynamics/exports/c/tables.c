/* Piecewise cubic tables (Hermite data: of every node the 2^axes derivatives once along the axes whose bit is set; the last
   axis runs fastest), held at their ends, and the forces that are made of them. */
typedef struct {
    int axes;
    int points[4];
    const double *x[4];
    const double *nodes;
} grid;

typedef struct {
    int channel;
    int shelter; /* 1/(1 + (value/reference)^2) instead of a power */
    double reference, exponent, dead_band;
} scale;

typedef struct {
    const grid *table;
    double factor;
    int channel[4]; /* of each axis; -1: held */
    double held[4];
    int scales;
    const scale *scale_of;
} source;

typedef struct {
    int count;
    const source *of;
} force;

static int cell_of(const double *x, int points, double at) {
    int low = 0, high = points - 1;
    while (high - low > 1) {
        const int middle = (low + high) / 2;
        if (at >= x[middle]) {
            low = middle;
        } else {
            high = middle;
        }
    }
    return low;
}

/* Hermite functions of a cell and their first derivatives: [derivative][corner][0: of the value, 1: of the slope]. */
static void weights(double t, double width, double w[2][2][2]) {
    w[0][0][0] = (1 + 2 * t) * (1 - t) * (1 - t);
    w[0][0][1] = width * t * (1 - t) * (1 - t);
    w[0][1][0] = t * t * (3 - 2 * t);
    w[0][1][1] = width * t * t * (t - 1);
    w[1][0][0] = 6 * t * (t - 1) / width;
    w[1][0][1] = (1 - t) * (1 - 3 * t);
    w[1][1][0] = -w[1][0][0];
    w[1][1][1] = t * (3 * t - 2);
}

static double grid_value(const grid *g, const double *point, double *slope) {
    double w[4][2][2][2], value = 0;
    int cell[4], inside[4], k, corner, mask, which;
    const int width = 1 << g->axes;
    for (k = 0; k < g->axes; ++k) {
        const double *x = g->x[k];
        const int last = g->points[k] - 1;
        double at = point[k];
        inside[k] = at >= x[0] && at <= x[last];
        at = at > x[0] ? at : x[0];
        at = at < x[last] ? at : x[last];
        cell[k] = cell_of(x, g->points[k], at);
        weights((at - x[cell[k]]) / (x[cell[k] + 1] - x[cell[k]]), x[cell[k] + 1] - x[cell[k]], w[k]);
        slope[k] = 0;
    }
    for (corner = 0; corner < width; ++corner) {
        const double *node;
        int number = 0;
        for (k = 0; k < g->axes; ++k) {
            number = number * g->points[k] + cell[k] + (corner >> k & 1);
        }
        node = g->nodes + (size_t)number * (size_t)width;
        for (mask = 0; mask < width; ++mask) {
            for (which = -1; which < g->axes; ++which) {
                double product = node[mask];
                for (k = 0; k < g->axes; ++k) {
                    product *= w[k][k == which][corner >> k & 1][mask >> k & 1];
                }
                if (which < 0) {
                    value += product;
                } else if (inside[which]) {
                    slope[which] += product;
                }
            }
        }
    }
    return value;
}

static num grid_at(const grid *g, const num *point) {
    double at[4], slope[4];
    num r;
    int k;
    for (k = 0; k < g->axes; ++k) {
        at[k] = point[k].v;
    }
    r.v = grid_value(g, at, slope);
    r.d = 0;
    for (k = 0; k < g->axes; ++k) {
        r.d += slope[k] * point[k].d;
    }
    return r;
}

/* Of a table of one axis the value and its slope. */
static void curve_at(const grid *g, num x, num *value, num *slope) {
    double first, second = 0;
    const int last = g->points[0] - 1;
    value->v = grid_value(g, &x.v, &first);
    if (x.v >= g->x[0][0] && x.v <= g->x[0][last]) {
        const int i = cell_of(g->x[0], g->points[0], x.v);
        const double width = g->x[0][i + 1] - g->x[0][i], t = (x.v - g->x[0][i]) / width, *n = g->nodes + 2 * i;
        second = (6 * (2 * t - 1) * (n[0] - n[2]) / width + (6 * t - 4) * n[1] + (6 * t - 2) * n[3]) / width;
    }
    value->d = first * x.d;
    slope->v = first;
    slope->d = second * x.d;
}

static num scaled(const scale *s, num x) {
    num ratio;
    if (s->shelter) {
        ratio = isnan(x.v) ? con(0) : times(1 / s->reference, x);
        return quo(con(1), plus(mul(ratio, ratio), 1));
    }
    if (isnan(x.v)) {
        return con(1);
    }
    ratio = times(1 / (s->reference - s->dead_band), at_least(plus(size_of_num(x), -s->dead_band), 0));
    if (!(ratio.v > 0)) {
        return con(s->exponent == 0 ? 1 : 0);
    }
    return with_slope(ratio, pow(ratio.v, s->exponent), s->exponent * pow(ratio.v, s->exponent - 1));
}

static num force_at(const force *f, const num *channel) {
    num sum = con(0);
    int i, k;
    for (i = 0; i < f->count; ++i) {
        const source *s = f->of + i;
        num point[4], product = con(s->factor);
        for (k = 0; k < s->table->axes; ++k) {
            point[k] = s->channel[k] < 0 || isnan(channel[s->channel[k]].v) ? con(s->held[k]) : channel[s->channel[k]];
        }
        for (k = 0; k < s->scales; ++k) {
            product = mul(product, scaled(s->scale_of + k, channel[s->scale_of[k].channel]));
        }
        sum = add(sum, mul(product, grid_at(s->table, point)));
    }
    return sum;
}
