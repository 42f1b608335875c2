/* Co-simulation: the pair of Dormand and Prince, orders 5 and 4, with the ground found within its steps. */
static void rates(const Instance *c, const double *x, double later, double *rate) {
    moment m;
    num dx[STATES];
    int i;
    moment_of(c, x, later, &m);
    derivatives(&m, dx);
    for (i = 0; i < STATES; ++i) {
        rate[i] = dx[i].v;
    }
}

/* One step of h from `later` seconds after the instance's time; gives its error in units of the tolerance. */
static double one_step(const Instance *c, const double *x, double later, double h, double *next) {
    static const double place[7] = {0, 0.2, 0.3, 0.8, 8.0 / 9, 1, 1};
    static const double a[7][6] = {
        {0, 0, 0, 0, 0, 0},
        {0.2, 0, 0, 0, 0, 0},
        {3.0 / 40, 9.0 / 40, 0, 0, 0, 0},
        {44.0 / 45, -56.0 / 15, 32.0 / 9, 0, 0, 0},
        {19372.0 / 6561, -25360.0 / 2187, 64448.0 / 6561, -212.0 / 729, 0, 0},
        {9017.0 / 3168, -355.0 / 33, 46732.0 / 5247, 49.0 / 176, -5103.0 / 18656, 0},
        {35.0 / 384, 0, 500.0 / 1113, 125.0 / 192, -2187.0 / 6784, 11.0 / 84}};
    static const double e[7] = {71.0 / 57600,      0,           -71.0 / 16695, 71.0 / 1920,
                                -17253.0 / 339200, 22.0 / 525, -1.0 / 40};
    double k[7][STATES], largest = 0;
    int s, i, j;
    for (s = 0; s < 7; ++s) {
        for (i = 0; i < STATES; ++i) {
            next[i] = x[i];
            for (j = 0; j < s; ++j) {
                next[i] += h * a[s][j] * k[j][i];
            }
        }
        rates(c, next, later + place[s] * h, k[s]);
    }
    for (i = 0; i < STATES; ++i) {
        double error = 0, scale_of = fabs(x[i]) > fabs(next[i]) ? fabs(x[i]) : fabs(next[i]);
        for (s = 0; s < 7; ++s) {
            error += e[s] * k[s][i];
        }
        error = fabs(h * error) / (c->tolerance * (scale_of + ABSOLUTE));
        largest = error > largest || !(error == error) ? error : largest;
    }
    return largest;
}

static int crossed(const Instance *c, const double *x, double later, const double *before, double *z) {
    moment m;
    int i, which = 0;
    moment_of(c, x, later, &m);
    indicators(&m, z);
    for (i = 0; i < INDICATORS; ++i) {
        which = which || (z[i] < 0 && (before == NULL || before[i] >= 0));
    }
    return which;
}

/* Moves on by `width` or to where the ground changes the motion; 0 where no step succeeds. `done`: how far. */
static int advance(Instance *c, double width, double *done, int *event) {
    double later = 0, next[STATES], z[INDICATORS], after[INDICATORS];
    int i, tries = 0;
    crossed(c, c->x, 0, NULL, z);
    *event = 0;
    while (later < width) {
        double h = c->step > 0 ? c->step : 1e-3, error, factor;
        const double longest = c->bearing && MAX_STEP_AT_REST > 0 ? MAX_STEP_AT_REST : MAX_STEP;
        int last;
        if (longest > 0 && h > longest) {
            h = longest;
        }
        last = later + h >= width * (1 - 1e-12);
        h = last ? width - later : h;
        error = one_step(c, c->x, later, h, next);
        factor = error == error ? 0.9 * pow(error > 1e-12 ? error : 1e-12, -0.2) : 0.1;
        factor = factor < 0.1 ? 0.1 : factor > 5 ? 5 : factor;
        if (!(error <= 1)) {
            c->step = h * (factor < 0.9 ? factor : 0.9);
            if (++tries > 100000 || c->step < 1e-14) {
                return 0;
            }
            continue;
        }
        if (crossed(c, next, later + h, z, after)) {
            double low = 0, high = h;
            for (i = 0; i < 60 && high - low > 1e-15 * (1 + fabs(c->t)); ++i) {
                const double middle = 0.5 * (low + high);
                double at[STATES];
                one_step(c, c->x, later, middle, at);
                if (crossed(c, at, later + middle, z, after)) {
                    high = middle;
                    memcpy(next, at, sizeof(next));
                } else {
                    low = middle;
                }
            }
            h = high;
            *event = 1;
            last = 0;
        } else if (!last || h * factor < c->step || c->step <= 0) {
            c->step = h * factor;
        }
        memcpy(c->x, next, sizeof(next));
        later = last ? width : later + h;
        memcpy(z, after, sizeof(z));
        if (*event) {
            c->step = 1e-4;
            break;
        }
    }
    *done = later;
    return 1;
}

