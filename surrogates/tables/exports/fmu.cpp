// FMU 2.0 for model exchange and co-simulation: the C header of the table with the standard's functions around it.
// FMI Specification 2.0.4. Inputs are the axes; outputs the value, its slopes, its error and whether the point lies
// outside.
#include <algorithm>

#include "core/error.h"
#include "core/file.h"
#include "core/inputs.h"
#include "core/text.h"
#include "surrogates/tables/exports/export_grid.h"
#include "surrogates/tables/exports/fmu_package.h"

namespace underbody::tables {

namespace {

/// The functions of the standard; NAME, AXES, OUTPUTS and EVALUATE are written in front.
constexpr const char* wrapper = R"(
#include <stdlib.h>
#include <string.h>

/* Types of FMI 2.0 (fmi2TypesPlatform.h, fmi2FunctionTypes.h). */
typedef void* fmi2Component;
typedef void* fmi2ComponentEnvironment;
typedef void* fmi2FMUstate;
typedef unsigned int fmi2ValueReference;
typedef double fmi2Real;
typedef int fmi2Integer;
typedef int fmi2Boolean;
typedef char fmi2Char;
typedef const fmi2Char* fmi2String;
typedef char fmi2Byte;
typedef enum { fmi2OK, fmi2Warning, fmi2Discard, fmi2Error, fmi2Fatal, fmi2Pending } fmi2Status;
typedef enum { fmi2ModelExchange, fmi2CoSimulation } fmi2Type;
typedef enum { fmi2DoStepStatus, fmi2PendingStatus, fmi2LastSuccessfulTime, fmi2Terminated } fmi2StatusKind;
typedef struct {
    void (*logger)(fmi2ComponentEnvironment, fmi2String, fmi2Status, fmi2String, fmi2String, ...);
    void* (*allocateMemory)(size_t, size_t);
    void (*freeMemory)(void*);
    void (*stepFinished)(fmi2ComponentEnvironment, fmi2Status);
    fmi2ComponentEnvironment componentEnvironment;
} fmi2CallbackFunctions;
typedef struct {
    fmi2Boolean newDiscreteStatesNeeded, terminateSimulation, nominalsOfContinuousStatesChanged, valuesOfContinuousStatesChanged, nextEventTimeDefined;
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

typedef struct {
    double input[AXES];
    double time;
} Instance;

EXPORTED const char* fmi2GetTypesPlatform(void) { return "default"; }
EXPORTED const char* fmi2GetVersion(void) { return "2.0"; }

EXPORTED fmi2Component fmi2Instantiate(fmi2String name, fmi2Type type, fmi2String guid, fmi2String resources, const fmi2CallbackFunctions* functions,
                                       fmi2Boolean visible, fmi2Boolean logging) {
    Instance* instance;
    UNUSED(name); UNUSED(type); UNUSED(resources); UNUSED(functions); UNUSED(visible); UNUSED(logging);
    if (guid == NULL || strcmp(guid, GUID) != 0) {
        return NULL;
    }
    instance = (Instance*)malloc(sizeof(Instance));
    if (instance != NULL) {
        memcpy(instance->input, start_values, sizeof(start_values));
        instance->time = 0;
    }
    return instance;
}
EXPORTED void fmi2FreeInstance(fmi2Component c) { free(c); }
EXPORTED fmi2Status fmi2Reset(fmi2Component c) {
    memcpy(((Instance*)c)->input, start_values, sizeof(start_values));
    return fmi2OK;
}

EXPORTED fmi2Status fmi2GetReal(fmi2Component c, const fmi2ValueReference vr[], size_t n, fmi2Real value[]) {
    const Instance* instance = (const Instance*)c;
    double out[OUTPUTS];
    size_t i;
    int evaluated = 0;
    int refused = 0;
    fmi2Status status = fmi2OK;
    for (i = 0; i < n; ++i) {
        if (vr[i] < AXES) {
            value[i] = instance->input[vr[i]];
        } else if (vr[i] < AXES + OUTPUTS) {
            if (!evaluated) {
                refused = evaluate(instance->input, out);
                evaluated = 1;
            }
            value[i] = out[vr[i] - AXES];
            if (refused && is_value_or_slope(vr[i] - AXES)) {
                status = fmi2Discard; /* outside an axis that refuses this: no value, no slopes */
            }
        } else {
            return fmi2Error;
        }
    }
    return status;
}
EXPORTED fmi2Status fmi2SetReal(fmi2Component c, const fmi2ValueReference vr[], size_t n, const fmi2Real value[]) {
    size_t i;
    for (i = 0; i < n; ++i) {
        if (vr[i] >= AXES) {
            return fmi2Error;
        }
        ((Instance*)c)->input[vr[i]] = value[i];
    }
    return fmi2OK;
}

/* Derivatives of all outputs along one axis. In a cell, and beyond an end, every output is a cubic of that coordinate at most, so that four places give its
   slope to rounding; the flags are constant there. 1 when the point is refused. */
static int derivatives(const double* input, unsigned axis, double* out) {
    static const double place[4] = {0.125, 0.375, 0.625, 0.875};
    double point[AXES], at[OUTPUTS], begin, width, t;
    unsigned i, j, m;
    interval(axis, input[axis], &begin, &width);
    t = (input[axis] - begin) / width;
    memcpy(point, input, sizeof(point));
    for (j = 0; j < OUTPUTS; ++j) {
        out[j] = 0;
    }
    for (i = 0; i < 4u; ++i) {
        double slope = 0; /* of the Lagrange polynomial of place i at t */
        for (m = 0; m < 4u; ++m) {
            if (m != i) {
                double product = 1 / (place[i] - place[m]);
                for (j = 0; j < 4u; ++j) {
                    if (j != i && j != m) {
                        product *= (t - place[j]) / (place[i] - place[j]);
                    }
                }
                slope += product;
            }
        }
        point[axis] = begin + place[i] * width;
        if (evaluate(point, at)) {
            return 1;
        }
        for (j = 0; j < OUTPUTS - 2u; ++j) {
            out[j] += slope / width * at[j];
        }
    }
    return 0;
}
EXPORTED fmi2Status fmi2GetDirectionalDerivative(fmi2Component c, const fmi2ValueReference unknown[], size_t n_unknown, const fmi2ValueReference known[],
                                                 size_t n_known, const fmi2Real d_known[], fmi2Real d_unknown[]) {
    double out[OUTPUTS];
    size_t i, j;
    for (i = 0; i < n_unknown; ++i) {
        if (unknown[i] < AXES || unknown[i] >= AXES + OUTPUTS) {
            return fmi2Error;
        }
        d_unknown[i] = 0;
    }
    if (evaluate(((const Instance*)c)->input, out)) {
        return fmi2Discard;
    }
    for (j = 0; j < n_known; ++j) {
        if (known[j] >= AXES) {
            return fmi2Error;
        }
        if (derivatives(((const Instance*)c)->input, known[j], out)) {
            return fmi2Discard;
        }
        for (i = 0; i < n_unknown; ++i) {
            d_unknown[i] += out[unknown[i] - AXES] * d_known[j];
        }
    }
    return fmi2OK;
}

#define NOTHING(name, parameters, unused) EXPORTED fmi2Status name parameters { unused; return fmi2OK; }
#define NONE_OF(name, type) \
    EXPORTED fmi2Status name(fmi2Component c, const fmi2ValueReference vr[], size_t n, type value) { UNUSED(c); UNUSED(vr); UNUSED(value); return n == 0 ? fmi2OK : fmi2Error; }
NONE_OF(fmi2GetInteger, fmi2Integer*)
NONE_OF(fmi2GetBoolean, fmi2Boolean*)
NONE_OF(fmi2GetString, fmi2String*)
NONE_OF(fmi2SetInteger, const fmi2Integer*)
NONE_OF(fmi2SetBoolean, const fmi2Boolean*)
NONE_OF(fmi2SetString, const fmi2String*)
NOTHING(fmi2SetDebugLogging, (fmi2Component c, fmi2Boolean on, size_t n, const fmi2String categories[]), UNUSED(c); UNUSED(on); UNUSED(n); UNUSED(categories))
NOTHING(fmi2SetupExperiment, (fmi2Component c, fmi2Boolean t_defined, fmi2Real tolerance, fmi2Real start, fmi2Boolean s_defined, fmi2Real stop),
        UNUSED(t_defined); UNUSED(tolerance); UNUSED(s_defined); UNUSED(stop); ((Instance*)c)->time = start)
NOTHING(fmi2EnterInitializationMode, (fmi2Component c), UNUSED(c))
NOTHING(fmi2ExitInitializationMode, (fmi2Component c), UNUSED(c))
NOTHING(fmi2Terminate, (fmi2Component c), UNUSED(c))

/* The state is the inputs and the time. */
EXPORTED fmi2Status fmi2GetFMUstate(fmi2Component c, fmi2FMUstate* state) {
    if (*state == NULL) {
        *state = malloc(sizeof(Instance));
    }
    if (*state == NULL) {
        return fmi2Error;
    }
    memcpy(*state, c, sizeof(Instance));
    return fmi2OK;
}
EXPORTED fmi2Status fmi2SetFMUstate(fmi2Component c, fmi2FMUstate state) { memcpy(c, state, sizeof(Instance)); return fmi2OK; }
EXPORTED fmi2Status fmi2FreeFMUstate(fmi2Component c, fmi2FMUstate* state) { UNUSED(c); free(*state); *state = NULL; return fmi2OK; }
EXPORTED fmi2Status fmi2SerializedFMUstateSize(fmi2Component c, fmi2FMUstate state, size_t* size) { UNUSED(c); UNUSED(state); *size = sizeof(Instance); return fmi2OK; }
EXPORTED fmi2Status fmi2SerializeFMUstate(fmi2Component c, fmi2FMUstate state, fmi2Byte bytes[], size_t size) {
    UNUSED(c);
    if (size < sizeof(Instance)) {
        return fmi2Error;
    }
    memcpy(bytes, state, sizeof(Instance));
    return fmi2OK;
}
EXPORTED fmi2Status fmi2DeSerializeFMUstate(fmi2Component c, const fmi2Byte bytes[], size_t size, fmi2FMUstate* state) {
    if (size < sizeof(Instance) || fmi2GetFMUstate(c, state) != fmi2OK) {
        return fmi2Error;
    }
    memcpy(*state, bytes, sizeof(Instance));
    return fmi2OK;
}

/* Model exchange: no states, no events. */
NOTHING(fmi2EnterEventMode, (fmi2Component c), UNUSED(c))
NOTHING(fmi2EnterContinuousTimeMode, (fmi2Component c), UNUSED(c))
NOTHING(fmi2SetTime, (fmi2Component c, fmi2Real time), ((Instance*)c)->time = time)
EXPORTED fmi2Status fmi2NewDiscreteStates(fmi2Component c, fmi2EventInfo* info) { UNUSED(c); memset(info, 0, sizeof(*info)); return fmi2OK; }
EXPORTED fmi2Status fmi2CompletedIntegratorStep(fmi2Component c, fmi2Boolean no_set, fmi2Boolean* event, fmi2Boolean* terminate) {
    UNUSED(c); UNUSED(no_set);
    *event = 0;
    *terminate = 0;
    return fmi2OK;
}
#define NO_STATES(name, type) EXPORTED fmi2Status name(fmi2Component c, type x, size_t n) { UNUSED(c); UNUSED(x); return n == 0 ? fmi2OK : fmi2Error; }
NO_STATES(fmi2SetContinuousStates, const fmi2Real*)
NO_STATES(fmi2GetContinuousStates, fmi2Real*)
NO_STATES(fmi2GetDerivatives, fmi2Real*)
NO_STATES(fmi2GetEventIndicators, fmi2Real*)
NO_STATES(fmi2GetNominalsOfContinuousStates, fmi2Real*)

/* Co-simulation: the outputs follow the inputs at once. */
EXPORTED fmi2Status fmi2DoStep(fmi2Component c, fmi2Real time, fmi2Real step, fmi2Boolean no_set) { UNUSED(no_set); ((Instance*)c)->time = time + step; return fmi2OK; }
NOTHING(fmi2CancelStep, (fmi2Component c), UNUSED(c))
EXPORTED fmi2Status fmi2SetRealInputDerivatives(fmi2Component c, const fmi2ValueReference vr[], size_t n, const fmi2Integer order[], const fmi2Real value[]) {
    UNUSED(c); UNUSED(vr); UNUSED(order); UNUSED(value);
    return n == 0 ? fmi2OK : fmi2Error;
}
EXPORTED fmi2Status fmi2GetRealOutputDerivatives(fmi2Component c, const fmi2ValueReference vr[], size_t n, const fmi2Integer order[], fmi2Real value[]) {
    UNUSED(c); UNUSED(vr); UNUSED(order); UNUSED(value);
    return n == 0 ? fmi2OK : fmi2Error;
}
EXPORTED fmi2Status fmi2GetStatus(fmi2Component c, const fmi2StatusKind s, fmi2Status* value) { UNUSED(c); UNUSED(s); *value = fmi2OK; return fmi2Discard; }
EXPORTED fmi2Status fmi2GetRealStatus(fmi2Component c, const fmi2StatusKind s, fmi2Real* value) {
    if (s == fmi2LastSuccessfulTime) {
        *value = ((Instance*)c)->time;
        return fmi2OK;
    }
    return fmi2Discard;
}
EXPORTED fmi2Status fmi2GetIntegerStatus(fmi2Component c, const fmi2StatusKind s, fmi2Integer* value) { UNUSED(c); UNUSED(s); *value = 0; return fmi2Discard; }
EXPORTED fmi2Status fmi2GetBooleanStatus(fmi2Component c, const fmi2StatusKind s, fmi2Boolean* value) { UNUSED(c); UNUSED(s); *value = 0; return fmi2Discard; }
EXPORTED fmi2Status fmi2GetStringStatus(fmi2Component c, const fmi2StatusKind s, fmi2String* value) { UNUSED(c); UNUSED(s); *value = ""; return fmi2Discard; }
)";

double start_value(const ExportAxis& axis) { return 0.5 * (axis.lower + axis.upper); }

/// Cells along each axis, and what lies beyond its ends, as places between which every output is one polynomial. Of an
/// axis that refuses only what lies in its range, which may end at a line inside the grid: a point at that end belongs
/// to the cell before it, and the rest of a cell that the range cuts is not used.
std::string interval_function(const ExportGrid& grid) {
    std::string text =
        "/* The cell along an axis, or a stretch beyond its end. */\nstatic void interval(unsigned axis, double v, "
        "double* begin, double* width) {\n"
        "    const " +
        grid.name +
        "_real* x = 0;\n    double from = 0, to = 0, end;\n    unsigned cells = 0, low = 0, high = 0;\n"
        "    switch (axis) {\n";
    for (std::size_t k = 0; k < grid.axes.size(); ++k) {
        const ExportAxis& axis = grid.axes[k];
        const auto& x = axis.points;
        std::size_t first = 0, last = x.size() - 1;
        double from = x.front(), to = x.back();
        if (axis.range == RangePolicy::refuse) {
            from = std::max(from, axis.lower);
            to = std::min(to, axis.upper);
            // Lines and ends that differ by rounding are one; the narrowest cells, beside kinks, are ten times as wide.
            const double same = 1e-9 * (to - from);
            while (first + 1 < last && x[first + 1] <= from + same) {
                ++first;
            }
            while (last > first + 1 && x[last - 1] >= to - same) {
                --last;
            }
        }
        const std::string id = std::to_string(k);
        text += "    case " + id + "u:\n        x = " + grid.name + "_x" + id +
                ";\n        cells = " + std::to_string(x.size() - 1) + "u;\n        low = " + std::to_string(first) +
                "u;\n        high = " + std::to_string(last) + "u;\n        from = " + core::format_number(from) +
                ";\n        to = " + core::format_number(to) + ";\n        break;\n";
    }
    return text +
           "    default:\n        break;\n    }\n"
           "    if (!(v >= (double)x[0])) {\n        *width = 2 * ((double)x[0] - v) + (double)x[1] - (double)x[0];\n  "
           "      *begin = (double)x[0] - *width;\n        return;\n    }\n"
           "    if (v > (double)x[cells]) {\n        *width = 2 * (v - (double)x[cells]) + (double)x[1] - "
           "(double)x[0];\n        *begin = (double)x[cells];\n        return;\n    }\n"
           "    while (high - low > 1u) {\n        const unsigned middle = (low + high) / 2u;\n        if (v >= "
           "(double)x[middle]) {\n            low = middle;\n        } else {\n"
           "            high = middle;\n        }\n    }\n"
           "    *begin = (double)x[low] > from ? (double)x[low] : from;\n"
           "    end = (double)x[low + 1u] < to ? (double)x[low + 1u] : to;\n    *width = end - *begin;\n}\n";
}

std::string source(const ExportGrid& grid, const std::string& guid) {
    const std::size_t n = grid.axes.size(), quantities = grid.quantities.size();
    std::string text =
        "/* " + grid.origin.front() + "; FMU 2.0, model exchange and co-simulation. */\n#include \"table.h\"\n";
    text +=
        "#define GUID \"" + guid + "\"\n#define AXES " + std::to_string(n) + "u\n#define QUANTITIES " +
        std::to_string(quantities) +
        "u\n/* of each quantity the value, its slopes and its error; then outside and no_data */\n#define OUTPUTS " +
        std::to_string(quantities * (n + 2) + 2) + "u\n";
    text += "static const double start_values[AXES] = {";
    for (std::size_t k = 0; k < n; ++k) {
        text += (k == 0 ? "" : ", ") + core::format_number(start_value(grid.axes[k]));
    }
    text +=
        "};\nstatic int is_value_or_slope(unsigned output) { return output < QUANTITIES * (AXES + 2u) && output % "
        "(AXES + 2u) <= AXES; }\n";
    text += "/* 1 when the point is refused. */\nstatic int evaluate(const double* input, double* out) {\n    " +
            grid.name + "_real point[AXES];\n    " + grid.name + "_result r;\n    unsigned k;\n";
    text += "    for (k = 0; k < AXES; ++k) {\n        point[k] = (" + grid.name + "_real)input[k];\n    }\n    " +
            grid.name + "_at(point, &r);\n";
    for (std::size_t q = 0; q < quantities; ++q) {
        const std::string of = quantities > 1 ? identifier(grid.quantities[q].name) + "." : "",
                          at = std::to_string(q * (n + 2)) + "u";
        text += "    out[" + at + "] = (double)r." + of + "value;\n    for (k = 0; k < AXES; ++k) {\n        out[" +
                at + " + 1u + k] = (double)r." + of + "slope[k];\n    }\n";
        text += "    out[" + at + " + 1u + AXES] = (double)r." + of + "sigma;\n";
    }
    text += "    out[OUTPUTS - 2u] = r.outside;\n    out[OUTPUTS - 1u] = r.no_data;\n    return r.refused;\n}\n";
    return text + interval_function(grid) + wrapper;
}

/// The variables of a model description, and the units that they have.
class Variables {
public:
    void input(const std::string& name, const std::string& unit, const std::string& what, double start) {
        add(name, unit, what, "input", " start=\"" + core::format_number(start) + "\"");
    }
    void output(const std::string& name, const std::string& unit, const std::string& what) {
        add(name, unit, what, "output", "");
    }
    [[nodiscard]] const std::string& text() const { return text_; }
    [[nodiscard]] std::size_t count() const { return count_; }
    [[nodiscard]] const std::vector<std::string>& units() const { return units_; }

private:
    void add(const std::string& name, const std::string& unit, const std::string& what, const char* causality,
             const std::string& start) {
        text_ += "    <ScalarVariable name=\"" + name + "\" valueReference=\"" + std::to_string(count_++) +
                 "\" description=\"" + core::escape_html(what) + "\" causality=\"" + causality +
                 "\" variability=\"continuous\">\n      <Real unit=\"" + core::escape_html(unit) + "\"" + start +
                 "/>\n    </ScalarVariable>\n";
        if (std::find(units_.begin(), units_.end(), unit) == units_.end()) {
            units_.push_back(unit);
        }
    }

