/* FMI 2.0.4: types, instances, model exchange, co-simulation. */
typedef void *fmi2Component;
typedef void *fmi2ComponentEnvironment;
typedef void *fmi2FMUstate;
typedef unsigned int fmi2ValueReference;
typedef double fmi2Real;
typedef int fmi2Integer;
typedef int fmi2Boolean;
typedef char fmi2Char;
typedef const fmi2Char *fmi2String;
typedef char fmi2Byte;
typedef enum { fmi2OK, fmi2Warning, fmi2Discard, fmi2Error, fmi2Fatal, fmi2Pending } fmi2Status;
typedef enum { fmi2ModelExchange, fmi2CoSimulation } fmi2Type;
typedef enum { fmi2DoStepStatus, fmi2PendingStatus, fmi2LastSuccessfulTime, fmi2Terminated } fmi2StatusKind;
typedef void (*fmi2Logger)(fmi2ComponentEnvironment, fmi2String, fmi2Status, fmi2String, fmi2String, ...);
typedef struct {
    fmi2Logger logger;
    void *(*allocateMemory)(size_t, size_t);
    void (*freeMemory)(void *);
    void (*stepFinished)(fmi2ComponentEnvironment, fmi2Status);
    fmi2ComponentEnvironment componentEnvironment;
} fmi2CallbackFunctions;
typedef struct {
    fmi2Boolean newDiscreteStatesNeeded, terminateSimulation, nominalsOfContinuousStatesChanged,
        valuesOfContinuousStatesChanged, nextEventTimeDefined;
    fmi2Real nextEventTime;
} fmi2EventInfo;

#if defined(_WIN32)
#define EXPORTED __declspec(dllexport)
#elif defined(__GNUC__)
#define EXPORTED __attribute__((visibility("default")))
#else
#define EXPORTED
#endif
#define UNUSED(x) (void)(x)
#define VARIABLES (INPUTS + 2 * STATES + OUTPUTS) /* inputs, states, their derivatives, outputs */

typedef struct {
    double start[STATES]; /* as set; what follows from others is found by begin() */
    double x[STATES], u[INPUTS], slope[INPUTS];
    double t, step, tolerance;
    int bearing, begun, initialised;
    command_history past; /* of the input force, where it is delayed */
    double reached;       /* jumps that arrive until then have arrived */
    int within;           /* a step of co-simulation, on the line of the delayed command from the instance's time on: */
    double command, command_slope;
    fmi2Logger logger;
    fmi2ComponentEnvironment environment;
    char name[64];
} Instance;

static fmi2Status failed(const Instance *c, const char *why) {
    if (c->logger != NULL) {
        c->logger(c->environment, c->name, fmi2Error, "logStatusError", "%s", why);
    }
    return fmi2Error;
}

/* What stands in an instance, with inputs that went on along their slopes for `later` seconds. */
static void moment_of(const Instance *c, const double *x, double later, moment *m) {
    int i;
    m->t = c->t + later;
    m->bearing = c->bearing;
    for (i = 0; i < STATES; ++i) {
        m->x[i] = con(x[i]);
    }
    for (i = 0; i < INPUTS; ++i) {
        m->u[i] = con(c->u[i] + later * c->slope[i]);
    }
    m->commanded = !DELAYED    ? m->u[0]
                   : c->within ? con(c->command + later * c->command_slope)
                               : con(delayed_command(&c->past, m->t, m->u[0].v, c->reached >= m->t - same_time(m->t)));
}

/* Keeps the command of this moment; 0: no memory. */
static int keep_command(Instance *c, double later) {
    return !DELAYED || remember(&c->past, c->t, c->t + later, c->u[0] + later * c->slope[0]);
}

/* The ground at this moment; 1 when states changed, -1 when nothing fits. */
static int ground(Instance *c) {
    moment m;
    int i, changed;
    moment_of(c, c->x, 0, &m);
    changed = meet_ground(&m);
    for (i = 0; i < STATES; ++i) {
        c->x[i] = m.x[i].v;
    }
    c->bearing = m.bearing;
    return changed;
}

