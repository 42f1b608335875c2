// Scores discover() and its peers on static data sets with known truth. bench_discovery_static --help says how.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <map>

#include "core/file.h"
#include "tests/bench/discovery/peers.h"
#include "tests/bench/discovery/plants.h"
#include "tests/bench/discovery/score.h"

using namespace underbody;

namespace {

struct Options {
    std::string family = "all", kind = "all", only;
    int seeds = 4;
    std::uint64_t first_seed = 1000;
    double level = 0;
    bool verbose = false, peers = true, markdown = false;
};

const char* const usage =
    "bench_discovery_static [--family glide|towed|jet|both] [--kind single|clean|unknown|pair|noise] [--only EFFECT] [--level X]\n"
    "                       [--seeds N] [--first-seed N] [--no-peers] [--markdown] [--verbose]\n"
    "Constants of the program were set on seeds 1 to 99; figures are quoted from seeds 1000 and up.\n";

using Tallies = std::map<std::string, std::map<std::string, bench::Tally>>;  // kind -> method

std::string channel_of_error(const discovery::Discovery& found) { return found.error.front().channel; }

void describe(const bench::Case& wanted, const bench::Outcome& one, const discovery::Discovery& found) {
    std::string said;
    for (std::size_t k = 0; k < one.names.size(); ++k) {
        said += one.names[k] + " ";
    }
    for (const auto& [name, probability] : one.rivals) {
        if (probability > 0.005) {
            said += "| " + name + " " + std::to_string(probability).substr(0, 5) + " ";
        }
    }
    std::string on;
    for (const std::string& name : found.depends_on) {
        on += name + " ";
    }
    std::printf("   %-60s -> %s %.2f gate %.2g: %s; dep %s; err %.2f -> %.2f (best %.2f) pull %.1f\n", wanted.text().c_str(), one.verdict.c_str(), one.stated,
                found.gate, said.c_str(), on.c_str(), one.before, one.after, one.best, one.pull);
    std::fflush(stdout);
}

bench::Outcome peer_outcome(const bench::PeerAnswer& answer, const bench::Sample& sample, const std::string& channel, double noise) {
    bench::Outcome one;
    one.truth = sample.names;
    one.verdict = answer.verdict;
    one.names = answer.verdict == "unknown" ? std::vector<std::string>{"unknown"} : answer.names;
    std::vector<std::string> truth = sample.depends_on, said = answer.depends_on;
    std::sort(truth.begin(), truth.end());
    std::sort(said.begin(), said.end());
    one.variables = truth == said;
    one.after = answer.rmse.at(channel) / noise;
    return one;
}

void run(const bench::Case& wanted, const dynamics::Model& model, const Options& options, const std::string& kind, Tallies& tallies) {
    const bench::Sample sample = bench::make_sample(wanted);
    dynamics::Measurements data = sample.train;
    data.runs.insert(data.runs.end(), sample.test.runs.begin(), sample.test.runs.end());
    discovery::DiscoverOptions settings;
    settings.figures = settings.consequence = false;
    const discovery::Discovery found = discovery::discover(model, data, settings);
    bench::Outcome one = bench::outcome_of(found, sample.names, sample.depends_on);
    const std::string channel = channel_of_error(found);
    const double noise = bench::static_noise(wanted.family, channel);
    one.before = found.error.front().before.rmse / noise;
    one.after = found.error.front().after.rmse / noise;
    one.best = bench::static_oracle(wanted, sample).at(channel) / noise;
    if (one.right() && sample.names.size() == 1 && one.verdict == "effect" && std::isfinite(sample.in_catalogue_terms)) {
        const discovery::FoundParameter& p = found.effects.front().parameters.front();
        one.pull = p.sigma > 0 ? (p.value - sample.in_catalogue_terms) / p.sigma : std::nan("");
    }
    if (options.verbose || (!one.right() && !one.tied()) || one.after > 1.15 * one.best) {
        describe(wanted, one, found);
    }
    for (const std::string& key : {kind, wanted.family + " " + kind, wanted.family + "   " + (wanted.names.empty() ? "clean" : wanted.names.front()) + " " + wanted.law}) {
        tallies[key]["discover"].outcomes.push_back(one);
    }
    if (!options.peers) {
        return;
    }
    bench::Noise sigma;
    for (const char* name : {"lift_force", "drag_force", "pitch_moment"}) {
        sigma[name] = bench::static_noise(wanted.family, name);
    }
    const std::map<std::string, bench::PeerAnswer> answers{
        {"sparse regression (STLSQ)", bench::sparse_regression(model, sample.train, sample.test, sigma)},
        {"polynomial residual", bench::polynomial_residual(model, sample.train, sample.test, sigma)},
        {"Gaussian-process discrepancy", bench::gaussian_process_discrepancy(model, sample.train, sample.test, sigma)}};
    for (const auto& [name, answer] : answers) {
        bench::Outcome other = peer_outcome(answer, sample, channel, noise);
        other.before = one.before;
        other.best = one.best;
        tallies[kind][name].outcomes.push_back(other);
    }
}

/// The table of the README.
void print_markdown(const Tallies& tallies) {
    std::printf("\n| method | one effect at 1x: named (wrong) | at 2x: named (wrong) | clean: false | outside the catalogue: said so, with its variables | held-out error over the best "
                "reachable, 2x |\n|---|---|---|---|---|---|\n");
    for (const char* method : {"discover", "sparse regression (STLSQ)", "polynomial residual", "Gaussian-process discrepancy"}) {
        const auto tally = [&](const char* kind) {
            const auto found = tallies.find(kind);
            return found == tallies.end() || found->second.count(method) == 0 ? bench::Tally{} : found->second.at(method);
        };
        const auto named = [](const bench::Tally& t) {
            return bench::share(t.count([](const bench::Outcome& o) { return o.right() || o.tied(); }), t.count()) + ", " +
                   std::to_string(t.count([](const bench::Outcome& o) { return o.wrong(); })) + " wrong";
        };
        const bench::Tally clean = tally("clean"), unknown = tally("unknown");
        std::printf("| %s | %s | %s | %s | %s | %.2f |\n", method, named(tally("single 1x")).c_str(), named(tally("single 2x")).c_str(),
                    bench::share(clean.count([](const bench::Outcome& o) { return !o.right(); }), clean.count()).c_str(),
                    bench::share(unknown.count([](const bench::Outcome& o) { return o.right() && o.variables; }), unknown.count()).c_str(), tally("single 2x").oracle_gap());
    }
}

Options read(int argc, char** argv) {
    Options o;
    for (int i = 1; i < argc; ++i) {
        const auto value = [&](const char* key) { return std::strcmp(argv[i], key) == 0 && i + 1 < argc; };
        if (value("--family")) o.family = argv[++i];
        else if (value("--kind")) o.kind = argv[++i];
        else if (value("--only")) o.only = argv[++i];
        else if (value("--seeds")) o.seeds = std::atoi(argv[++i]);
        else if (value("--first-seed")) o.first_seed = static_cast<std::uint64_t>(std::atoi(argv[++i]));
        else if (value("--level")) o.level = std::atof(argv[++i]);
        else if (std::strcmp(argv[i], "--verbose") == 0) o.verbose = true;
        else if (std::strcmp(argv[i], "--markdown") == 0) o.markdown = true;
        else if (std::strcmp(argv[i], "--no-peers") == 0) o.peers = false;
        else {
            std::printf("%s", usage);
            std::exit(2);
        }
    }
    return o;
}

}  // namespace

