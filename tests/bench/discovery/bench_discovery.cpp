// Scores discover() and its peers on heave runs with known truth. bench_discovery --help says how.
#include <cmath>

#include "core/file.h"
#include "tests/bench/discovery/campaign.h"
#include "tests/bench/discovery/heave_peers.h"

using namespace underbody;

namespace {

const char* const usage =
    "bench_discovery [--kind single|clean|unknown|pair|noise] [--only EFFECT] [--level X] [--seeds N] [--first-seed N] "
    "[--rate HZ]\n"
    "                [--coloured 0|1] [--velocity 0|1] [--threads N] [--no-peers] [--markdown] [--verbose]\n"
    "Constants of the program were set on seeds below 6000; figures are quoted from seeds 6000 and up.\n";

double noise_of(const bench::Case&, const std::string& channel) { return channel == "gap" ? bench::heave_noise : 1; }

}  // namespace

int main(int argc, char** argv) {
    const bench::Options o = bench::read_options(argc, argv, usage);
    core::TemporaryFolder folder("bench");
    bench::Campaign campaign(o);
    const dynamics::Model model = dynamics::read_model(bench::write_declared_model("heave", folder.path()));
    const auto cases = [&](const std::string& kind, const std::vector<std::string>& names, const std::string& law,
                           double level, int shift = 0) {
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
            campaign.run(
                kind, wanted, model, noise_of,
                [&](const bench::Sample& sample, const dynamics::Measurements&, const discovery::Discovery& found,
                    bench::Outcome& one) {
                    one.best = bench::heave_best(model, wanted, sample) / bench::heave_noise;
                    if (one.right() && sample.names.size() == 1 && one.verdict == "effect" &&
                        std::isfinite(sample.in_catalogue_terms)) {
                        const discovery::FoundParameter& p = found.effects.front().parameters.front();
                        one.pull = p.sigma > 0 ? (p.value - sample.in_catalogue_terms) / p.sigma : std::nan("");
                    }
                },
                [&](const bench::Sample& sample) {
                    const bench::HeavePeers peers(model, sample);
                    return std::map<std::string, bench::PeerAnswer>{
                        {"sparse regression (STLSQ)", peers.sparse_regression()},
                        {"polynomial residual", peers.polynomial()},
                        {"Gaussian-process discrepancy", peers.gaussian_process()}};
                });
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
    campaign.print();
    return 0;
}
