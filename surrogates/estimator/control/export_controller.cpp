#include <algorithm>
#include <cctype>
#include <cmath>
#include <limits>
#include <utility>

#include "core/error.h"
#include "core/hash.h"
#include "core/text.h"
#include "surrogates/estimator/control/closed_loop.h"

namespace underbody::estimator {

namespace {

/// Shortest digits that read back to the same double, always a floating constant of C.
std::string number(double value) {
    const std::string text = core::format_number(value);
    return text.find_first_of(".en") == std::string::npos ? text + ".0" : text;
}

std::string count(std::size_t value) { return std::to_string(value); }

/// In brackets where it is negative.
std::string term(double value) { return value < 0 ? "(" + number(value) + ")" : number(value); }

void check(const LoopEstimator& estimator, const LoopOptions& options, const std::string& name) {
    if (estimator.source == ForceSource::extended || estimator.source == ForceSource::truth ||
        options.feedback == Feedback::truth) {
        throw core::InputError(
            "name", "the estimator '" + estimator.name + "' is no linear filter: it cannot be written as a controller",
            {}, "take one of disturbance, reduced, full, latent, kalman, none");
    }
    const bool letters =
        std::all_of(name.begin(), name.end(), [](unsigned char c) { return std::isalnum(c) != 0 || c == '_'; });
    if (name.empty() || !letters || std::isdigit(static_cast<unsigned char>(name[0])) != 0) {
        throw core::InputError("name", "'" + name + "' is no name in C", {},
                               "letters, digits and '_', not beginning with a digit");
    }
}

/// How much of the commands before reaches the body in each part of a sample: share[part][how many samples ago], the
/// present command first. As Loop has it: each command held over its sample, late by the delay.
std::vector<std::vector<double>> shares(double delay, double step, int parts) {
    const double dt = step / parts;
    const auto longest = static_cast<std::size_t>(std::max(0.0, std::ceil(delay / step - 1e-9)));
    std::vector<std::vector<double>> all(static_cast<std::size_t>(parts), std::vector<double>(longest + 1, 0.0));
    for (int i = 0; i < parts; ++i) {
        const double begin = dt * i - delay, end = begin + dt;
        for (auto k = static_cast<long>(std::floor(begin / step + 1e-9));
             static_cast<double>(k) * step < end - 1e-9 * step; ++k) {
            const double from = std::max(begin, static_cast<double>(k) * step),
                         to = std::min(end, static_cast<double>(k + 1) * step);
            const auto ago = std::min(static_cast<std::size_t>(std::max(0L, -k)), longest);
            all[static_cast<std::size_t>(i)][ago] += (to - from) / dt;
        }
    }
    return all;
}

class Writer {
public:
    Writer(const SeparatedPlant& plant, const ControlLaw& law, const LoopEstimator& estimator,
           const LoopOptions& options, const std::string& name)
        : plant_(plant),
          law_(law),
          estimator_(estimator),
          options_(options),
          name_(name),
          filter_(estimator.filter ? &*estimator.filter : nullptr),
          parts_(loop_substeps(options.step)),
          shares_(shares(plant.actuator.delay, options.step, parts_)) {}

    std::string text(const std::vector<std::string>& made_from) {
        state();
        command();
        actuator();
        std::string content;
        std::swap(content, out_);
        if (filter_ != nullptr) {
            out_ = export_c(*filter_, name_ + "_observer") + "\n";
        }
        comment(made_from);
        // Another controller of the same name has another guard: a compiler then says what is defined twice.
        const std::string guard = "UNDERBODY_" + name_ + "_" + core::content_hash(content).substr(0, 12) + "_H";
        return out_ + "#ifndef " + guard + "\n#define " + guard + "\n\n" + content + "\n#endif\n";
    }

private:
    void comment(const std::vector<std::string>& made_from) {
        out_ += "/* Controller that holds a gap of " + number(law_.reference_gap) + " m, sampled every " +
                number(options_.step) + " s; SI units, gap and forces positive up.\n";
        out_ += " * Estimator: " + estimator_.name + "; feedback on " +
                (options_.feedback == Feedback::estimated ? "estimated" : "measured") + " gap and velocity.\n";
        for (std::string line : made_from) {
            for (std::size_t at; (at = line.find("*/")) != std::string::npos;) {
                line.replace(at, 2, "* /");
            }
            out_ += " * made from: " + line + "\n";
        }
        const std::string rest = options_.velocity_measured ? ", heave_velocity" : "";
        out_ += " * C99, no heap, no library. Call " + name_ + "_start once, then at every sample " + name_ +
                "_step(&state, gap" + rest + "),\n * which gives the force to command, N.\n";
        out_ +=
            " * What the actuator makes of the commands (delay, dead zone, gain, lag as the model declares them) "
            "is followed inside;\n * where its force is measured, give its mean over the sample before: " +
            name_ + "_step_with(&state, gap" + rest + ", acted).\n";
        out_ +=
            " * A reading that is no finite number is left out: the command before is given again, and state.rejected "
            "counts "
            "how\n * many readings in a row were. Before the first good reading the command is 0. */\n";
    }