/* States that follow from others at the start: what actuator and jets give, the memory of the water; then the ground. */
static void begin(Instance *c) {
    moment m;
    int i;
    if (c->begun) {
        return;
    }
    memcpy(c->x, c->start, sizeof(c->x));
    c->bearing = c->within = 0;
    c->past.count = 0;
    c->reached = c->t;
    keep_command(c, 0);
    moment_of(c, c->x, 0, &m);
    if (terms.lag > 0) {
        c->x[LAG_AT] = felt(m.commanded).v;
    }
    for (i = 0; i < JETS; ++i) {
        if (jets[i].state >= 0) {
            c->x[jets[i].state] = between(m.u[1 + i], jets[i].minimum, jets[i].maximum).v;
        }
    }
    for (i = 0; i < MEMORIES && terms.history != 0; ++i) {
        c->x[MEMORY_AT + i] = -centre_velocity(&m).v;
    }
    if (ground(c) < 0) {
        c->bearing = 0;
    }
    c->begun = 1;
}

EXPORTED const char *fmi2GetTypesPlatform(void) { return "default"; }
EXPORTED const char *fmi2GetVersion(void) { return "2.0"; }

EXPORTED fmi2Status fmi2Reset(fmi2Component component) {
    Instance *c = (Instance *)component;
    memcpy(c->start, start_states, sizeof(c->start));
    memcpy(c->u, start_inputs, sizeof(c->u));
    memset(c->slope, 0, sizeof(c->slope));
    c->t = c->step = 0;
    c->tolerance = 1e-10;
    c->begun = c->initialised = 0;
    return fmi2OK;
}
EXPORTED fmi2Component fmi2Instantiate(fmi2String name, fmi2Type type, fmi2String guid, fmi2String resources,
                                       const fmi2CallbackFunctions *functions, fmi2Boolean visible, fmi2Boolean logging) {
    Instance *c;
    UNUSED(type);
    UNUSED(resources);
    UNUSED(visible);
    UNUSED(logging);
    if (guid == NULL || strcmp(guid, GUID) != 0) {
        return NULL;
    }
    c = (Instance *)calloc(1, sizeof(Instance));
    if (c != NULL) {
        fmi2Reset(c);
        c->logger = functions != NULL ? functions->logger : NULL;
        c->environment = functions != NULL ? functions->componentEnvironment : NULL;
        strncpy(c->name, name != NULL ? name : "", sizeof(c->name) - 1);
    }
    return c;
}
EXPORTED void fmi2FreeInstance(fmi2Component c) {
    if (c != NULL) {
        free(((Instance *)c)->past.at);
    }
    free(c);
}

EXPORTED fmi2Status fmi2SetupExperiment(fmi2Component component, fmi2Boolean with_tolerance, fmi2Real tolerance,
                                        fmi2Real start, fmi2Boolean with_stop, fmi2Real stop) {
    Instance *c = (Instance *)component;
    UNUSED(with_stop);
    UNUSED(stop);
    c->t = start;
    if (with_tolerance && tolerance > 0) {
        c->tolerance = tolerance;
    }
    return fmi2OK;
}
EXPORTED fmi2Status fmi2EnterInitializationMode(fmi2Component c) {
    ((Instance *)c)->begun = 0;
    return fmi2OK;
}
EXPORTED fmi2Status fmi2ExitInitializationMode(fmi2Component component) {
    Instance *c = (Instance *)component;
    begin(c);
    c->initialised = 1;
    return fmi2OK;
}

static void evaluate(const moment *m, num *all) {
    memcpy(all, m->u, sizeof(m->u));
    memcpy(all + INPUTS, m->x, sizeof(m->x));
    derivatives(m, all + INPUTS + STATES);
    outputs(m, all + INPUTS + 2 * STATES);
}

