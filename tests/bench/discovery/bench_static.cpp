// Scores discover() and its peers on static data sets with known truth. bench_discovery_static --help says how.
#include <cmath>

#include "core/file.h"
#include "tests/bench/discovery/campaign.h"

using namespace underbody;

namespace {

const char* const usage =
    "bench_discovery_static [--family glide|towed|jet|both] [--kind single|weak|clean|unknown|pair|noise|rig] [--only "
    "EFFECT] "
    "[--level X]\n"
    "                       [--seeds N] [--first-seed N] [--threads N] [--no-peers] [--markdown] [--verbose]\n"
    "Constants of the program were set on seeds 1 to 99; figures are quoted from seeds 1000 and up.\n";

double noise_of(const bench::Case& wanted, const std::string& channel) {
    return bench::static_noise(wanted.family, channel);
}

void run(bench::Campaign& campaign, const bench::Case& wanted, const dynamics::Model& model, const std::string& kind) {
    campaign.run(
        kind, wanted, model, noise_of,
        [&](const bench::Sample& sample, const dynamics::Measurements&, const discovery::Discovery& found,
            bench::Outcome& one) {
            const std::string channel = found.error.front().channel;
            one.best = bench::static_oracle(wanted, sample).at(channel) / noise_of(wanted, channel);
            if (one.right() && sample.names.size() == 1 && one.verdict == "effect" &&
                std::isfinite(sample.in_catalogue_terms)) {
                const discovery::FoundParameter& p = found.effects.front().parameters.front();
                one.pull = p.sigma > 0 ? (p.value - sample.in_catalogue_terms) / p.sigma : std::nan("");
            }
        },
        [&](const bench::Sample& sample) {
            bench::Noise sigma;
            for (const char* name : {"lift_force", "drag_force", "pitch_moment"}) {
                sigma[name] = noise_of(wanted, name);
            }
            return std::map<std::string, bench::PeerAnswer>{
                {"sparse regression (STLSQ)", bench::sparse_regression(model, sample.train, sample.test, sigma)},
                {"polynomial residual", bench::polynomial_residual(model, sample.train, sample.test, sigma)},
                {"Gaussian-process discrepancy",
                 bench::gaussian_process_discrepancy(model, sample.train, sample.test, sigma)}};
        });
}

}  // namespace

int main(int argc, char** argv) {
    const bench::Options o = bench::read_options(argc, argv, usage);
    core::TemporaryFolder folder("bench");
    bench::Campaign campaign(o);
    for (const std::string family : {"glide", "towed", "jet", "both"}) {
        if (o.family != "all" && o.family != family) continue;
        const dynamics::Model model = dynamics::read_model(bench::write_declared_model(family, folder.path() / family));
        const auto cases = [&](const std::string& kind, const std::vector<std::string>& names, const std::string& law,
                               double level, int shift = 0, std::uint64_t draw = 0) {
            if (!campaign.wants(kind, names, law, level)) return;
            for (int s = 0; s < o.seeds; ++s) {
                bench::Case wanted;
                wanted.family = family;
                wanted.names = names;
                wanted.law = law;
                wanted.level = level;
                wanted.draw = draw;
                wanted.seed = o.first_seed + static_cast<std::uint64_t>(s + shift);
                wanted.coloured = wanted.seed % 4 == 1;
                wanted.declared_noise = kind.rfind("noise", 0) == 0 ? (wanted.seed % 3 == 0   ? 0
                                                                       : wanted.seed % 3 == 1 ? 0.5
                                                                                              : 2)
                                        : wanted.seed % 5 == 4      ? 0
                                                                    : 1;
                run(campaign, wanted, model, kind);
            }
        };
        for (const double level : {1.0, 2.0}) {
            for (const std::string& name : bench::effects_of(family))
                cases(level == 1 ? "single 1x" : "single 2x", {name}, "", level);
        }
        std::uint64_t draw = 0;
        for (const double level : {0.4, 0.6, 0.8}) {  // verdicts that are not sure; only where asked for
            for (const std::string& name : bench::effects_of(family))
                if (o.kind == "weak") cases("weak", {name}, "", level, 0, ++draw);
        }
        for (const std::string& law : bench::unknown_laws(family)) cases("unknown", {"unknown"}, law, 3);
        for (int k = 0; k < 5; ++k) cases("clean", {}, "", 0, 101 * k);
        const std::string other = family == "jet" ? "pump_curve" : "current";
        cases("pair", {"force_bias", other}, "", 4);
        cases("pair", {"gap_offset", "drift"}, "", 4);
        cases("rig scale and offset", {"gap_offset", "sensor_gain"}, bench::scale_and_offset, 1);
        cases("rig large scale and offset", {"gap_offset", "sensor_gain"}, "", 25);
        cases("noise single", {"gap_offset"}, "", 2);
        cases("noise single", {"sensor_gain"}, "", 2);
        cases("noise clean", {}, "", 0, 50);
    }
    campaign.print();
    return 0;
}
