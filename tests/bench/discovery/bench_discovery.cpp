// Scores discover() and its peers on heave runs with known truth. bench_discovery --help says how.
#include <cmath>
#include <cstdio>

#include "core/file.h"
#include "core/random.h"
#include "surrogates/discovery/calibration.h"
#include "tests/bench/discovery/campaign.h"
#include "tests/bench/discovery/heave_peers.h"

using namespace underbody;

namespace {

const char* const usage =
    "bench_discovery [--kind single|weak|clean|unknown|pair|noise|rig|\"rig ...\"] [--only EFFECT] [--level X] "
    "[--seeds N] "
    "[--first-seed N] [--rate HZ]\n"
    "                [--write FOLDER: the data sets themselves, with their truth]\n"
    "                [--recalibrate: half and twice each number that decides a verdict (--only NAME), and what moves]\n"
    "                [--coloured 0|1] [--velocity 0|1] [--threads N] [--no-peers] [--markdown] [--verbose]\n"
    "Constants of the program were set on seeds below 6000 (rigs: below 20000); figures are quoted from seeds above.\n";

/// Rigs as they are: the controller is fed what is logged. One set of each kind a seed.
struct RigKind {
    const char* kind;
    bench::Rig rig;
    std::vector<std::string> names;  ///< {"catalogue"}: one effect, another one each seed; {"unknown"}: one law
    double level = 0;
    bool strong = false;
};

std::vector<RigKind> rig_kinds() {
    const bench::Rig white{true}, coloured{true, 0.9};
    bench::Rig gusts = white, drift = white, rough = white;
    gusts.gusts = 1;
    drift.drift = 12;
    rough.rounding = 1.5;
    rough.outliers = 0.003;
    rough.dropouts = 0.02;
    return {{"rig clean white", white, {}},
            {"rig clean coloured", coloured, {}},
            {"rig clean gusts", gusts, {}},
            {"rig clean rounded, outliers, dropouts", rough, {}},
            {"rig drift of the sensor", drift, {}},
            {"rig single coloured 0.3x", coloured, {"catalogue"}, 0.3},
            {"rig single coloured 0.5x", coloured, {"catalogue"}, 0.5},
            {"rig single coloured 1x", coloured, {"catalogue"}, 1},
            {"rig single coloured 2x", coloured, {"catalogue"}, 2},
            {"rig single coloured 5x", coloured, {"catalogue"}, 5},
            {"rig single strong tether", white, {"tether_stiffness"}, 1, true},
            {"rig two effects", white, {"added_mass", "constant_force"}, 2},
            {"rig unknown", white, {"unknown"}, 3},
            {"rig unknown coloured", coloured, {"unknown"}, 3}};
}

void on_rig(const RigKind& kind, bench::Case& wanted) {
    wanted.rig = kind.rig;
    wanted.strong = kind.strong;
    wanted.coloured = false;
    wanted.declared_noise = 1;
    if (wanted.names == std::vector<std::string>{"catalogue"}) {
        const std::vector<std::string> all = bench::effects_of("heave");
        wanted.names = {all[wanted.seed % all.size()]};
    } else if (wanted.names == std::vector<std::string>{"unknown"}) {
        std::vector<std::string> all = bench::unknown_laws("heave");
        all.insert(all.end(), {"backlash", "wavy_floor"});
        wanted.law = all[wanted.seed % all.size()];
    }
}

double noise_of(const bench::Case&, const std::string& channel) { return channel == "gap" ? bench::heave_noise : 1; }

/// One set; what a weak one's true law refitted would leave is not asked: it takes as long as the verdict.
void judge(const std::string& kind, const bench::Case& wanted, const dynamics::Model& model,
           bench::Campaign& campaign) {
    campaign.run(
        kind, wanted, model, noise_of,
        [&](const bench::Sample& sample, const dynamics::Measurements&, const discovery::Discovery& found,
            bench::Outcome& one) {
            if (wanted.draw == 0) {
                one.best = bench::heave_best(model, wanted, sample) / bench::heave_noise;
            }
            if (one.right() && sample.names.size() == 1 && one.verdict == "effect" &&
                std::isfinite(sample.in_catalogue_terms)) {
                const discovery::FoundParameter& p = found.effects.front().parameters.front();
                one.pull = p.sigma > 0 ? (p.value - sample.in_catalogue_terms) / p.sigma : std::nan("");
            }
        },
        [&](const bench::Sample& sample) {
            const bench::HeavePeers peers(model, sample);
            return std::map<std::string, bench::PeerAnswer>{{"sparse regression (STLSQ)", peers.sparse_regression()},
                                                            {"polynomial residual", peers.polynomial()},
                                                            {"Gaussian-process discrepancy", peers.gaussian_process()}};
        });
}

/// About the least strength that is seen in white noise in runs like those of run_weak(); a delay below a sample is how
/// the log was written.
double just_seen(const std::string& name) {
    const bool late = name == "input_delay" || name == "gap_sensor_delay" || name == "actuator_lag";
    return late ? 0.35 : name == "periodic_disturbance" ? 0.18 : 0.05;
}

/// Verdicts that are not sure: rigs of four short runs (and as many held out) fed the logged reading, one effect of the
/// catalogue each, and six clean ones a seed. Strength, noise, what is measured and declared are drawn by set.
void run_weak(const bench::Options& o, const dynamics::Model& model, bench::Campaign& campaign) {
    const std::vector<double> times{1.3, 2, 3, 4.5};
    const std::vector<std::string> all = bench::effects_of("heave");
    const std::size_t clean = 6;
    for (int s = 0; s < o.seeds; ++s) {
        for (std::size_t i = 0; i < all.size() + clean; ++i) {
            bench::Case wanted;
            wanted.family = "heave";
            wanted.seed = o.first_seed + static_cast<std::uint64_t>(s);
            wanted.draw = i + 1;
            core::Random pick(wanted.seed, wanted.draw);
            wanted.rig.feedback = true;
            wanted.rig.ar = pick.uniform() < 0.5 ? 0.9 : 0;
            wanted.velocity = pick.below(3) == 0;
            wanted.declared_noise = pick.below(5) == 0 ? 0 : 1;
            wanted.rate = o.rate;
            wanted.runs = wanted.held_out = 4;
            wanted.seconds = 20;
            wanted.fresh = false;
            if (i < all.size()) {
                wanted.names = {all[i]};
                const bool hidden = wanted.rig.ar > 0 && just_seen(all[i]) < 0.35;
                wanted.level = just_seen(all[i]) * (hidden ? 2 : 1) * times[pick.below(times.size())];
            }
            const std::string kind = wanted.names.empty() ? "weak clean" : "weak";
            if (campaign.wants(kind, wanted.names, "", wanted.level)) {
                judge(kind, wanted, model, campaign);
            }
        }
    }
}

void run_all(const bench::Options& o, const dynamics::Model& model, bench::Campaign& campaign) {
    const auto cases = [&](const std::string& kind, const std::vector<std::string>& names, const std::string& law,
                           double level, int shift = 0, const RigKind* rig = nullptr) {
        if (!campaign.wants(kind, names, law, level)) return;
        for (int s = 0; s < o.seeds; ++s) {
            bench::Case wanted;
            wanted.family = "heave";
            wanted.names = names;
            wanted.law = law;
            wanted.level = level;
            wanted.seed = o.first_seed + static_cast<std::uint64_t>(s + shift);
            wanted.rate = o.rate;
            wanted.velocity = o.velocity >= 0 ? o.velocity == 1 : wanted.seed % 3 == 0;
            wanted.coloured = o.coloured >= 0 ? o.coloured == 1 : wanted.seed % 4 == 1;
            wanted.declared_noise = kind.rfind("noise", 0) == 0 ? (wanted.seed % 3 == 0   ? 0
                                                                   : wanted.seed % 3 == 1 ? 0.5
                                                                                          : 2)
                                    : wanted.seed % 5 == 4      ? 0
                                                                : 1;
            if (rig != nullptr) {
                on_rig(*rig, wanted);
            }
            judge(kind, wanted, model, campaign);
        }
    };
    for (const double level : {1.0, 2.0}) {
        for (const std::string& name : bench::effects_of("heave"))
            cases(level == 1 ? "single 1x" : "single 2x", {name}, "", level);
    }
    for (const std::string& law : bench::unknown_laws("heave")) cases("unknown", {"unknown"}, law, 3);
    for (int k = 0; k < 5; ++k) cases("clean", {}, "", 0, 101 * k);
    cases("pair", {"constant_force", "linear_damping"}, "", 4);
    cases("pair", {"coulomb_friction", "input_gain"}, "", 4);
    cases("pair", {"added_mass", "tether_stiffness"}, "", 4);
    cases("noise single", {"coulomb_friction"}, "", 2);
    cases("noise single", {"tether_stiffness"}, "", 2);
    cases("noise clean", {}, "", 0, 50);
    for (const RigKind& rig : rig_kinds()) cases(rig.kind, rig.names, "", rig.level, 0, &rig);
    if (o.kind.rfind("weak", 0) == 0) {  // only where asked for
        run_weak(o, model, campaign);
    }
}

std::string counts(const bench::Tally& tally) {
    const auto right = tally.count([](const bench::Outcome& one) { return one.right() || one.tied(); });
    const auto wrong = tally.count([](const bench::Outcome& one) { return one.wrong(); });
    return std::to_string(right) + " right, " + std::to_string(wrong) + " wrong of " + std::to_string(tally.count());
}

/// Every number that decides a verdict at half and at twice its value, on the seeds asked for: what moves.
void recalibrate(bench::Options o, const dynamics::Model& model) {
    o.peers = false;
    const std::string only = o.only;
    o.only.clear();
    bench::Campaign base(o);
    run_all(o, model, base);
    for (const std::string& kind : base.kinds()) {
        std::printf("%-44s %s\n", kind.c_str(), counts(base.of(kind)).c_str());
    }
    for (const discovery::CalibratedNumber& number : discovery::calibrated_numbers()) {
        if (!only.empty() && number.name != only) continue;
        const double value = discovery::heave_calibration().*number.value;
        for (const double factor : {0.5, 2.0}) {
            bench::Options moved = o;
            moved.constants[number.name] = factor * value;
            bench::Campaign other(moved);
            run_all(moved, model, other);
            bool any = false;
            for (const std::string& kind : other.kinds()) {
                if (counts(other.of(kind)) != counts(base.of(kind))) {
                    std::printf("%s %g instead of %g: %s: %s\n", number.name.c_str(), factor * value, value,
                                kind.c_str(), counts(other.of(kind)).c_str());
                    any = true;
                }
            }
            if (!any) {
                std::printf("%s %g instead of %g: nothing moves\n", number.name.c_str(), factor * value, value);
            }
            std::fflush(stdout);
        }
    }
}

}  // namespace

int main(int argc, char** argv) {
    const bench::Options o = bench::read_options(argc, argv, usage);
    core::TemporaryFolder folder("bench");
    const dynamics::Model model = dynamics::read_model(bench::write_declared_model("heave", folder.path()));
    if (o.recalibrate) {
        recalibrate(o, model);
        return 0;
    }
    bench::Campaign campaign(o);
    run_all(o, model, campaign);
    campaign.print();
    return 0;
}
