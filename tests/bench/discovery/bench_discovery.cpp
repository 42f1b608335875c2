// Scores discover() on data sets with known truth. bench_discovery --help says how.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <ctime>
#include <map>

#include "core/file.h"
#include "core/parallel.h"
#include "surrogates/discovery/discovery.h"
#include "surrogates/discovery/statistics.h"
#include "tests/bench/discovery/plants.h"

using namespace underbody;

namespace {

struct Score {
    std::size_t count = 0, right = 0, tied = 0, wrong = 0, none = 0, unknown = 0, variables = 0;
    double seconds = 0, before = 0, after = 0;
    double gap_sum = 0;                            ///< error after over the error with the true effect fitted, less one
    std::size_t gaps = 0, worse_clean = 0;
    std::size_t covered = 0, intervals = 0;        ///< 95 % intervals of the effect's chief number
    std::vector<std::pair<double, bool>> stated;   ///< probability and whether it was right
};

bool delays(const std::string& a, const std::string& b) {
    return (a == "input_delay" && b == "gap_sensor_delay") || (a == "gap_sensor_delay" && b == "input_delay");
}

bool buoyancies(const std::string& a, const std::string& b) {
    return (a == "cable_buoyancy" && b == "strut_buoyancy") || (a == "strut_buoyancy" && b == "cable_buoyancy");
}

std::vector<std::string> sorted(std::vector<std::string> names) {
    std::sort(names.begin(), names.end());
    return names;
}

struct Options {
    std::string family = "all", kind = "all", only;
    int seeds = 2;
    std::uint64_t first_seed = 1;
    bool verbose = false;
    double level = 0, rate = 50;
    int coloured = -1, velocity = -1, threads = 0;
    bool oracle = false;
};

/// The catalogue's number for the plant's strength where both mean the same.
bool comparable(const std::string& name, double strength, double& number) {
    number = name == "input_gain" || name == "declared_parameter" ? 1 + strength : strength;
    return name == "constant_force" || name == "added_mass" || name == "input_gain" || name == "input_delay" || name == "actuator_lag" ||
           name == "gap_sensor_delay" || name == "gap_sensor_bias" || name == "ambient_heave_current" || name == "declared_parameter" ||
           name == "periodic_disturbance" || name == "coulomb_friction";
}

void count_extras(const bench::Case& wanted, const bench::Sample& sample, const dynamics::Model& model, const dynamics::Measurements& data,
                  const discovery::Discovery& found, bool right, bool oracle, Score& total) {
    const auto& error = found.error.front();
    if (wanted.names.empty()) {
        total.worse_clean += error.after.rmse > error.before.rmse * 1.0001;
        return;
    }
    double number = 0;
    if (right && wanted.names.size() == 1 && comparable(wanted.names.front(), sample.strength, number)) {
        const discovery::FoundParameter& p = found.effects.front().parameters.front();
        ++total.intervals;
        total.covered += std::abs(p.value - number) <= 1.96 * p.sigma;
    }
    if (oracle && wanted.names.size() == 1 && wanted.names.front() != "unknown") {
        discovery::DiscoverOptions options;
        options.figures = options.consequence = false;
        options.candidates = wanted.names;
        const discovery::Discovery best = discovery::discover(model, data, options);
        if (best.verdict == "effect") {
            total.gap_sum += error.after.rmse / best.error.front().after.rmse - 1;
            ++total.gaps;
        }
    }
}

void score(const bench::Case& wanted, const dynamics::Model& model, Score& total, bool verbose, bool oracle) {
    const bench::Sample sample = bench::make_sample(wanted);
    dynamics::Measurements data = sample.train;
    data.runs.insert(data.runs.end(), sample.test.runs.begin(), sample.test.runs.end());
    discovery::DiscoverOptions options;
    options.figures = options.consequence = false;
    const std::clock_t begin = std::clock();
    discovery::Discovery found = discovery::discover(model, data, options);
    found.seconds = static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC;   // of all threads: fair on a busy machine
    std::vector<std::string> names;
    for (const auto& effect : found.effects) {
        names.push_back(effect.name);
    }
    ++total.count;
    total.seconds += found.seconds;
    bool tied = false;
    for (const auto& rival : found.alternatives) {
        tied = tied || (rival.probability > 0.2 && wanted.names.size() == 1 && rival.name == wanted.names.front());
    }
    if (names.size() == 1 && wanted.names.size() == 1 && (delays(names[0], wanted.names[0]) || buoyancies(names[0], wanted.names[0]))) {
        tied = true;
    }
    const bool right = sorted(names) == sorted(wanted.names);
    total.right += right;
    total.tied += !right && tied;
    total.none += !right && !tied && found.verdict == "none";
    total.unknown += !right && !tied && found.verdict == "unknown";
    total.wrong += !right && !tied && found.verdict == "effect";
    total.variables += sorted(found.depends_on) == sorted(sample.depends_on);
    if (!found.effects.empty()) {
        total.stated.emplace_back(found.effects.front().probability, right);
    } else {
        total.stated.emplace_back(found.none_probability, right);
    }
    count_extras(wanted, sample, model, data, found, right, oracle, total);
    const auto& error = found.error.front();
    total.before += error.before.rmse / error.noise;
    total.after += error.after.rmse / error.noise;
    if (verbose || (!right && !tied)) {
        std::string said;
        for (const auto& effect : found.effects) {
            said += effect.name + "(" + std::to_string(effect.probability).substr(0, 4) + ") ";
        }
        for (const auto& rival : found.alternatives) {
            said += "| " + rival.name + " " + std::to_string(rival.probability).substr(0, 5) + " ex " + std::to_string(static_cast<long>(rival.explained)) + " ";
            if (said.size() > 230) break;
        }
        std::string on;
        for (const auto& name : found.depends_on) {
            on += name + " ";
        }
        std::printf("   %-52s -> %s gate %.2g ex %.0f: %s; dep %s; err %.2f -> %.2f; %.1f s\n", wanted.text().c_str(), found.verdict.c_str(), found.gate,
                    found.effects.empty() ? 0.0 : found.effects.front().explained, said.c_str(), on.c_str(), error.before.rmse / error.noise,
                    error.after.rmse / error.noise, found.seconds);
    }
    std::fflush(stdout);
}

void print(const std::string& name, const Score& s) {
    const std::size_t good = s.right + s.tied;
    const discovery::Interval w = discovery::wilson_interval(good, s.count);
    std::string extras;
    char text[128];
    if (s.intervals > 0) {
        std::snprintf(text, sizeof text, " | 95 %% intervals hold %zu of %zu", s.covered, s.intervals);
        extras += text;
    }
    if (s.gaps > 0) {
        std::snprintf(text, sizeof text, " | after over true effect refitted %.3f", 1 + s.gap_sum / static_cast<double>(s.gaps));
        extras += text;
    }
    std::printf("%-44s n %3zu right %3zu tied %2zu wrong %2zu none %2zu unknown %2zu | %.2f (%.2f-%.2f) | variables %zu | error %.2f -> %.2f noise | %.1f s%s\n",
                name.c_str(), s.count, s.right, s.tied, s.wrong, s.none, s.unknown, static_cast<double>(good) / static_cast<double>(std::max<std::size_t>(s.count, 1)),
                w.low, w.high, s.variables, s.before / static_cast<double>(s.count), s.after / static_cast<double>(s.count), s.seconds / static_cast<double>(s.count), extras.c_str());
}

}  // namespace

