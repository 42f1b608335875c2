/* What was commanded, kept for as long as the actuator's delay: points with straight lines between them, two of one time where
   the command jumps. Before the first it is that of the first. */
typedef struct {
    double t, u;
} command_point;
typedef struct {
    command_point *at; /* an instance's own; the points of a stored state stand behind it */
    size_t count, room;
} command_history;

static double same_time(double t) { return 1e-12 * (1 + fabs(t)); }

static int make_room(command_history *past, size_t points) {
    if (past->room < points) {
        command_point *more = (command_point *)realloc(past->at, 2 * points * sizeof(command_point));
        if (more == NULL) {
            return 0;
        }
        past->at = more;
        past->room = 2 * points;
    }
    return 1;
}

/* How many points lie at s or before it. */
static size_t points_until(const command_history *past, double s) {
    size_t low = 0, high = past->count;
    while (low < high) {
        const size_t middle = (low + high) / 2;
        if (past->at[middle].t <= s) {
            low = middle + 1;
        } else {
            high = middle;
        }
    }
    return low;
}

/* The line after `which` points, at s. */
static double on_line(const command_history *past, size_t which, double s, double *slope) {
    const command_point *p = past->at + (which > 0 ? which - 1 : 0);
    *slope = 0;
    if (which == 0) {
        return p->u;
    }
    if (which < past->count && p[1].t - p[0].t > same_time(s)) {
        *slope = (p[1].u - p[0].u) / (p[1].t - p[0].t);
    }
    return p[0].u + *slope * (s - p[0].t);
}

/* The command u of the time t; what was kept of later times belongs to a step that is taken again. What was felt before `now`
   is forgotten. 0: no memory. */
static int remember(command_history *past, double now, double t, double u) {
    size_t old, n = points_until(past, t + same_time(t));
    if (n > 0 && n < past->count) {
        double slope;
        past->at[n].u = on_line(past, n, t, &slope);
        past->at[n].t = t;
        past->count = n + 1;
    } else {
        past->count = n;
    }
    old = points_until(past, now - DELAY - same_time(t));
    if (old > 2 && old > past->count / 2) {
        memmove(past->at, past->at + old - 2, (past->count - old + 2) * sizeof(command_point));
        past->count -= old - 2;
    }
    n = past->count;
    if (n > 0 && past->at[n - 1].u == u && t - past->at[n - 1].t <= same_time(t)) {
        return 1;
    }
    if (n > 1 && t - past->at[n - 2].t <= same_time(t)) { /* set twice at one time: the last counts */
        past->at[n - 1].u = u;
        return 1;
    }
    if (n > 1 && past->at[n - 1].u == u && past->at[n - 2].u == u) {
        past->at[n - 1].t = t;
        return 1;
    }
    if (!make_room(past, n + 1)) {
        return 0;
    }
    past->at[n].t = t;
    past->at[n].u = u;
    ++past->count;
    return 1;
}

/* What is felt at t, when the command there is u; `after`: on the far side of a jump that arrives at t. */
static double delayed_command(const command_history *past, double t, double u, int after) {
    const double s = t - DELAY;
    double slope;
    size_t which;
    if (past->count == 0) {
        return u;
    }
    which = points_until(past, after ? s + same_time(t) : s - same_time(t));
    if (which == past->count && t > past->at[which - 1].t) { /* commanded since the last point that was kept */
        const command_point last = past->at[which - 1];
        return last.u + (u - last.u) * (s - last.t) / (t - last.t);
    }
    return on_line(past, which, s, &slope);
}

/* From t on, for at most `width`: the line that is felt, and how long it is one. */
static double straight_until(const command_history *past, double t, double width, double *value, double *slope) {
    const size_t next = points_until(past, t - DELAY + same_time(t));
    if (next < past->count && past->at[next].t + DELAY - t < width) {
        width = past->at[next].t + DELAY - t;
    }
    *value = on_line(past, points_until(past, t - DELAY + 0.5 * width), t - DELAY, slope);
    return width;
}

/* When the next jump arrives after t; 0 where none is on its way. */
static int next_jump(const command_history *past, double t, double *when) {
    size_t i;
    for (i = points_until(past, t - DELAY + same_time(t)); i + 1 < past->count; ++i) {
        if (past->at[i + 1].t - past->at[i].t <= same_time(t)) {
            *when = past->at[i].t + DELAY;
            return 1;
        }
    }
    return 0;
}
