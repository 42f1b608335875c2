/* What acts upward beside the force tables: weight, input, springs, friction, film, drag, waves, memory of the water. */
typedef struct {
    double linear, quadratic;
    int mixed;
    double w1, w2, c[6];
} drag_law;

typedef struct {
    double mass, constant, growth_of_force;
    const grid *added_mass;
    int growths, waves, corrections;
    const double *growth; /* mass, length */
    const double *wave;   /* amplitude, frequency, phase */
    const source *correction;
    drag_law drag;
    double current, extra_linear, extra_quadratic, friction, friction_width, film, stiffness, stiffness_gap;
    double rough_near, rough_far, rough_length, rough_sharpness, thrust_loss, thrust_length, history;
    double dead_zone, gain, lag;
    double contact_gap, restitution;
} vertical_terms;
static const vertical_terms terms;

static const double least_film_gap = 1e-5;
#define MEMORIES 10
typedef struct {
    double rate[MEMORIES], weight[MEMORIES], mass;
} history_kernel;
static const history_kernel kernel;

static num drag_at(const drag_law *law, num v) {
    const num size = size_of_num(v);
    double s, force, slope;
    if (!law->mixed) {
        return mul(plus(times(law->quadratic, size), law->linear), v);
    }
    if (size.v <= law->w1) {
        return times(law->linear, v);
    }
    if (size.v >= law->w2) {
        return times(law->quadratic, mul(size, v));
    }
    s = (size.v - law->w1) / (law->w2 - law->w1);
    force = law->c[0] + s * (law->c[1] + s * (law->c[2] + s * (law->c[3] + s * (law->c[4] + s * law->c[5]))));
    slope = (law->c[1] + s * (2 * law->c[2] + s * (3 * law->c[3] + s * (4 * law->c[4] + s * 5 * law->c[5])))) /
            (law->w2 - law->w1);
    return with_slope(v, v.v < 0 ? -force : force, slope);
}

static num water_drag(num v) {
    return add(drag_at(&terms.drag, v), mul(plus(times(terms.extra_quadratic, size_of_num(v)), terms.extra_linear), v));
}

static num roughened(num lift, num h) {
    double x, power, steep, base;
    if (terms.rough_near == 0 && terms.rough_far == 0) {
        return lift;
    }
    x = h.v / terms.rough_length;
    if (terms.rough_sharpness == 2) {
        power = x * x;
        steep = 2 * x;
    } else {
        x = x > 0 ? x : 0;
        power = pow(x, terms.rough_sharpness);
        steep = terms.rough_sharpness * pow(x, terms.rough_sharpness - 1);
    }
    base = 1 + power;
    return mul(lift, with_slope(h, 1 + (terms.rough_near - terms.rough_far * power) / base,
                                -steep * (terms.rough_near + terms.rough_far) / (base * base) / terms.rough_length));
}

/* What dead zone and gain of the actuator leave of a command. */
static num felt(num u) {
    const num rest = at_least(plus(size_of_num(u), -terms.dead_zone), 0);
    return times(u.v < 0 ? -terms.gain : terms.gain, rest);
}

static num timed_force(double t) {
    double force = terms.growth_of_force * t;
    int i;
    for (i = 0; i < terms.waves; ++i) {
        const double *w = terms.wave + 3 * i;
        force += w[0] * sin(6.283185307179586 * w[1] * t + w[2]);
    }
    return con(force);
}

/* Weight, input, springs, corrections, guide and film; `channel` brings what corrections depend on. */
static num other_force(num h, num w, num input, const num *channel) {
    num force = add(con(terms.constant), input);
    int i, k;
    if (terms.thrust_loss != 0) {
        const double left = terms.thrust_loss * exp(-h.v / terms.thrust_length);
        force = sub(force, mul(input, with_slope(h, left, -left / terms.thrust_length)));
    }
    force = sub(force, times(terms.stiffness, plus(h, -terms.stiffness_gap)));
    for (i = 0; i < terms.corrections; ++i) {
        const source *s = terms.correction + i;
        num point[4];
        for (k = 0; k < s->table->axes; ++k) {
            point[k] = s->channel[k] == CHANNEL_GAP              ? h
                       : s->channel[k] == CHANNEL_HEAVE_VELOCITY ? w
                       : s->channel[k] == CHANNEL_INPUT_FORCE    ? input
                       : isnan(channel[s->channel[k]].v)         ? con(0)
                                                                 : channel[s->channel[k]];
        }
        force = add(force, grid_at(s->table, point));
    }
    if (terms.friction != 0) {
        const num size = root(plus(mul(w, w), terms.friction_width * terms.friction_width));
        force = sub(force, times(terms.friction, quo(w, size)));
    }
    if (terms.film != 0) {
        const num gap = at_least(h, least_film_gap);
        force = sub(force, times(terms.film, quo(w, mul(gap, mul(gap, gap)))));
    }
    return force;
}

/* Virtual mass and its slope along the gap. */
static void inertia(num h, num *mass, num *slope) {
    int i;
    *mass = con(terms.mass);
    *slope = con(0);
    if (terms.added_mass != NULL) {
        num more, steeper;
        curve_at(terms.added_mass, h, &more, &steeper);
        *mass = add(*mass, more);
        *slope = add(*slope, steeper);
    }
    for (i = 0; i < terms.growths; ++i) {
        const double m = terms.growth[2 * i], length = terms.growth[2 * i + 1];
        const num base = plus(at_least(h, 0), length), share = quo(con(m * length), base);
        *mass = add(*mass, share);
        if (h.v > 0) {
            *slope = sub(*slope, quo(share, base));
        }
    }
}

/* Pull of the water's memory on a body that moves with w; its fastest part acts as mass. */
static num memory_force(num w, const num *memory) {
    num sum = con(0);
    int i;
    if (terms.history != 0) {
        for (i = 0; i < MEMORIES; ++i) {
            sum = add(sum, times(kernel.weight[i], add(w, memory[i])));
        }
    }
    return times(-terms.history, sum);
}
static void memory_rates(num w, const num *memory, num *rate) {
    int i;
    for (i = 0; i < MEMORIES; ++i) {
        rate[i] = times(-kernel.rate[i], add(memory[i], w));
    }
}