int main(int argc, char** argv) {
    Options o;
    for (int i = 1; i < argc; ++i) {
        const auto value = [&](const char* key) { return std::strcmp(argv[i], key) == 0 && i + 1 < argc; };
        if (value("--family")) o.family = argv[++i];
        else if (value("--kind")) o.kind = argv[++i];
        else if (value("--only")) o.only = argv[++i];
        else if (value("--seeds")) o.seeds = std::atoi(argv[++i]);
        else if (value("--first-seed")) o.first_seed = static_cast<std::uint64_t>(std::atoi(argv[++i]));
        else if (value("--level")) o.level = std::atof(argv[++i]);
        else if (value("--rate")) o.rate = std::atof(argv[++i]);
        else if (value("--coloured")) o.coloured = std::atoi(argv[++i]);
        else if (value("--threads")) o.threads = std::atoi(argv[++i]);
        else if (std::strcmp(argv[i], "--oracle") == 0) o.oracle = true;
        else if (value("--velocity")) o.velocity = std::atoi(argv[++i]);
        else if (std::strcmp(argv[i], "--verbose") == 0) o.verbose = true;
        else {
            std::printf("bench_discovery [--family heave|glide|jet] [--kind single|clean|unknown|pair] [--only EFFECT] [--seeds N] [--first-seed N]\n"
                        "                [--level X] [--rate HZ] [--coloured 0|1] [--velocity 0|1] [--threads N] [--oracle] [--verbose]\n");
            return 2;
        }
    }
    core::set_threads(o.threads);
    core::TemporaryFolder folder("bench");
    std::map<std::string, Score> totals;
    for (const std::string family : {"glide", "jet", "heave"}) {
        if (o.family != "all" && o.family != family) continue;
        const dynamics::Model model = dynamics::read_model(bench::write_declared_model(family, folder.path() / family));
        const auto cases = [&](const std::string& kind, const std::vector<std::string>& names, const std::string& law, double level, int shift = 0) {
            if (o.kind != "all" && o.kind != kind) return;
            if (!o.only.empty() && std::find(names.begin(), names.end(), o.only) == names.end() && law != o.only) return;
            for (int s = 0; s < o.seeds; ++s) {
                bench::Case wanted;
                wanted.family = family;
                wanted.names = names;
                wanted.law = law;
                wanted.level = level;
                wanted.seed = o.first_seed + static_cast<std::uint64_t>(s + shift);
                wanted.rate = o.rate;
                wanted.velocity = o.velocity >= 0 ? o.velocity == 1 : wanted.seed % 3 == 0;
                wanted.coloured = o.coloured >= 0 ? o.coloured == 1 : wanted.seed % 4 == 1;
                wanted.declared_noise = wanted.seed % 5 == 4 ? 0 : wanted.seed % 7 == 6 ? 0.5 : 1;
                Score one;
                score(wanted, model, one, o.verbose, o.oracle);
                for (const std::string& key : {family + " " + kind + (level > 0 ? " " + std::to_string(level).substr(0, 3) + "x" : ""),
                                              family + "   " + (names.empty() ? "clean" : names.front()) + " " + law}) {
                    Score& t = totals[key];
                    t.count += one.count; t.right += one.right; t.tied += one.tied; t.wrong += one.wrong; t.none += one.none;
                    t.unknown += one.unknown; t.variables += one.variables; t.seconds += one.seconds; t.before += one.before; t.after += one.after;
                    t.gap_sum += one.gap_sum; t.gaps += one.gaps; t.worse_clean += one.worse_clean; t.covered += one.covered; t.intervals += one.intervals;
                    t.stated.insert(t.stated.end(), one.stated.begin(), one.stated.end());
                }
            }
        };
        for (const double level : o.level > 0 ? std::vector<double>{o.level} : std::vector<double>{1.0, 2.0}) {
            for (const std::string& name : bench::effects_of(family)) cases("single", {name}, "", level);
        }
        for (const std::string& law : bench::unknown_laws(family)) cases("unknown", {"unknown"}, law, o.level > 0 ? o.level : 3);
        for (int k = 0; k < 4; ++k) cases("clean", {}, "", 0, k * o.seeds);
        if (family == "heave") {
            cases("pair", {"constant_force", "linear_damping"}, "", 4);
            cases("pair", {"coulomb_friction", "input_gain"}, "", 4);
            cases("pair", {"added_mass", "tether_stiffness"}, "", 4);
        }
    }
    std::printf("\n");
    std::vector<std::pair<double, bool>> stated;
    for (const auto& [name, total] : totals) {
        print(name, total);
        if (name.find("   ") != std::string::npos) stated.insert(stated.end(), total.stated.begin(), total.stated.end());
    }
    for (const double low : {0.0, 0.5, 0.7, 0.9, 0.97}) {
        const double high = low == 0.0 ? 0.5 : low == 0.5 ? 0.7 : low == 0.7 ? 0.9 : low == 0.9 ? 0.97 : 1.01;
        double sum = 0, right = 0, n = 0;
        for (const auto& [p, ok] : stated) {
            if (p >= low && p < high) { sum += p; right += ok; n += 1; }
        }
        if (n > 0) std::printf("stated %.2f to %.2f: n %3.0f mean stated %.3f right %.3f\n", low, high, n, sum / n, right / n);
    }
    return 0;
}