int main(int argc, char** argv) {
    const Options o = read(argc, argv);
    core::TemporaryFolder folder("bench");
    Tallies tallies;
    for (const std::string family : {"glide", "towed", "jet", "both"}) {
        if (o.family != "all" && o.family != family) continue;
        const dynamics::Model model = dynamics::read_model(bench::write_declared_model(family, folder.path() / family));
        const auto cases = [&](const std::string& kind, const std::vector<std::string>& names, const std::string& law, double level, int shift = 0) {
            const std::string word = kind.substr(0, kind.find(' '));
            if (o.kind != "all" && o.kind != word) return;
            if (!o.only.empty() && std::find(names.begin(), names.end(), o.only) == names.end() && law != o.only) return;
            if (o.level > 0 && level != o.level) return;
            for (int s = 0; s < o.seeds; ++s) {
                bench::Case wanted;
                wanted.family = family;
                wanted.names = names;
                wanted.law = law;
                wanted.level = level;
                wanted.seed = o.first_seed + static_cast<std::uint64_t>(s + shift);
                wanted.coloured = wanted.seed % 4 == 1;
                wanted.declared_noise = word == "noise" ? (wanted.seed % 3 == 0 ? 0 : wanted.seed % 3 == 1 ? 0.5 : 2) : wanted.seed % 5 == 4 ? 0 : 1;
                run(wanted, model, o, kind, tallies);
            }
        };
        for (const double level : {1.0, 2.0}) {
            for (const std::string& name : bench::effects_of(family)) cases(level == 1 ? "single 1x" : "single 2x", {name}, "", level);
        }
        for (const std::string& law : bench::unknown_laws(family)) cases("unknown", {"unknown"}, law, 3);
        for (int k = 0; k < 5; ++k) cases("clean", {}, "", 0, 101 * k);
        const std::string other = family == "jet" ? "pump_curve" : "current";
        cases("pair", {"force_bias", other}, "", 4);
        cases("pair", {"gap_offset", "drift"}, "", 4);
        cases("noise single", {"gap_offset"}, "", 2);
        cases("noise single", {"sensor_gain"}, "", 2);
        cases("noise clean", {}, "", 0, 50);
    }
    std::printf("\n");
    std::vector<bench::Outcome> all;
    for (const auto& [kind, methods] : tallies) {
        for (const auto& [method, tally] : methods) {
            std::printf("%-40s %-28s %s\n", kind.c_str(), method.c_str(), tally.line().c_str());
        }
        const bool whole = kind.find("   ") != std::string::npos;  // each data set stands in one of these
        if (whole) {
            const auto& outcomes = methods.at("discover").outcomes;
            all.insert(all.end(), outcomes.begin(), outcomes.end());
        }
    }
    std::printf("\n%s%s", bench::calibration_lines(all).c_str(), bench::coverage_line(all).c_str());
    if (o.markdown) {
        print_markdown(tallies);
    }
    return 0;
}
