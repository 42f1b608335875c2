/* A moment of the motion: what a simulator gives. bearing: which edges lie on the ground (1 nose, 2 tail; in heave 1: all).
   commanded: the input force as it reaches the actuator, after its delay. */
typedef struct {
    double t;
    num x[STATES], u[INPUTS], commanded;
    int bearing;
} moment;

/* All channels, NaN where nothing is known: as held, but what the inputs bring. */
static void channels_of(const moment *m, num *channel) {
    int i;
    for (i = 0; i < CHANNELS; ++i) {
        channel[i] = con(held_channels[i]);
    }
    for (i = 0; i < INPUTS; ++i) {
        if (channel_of_input[i] >= 0) {
            channel[channel_of_input[i]] = m->u[i];
        }
    }
    channel[CHANNEL_TIME] = con(m->t);
}

/* The input force as it reaches the body. */
static num acting_input(const moment *m) { return terms.lag > 0 ? m->x[LAG_AT] : felt(m->commanded); }

static void lag_rates(const moment *m, num *dx) {
    if (terms.lag > 0) {
        dx[LAG_AT] = times(1 / terms.lag, sub(felt(m->commanded), m->x[LAG_AT]));
    }
}

static double is_outside(const num *channel) {
    int i, outside = 0;
    for (i = 0; i < RANGES; ++i) {
        const double at = ranges[i].magnitude ? fabs(channel[ranges[i].channel].v) : channel[ranges[i].channel].v;
        outside = outside || at < ranges[i].lower || at > ranges[i].upper;
    }
    return outside;
}