EXPORTED fmi2Status fmi2GetReal(fmi2Component component, const fmi2ValueReference vr[], size_t n, fmi2Real value[]) {
    Instance *c = (Instance *)component;
    moment m;
    num all[VARIABLES];
    size_t i;
    begin(c);
    moment_of(c, c->x, 0, &m);
    evaluate(&m, all);
    for (i = 0; i < n; ++i) {
        if (vr[i] >= VARIABLES) {
            return failed(c, "there is no variable of this reference");
        }
        value[i] = all[vr[i]].v;
    }
    return fmi2OK;
}
EXPORTED fmi2Status fmi2SetReal(fmi2Component component, const fmi2ValueReference vr[], size_t n, const fmi2Real value[]) {
    Instance *c = (Instance *)component;
    size_t i;
    for (i = 0; i < n; ++i) {
        if (vr[i] < INPUTS) {
            c->u[vr[i]] = value[i];
            c->slope[vr[i]] = 0;
        } else if (vr[i] < INPUTS + GIVEN_STATES && !c->initialised) {
            c->start[vr[i] - INPUTS] = value[i];
        } else {
            return failed(c, "inputs can be set, and starts of states before the motion begins");
        }
    }
    c->begun = c->begun && c->initialised;
    return fmi2OK;
}
EXPORTED fmi2Status fmi2GetDirectionalDerivative(fmi2Component component, const fmi2ValueReference unknown[],
                                                 size_t n_unknown, const fmi2ValueReference known[], size_t n_known,
                                                 const fmi2Real d_known[], fmi2Real d_unknown[]) {
    Instance *c = (Instance *)component;
    moment m;
    num all[VARIABLES];
    size_t i;
    begin(c);
    moment_of(c, c->x, 0, &m);
    for (i = 0; i < n_known; ++i) {
        if (known[i] < INPUTS) {
            m.u[known[i]].d += d_known[i];
        } else if (known[i] < INPUTS + STATES) {
            m.x[known[i] - INPUTS].d += d_known[i];
        } else {
            return failed(c, "derivatives are those along inputs and states");
        }
    }
    if (!DELAYED) {
        m.commanded = m.u[0];
    }
    evaluate(&m, all);
    for (i = 0; i < n_unknown; ++i) {
        if (unknown[i] >= VARIABLES) {
            return failed(c, "there is no variable of this reference");
        }
        d_unknown[i] = all[unknown[i]].d;
    }
    return fmi2OK;
}

#define NOTHING(name, parameters, unused) \
    EXPORTED fmi2Status name parameters { \
        unused; \
        return fmi2OK; \
    }
#define NONE_OF(name, type) \
    EXPORTED fmi2Status name(fmi2Component c, const fmi2ValueReference vr[], size_t n, type value) { \
        UNUSED(c); \
        UNUSED(vr); \
        UNUSED(value); \
        return n == 0 ? fmi2OK : fmi2Error; \
    }
NONE_OF(fmi2GetInteger, fmi2Integer *)
NONE_OF(fmi2GetBoolean, fmi2Boolean *)
NONE_OF(fmi2GetString, fmi2String *)
NONE_OF(fmi2SetInteger, const fmi2Integer *)
NONE_OF(fmi2SetBoolean, const fmi2Boolean *)
NONE_OF(fmi2SetString, const fmi2String *)
NOTHING(fmi2SetDebugLogging, (fmi2Component c, fmi2Boolean on, size_t n, const fmi2String categories[]), UNUSED(c);
        UNUSED(on); UNUSED(n); UNUSED(categories))
NOTHING(fmi2Terminate, (fmi2Component c), UNUSED(c))
NOTHING(fmi2EnterEventMode, (fmi2Component c), UNUSED(c))
NOTHING(fmi2EnterContinuousTimeMode, (fmi2Component c), UNUSED(c))
NOTHING(fmi2CancelStep, (fmi2Component c), UNUSED(c))

/* A stored state is an instance and behind it the points of its history. */
static size_t stored_size(const Instance *c) { return sizeof(Instance) + c->past.count * sizeof(command_point); }

EXPORTED fmi2Status fmi2GetFMUstate(fmi2Component component, fmi2FMUstate *state) {
    const Instance *c = (const Instance *)component;
    void *room = realloc(*state, stored_size(c));
    if (room == NULL) {
        return fmi2Error;
    }
    *state = room;
    memcpy(room, c, sizeof(Instance));
    if (c->past.count > 0) {
        memcpy((char *)room + sizeof(Instance), c->past.at, c->past.count * sizeof(command_point));
    }
    return fmi2OK;
}
EXPORTED fmi2Status fmi2SetFMUstate(fmi2Component component, fmi2FMUstate state) {
    Instance *c = (Instance *)component, own;
    const size_t points = ((const Instance *)state)->past.count;
    if (points > 0 && !make_room(&c->past, points)) {
        return failed(c, "there is no memory for the state");
    }
    own = *c;
    memcpy(c, state, sizeof(Instance));
    c->past.at = own.past.at;
    c->past.room = own.past.room;
    c->logger = own.logger;
    c->environment = own.environment;
    if (points > 0) {
        memcpy(c->past.at, (const char *)state + sizeof(Instance), points * sizeof(command_point));
    }
    return fmi2OK;
}
EXPORTED fmi2Status fmi2FreeFMUstate(fmi2Component c, fmi2FMUstate *state) {
    UNUSED(c);
    free(*state);
    *state = NULL;
    return fmi2OK;
}
EXPORTED fmi2Status fmi2SerializedFMUstateSize(fmi2Component c, fmi2FMUstate state, size_t *size) {
    UNUSED(c);
    *size = stored_size((const Instance *)state);
    return fmi2OK;
}
EXPORTED fmi2Status fmi2SerializeFMUstate(fmi2Component c, fmi2FMUstate state, fmi2Byte bytes[], size_t size) {
    const size_t needed = stored_size((const Instance *)state);
    UNUSED(c);
    if (size < needed) {
        return fmi2Error;
    }
    memcpy(bytes, state, needed);
    return fmi2OK;
}
EXPORTED fmi2Status fmi2DeSerializeFMUstate(fmi2Component component, const fmi2Byte bytes[], size_t size, fmi2FMUstate *state) {
    Instance stored;
    void *room;
    if (size < sizeof(Instance)) {
        return failed((const Instance *)component, "these bytes are no state of this FMU");
    }
    memcpy(&stored, bytes, sizeof(Instance));
    if (stored.past.count > (size - sizeof(Instance)) / sizeof(command_point)) {
        return failed((const Instance *)component, "these bytes are no whole state of this FMU");
    }
    room = realloc(*state, stored_size(&stored));
    if (room == NULL) {
        return fmi2Error;
    }
    memcpy(room, bytes, stored_size(&stored));
    *state = room;
    return fmi2OK;
}