    /// The largest double: a comparison with it holds for finite numbers alone.
    [[nodiscard]] static std::string largest() { return number(std::numeric_limits<double>::max()); }

    [[nodiscard]] std::string sensors() const { return options_.velocity_measured ? ", double heave_velocity" : ""; }

    void state() {
        out_ += "typedef struct {\n";
        if (filter_ != nullptr) {
            out_ += "    " + name_ + "_observer_state observer;\n";
        }
        out_ +=
            "    double felt[" + count(shares_[0].size()) +
            "]; /* commands as the actuator takes them, the last first */\n" +
            "    double lag[2];\n    double acted; /* mean force since the sample before */\n    double command; /* "
            "the last one given */\n    int started;\n    int rejected; /* readings in a row that were no finite "
            "numbers */\n} " +
            name_ + "_state;\n\n";
        out_ +=
            "static inline void " + name_ + "_start(" + name_ + "_state *c) {\n    int i;\n    for (i = 0; i < " +
            count(shares_[0].size()) + "; ++i) {\n        c->felt[i] = 0.0;\n    }\n" +
            "    c->lag[0] = 0.0;\n    c->lag[1] = 0.0;\n    c->acted = 0.0;\n    c->command = 0.0;\n    c->started = "
            "0;\n    c->rejected = 0;\n}\n\n";
        out_ += "static inline int " + name_ + "_finite(double x) {\n    return ((x >= -" + largest() +
                ") && (x <= " + largest() + ")) ? 1 : 0;\n}\n\n";
        out_ += "static inline void " + name_ + "_follow(" + name_ + "_state *c, double command);\n\n";
    }

    /// An estimate of the filter as an expression; nothing when it gives none of that name.
    [[nodiscard]] std::string estimate(const char* wanted) const {
        const auto at = std::find(filter_->estimates.begin(), filter_->estimates.end(), wanted);
        return at == filter_->estimates.end() ? "" : "estimates[" + count(at - filter_->estimates.begin()) + "]";
    }

    void command() {
        out_ += "static inline double " + name_ + "_step_with(" + name_ + "_state *c, double gap" + sensors() +
                ", double acted) {\n    double h = gap;\n";
        out_ += options_.velocity_measured ? "    double w = heave_velocity;\n" : "    double w = 0.0;\n";
        out_ += "    double u;\n    if ((" + name_ + "_finite(gap) == 0)";
        out_ += options_.velocity_measured ? " || (" + name_ + "_finite(heave_velocity) == 0)" : "";
        out_ += ") {\n        if (c->rejected < 32767) {\n            c->rejected += 1;\n        }\n        " + name_ +
                "_follow(c, c->command);\n        return c->command;\n    }\n    c->rejected = 0;\n";
        if (filter_ != nullptr) {
            out_ += "    if (" + name_ + "_finite(acted) == 0) {\n        acted = c->acted;\n    }\n";
        }
        std::string total;
        if (filter_ != nullptr) {
            observe();
            total = estimate("total_force");
            total = total.empty() ? "(" + estimate("ground_force") + " - " + estimate("drag_force") + ")" : total;
        } else {
            out_ += "    (void)acted;\n";
        }
        out_ += "    c->started = 1;\n";
        out_ += "    u = -" + term(law_.velocity_gain) + " * w - " + term(law_.gap_gain) + " * (h - " +
                term(law_.reference_gap) + ");\n";
        out_ += law_.cancel && !total.empty() ? "    u -= " + total + ";\n" : "";
        out_ += law_.cancel_bias ? "    u -= " + term(plant_.bias) + ";\n" : "";
        if (std::isfinite(law_.limit)) {
            out_ += "    if (u > " + number(law_.limit) + ") {\n        u = " + number(law_.limit) +
                    ";\n    } else if (u < -" + number(law_.limit) + ") {\n        u = -" + number(law_.limit) +
                    ";\n    } else {\n        /* within the limit */\n    }\n";
        }
        out_ += "    c->command = u;\n    " + name_ + "_follow(c, u);\n    return u;\n}\n\n";
        out_ += "static inline double " + name_ + "_step(" + name_ + "_state *c, double gap" + sensors() +
                ") {\n    return " + name_ + "_step_with(c, gap" +
                (options_.velocity_measured ? ", heave_velocity" : "") + ", c->acted);\n}\n\n";
    }