/* Steps from the instance's time to `end`, `left` seconds later. */
static fmi2Status go_on(Instance *c, double end, double left) {
    int i, pieces = 0;
    while (left > 0) {
        double done, width = left, z[INDICATORS];
        int event;
        if (DELAYED) {
            width = straight_until(&c->past, c->t, left, &c->command, &c->command_slope);
        }
        /* An input that jumped may lift a body that lies, or press one down. */
        if (crossed(c, c->x, 0, NULL, z) && ground(c) < 0) {
            return failed(c, "no contact forces fit this motion");
        }
        if (!advance(c, width, &done, &event)) {
            failed(c, "no step of the integrator succeeds");
            return fmi2Discard;
        }
        c->t = done >= left ? end : c->t + done;
        left = done >= left ? 0 : left - done;
        for (i = 0; i < INPUTS; ++i) {
            c->u[i] += done * c->slope[i];
        }
        c->command += done * c->command_slope;
        if (event && (ground(c) < 0 || ++pieces > 5000)) {
            return failed(c, pieces > 5000 ? "the contact chatters" : "no contact forces fit this motion");
        }
    }
    return fmi2OK;
}

EXPORTED fmi2Status fmi2DoStep(fmi2Component component, fmi2Real time, fmi2Real step, fmi2Boolean no_set) {
    Instance *c = (Instance *)component;
    fmi2Status status;
    UNUSED(no_set);
    begin(c);
    c->t = time;
    if (!keep_command(c, 0) || !keep_command(c, step)) {
        return failed(c, "there is no memory for the delayed input");
    }
    c->within = 1;
    status = go_on(c, time + step, step);
    c->within = 0;
    c->reached = c->t;
    return status;
}
EXPORTED fmi2Status fmi2SetRealInputDerivatives(fmi2Component component, const fmi2ValueReference vr[], size_t n,
                                                const fmi2Integer order[], const fmi2Real value[]) {
    Instance *c = (Instance *)component;
    size_t i;
    for (i = 0; i < n; ++i) {
        if (vr[i] >= INPUTS || order[i] != 1) {
            return failed(c, "inputs have derivatives of order 1");
        }
        c->slope[vr[i]] = value[i];
    }
    return fmi2OK;
}
EXPORTED fmi2Status fmi2GetRealOutputDerivatives(fmi2Component c, const fmi2ValueReference vr[], size_t n,
                                                 const fmi2Integer order[], fmi2Real value[]) {
    UNUSED(c);
    UNUSED(vr);
    UNUSED(order);
    UNUSED(value);
    return n == 0 ? fmi2OK : fmi2Error;
}
EXPORTED fmi2Status fmi2GetStatus(fmi2Component c, const fmi2StatusKind s, fmi2Status *value) {
    UNUSED(c);
    UNUSED(s);
    *value = fmi2OK;
    return fmi2Discard;
}
EXPORTED fmi2Status fmi2GetRealStatus(fmi2Component c, const fmi2StatusKind s, fmi2Real *value) {
    *value = ((Instance *)c)->t;
    return s == fmi2LastSuccessfulTime ? fmi2OK : fmi2Discard;
}
EXPORTED fmi2Status fmi2GetIntegerStatus(fmi2Component c, const fmi2StatusKind s, fmi2Integer *value) {
    UNUSED(c);
    UNUSED(s);
    *value = 0;
    return fmi2Discard;
}
EXPORTED fmi2Status fmi2GetBooleanStatus(fmi2Component c, const fmi2StatusKind s, fmi2Boolean *value) {
    UNUSED(c);
    UNUSED(s);
    *value = 0;
    return fmi2Discard;
}
EXPORTED fmi2Status fmi2GetStringStatus(fmi2Component c, const fmi2StatusKind s, fmi2String *value) {
    UNUSED(c);
    UNUSED(s);
    *value = "";
    return fmi2Discard;
}