/* Model exchange: the simulator integrates, the ground makes events. */
EXPORTED fmi2Status fmi2SetTime(fmi2Component c, fmi2Real time) {
    ((Instance *)c)->t = time;
    return fmi2OK;
}
EXPORTED fmi2Status fmi2NewDiscreteStates(fmi2Component component, fmi2EventInfo *info) {
    Instance *c = (Instance *)component;
    int changed;
    begin(c);
    c->reached = c->t;
    if (!keep_command(c, 0)) {
        return failed(c, "there is no memory for the delayed input");
    }
    changed = ground(c);
    memset(info, 0, sizeof(*info));
    info->valuesOfContinuousStatesChanged = changed > 0;
    if (DELAYED) {
        info->nextEventTimeDefined = next_jump(&c->past, c->t, &info->nextEventTime);
    }
    return changed < 0 ? failed(c, "no contact forces fit this motion") : fmi2OK;
}
EXPORTED fmi2Status fmi2CompletedIntegratorStep(fmi2Component c, fmi2Boolean no_set, fmi2Boolean *event,
                                                fmi2Boolean *terminate) {
    UNUSED(no_set);
    *event = 0;
    *terminate = 0;
    return keep_command((Instance *)c, 0) ? fmi2OK : failed((Instance *)c, "there is no memory for the delayed input");
}
EXPORTED fmi2Status fmi2SetContinuousStates(fmi2Component c, const fmi2Real x[], size_t n) {
    if (n != STATES) {
        return fmi2Error;
    }
    memcpy(((Instance *)c)->x, x, n * sizeof(*x));
    return fmi2OK;
}
EXPORTED fmi2Status fmi2GetContinuousStates(fmi2Component c, fmi2Real x[], size_t n) {
    if (n != STATES) {
        return fmi2Error;
    }
    begin((Instance *)c);
    memcpy(x, ((Instance *)c)->x, n * sizeof(*x));
    return fmi2OK;
}
EXPORTED fmi2Status fmi2GetNominalsOfContinuousStates(fmi2Component c, fmi2Real x[], size_t n) {
    UNUSED(c);
    if (n != STATES) {
        return fmi2Error;
    }
    memcpy(x, nominal_states, n * sizeof(*x));
    return fmi2OK;
}
EXPORTED fmi2Status fmi2GetDerivatives(fmi2Component component, fmi2Real rate[], size_t n) {
    Instance *c = (Instance *)component;
    moment m;
    num dx[STATES];
    size_t i;
    if (n != STATES) {
        return fmi2Error;
    }
    begin(c);
    moment_of(c, c->x, 0, &m);
    derivatives(&m, dx);
    for (i = 0; i < n; ++i) {
        rate[i] = dx[i].v;
    }
    return fmi2OK;
}
EXPORTED fmi2Status fmi2GetEventIndicators(fmi2Component component, fmi2Real z[], size_t n) {
    Instance *c = (Instance *)component;
    moment m;
    if (n != INDICATORS) {
        return fmi2Error;
    }
    begin(c);
    moment_of(c, c->x, 0, &m);
    indicators(&m, z);
    return fmi2OK;
}
