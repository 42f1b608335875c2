/* The vehicle with roll held at zero: speeds u, v, w and rates q, r in body axes, theta, psi, place X, Y, Z (down), thrusts. */
#define ACCELERATIONS 5
#define SLIDES 1
#define OUTPUTS 11 /* gap, heave_velocity, p, lift_force, drag_force, pitch_moment, input_force, nose and tail edge force,
                      contact, outside_table */
enum { U, V, W, Q, R, THETA, PSI, X, Y, Z };
typedef struct {
    num force[3], moment[3], mass;
} loads;

static void cross_to(const num *a, const num *b, num *sum) {
    int i;
    for (i = 0; i < 3; ++i) {
        const int j = (i + 1) % 3, k = (i + 2) % 3;
        sum[i] = add(sum[i], sub(mul(a[j], b[k]), mul(a[k], b[j])));
    }
}
/* A force at a place, both in body axes. */
static void load(loads *l, const double *at, const num *f) {
    num place[3];
    int i;
    for (i = 0; i < 3; ++i) {
        place[i] = con(at[i]);
        l->force[i] = add(l->force[i], f[i]);
    }
    cross_to(place, f, l->moment);
}
static void load_upward(loads *l, const double *at, const moment *m, num up, num along, num sideways) {
    const num st = sine(m->x[THETA]), ct = cosine(m->x[THETA]);
    num f[3];
    f[0] = add(mul(up, st), mul(along, ct));
    f[1] = sideways;
    f[2] = sub(mul(along, st), mul(up, ct));
    load(l, at, f);
}

static num roll_rate(const moment *m) {
    return times(-1, mul(m->x[R], quo(sine(m->x[THETA]), cosine(m->x[THETA]))));
}
static num down_velocity(const moment *m) {
    return sub(mul(m->x[W], cosine(m->x[THETA])), mul(m->x[U], sine(m->x[THETA])));
}
static num centre_velocity(const moment *m) { return times(-1, down_velocity(m)); }
static num gap_of(const moment *m) {
    return sub(sub(times(base_place[0], sine(m->x[THETA])), times(base_place[2], cosine(m->x[THETA]))), m->x[Z]);
}
static num lever_of(const moment *m) {
    return add(times(base_place[2], sine(m->x[THETA])), times(base_place[0], cosine(m->x[THETA])));
}
static num rise_of_base(const moment *m) { return sub(mul(lever_of(m), m->x[Q]), down_velocity(m)); }

static void seen(const moment *m, num *channel) {
    channels_of(m, channel);
    channel[CHANNEL_GAP] = gap_of(m);
    channel[CHANNEL_PITCH] = m->x[THETA];
    channel[CHANNEL_HEAVE_VELOCITY] = rise_of_base(m);
    channel[CHANNEL_PITCH_RATE] = m->x[Q];
    channel[CHANNEL_SPEED] = add(mul(m->x[U], cosine(m->x[THETA])), mul(m->x[W], sine(m->x[THETA])));
}

static void table_loads(const num *signed_channel, num *up, num *aft, num *turn, num *channel) {
    const num forward = signed_channel[CHANNEL_SPEED];
    memcpy(channel, signed_channel, CHANNELS * sizeof(num));
    channel[CHANNEL_SPEED] = size_of_num(forward);
    *up = roughened(force_at(&lift, channel), channel[CHANNEL_GAP]);
    *aft = mul(quo(forward, root(plus(mul(forward, forward), 1e-6))), force_at(&drag, channel));
    *turn = force_at(&pitch_moment, channel);
}

static num thrust_of(const moment *m, int jet) {
    return jets[jet].state >= 0 ? m->x[jets[jet].state]
                                : between(m->u[1 + jet], jets[jet].minimum, jets[jet].maximum);
}

static void no_loads(const moment *m, loads *l) {
    num slope;
    int i;
    for (i = 0; i < 3; ++i) {
        l->force[i] = l->moment[i] = con(0);
    }
    inertia(gap_of(m), &l->mass, &slope);
    l->mass = plus(l->mass, terms.history * kernel.mass);
}

static void free_loads(const moment *m, loads *l) {
    static const double centre[3] = {0, 0, 0};
    const num st = sine(m->x[THETA]), ct = cosine(m->x[THETA]), none = con(0);
    num signed_channel[CHANNELS], channel[CHANNELS], up, aft, turn, other, f[3], upright[3], place[3], mass, slope, w = m->x[W];
    int i, k;
    seen(m, signed_channel);
    no_loads(m, l);
    table_loads(signed_channel, &up, &aft, &turn, channel);
    for (i = 0; i < JETS; ++i) {
        const num thrust = thrust_of(m, i);
        for (k = 0; k < 3; ++k) {
            f[k] = times(jets[i].direction[k], thrust);
        }
        load(l, jets[i].position, f);
    }
    load_upward(l, base_place, m, up, times(-1, aft), force_at(&side, channel));
    l->moment[0] = add(l->moment[0], force_at(&roll_moment, channel));
    l->moment[1] = add(l->moment[1], turn);
    l->moment[2] = add(l->moment[2], force_at(&yaw_moment, channel));
    other = add(other_force(channel[CHANNEL_GAP], centre_velocity(m), acting_input(m), channel), timed_force(m->t));
    if (terms.history != 0) {
        other = add(other, memory_force(centre_velocity(m), m->x + MEMORY_AT));
    }
    load_upward(l, centre, m, other, none, none);
    upright[0] = times(buoyancy, st);
    upright[1] = none;
    upright[2] = times(-buoyancy, ct);
    for (k = 0; k < 3; ++k) {
        place[k] = con(buoyancy_centre[k]);
    }
    cross_to(place, upright, l->moment);
    f[0] = drag_at(&drag_surge, sub(m->x[U], times(terms.current, st)));
    l->force[0] = sub(l->force[0], f[0]);
    l->force[1] = sub(l->force[1], drag_at(&drag_sway, m->x[V]));
    l->force[2] = sub(l->force[2], water_drag(add(w, times(terms.current, ct))));
    l->moment[1] = add(l->moment[1], sub(times(drag_height, f[0]), drag_at(&drag_pitch, m->x[Q])));
    l->moment[2] = sub(l->moment[2], drag_at(&drag_yaw, m->x[R]));
    inertia(channel[CHANNEL_GAP], &mass, &slope);
    l->force[2] = sub(l->force[2], mul(mul(slope, channel[CHANNEL_HEAVE_VELOCITY]), w));
    load_upward(l, base_place, m, times(0.5, mul(slope, mul(w, w))), none, none);
}

static void edge_place(int edge, double *at) {
    at[0] = base_place[0] + (edge == 0 ? half_length : -half_length);
    at[1] = base_place[1];
    at[2] = base_place[2];
}
/* Slip of an edge along the ground: forward in the heading, to starboard. */
static void slip_of(const moment *m, int edge, num *forward, num *starboard) {
    const num p = roll_rate(m);
    num vx, vz;
    double at[3];
    edge_place(edge, at);
    vx = add(m->x[U], sub(times(at[2], m->x[Q]), times(at[1], m->x[R])));
    vz = add(m->x[W], sub(times(at[1], p), times(at[0], m->x[Q])));
    *forward = add(mul(vx, cosine(m->x[THETA])), mul(vz, sine(m->x[THETA])));
    *starboard = add(m->x[V], sub(times(at[0], m->x[R]), times(at[2], p)));
}