    void observe() {
        out_ += "    double measured[" + count(filter_->measured.size()) + "];\n    double estimates[" +
                count(filter_->estimates.size()) + "];\n";
        for (std::size_t i = 0; i < filter_->measured.size(); ++i) {
            out_ += "    measured[" + count(i) + "] = " + filter_->measured[i] + ";\n";
        }
        out_ += "    if (c->started != 0) {\n        " + name_ +
                "_observer_step(&c->observer, measured, &acted, estimates);\n    } else {\n        " + name_ +
                "_observer_start(&c->observer, measured, estimates);\n    }\n";
        if (options_.feedback == Feedback::estimated) {
            const std::string h = estimate("gap"), w = estimate("heave_velocity");
            out_ += (h.empty() ? "" : "    h = " + h + ";\n") + (w.empty() ? "" : "    w = " + w + ";\n");
        }
    }

    /// What the actuator will have made of the command by the next sample.
    void actuator() {
        const std::size_t kept = shares_[0].size();
        const dynamics::Actuator& a = plant_.actuator;
        out_ += "/* What acts until the next sample when this is commanded now. */\nstatic inline void " + name_ +
                "_follow(" + name_ + "_state *c, double command) {\n";
        out_ += "    static const double share[" + count(shares_.size()) + "][" + count(kept) + "] = {";
        for (std::size_t i = 0; i < shares_.size(); ++i) {
            out_ += i == 0 ? "{" : ", {";
            for (std::size_t k = 0; k < kept; ++k) {
                out_ += (k == 0 ? "" : ", ") + number(shares_[i][k]);
            }
            out_ += "}";
        }
        out_ += "};\n    double sum = 0.0;\n    int i;\n    int k;\n";
        out_ += "    for (k = " + count(kept - 1) + "; k > 0; --k) {\n        c->felt[k] = c->felt[k - 1];\n    }\n";
        if (a.dead_zone > 0) {
            out_ += "    if (command > " + number(a.dead_zone) + ") {\n        command -= " + number(a.dead_zone) +
                    ";\n    } else if (command < -" + number(a.dead_zone) +
                    ") {\n        command += " + number(a.dead_zone) +
                    ";\n    } else {\n        command = 0.0;\n    }\n";
        }
        out_ += "    c->felt[0] = " + term(a.gain) + " * command;\n";
        out_ += "    for (i = 0; i < " + count(shares_.size()) + "; ++i) {\n        double mean = 0.0;\n";
        out_ += "        for (k = 0; k < " + count(kept) +
                "; ++k) {\n            mean += share[i][k] * c->felt[k];\n        }\n";
        lag(0, a.lag);
        lag(1, options_.actuator_lag);
        out_ += "        sum += mean;\n    }\n    c->acted = sum / " + number(parts_) + ";\n}\n";
    }

    void lag(int which, double tau) {
        if (!(tau > 0)) {
            return;
        }
        const double dt = options_.step / parts_, decay = std::exp(-dt / tau);
        const std::string state = "c->lag[" + std::to_string(which) + "]";
        out_ += "        {\n            const double driven = mean;\n            mean = driven + (" + state +
                " - driven) * " + number(tau / dt * (1 - decay)) + ";\n            " + state + " = driven + (" + state +
                " - driven) * " + number(decay) + ";\n        }\n";
    }

    const SeparatedPlant& plant_;
    const ControlLaw& law_;
    const LoopEstimator& estimator_;
    const LoopOptions& options_;
    std::string name_;
    const LinearFilter* filter_;
    int parts_;
    std::vector<std::vector<double>> shares_;
    std::string out_;
};

}  // namespace

std::string export_controller_c(const SeparatedPlant& plant, const ControlLaw& law, const LoopEstimator& estimator,
                                const LoopOptions& options, const std::string& name,
                                const std::vector<std::string>& made_from) {
    check(estimator, options, name);
    const Loop refused_alike(plant, law, estimator, options, law.reference_gap, 0);
    return Writer(plant, law, estimator, options, name).text(made_from);
}

}  // namespace underbody::estimator