    std::string text_;
    std::size_t count_ = 0;
    std::vector<std::string> units_;
};

Variables variables_of(const ExportGrid& grid) {
    Variables all;
    for (const auto& axis : grid.axes) {
        all.input(axis.name, axis.unit,
                  "axis, " + core::format_number(axis.lower, 6) + " to " + core::format_number(axis.upper, 6),
                  start_value(axis));
    }
    for (const auto& q : grid.quantities) {
        all.output(q.name, q.unit, q.meaning.empty() ? q.name : q.meaning);
        for (const auto& axis : grid.axes) {
            all.output(q.name + "_per_" + axis.name, q.unit + "/(" + axis.unit + ")", "slope");
        }
        all.output(q.name + "_sigma", q.unit, "one standard deviation");
    }
    const std::string flags = grid.quantities.size() > 1 ? "" : grid.first().name + "_";
    all.output(flags + "outside", "1", "1 when the point lies outside the table");
    all.output(flags + "no_data", "1",
               "1 where no points of the table lie around: outside, or in an empty corner of its box");
    return all;
}

/// Every output depends on every input.
std::string structure(std::size_t inputs, std::size_t variables) {
    std::string all_inputs;
    for (std::size_t k = 1; k <= inputs; ++k) {
        all_inputs += (k == 1 ? "" : " ") + std::to_string(k);
    }
    std::string xml;
    for (const char* list : {"Outputs", "InitialUnknowns"}) {
        xml += std::string("    <") + list + ">\n";
        for (std::size_t i = inputs + 1; i <= variables; ++i) {
            xml += "      <Unknown index=\"" + std::to_string(i) + "\" dependencies=\"" + all_inputs + "\"/>\n";
        }
        xml += std::string("    </") + list + ">\n";
    }
    return xml;
}

std::string description(const ExportGrid& grid, const std::string& guid) {
    std::string origin;
    for (const auto& line : header_lines(grid)) {
        origin += (origin.empty() ? "" : ". ") + line;
    }
    std::string xml =
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<fmiModelDescription fmiVersion=\"2.0\" modelName=\"" + grid.name +
        "\" guid=\"" + guid + "\" description=\"" + core::escape_html(origin) +
        "\" generationTool=\"Underbody\" variableNamingConvention=\"flat\" numberOfEventIndicators=\"0\">\n";
    for (const char* kind : {"ModelExchange", "CoSimulation"}) {
        xml += std::string("  <") + kind + " modelIdentifier=\"" + grid.name +
               "\" providesDirectionalDerivative=\"true\" canGetAndSetFMUstate=\"true\" canSerializeFMUstate=\"true\"" +
               (kind[0] == 'C' ? " canHandleVariableCommunicationStepSize=\"true\"" : "") +
               ">\n    <SourceFiles>\n      <File name=\"fmu.c\"/>\n    </SourceFiles>\n  </" + kind + ">\n";
    }
    const Variables variables = variables_of(grid);
    xml += "  <UnitDefinitions>\n";
    for (const auto& unit : variables.units()) {
        xml += "    <Unit name=\"" + core::escape_html(unit) + "\"/>\n";
    }
    return xml + "  </UnitDefinitions>\n  <DefaultExperiment startTime=\"0\" stopTime=\"1\"/>\n  <ModelVariables>\n" +
           variables.text() + "  </ModelVariables>\n  <ModelStructure>\n" +
           structure(grid.axes.size(), variables.count()) + "  </ModelStructure>\n</fmiModelDescription>\n";
}

}  // namespace

void export_fmu(const ExportGrid& asked, const std::filesystem::path& path, ExportResult& result) {
    ExportGrid grid = asked;
    grid.single_precision = false;  // the numbers of FMI are doubles
    core::TemporaryFolder folder("underbody-fmu");
    const core::RecordInputs own(folder.path());  // nothing there is an input
    ExportResult ignored;
    export_c(grid, folder.path() / "table.h", ignored);
    const std::string header = core::read_file(folder.path() / "table.h");
    const std::string guid = fmu_guid(header);
    write_fmu(path, grid.name, description(grid, guid), {{"fmu.c", source(grid, guid)}, {"table.h", header}},
              result.remarks);
}

}  // namespace underbody::tables
